/* SPDX-License-Identifier: GPL-2.0-or-later */
/* LIGGGHTS along a path, as a child process: a script and a data file in a temporary folder, and per row a
 * file with the contacts in equilibrium.
 *
 * The script relaxes each row until the residual is met, with `jump`. The motion from row to row goes through
 * velocities for the reason stated in gran.c. LIGGGHTS 3.8 makes no images of grains in
 * tilted cells (its list of ghosts is empty), so a path with shear is refused. */
#include "crosscheck/child.h"
#include "crosscheck/peers.h"

#include "granhom/io.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* Columns of the contacts' file: positions of both grains, ids and a flag, force on the first (and the
 * overlap, which the script itself uses). */
enum { X1, Y1, Z1, X2, Y2, Z2, ID1, ID2, PERIODIC, FX, FY, FZ, COLUMNS };

enum { PATH_SIZE = sizeof(((gh_temporary *)NULL)->folder) + 32 };

typedef struct liggghts {
  gh_context *ctx;
  const gh_peer_problem *p;
  peer_motion m;
  char *program;
  gh_temporary own; /* folder that the program runs in: the script names files without it */
} liggghts;

/* ---- what it reads ---- */

static gh_status write_data(const liggghts *g) {
  gh_text *text;
  char path[PATH_SIZE];
  peer_cell c;
  double z = 0;
  peer_cell_find(g->p, -1, &c);
  for (int i = 0; i < g->p->n; i++) z = fmax(z, g->p->radius[i]);
  GH_TRY(gh_text_create(g->ctx, &text));
  gh_text_print(text, "packing\n\n%d atoms\n1 atom types\n\n0 %.17g xlo xhi\n0 %.17g ylo yhi\n", g->p->n,
                c.t[0], c.t[3]);
  gh_text_print(text, "%.17g %.17g zlo zhi\n\nAtoms\n\n", -z, z);
  for (int i = 0; i < g->p->n; i++) {
    const double *at = g->p->x + 2 * i, r = g->p->radius[i];
    double y[2] = {c.q[0] * at[0] + c.q[2] * at[1], c.q[1] * at[0] + c.q[3] * at[1]}; /* q^T x */
    y[0] -= floor(y[0] / c.t[0]) * c.t[0];
    y[1] -= floor(y[1] / c.t[3]) * c.t[3];
    /* in the plane the mass is density pi r^2: 1 */
    gh_text_print(text, "%d 1 %.17g %.17g %.17g %.17g 0\n", i + 1, 2 * r, 1 / (acos(-1) * r * r), y[0], y[1]);
  }
  snprintf(path, sizeof path, "%s/packing.data", g->own.folder);
  gh_status status = gh_text_commit(text, path);
  gh_text_destroy(&text);
  return status;
}

static void print_setup(const liggghts *g, gh_text *s) {
  const peer_motion *m = &g->m;
  gh_text_print(s, "units si\ndimension 2\nboundary p p p\natom_style granular\natom_modify map array sort 0 "
                   "0\ncommunicate single vel yes\nnewton off\n");
  gh_text_print(s, "read_data packing.data\nneighbor %.17g bin\nneigh_modify delay 0 every 1 check yes\n",
                m->skin);
  const struct {
    const char *name;
    double value;
  } pairs[] = {{"kn", m->kn},
               {"kt", m->kt},
               {"gamman", m->contact},
               {"gammat", m->contact},
               {"coefficientFriction", m->mu}};
  for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++)
    gh_text_print(s, "fix m%zu all property/global %s peratomtypepair 1 %.17g\n", k, pairs[k].name,
                  pairs[k].value);
  /* asked for by every material, not used by this one */
  gh_text_print(s, "fix m8 all property/global youngsModulus peratomtype 1e7\nfix m9 all property/global "
                   "poissonsRatio peratomtype 0.3\n");
  gh_text_print(
      s, "pair_style gran model hooke/stiffness tangential history\npair_coeff * *\ntimestep %.17g\n", m->dt);
  gh_text_print(s, "fix move all %s\nfix plane all enforce2d\nfix drag all viscous %.17g\n",
                m->rotate ? "nve/sphere" : "nve", m->viscous);
  gh_text_print(
      s,
      "compute contact all pair/gran/local pos id force delta\ncompute mean all reduce ave c_contact[13]\n");
  gh_text_print(s,
                "compute grain all property/atom tqz radius\n"
                "variable force atom sqrt((fx+%.17g*vx)^2+(fy+%.17g*vy)^2)\n"
                "variable drag atom %.17g*sqrt(vx*vx+vy*vy)\n"
                "variable moment atom abs(c_grain[1])/c_grain[2]\n"
                "compute largest all reduce max v_force v_drag v_moment\n",
                m->viscous, m->viscous, m->viscous);
  static const char *const words[] = {"force", "drag", "moment"};
  for (int k = 0; k < 3; k++)
    gh_text_print(s, "variable r%s equal c_largest[%d]/(%.17g*c_mean+%.17g)\n", words[k], k + 1, m->kn,
                  m->floor);
  gh_text_print(s,
                "variable now equal step\nthermo_style custom step v_rforce v_rdrag v_rmoment\nthermo "
                "%ld\nrun 0 post no\n",
                m->steps_a_check);
}

/* The velocity field of the deforming cell on all grains; `ramp` is linear between its bounds and constant
 * beyond, where grains that have just left the cell are. */
static void print_field(gh_text *s, const double from[4], const double to[4], const double now[4],
                        double rate) {
  for (int k = 0; k < 2; k++) {
    double speed = rate * (to[3 * k] - from[3 * k]), size = now[3 * k];
    if (speed != 0)
      gh_text_print(s, "velocity all ramp v%c %.17g %.17g %c %.17g %.17g sum yes units box\n", "xy"[k],
                    -speed, 2 * speed, "xy"[k], -size, 2 * size);
  }
}

static void print_motion(const liggghts *g, gh_text *s, const double from[4], const double to[4]) {
  double rate = 1 / (g->p->steps_per_row * g->m.dt);
  if (memcmp(from, to, 4 * sizeof *from) == 0) return;
  print_field(s, from, to, from, rate);
  gh_text_print(s, "unfix drag\nfix cell all deform 1 x final 0 %.17g y final 0 %.17g remap v units box\n",
                to[0], to[3]);
  gh_text_print(s, "run %d post no\nunfix cell\n", g->p->steps_per_row);
  print_field(s, from, to, to, -rate);
  gh_text_print(s, "fix drag all viscous %.17g\nrun 0 post no\n", g->m.viscous);
}

static void print_row(const liggghts *g, gh_text *s, int row) {
  peer_cell from, to;
  peer_cell_find(g->p, row - 1, &from);
  peer_cell_find(g->p, row, &to);
  print_motion(g, s, from.t, to.t);
  long checks = (g->p->max_steps - 1) / g->m.steps_a_check + 1;
  double tol = g->p->tolerance;
  gh_text_print(s, "variable check loop %ld\nlabel relax%d\nrun %ld pre no post no\n", checks, row,
                g->m.steps_a_check);
  gh_text_print(s,
                "if \"(${rforce} <= %.17g) && (${rdrag} <= %.17g) && (${rmoment} <= %.17g)\" then \"jump "
                "SELF rest%d\"\n",
                tol, tol, g->m.rotate ? tol : 1e300, row);
  gh_text_print(s,
                "next check\njump SELF relax%d\nprint \"granhom unrest %d ${rforce} ${rdrag} "
                "${rmoment}\"\nquit\nlabel rest%d\nvariable check delete\n",
                row, row, row);
  /* the residual before the dump: its run sets up again, with the drag of the velocities half a step later */
  gh_text_print(s, "print \"granhom row %d ${now} ${rforce} ${rdrag} %s\"\n", row,
                g->m.rotate ? "${rmoment}" : "0");
  gh_text_print(s, "dump rest all local 1 contacts.%d", row);
  for (int k = 1; k <= COLUMNS; k++) gh_text_print(s, " c_contact[%d]", k);
  gh_text_print(s, "\ndump_modify rest format \"");
  for (int k = 0; k < COLUMNS; k++) gh_text_print(s, "%%.17g ");
  gh_text_print(s, "\"\nrun 0 post no\nundump rest\n");
}

static gh_status write_script(const liggghts *g) {
  gh_text *s;
  char path[PATH_SIZE];
  GH_TRY(gh_text_create(g->ctx, &s));
  print_setup(g, s);
  for (int row = 0; row < g->p->rows; row++) print_row(g, s, row);
  snprintf(path, sizeof path, "%s/in.path", g->own.folder);
  gh_status status = gh_text_commit(s, path);
  gh_text_destroy(&s);
  return status;
}

/* ---- what it writes ---- */

/* The contacts of a row; branch vectors to the nearest image, as cells are wide. */
static gh_status read_contacts(const liggghts *g, int row, gh_peer_row *r) {
  char path[PATH_SIZE], *line = NULL;
  size_t size = 0;
  peer_cell c;
  peer_sum sum = {0};
  bool entries = false, number = false, good = true;
  int wanted = -1;
  peer_cell_find(g->p, row, &c);
  snprintf(path, sizeof path, "%s/contacts.%d", g->own.folder, row);
  FILE *file = fopen(path, "r");
  if (!file) return gh_fail(g->ctx, GH_ENGINE, "LIGGGHTS has not written its contacts");
  while (good && getline(&line, &size, file) > 0) {
    double v[COLUMNS];
    char *at = line;
    if (strncmp(line, "ITEM:", 5) == 0) {
      entries = strncmp(line, "ITEM: ENTRIES", 13) == 0;
      number = strncmp(line, "ITEM: NUMBER OF ENTRIES", 23) == 0;
      continue;
    }
    if (number) wanted = atoi(line);
    number = false;
    if (!entries) continue;
    for (int k = 0; k < COLUMNS && good; k++) {
      char *end;
      v[k] = strtod(at, &end);
      good = end != at && isfinite(v[k]);
      at = end;
    }
    if (!good) break;
    double l[2] = {v[X2] - v[X1], v[Y2] - v[Y1]};
    l[0] -= nearbyint(l[0] / c.t[0]) * c.t[0];
    l[1] -= nearbyint(l[1] / c.t[3]) * c.t[3];
    peer_add(&sum, l, v + FX);
  }
  free(line);
  fclose(file);
  if (!good || sum.contacts != wanted)
    return gh_fail(g->ctx, GH_ENGINE, "LIGGGHTS's list of contacts cannot be read");
  peer_close(&sum, &c, r);
  return GH_OK;
}

/* The lines "granhom row ..." of its output, and the last line or, where there is one, the first error. */
typedef struct report {
  int rows;
  bool unrest; /* a row did not come to rest */
  char last[256];
} report;

static void take_line(const char *line, report *t, gh_peer_row *row, int rows, long *before) {
  int k;
  long step;
  double r[3];
  if (sscanf(line, "granhom row %d %ld %lf %lf %lf", &k, &step, r, r + 1, r + 2) == 5 && k == t->rows &&
      k < rows) {
    row[k].residual = gh_max(r[0], gh_max(r[1], r[2]));
    row[k].steps = step - *before;
    *before = step;
    t->rows++;
  } else if (sscanf(line, "granhom unrest %d %lf %lf %lf", &k, r, r + 1, r + 2) == 4) {
    t->unrest = true;
    snprintf(t->last, sizeof t->last, "%.2g", gh_max(r[0], gh_max(r[1], r[2])));
  } else if (*line && !t->unrest && !strstr(t->last, "ERROR")) snprintf(t->last, sizeof t->last, "%s", line);
}

static gh_status read_output(const liggghts *g, const char *output, gh_peer_row *row, report *t) {
  char *line = NULL;
  size_t size = 0;
  long before = 0;
  *t = (report){0};
  FILE *file = fopen(output, "r");
  if (!file) return gh_fail(g->ctx, GH_SYSTEM, "%s: cannot be read: %s", output, strerror(errno));
  while (getline(&line, &size, file) > 0) {
    line[strcspn(line, "\r\n")] = 0;
    take_line(line, t, row, g->p->rows, &before);
  }
  free(line);
  fclose(file);
  return GH_OK;
}

/* ---- the run ---- */

static void tell_end(const liggghts *g, child_end end, int code, const report *t, gh_peer_result *r) {
  if (end == CHILD_STOPPED)
    peer_end(r, GH_PEER_STOPPED, "row %d: stopped after %g s", t->rows, g->p->seconds);
  else if (t->unrest)
    peer_end(r, GH_PEER_FAILED, "row %d: no equilibrium within %ld time steps: residual %s", t->rows,
             g->p->max_steps, t->last);
  else if (end == CHILD_SIGNAL)
    peer_end(r, GH_PEER_FAILED, "row %d: %s was ended by signal %d: %s", t->rows, g->program, code, t->last);
  else if (code != 0 || t->rows < g->p->rows)
    peer_end(r, GH_PEER_FAILED, "row %d: %s ended with status %d: %s", t->rows, g->program, code, t->last);
}

static gh_status run(const liggghts *g, gh_peer_row *row, gh_peer_result *result) {
  char output[PATH_SIZE];
  child_end end;
  int code;
  report t;
  GH_TRY(write_data(g));
  GH_TRY(write_script(g));
  snprintf(output, sizeof output, "%s/output", g->own.folder);
  char in[] = "-in", script[] = "in.path", log[] = "-log", none[] = "none";
  char *const argv[] = {g->program, in, script, log, none, NULL};
  GH_TRY(child_run(g->ctx, argv, output, g->own.folder, g->p->seconds, &end, &code));
  GH_TRY(read_output(g, output, row, &t));
  for (; result->rows < t.rows; result->rows++) GH_TRY(read_contacts(g, result->rows, row + result->rows));
  tell_end(g, end, code, &t, result);
  return GH_OK;
}

static bool tilted(const gh_peer_problem *p, gh_peer_result *r) {
  for (int row = -1; row < p->rows; row++) {
    peer_cell c;
    peer_cell_find(p, row, &c);
    if (fabs(c.t[1]) <= 1e-14 * c.t[0]) continue;
    peer_end(r, GH_PEER_UNABLE, "row %d: the cell is tilted, and LIGGGHTS makes no images of grains there",
             row);
    return true;
  }
  return false;
}

gh_status peer_liggghts(gh_context *ctx, const gh_peer_problem *p, gh_peer_row *row, gh_peer_result *result) {
  const char *name = p->program ? p->program : "liggghts";
  liggghts g = {.ctx = ctx, .p = p, .m = peer_motion_of(p), .program = child_find(name)};
  if (!g.program) {
    peer_end(result, GH_PEER_MISSING, "there is no program %s (Debian: apt-get install liggghts)", name);
    return GH_OK;
  }
  gh_status status = GH_OK;
  if (!tilted(p, result)) {
    status = gh_temporary_make(ctx, "liggghts", &g.own);
    if (status == GH_OK) {
      status = run(&g, row, result);
      gh_temporary_remove(&g.own);
    }
  }
  free(g.program);
  if (status == GH_ENGINE) {
    peer_end(result, GH_PEER_FAILED, "row %d: %s", result->rows, gh_message(ctx));
    status = GH_OK;
  }
  return status;
}
