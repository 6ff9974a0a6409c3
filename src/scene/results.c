/* Results of a run: one folder of files, each whole after each increment. SPDX-License-Identifier:
 * GPL-2.0-or-later
 *
 * results.h5      /mesh and one group per increment, /step0000 (the start) onwards
 * results.xdmf    the same for ParaView
 * rves.h5         grains and contacts of recorded material points at the last increment
 * history.csv, convergence.csv, run.json */
#include "scene/internal.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

struct scene_results {
  gh_context *ctx;
  gh_scene *scene;
  gh_farm *farm;
  gh_macro *macro;
  char *folder;
  gh_text *history, *convergence, *xdmf;
  bool begun; /* the folder is there */
  int frames; /* complete increments on disk */
  int unjammed;
  double min_acoustic;
  int most_loaded,
      least_stable; /* points with the largest von Mises stress and the smallest acoustic eigenvalue */
  char started[40];
  double *tensor, *scalar; /* scratch: 4 and 1 numbers per point */
};

/* ---- folder ---- */

gh_status scene_results_check(gh_context *ctx, const char *folder) {
  struct stat info;
  if (!*folder) return gh_fail(ctx, GH_INPUT, "the name of the folder for results is empty");
  char *path = strdup(folder);
  if (!path) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  gh_status status = GH_OK;
  while (stat(path, &info) != 0 && (errno == ENOENT || errno == ENOTDIR)) { /* up to what exists */
    char *parent = gh_path_folder(path);
    free(path);
    if (!parent) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
    path = parent;
  }
  if (stat(path, &info) != 0) status = gh_fail(ctx, GH_SYSTEM, "%s: %s", path, strerror(errno));
  else if (!S_ISDIR(info.st_mode))
    status = gh_fail(ctx, GH_INPUT, "%s: is a file, and the results need a folder", path);
  else if (access(path, W_OK | X_OK) != 0)
    status = gh_fail(ctx, GH_SYSTEM, "%s: cannot write there: %s", path, strerror(errno));
  free(path);
  return status;
}

static gh_status path_of(const scene_results *r, const char *name, char **path) {
  *path = gh_path_join(r->folder, name);
  return *path ? GH_OK : gh_fail(r->ctx, GH_MEMORY, "no memory for a path");
}

static gh_status commit_text(scene_results *r, gh_text *text, const char *name) {
  char *path;
  GH_TRY(path_of(r, name, &path));
  gh_status status = gh_text_commit(text, path);
  free(path);
  return status;
}

/* ---- history.csv ---- */

/* A set's name as part of a column's: no commas, spaces or quotes. */
static const char *column(const gh_mesh *mesh, int set, char text[64]) {
  snprintf(text, 64, "%s", mesh->sets[set].name);
  for (char *c = text; *c; c++)
    if (*c == ',' || *c == ' ' || *c == '"' || *c == '\'') *c = '_';
  return text;
}

static bool pressed(const gh_scene *s, int set) {
  for (int k = 0; k < s->nsteps; k++)
    for (int j = 0; j < s->steps[k].npressures; j++)
      if (s->steps[k].pressures[j].set == set) return true;
  return s->present.pressure[set].now != 0;
}

static bool driven(const gh_scene *s, int set, int i) {
  for (int k = 0; k < s->nsteps; k++)
    for (int j = 0; j < s->steps[k].ndisplaces; j++)
      if (s->steps[k].displaces[j].set == set && !isnan(s->steps[k].displaces[j].to[i])) return true;
  return false;
}

static bool forced(const gh_scene *s, int set) {
  for (int k = 0; k < s->nsteps; k++)
    for (int j = 0; j < s->steps[k].nforces; j++)
      if (s->steps[k].forces[j].set == set) return true;
  return false;
}

/* Writes the header (frame NULL) or the loads of a row: one list of columns for both. */
static void history_loads(scene_results *r, const scene_frame *frame) {
  const gh_scene *s = r->scene;
  gh_text *t = r->history;
  char name[64];
  for (int set = 0; set < s->nsets; set++) {
    gh_scene_load load;
    gh_scene_load_on(s, set, &load);
    column(s->mesh, set, name);
    if (pressed(s, set)) frame ? gh_text_print(t, ",%.17g", load.pressure) : gh_text_print(t, ",p_%s", name);
    for (int i = 0; i < 2; i++) {
      if (driven(s, set, i))
        frame ? gh_text_print(t, ",%.17g", load.displacement[i]) : gh_text_print(t, ",u%c_%s", "xy"[i], name);
      if (forced(s, set))
        frame ? gh_text_print(t, ",%.17g", load.force[i]) : gh_text_print(t, ",f%c_%s", "xy"[i], name);
    }
  }
  double b[2];
  gh_scene_gravity(s, b);
  frame ? gh_text_print(t, ",%.17g,%.17g", b[0], b[1]) : gh_text_print(t, ",gx,gy");
}

static void history_header(scene_results *r) {
  char name[64];
  gh_text_print(r->history, "step,increment,name,load_step,time");
  history_loads(r, NULL);
  for (int set = 0; set < r->scene->nsets; set++) {
    column(r->scene->mesh, set, name);
    gh_text_print(r->history, ",%s_x,%s_y", name, name);
  }
  gh_text_print(
      r->history,
      ",dilatancy,iterations,substeps,cuts,jumps,unjammed,min_acoustic,residual,micro_seconds,seconds\n");
}

static void history_row(scene_results *r, const scene_frame *f) {
  gh_text *t = r->history;
  gh_text_print(t, "%d,%d,", f->counter, f->increment);
  for (const char *c = f->name; *c; c++)
    gh_text_print(t, "%c", *c == ',' || *c == '"' || *c == '\n' ? '_' : *c);
  gh_text_print(t, ",%d,%.17g", f->step, f->time);
  history_loads(r, f);
  for (int set = 0; set < r->scene->nsets; set++) {
    double sum[2];
    gh_macro_reaction(r->macro, set, sum);
    gh_text_print(t, ",%.17g,%.17g", sum[0], sum[1]);
  }
  double V, v;
  const gh_macro_report *m = f->report;
  gh_macro_volumes(r->macro, &V, &v);
  gh_text_print(t, ",%.17g,%d,%d,%d,%d,%d,%.17g,%.17g,%.17g,%.17g\n", 100 * (v / V - 1), m->iterations,
                m->substeps, m->cuts, m->jumps, r->unjammed, r->min_acoustic, m->relative, m->micro_seconds,
                m->seconds);
}

void scene_results_iteration(scene_results *r, int counter, const gh_macro_iteration *it) {
  gh_text_print(r->convergence, "%d,%d,%d,%.17g,%.17g,%.17g,%.17g,%.17g\n", counter, it->substep,
                it->iteration, it->residual, it->relative, it->first, it->step, it->seconds);
}

/* ---- results.h5 ---- */

static gh_status put(scene_results *r, gh_h5 *file, const scene_frame *f, const char *name, size_t rows,
                     size_t cols, const double *data) {
  char full[128];
  (void)r;
  snprintf(full, sizeof full, "/step%04d/%s", f->counter, name);
  return gh_h5_put_doubles(file, full, rows, cols, data);
}

static gh_status put_mesh(scene_results *r, gh_h5 *file) {
  const gh_mesh *m = r->scene->mesh;
  size_t nnodes = (size_t)m->nnodes, npoints = 4 * (size_t)m->nelements;
  double *x;
  GH_TRY(gh_alloc(r->ctx, 3 * nnodes + 2 * npoints, sizeof *x, &x));
  for (size_t n = 0; n < nnodes; n++) memcpy(x + 3 * n, m->X + 2 * n, 2 * sizeof *x);
  gh_mesh_gauss(m, x + 3 * nnodes);
  gh_status status;
  GH_TRY_OR(gh_h5_put_doubles(file, "/mesh/coordinates", nnodes, 3, x), done);
  GH_TRY_OR(gh_h5_put_doubles(file, "/mesh/gauss", npoints, 2, x + 3 * nnodes), done);
  GH_TRY_OR(gh_h5_put_ints(file, "/mesh/cells", (size_t)m->nelements, 4, &m->quad[0][0]), done);
  for (int k = 0; k < r->scene->nsets; k++) {
    char name[96] = "/mesh/sets/", part[64];
    strncat(name, column(m, k, part), 64);
    for (char *c = name + strlen("/mesh/sets/"); *c; c++)
      if (*c == '/') *c = '_'; /* HDF5 would make groups of it */
    GH_TRY_OR(gh_h5_put_ints(file, name, (size_t)m->sets[k].nnodes, 1, m->sets[k].nodes), done);
  }
  GH_TRY_OR(gh_h5_put_text(file, "/title", r->scene->title), done);
  GH_TRY_OR(gh_h5_put_text(file, "/units/length", r->scene->length_unit), done);
  GH_TRY_OR(gh_h5_put_text(file, "/units/force", r->scene->force_unit), done);
done:
  free(x);
  return status;
}

/* Vectors of the plane, nnodes x 2, as the three components that ParaView wants. */
static gh_status put_nodes(scene_results *r, gh_h5 *file, const scene_frame *f, const char *name,
                           const double *values) {
  size_t nnodes = (size_t)r->scene->mesh->nnodes;
  double *three;
  GH_TRY(gh_alloc(r->ctx, 3 * nnodes, sizeof *three, &three));
  for (size_t n = 0; n < nnodes; n++) memcpy(three + 3 * n, values + 2 * n, 2 * sizeof *three);
  gh_status status = put(r, file, f, name, nnodes, 3, three);
  free(three);
  return status;
}

/* Cell averages of a tensor of the plane as 3 x 3. */
static gh_status put_cell_tensor(scene_results *r, gh_h5 *file, const scene_frame *f, const char *name,
                                 const double *points) {
  size_t n = (size_t)r->scene->mesh->nelements;
  double *average;
  GH_TRY(gh_alloc(r->ctx, (4 + 9) * n, sizeof *average, &average));
  double *full = average + 4 * n;
  scene_cell_average((int)n, 4, points, average);
  for (size_t e = 0; e < n; e++) {
    static const int at[4] = {0, 1, 3, 4};
    for (int k = 0; k < 4; k++) full[9 * e + (size_t)at[k]] = average[4 * e + (size_t)k];
  }
  gh_status status = put(r, file, f, name, n, 9, full);
  free(average);
  return status;
}

static gh_status put_stress(scene_results *r, gh_h5 *file, const scene_frame *f) {
  const gh_mesh *m = r->scene->mesh;
  size_t np = 4 * (size_t)m->nelements, nn = (size_t)m->nnodes;
  const double *F = gh_macro_F(r->macro), *P = gh_macro_P(r->macro);
  double *cauchy = r->tensor, *mises;
  for (size_t p = 0; p < np; p++) gh_cauchy2(P + 4 * p, F + 4 * p, cauchy + 4 * p);
  GH_TRY(put(r, file, f, "points/F", np, 4, F));
  GH_TRY(put(r, file, f, "points/P", np, 4, P));
  GH_TRY(put(r, file, f, "points/cauchy", np, 4, cauchy));
  GH_TRY(put_cell_tensor(r, file, f, "cells/piola", P));
  GH_TRY(put_cell_tensor(r, file, f, "cells/cauchy", cauchy));
  GH_TRY(gh_alloc(r->ctx, np + nn, sizeof *mises, &mises));
  gh_status status = scene_nodal_mises(r->ctx, m, cauchy, mises + np);
  if (status == GH_OK) status = put(r, file, f, "von_mises", nn, 1, mises + np);
  for (size_t e = 0; e < np / 4; e++) { /* of the average stress */
    double s[4];
    scene_cell_average(1, 4, cauchy + 16 * e, s);
    mises[e] = scene_mises(s);
  }
  if (status == GH_OK) status = put(r, file, f, "cells/von_mises", np / 4, 1, mises);
  free(mises);
  return status;
}

/* Numbers of a material point that are written one by one and averaged over the cells. */
typedef struct point_number {
  const char *name;
  double (*of)(const gh_rve_measures *m);
} point_number;
static double energy(const gh_rve_measures *m) {
  return m->energy;
}
static double coordination(const gh_rve_measures *m) {
  return m->coordination;
}
static double contacts(const gh_rve_measures *m) {
  return m->contacts;
}
static double rattlers(const gh_rve_measures *m) {
  return m->rattlers;
}
static double residual(const gh_rve_measures *m) {
  return m->residual;
}
static double mean_force(const gh_rve_measures *m) {
  return m->mean_force;
}
static double unjammed(const gh_rve_measures *m) {
  return m->unjammed;
}
static double volume_fraction(const gh_rve_measures *m) {
  return m->volume_fraction;
}
static double fabric_xx(const gh_rve_measures *m) {
  return m->fabric[0];
}
static double fabric_xy(const gh_rve_measures *m) {
  return m->fabric[1];
}
static double fabric_yy(const gh_rve_measures *m) {
  return m->fabric[2];
}
static double steps(const gh_rve_measures *m) {
  return (double)m->steps;
}
static double seconds(const gh_rve_measures *m) {
  return m->seconds;
}
static double regularised(const gh_rve_measures *m) {
  return m->regularised;
}
static const point_number numbers[] = {{"energy", energy},       {"coordination", coordination},
                                       {"contacts", contacts},   {"rattlers", rattlers},
                                       {"residual", residual},   {"mean_force", mean_force},
                                       {"unjammed", unjammed},   {"volume_fraction", volume_fraction},
                                       {"fabric_xx", fabric_xx}, {"fabric_xy", fabric_xy},
                                       {"fabric_yy", fabric_yy}, {"steps", steps},
                                       {"seconds", seconds},     {"regularised", regularised}};

static gh_status put_numbers(scene_results *r, gh_h5 *file, const scene_frame *f) {
  int np = gh_farm_size(r->farm);
  char name[64];
  for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
    for (int p = 0; p < np; p++) {
      const gh_rve_measures *m = gh_farm_measure(r->farm, p);
      if (!m) return GH_OK; /* points that are no RVEs have no measures */
      r->scalar[p] = numbers[k].of(m);
    }
    snprintf(name, sizeof name, "points/%s", numbers[k].name);
    GH_TRY(put(r, file, f, name, (size_t)np, 1, r->scalar));
    scene_cell_average(np / 4, 1, r->scalar, r->tensor);
    snprintf(name, sizeof name, "cells/%s", numbers[k].name);
    GH_TRY(put(r, file, f, name, (size_t)np / 4, 1, r->tensor));
  }
  return GH_OK;
}

/* Acoustic tensors: of each point, and the smallest of each cell. */
static gh_status put_acoustic(scene_results *r, gh_h5 *file, const scene_frame *f) {
  size_t np = (size_t)gh_farm_size(r->farm);
  const double *A = gh_macro_A(r->macro);
  for (size_t p = 0; p < np; p++) r->scalar[p] = gh_acoustic(A + 16 * p, r->tensor + p);
  GH_TRY(put(r, file, f, "points/acoustic", np, 1, r->scalar));
  GH_TRY(put(r, file, f, "points/acoustic_angle", np, 1, r->tensor));
  for (size_t e = 0; e < np / 4; e++)
    r->tensor[e] =
        fmin(fmin(r->scalar[4 * e], r->scalar[4 * e + 1]), fmin(r->scalar[4 * e + 2], r->scalar[4 * e + 3]));
  return put(r, file, f, "cells/acoustic", np / 4, 1, r->tensor);
}

static gh_status write_h5(scene_results *r, const scene_frame *f) {
  char *path;
  gh_h5 *file = NULL;
  GH_TRY(path_of(r, "results.h5", &path));
  gh_status status = gh_h5_open(r->ctx, path, r->frames > 0, &file);
  free(path);
  if (status != GH_OK) return status;
  if (r->frames == 0) GH_TRY_OR(put_mesh(r, file), failed);
  GH_TRY_OR(put(r, file, f, "time", 1, 1, &f->time), failed);
  GH_TRY_OR(put_nodes(r, file, f, "displacement", gh_macro_u(r->macro)), failed);
  GH_TRY_OR(put_nodes(r, file, f, "reaction", gh_macro_reactions(r->macro)), failed);
  GH_TRY_OR(put_stress(r, file, f), failed);
  GH_TRY_OR(put_numbers(r, file, f), failed);
  GH_TRY_OR(put_acoustic(r, file, f), failed);
  return gh_h5_commit(&file);
failed:
  gh_h5_close(&file);
  return status;
}

/* ---- rves.h5 ---- */

static gh_status put_rve(scene_results *r, gh_h5 *file, int point) {
  gh_rve_view v;
  gh_rve *rve = gh_farm_rve(r->farm, point);
  if (!rve) return GH_OK;
  GH_TRY(gh_rve_look(rve, &v));
  size_t n = (size_t)v.n, nc = (size_t)v.ncontacts, most = n > nc ? n : nc;
  char name[64];
  double *row = NULL;
  int *pairs = NULL, periodic = v.periodic;
  gh_status status;
#define PUT(kind, what, rows, cols, data)                                                                    \
  snprintf(name, sizeof name, "/rve/%04d/%s", point, what);                                                  \
  GH_TRY_OR(gh_h5_put_##kind(file, name, rows, cols, data), done)
  GH_TRY_OR(gh_alloc(r->ctx, 4 * most, sizeof *row, &row), done);
  GH_TRY_OR(gh_alloc(r->ctx, 2 * most, sizeof *pairs, &pairs), done);
  PUT(doubles, "positions", n, 2, v.x);
  PUT(doubles, "radii", n, 1, v.radius);
  PUT(ints, "ids", n, 1, v.id);
  PUT(ints, "types", n, 1, v.type);
  for (size_t k = 0; k < n; k++) pairs[k] = v.flags[k];
  PUT(ints, "flags", n, 1, pairs);
  PUT(doubles, "cell", 1, 4, v.cell);
  PUT(doubles, "low", 1, 2, v.low);
  PUT(ints, "periodic", 1, 1, &periodic);
  PUT(doubles, "cauchy", 1, 4, gh_rve_measure(rve)->cauchy);
  for (size_t k = 0; k < nc; k++) {
    pairs[2 * k] = v.contacts[k].i, pairs[2 * k + 1] = v.contacts[k].j;
    memcpy(row + 4 * k, v.contacts[k].l, 2 * sizeof *row);
    memcpy(row + 4 * k + 2, v.contacts[k].f, 2 * sizeof *row);
  }
  PUT(ints, "contact_pairs", nc, 2, pairs);
  PUT(doubles, "contact_branch_force", nc, 4, row);
#undef PUT
done:
  free(row);
  free(pairs);
  return status;
}

/* What the scene asks for; without a wish all points if they are few, else the first, the most loaded and the
 * one nearest to losing ellipticity. */
static gh_status write_rves(scene_results *r, const scene_frame *f) {
  int points = gh_farm_size(r->farm), wanted = r->scene->nrves,
      chosen[3] = {0, r->most_loaded, r->least_stable};
  const int *list = r->scene->rves;
  bool all = wanted == SCENE_ALL_RVES || (wanted == SCENE_FEW_RVES && points <= SCENE_FEW);
  if (!all && wanted == SCENE_FEW_RVES) list = chosen, wanted = 3;
  if (!all && wanted == 0) return GH_OK;
  char *path;
  gh_h5 *file = NULL;
  GH_TRY(path_of(r, "rves.h5", &path));
  gh_status status = gh_h5_open(r->ctx, path, false, &file);
  free(path);
  if (status != GH_OK) return status;
  GH_TRY_OR(gh_h5_put_ints(file, "/step", 1, 1, &f->counter), failed);
  for (int k = 0; k < (all ? points : wanted); k++) GH_TRY_OR(put_rve(r, file, all ? k : list[k]), failed);
  return gh_h5_commit(&file);
failed:
  gh_h5_close(&file);
  return status;
}

/* ---- the whole ---- */

static gh_status write_json(scene_results *r, const char *status_text, const char *message,
                            const gh_run_summary *summary) {
  gh_text *text;
  char *json = scene_run_json(r->scene, r->farm, r->started, status_text, message, summary);
  if (!json) return gh_fail(r->ctx, GH_MEMORY, "no memory for run.json");
  gh_status status = gh_text_create(r->ctx, &text);
  if (status == GH_OK) {
    gh_text_print(text, "%s\n", json);
    status = commit_text(r, text, "run.json");
    gh_text_destroy(&text);
  }
  free(json);
  return status;
}

static gh_status write_xdmf(scene_results *r, const scene_frame *f) {
  gh_text *whole;
  scene_xdmf_step(r->xdmf, r->scene->mesh, f);
  GH_TRY(gh_text_create(r->ctx, &whole));
  scene_xdmf_begin(whole);
  gh_text_print(whole, "%s", gh_text_get(r->xdmf, NULL));
  scene_xdmf_end(whole);
  gh_status status = commit_text(r, whole, "results.xdmf");
  gh_text_destroy(&whole);
  return status;
}

static gh_status begin(scene_results *r) {
  if (r->begun) return GH_OK;
  GH_TRY(gh_folder_make(r->ctx, r->folder));
  history_header(r);
  char *rves; /* of a run before, perhaps of another mesh */
  GH_TRY(path_of(r, "rves.h5", &rves));
  unlink(rves);
  free(rves);
  r->begun = true;
  return write_json(r, "running", NULL, NULL);
}

/* The number of points that carry nothing, the smallest acoustic eigenvalue, the most loaded point. */
static void look_at_points(scene_results *r) {
  const double *A = gh_macro_A(r->macro), *F = gh_macro_F(r->macro), *P = gh_macro_P(r->macro);
  double most = -1;
  r->unjammed = 0;
  r->min_acoustic = INFINITY;
  for (int p = 0; p < gh_farm_size(r->farm); p++) {
    double angle, cauchy[4], acoustic = gh_acoustic(A + 16 * p, &angle);
    const gh_rve_measures *m = gh_farm_measure(r->farm, p);
    gh_cauchy2(P + 4 * p, F + 4 * p, cauchy);
    if (m && m->unjammed) r->unjammed++;
    if (acoustic < r->min_acoustic) r->min_acoustic = acoustic, r->least_stable = p;
    if (scene_mises(cauchy) > most) most = scene_mises(cauchy), r->most_loaded = p;
  }
}

int scene_results_unjammed(const scene_results *r, double *min_acoustic) {
  *min_acoustic = r->min_acoustic;
  return r->unjammed;
}

/* results.h5 comes first: the others may then refer to what is in it. */
gh_status scene_results_write(scene_results *r, const scene_frame *f) {
  GH_TRY(begin(r));
  look_at_points(r);
  GH_TRY(write_h5(r, f));
  r->frames++;
  GH_TRY(write_rves(r, f));
  GH_TRY(write_xdmf(r, f));
  history_row(r, f);
  GH_TRY(commit_text(r, r->history, "history.csv"));
  return commit_text(r, r->convergence, "convergence.csv");
}

gh_status scene_results_close(scene_results *r, gh_status status, const char *message,
                              const gh_run_summary *summary) {
  if (status == GH_INPUT && !r->begun) return GH_OK; /* wrong input writes nothing */
  GH_TRY(begin(r));
  GH_TRY(commit_text(r, r->history, "history.csv"));
  GH_TRY(commit_text(r, r->convergence, "convergence.csv"));
  return write_json(r, status == GH_OK ? "done" : gh_status_text(status), message, summary);
}

gh_status scene_results_create(gh_scene *scene, gh_farm *farm, gh_macro *macro, const char *folder,
                               scene_results **results) {
  gh_context *ctx = scene->ctx;
  size_t points = (size_t)gh_farm_size(farm);
  gh_status status;
  GH_TRY(gh_alloc(ctx, 1, sizeof **results, results));
  scene_results *r = *results;
  r->ctx = ctx, r->scene = scene, r->farm = farm, r->macro = macro;
  r->min_acoustic = NAN;
  r->folder = strdup(folder);
  status = r->folder ? GH_OK : gh_fail(ctx, GH_MEMORY, "no memory for a path");
  if (status == GH_OK) status = gh_text_create(ctx, &r->history);
  if (status == GH_OK) status = gh_text_create(ctx, &r->convergence);
  if (status == GH_OK) status = gh_text_create(ctx, &r->xdmf);
  if (status == GH_OK) status = gh_alloc(ctx, 4 * points, sizeof *r->tensor, &r->tensor);
  if (status == GH_OK) status = gh_alloc(ctx, points, sizeof *r->scalar, &r->scalar);
  if (status != GH_OK) {
    scene_results_destroy(results);
    return status;
  }
  gh_text_print(r->convergence, "step,substep,iteration,residual,relative,first,step_length,seconds\n");
  time_t now = time(NULL);
  struct tm utc;
  if (gmtime_r(&now, &utc)) strftime(r->started, sizeof r->started, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return GH_OK;
}

void scene_results_destroy(scene_results **results) {
  if (!results || !*results) return;
  scene_results *r = *results;
  gh_text_destroy(&r->history);
  gh_text_destroy(&r->convergence);
  gh_text_destroy(&r->xdmf);
  free(r->folder);
  free(r->tensor);
  free(r->scalar);
  free(r);
  *results = NULL;
}
