/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Chosen material points as LAMMPS dumps: point_17.dump holds the grains, point_17.contacts.dump the contacts
 * (a `dump local`).
 *
 * A frame is put together in memory, appended by one write and fsynced. A write that fails is taken back; one
 * that is cut by a kill leaves a part of one frame at the end. Whatever follows the last whole frame of an
 * earlier increment is cut off before the next frame, so that a run that continues also replaces what a
 * killed one left. */
#include "results/results.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- files that grow by whole frames ---- */

/* Passes over one line; false when it is not there with its end. */
static bool line_pass(FILE *file, char **line, size_t *size) {
  ssize_t n = getline(line, size, file);
  return n > 0 && (*line)[n - 1] == '\n';
}

/* Passes over one frame of an increment before `counter`; false when there is none, or only a part of one. */
static bool frame_pass(FILE *file, char **line, size_t *size, long counter) {
  long step, rows;
  if (!line_pass(file, line, size) || strcmp(*line, "ITEM: TIMESTEP\n") != 0) return false;
  if (!line_pass(file, line, size) || sscanf(*line, "%ld", &step) != 1 || step >= counter) return false;
  if (!line_pass(file, line, size)) return false;
  if (!line_pass(file, line, size) || sscanf(*line, "%ld", &rows) != 1) return false;
  if (rows < 0 || rows > LONG_MAX - 5) return false;
  for (long k = 0; k < rows + 5; k++) /* box and its three sides, head of the table, rows */
    if (!line_pass(file, line, size)) return false;
  return true;
}

static gh_status cannot(gh_context *ctx, const char *path, const char *what) {
  return gh_fail(ctx, GH_SYSTEM, "%s: cannot %s: %s", path, what, strerror(errno));
}

/* Where the whole frames of increments before `counter` end. */
static gh_status end_find(gh_context *ctx, const char *path, int counter, off_t *end) {
  bool there = false;
  *end = 0;
  GH_TRY(gh_file_regular(ctx, path));
  if (counter > 0) GH_TRY(gh_file_there(ctx, path, &there));
  if (!there) return GH_OK;
  FILE *file = fopen(path, "r");
  if (!file) return cannot(ctx, path, "open");
  char *line = NULL;
  size_t size = 0;
  while (frame_pass(file, &line, &size, counter)) *end = ftello(file);
  gh_status status = feof(file) || !ferror(file) ? GH_OK : cannot(ctx, path, "read");
  free(line);
  fclose(file);
  return status;
}

/* *end: where the frame goes, -1 while unknown; afterwards where the next one goes. */
static gh_status frame_append(gh_context *ctx, const char *path, int counter, const gh_text *frame,
                              off_t *end) {
  size_t length, done = 0;
  GH_TRY(gh_text_check(frame));
  const char *bytes = gh_text_get(frame, &length);
  if (*end < 0) GH_TRY(end_find(ctx, path, counter, end));
  int fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (fd < 0) return cannot(ctx, path, "open");
  gh_status status = ftruncate(fd, *end) == 0 ? GH_OK : cannot(ctx, path, "cut");
  while (status == GH_OK && done < length) {
    ssize_t n = pwrite(fd, bytes + done, length - done, *end + (off_t)done);
    if (n > 0) done += (size_t)n;
    else if (n < 0 && errno != EINTR) status = cannot(ctx, path, "write");
  }
  if (status == GH_OK && fsync(fd) != 0) status = cannot(ctx, path, "write");
  if (status != GH_OK && ftruncate(fd, *end) != 0) status = cannot(ctx, path, "take back a part of a frame");
  if (close(fd) != 0 && status == GH_OK && errno != EINTR) status = cannot(ctx, path, "write");
  if (status == GH_OK) *end += (off_t)length;
  return status;
}

/* ---- frames ---- */

/* The box of a frame, and how positions are turned into it. LAMMPS wants the first lattice vector along x. */
typedef struct box {
  bool periodic;
  double cell[4], turn[4], inverse[4], low[2], high[2];
} box;

static void box_find(const gh_rve_view *v, box *b) {
  *b = (box){.periodic = v->periodic, .turn = {1, 0, 0, 1}};
  if (v->periodic) {
    double a = hypot(v->cell[0], v->cell[2]), c = v->cell[0] / a, s = v->cell[2] / a;
    memcpy(b->turn, (double[4]){c, s, -s, c}, sizeof b->turn);
    gh_mul2(b->turn, v->cell, b->cell);
    b->cell[2] = 0;
    b->cell[1] -= nearbyint(b->cell[1] / b->cell[0]) * b->cell[0]; /* the same lattice with the least tilt */
    gh_apply2(b->turn, v->low, b->low);
    gh_inv2(b->cell, b->inverse);
    return;
  }
  for (int k = 0; k < 2; k++) {
    b->low[k] = INFINITY, b->high[k] = -INFINITY;
    for (int i = 0; i < v->n; i++) {
      b->low[k] = fmin(b->low[k], v->x[2 * i + k] - v->radius[i]);
      b->high[k] = fmax(b->high[k], v->x[2 * i + k] + v->radius[i]);
    }
  }
}

static void head_print(gh_text *t, long counter, const char *what, int rows, const box *b) {
  gh_text_print(t, "ITEM: TIMESTEP\n%ld\nITEM: NUMBER OF %s\n%d\n", counter, what, rows);
  if (b->periodic) {
    double tilt = b->cell[1];
    gh_text_print(t, "ITEM: BOX BOUNDS xy xz yz pp pp pp\n%.17g %.17g %.17g\n%.17g %.17g 0\n-0.5 0.5 0\n",
                  b->low[0] + fmin(tilt, 0), b->low[0] + b->cell[0] + fmax(tilt, 0), tilt, b->low[1],
                  b->low[1] + b->cell[3]);
  } else {
    gh_text_print(t, "ITEM: BOX BOUNDS ff ff pp\n%.17g %.17g\n%.17g %.17g\n-0.5 0.5\n", b->low[0], b->high[0],
                  b->low[1], b->high[1]);
  }
}

static void columns_print(gh_text *t, const char *what, const gh_term *columns, const gh_term *more,
                          const gh_term *most) {
  const gh_term *const lists[] = {columns, more, most};
  gh_text_print(t, "ITEM: %s", what);
  for (int k = 0; k < 3; k++) {
    if (lists[k]) gh_text_print(t, " ");
    if (lists[k]) gh_terms_header(t, lists[k], " ");
  }
  gh_text_print(t, "\n");
}

/* x in the box, and how many lattice vectors it is away from it. */
static void box_enter(const box *b, const double from[2], double x[2], int image[2]) {
  double s[2];
  gh_apply2(b->turn, from, x);
  image[0] = image[1] = 0;
  if (!b->periodic) return;
  for (int k = 0; k < 2; k++) s[k] = x[k] - b->low[k];
  gh_apply2(b->inverse, s, s);
  double shift[2] = {floor(s[0]), floor(s[1])};
  for (int k = 0; k < 2; k++) image[k] = (int)shift[k];
  gh_apply2(b->cell, shift, s);
  for (int k = 0; k < 2; k++) x[k] -= s[k];
}

static void grains_print(gh_text *t, long counter, const gh_rve_view *v, const box *b) {
  head_print(t, counter, "ATOMS", v->n, b);
  columns_print(t, "ATOMS", results_grain_columns, v->theta ? results_grain_friction : NULL,
                v->support ? results_grain_frame : NULL);
  for (int i = 0; i < v->n; i++) {
    double x[2];
    int image[2];
    box_enter(b, v->x + 2 * i, x, image);
    gh_text_print(t, "%d %d %.17g %.17g 0 %d %d 0 %.17g %d %d %d %d", i + 1, v->type[i], x[0], x[1], image[0],
                  image[1], v->radius[i], v->id[i], v->flags[i] & 1, v->flags[i] >> 1 & 1,
                  v->flags[i] >> 2 & 1);
    if (v->theta) gh_text_print(t, " %.17g", v->theta[i]);
    if (v->support) {
      double a[2];
      gh_apply2(b->turn, v->support + 3 * i, a);
      gh_text_print(t, " %d %.17g %.17g %.17g", v->flags[i] >> 3 & 1, a[0], a[1], v->support[3 * i + 2]);
    }
    gh_text_print(t, "\n");
  }
}

void gh_dump_grains(gh_text *out, long step, const gh_rve_view *view) {
  box b;
  box_find(view, &b);
  grains_print(out, step, view, &b);
}

/* Force on the first grain, its parts along -n (pressing) and along t, n rotated by +90 degrees. */
static void contact_print(gh_text *t, const gh_rve_view *v, const box *b, int k) {
  const gh_contact *c = v->contacts + k;
  double x[2], l[2], f[2], length = hypot(c->l[0], c->l[1]);
  int image[2];
  box_enter(b, v->x + 2 * c->i, x, image);
  gh_apply2(b->turn, c->l, l);
  gh_apply2(b->turn, c->f, f);
  double n[2] = {l[0] / length, l[1] / length}, along = f[0] * n[0] + f[1] * n[1];
  gh_text_print(t, "%d %d %d %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g", k + 1, c->i + 1,
                c->j + 1, x[0], x[1], l[0], l[1], f[0], f[1], -along, f[1] * n[0] - f[0] * n[1], c->overlap);
  if (v->friction) {
    const gh_friction *q = v->friction + k;
    gh_text_print(t, " %d %.17g %.17g", q->slides != 0, q->slip.gamma, q->slip.gamma_pl);
  }
  gh_text_print(t, "\n");
}

static void contacts_print(gh_text *t, long counter, const gh_rve_view *v, const box *b) {
  head_print(t, counter, "ENTRIES", v->ncontacts, b);
  columns_print(t, "ENTRIES", results_contact_columns, v->friction ? results_contact_friction : NULL, NULL);
  for (int k = 0; k < v->ncontacts; k++) contact_print(t, v, b, k);
}

static gh_status point_dump(gh_results *r, const gh_frame *f, const char *folder, int point, bool contacts,
                            const gh_rve_view *v, const box *b, off_t *end) {
  char name[64];
  gh_text *frame;
  snprintf(name, sizeof name, "point_%d.%sdump", point, contacts ? "contacts." : "");
  char *path = gh_path_join(folder, name);
  if (!path) return gh_fail(r->ctx, GH_MEMORY, "no memory for a path");
  gh_status status = gh_text_create(r->ctx, &frame);
  if (status == GH_OK) {
    (contacts ? contacts_print : grains_print)(frame, f->counter, v, b);
    status = frame_append(r->ctx, path, f->counter, frame, end);
    gh_text_destroy(&frame);
  }
  free(path);
  return status;
}

/* The dumps of a run before. */
static void dumps_remove(const char *folder) {
  DIR *dir = opendir(folder);
  for (struct dirent *e; dir && (e = readdir(dir));) {
    if (strncmp(e->d_name, "point_", 6) != 0 || strlen(e->d_name) < 5 ||
        strcmp(e->d_name + strlen(e->d_name) - 5, ".dump") != 0)
      continue;
    char *path = gh_path_join(folder, e->d_name);
    if (path) unlink(path);
    free(path);
  }
  if (dir) closedir(dir);
}

static gh_status dumps_write(gh_results *r, const gh_frame *f, const char *folder) {
  const gh_solver_results *s = r->solver;
  const bool all = s->dumped.count == GH_ALL_POINTS;
  int count = all ? r->points : s->dumped.count;
  if (count == 0) return GH_OK;
  GH_TRY(gh_folder_make(r->ctx, folder));
  if (!r->dump_end) {
    GH_TRY(gh_alloc(r->ctx, 2 * (size_t)count, sizeof *r->dump_end, &r->dump_end));
    for (int k = 0; k < 2 * count; k++) r->dump_end[k] = -1;
  }
  for (int k = 0; k < count; k++) {
    int point = all ? k : s->dumped.point[k];
    gh_rve_view v;
    const gh_rve_measures *m;
    box b;
    GH_TRY(s->inspect(s->data, point, &v, &m));
    if (!m) continue;
    box_find(&v, &b);
    GH_TRY(point_dump(r, f, folder, point, false, &v, &b, r->dump_end + 2 * k));
    GH_TRY(point_dump(r, f, folder, point, true, &v, &b, r->dump_end + 2 * k + 1));
  }
  return GH_OK;
}

gh_status results_write_dumps(gh_results *r, const gh_frame *f) {
  char *folder;
  GH_TRY(results_path(r, "dumps", &folder));
  if (f->counter == 0) dumps_remove(folder);
  gh_status status = f->counter % r->solver->dump_every == 0 ? dumps_write(r, f, folder) : GH_OK;
  free(folder);
  return status;
}
