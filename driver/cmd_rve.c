/* granhom rve: one material point along a path of F. SPDX-License-Identifier: GPL-2.0-or-later */
#include "cli.h"
#include "contact_options.h"
#include "path.h"
#include "reference.h"
#include "rve_doubts.h"
#include "rve_error.h"
#include "rve_state.h"

#include "granhom/io.h"
#include "granhom/limits.h"
#include "granhom/scene.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char help[] =
    "usage: granhom rve PACKING --path PATH.csv [options] [-o OUT.csv]\n"
    "\n"
    "Deforms one packing (a LAMMPS data file, atom_style sphere) along a path of deformation gradients and "
    "writes\n"
    "stress, energy and what else is known of each increment.\n"
    "\n"
    "  --path FILE            CSV with the columns F11 F12 F21 F22 (and step), a row per increment; - is "
    "standard input\n"
    "  -o, --output FILE      results (default: standard output)\n"
    "  --boundary NAME        taylor: all grains of the cluster follow F; taylor-cell: the same in the "
    "periodic cell;\n"
    "                         restricted: grains at the boundary follow F, the others are in equilibrium;\n"
    "                         periodic: all grains of the periodic cell are in equilibrium (default)\n"
    "  --engine NAME          lammps (default) or native\n" CONTACT_HELP
    "  --tolerance T          largest force on a grain, and moment over radius, over the mean normal "
    "contact\n"
    "                         force (default 1e-8)\n" CLI_RELAXATION_HELP
    "  --max-steps N          relaxation steps after which an increment has no equilibrium and is cut, six\n"
    "                         times at most (default 400000, with friction 50000)\n"
    "  --accept FORCE         ... and is not cut, if no grain is then out of balance by more than FORCE\n"
    "  --estimate-error       goes along the path in halves of its rows, and once more in whole rows: an\n"
    "                         estimate of the error of the stress, for about three times the time\n"
    "  --tangent FILE         tangent dP/dF of each increment: step,A1111,A1112,...,A2222\n"
    "  --dump FILE            a LAMMPS dump of the grains, one frame per increment, positions with\n"
    "                         image flags (OVITO reads it)\n"
    "  --save-state FILE      converged state at the end of the path (HDF5)\n"
    "  --load-state FILE      start from such a state instead of the packing as read; of the\n"
    "                         same packing, boundary condition and contact law\n"
    "\n"
    "Exit status: 0 done, 1 an increment did not converge (the rows before it are written), 2 wrong input.\n";

static const double WRITE_EVERY = 2; /* seconds */

typedef struct arguments {
  const char *packing, *path, *output, *tangent, *dump, *save, *load;
  contact_options contact;
  gh_rve_options rve;
  bool estimate;
} arguments;

typedef struct job {
  gh_context *ctx;
  const arguments *args;
  gh_packing *packing;
  path_rows path;
  gh_rve *rve, *whole; /* whole: a second path, in whole rows; NULL without an estimate of the error */
  rve_error error;
  rve_doubts doubts; /* of the increment under way */
  gh_text *out, *tangent, *dump;
  double written; /* when the files were last written */
  int rows;       /* complete */
  bool warned;    /* of overlaps */
} job;

/* ---- options ---- */

static int parse_option(int c, void *data) {
  arguments *a = data;
  switch (c) {
  case 'p':
    a->path = optarg;
    return 0;
  case 'o':
    a->output = optarg;
    return 0;
  case 't':
    a->tangent = optarg;
    return 0;
  case 'd':
    a->dump = optarg;
    return 0;
  case 's':
    a->save = optarg;
    return 0;
  case 'l':
    a->load = optarg;
    return 0;
  case 'T':
    return cli_positive(&cli_rve, "--tolerance", optarg, 1, &a->rve.tolerance);
  case 'b':
    return cli_boundary(&cli_rve, optarg, &a->rve.boundary);
  case 'e':
    return cli_engine(&cli_rve, optarg, &a->rve.engine);
  case 'r':
    return cli_relaxation(&cli_rve, optarg, &a->rve.relaxation);
  case 'n':
    return cli_integer(&cli_rve, "--max-steps", optarg, 1, 1000000000, &a->rve.max_steps);
  case 'A':
    return cli_positive(&cli_rve, "--accept", optarg, INFINITY, &a->rve.accept);
  default: /* E */
    a->estimate = true;
    return 0;
  }
}

static int parse(int argc, char **argv, arguments *a) {
  static const struct option options[] = {
      {"path", 1, 0, 'p'},           {"output", 1, 0, 'o'},     {"boundary", 1, 0, 'b'},
      {"engine", 1, 0, 'e'},         {"tolerance", 1, 0, 'T'},  {"max-steps", 1, 0, 'n'},
      {"accept", 1, 0, 'A'},         {"tangent", 1, 0, 't'},    {"dump", 1, 0, 'd'},
      {"save-state", 1, 0, 's'},     {"load-state", 1, 0, 'l'}, {"relaxation", 1, 0, 'r'},
      {"estimate-error", 0, 0, 'E'}, CONTACT_OPTIONS,           {0, 0, 0, 0}};
  *a = (arguments){.rve = gh_rve_defaults()};
  int status = contact_arguments(&cli_rve, argc, argv, options, &a->contact, parse_option, a, &a->packing);
  if (status) return status;
  if (!a->path) return cli_usage(&cli_rve, "--path is missing");
  a->rve.allow_overlap = contact_allowed(&a->contact);
  return contact_law(&cli_rve, &a->contact, &a->rve.law);
}

/* ---- results ---- */

static void write_headers(job *j) {
  gh_terms_header(j->out, columns_point, ",");
  if (j->args->rve.law.friction) {
    gh_text_print(j->out, ",");
    gh_terms_header(j->out, columns_friction, ",");
  }
  gh_text_print(j->out, "\n");
  if (!j->tangent) return;
  gh_text_print(j->tangent, "step");
  for (int n = 0; n < 16; n++)
    gh_text_print(j->tangent, ",A%d%d%d%d", (n >> 3) + 1, (n >> 2 & 1) + 1, (n >> 1 & 1) + 1, (n & 1) + 1);
  gh_text_print(j->tangent, "\n");
}

static gh_status write_frame(job *j, long step) {
  gh_rve_view v;
  GH_TRY(gh_rve_look(j->rve, &v));
  gh_dump_grains(j->dump, step, &v);
  return GH_OK;
}

static gh_status check_rows(job *j, size_t row, size_t tangent_row) {
  GH_TRY(gh_text_check_row(j->out, row, j->args->output ? j->args->output : "the result"));
  return j->tangent ? gh_text_check_row(j->tangent, tangent_row, j->args->tangent) : GH_OK;
}

static gh_status write_row(job *j, long step, const double A[16]) {
  size_t row, tangent_row = 0;
  gh_text_get(j->out, &row);
  if (j->tangent) gh_text_get(j->tangent, &tangent_row);
  const gh_rve_measures *m = gh_rve_measure(j->rve);
  const double *const blocks[] = {m->F, m->P, m->cauchy};
  gh_text_print(j->out, "%ld", step);
  for (int b = 0; b < 3; b++)
    for (int k = 0; k < 4; k++) gh_text_print(j->out, ",%.17g", blocks[b][k]);
  gh_text_print(j->out, ",%.17g,%d,%d,%.17g,%.6g", m->energy, m->contacts, m->rattlers, m->residual,
                m->seconds);
  if (j->args->rve.law.friction)
    gh_text_print(j->out, ",%.17g,%.17g,%d", m->energy_t, m->dissipation, m->sliding);
  gh_text_print(j->out, "\n");
  if (j->tangent) {
    gh_text_print(j->tangent, "%ld", step);
    for (int n = 0; n < 16; n++) gh_text_print(j->tangent, ",%.17g", A[n]);
    gh_text_print(j->tangent, "\n");
  }
  GH_TRY(check_rows(j, row, tangent_row));
  if (m->unjammed)
    gh_log(j->ctx, GH_LEVEL_INFO, "step %ld: unjammed, no contact carries a force: P = 0", step);
  else if (m->stress_free)
    gh_log(j->ctx, GH_LEVEL_INFO, "step %ld: unjammed, contact forces are round-off: no stress", step);
  rve_doubts_tell(j->ctx, &j->doubts, step);
  if (m->regularised)
    gh_log(j->ctx, GH_LEVEL_WARNING, "step %ld: a mode without stiffness: the tangent is regularised", step);
  return j->dump ? write_frame(j, step) : GH_OK;
}

static gh_status write_text(gh_context *ctx, gh_text *text, const char *path, bool last) {
  if (!text) return GH_OK;
  if (path && strcmp(path, "-")) return gh_text_commit(text, path);
  return last ? cli_print(ctx, text) : GH_OK;
}

/* Files appear whole, the first time after the first increment, so that wrong input writes nothing; a killed
 * run leaves what it had. */
static gh_status write_files(job *j, bool last) {
  GH_TRY(write_text(j->ctx, j->out, j->args->output, last));
  GH_TRY(write_text(j->ctx, j->tangent, j->args->tangent, last));
  GH_TRY(write_text(j->ctx, j->dump, j->args->dump, last));
  j->written = gh_seconds();
  return GH_OK;
}

/* F of the converged state that the path starts from. */
static gh_status start_of_path(job *j, double F[4]) {
  double *state;
  GH_TRY(gh_alloc(j->ctx, gh_rve_state_size(j->rve), sizeof *state, &state));
  gh_status status = gh_rve_save(j->rve, state);
  memcpy(F, state, 4 * sizeof *F);
  free(state);
  return status;
}

static void count_part(void *data, const gh_rve_measures *m) {
  job *j = data;
  gh_rve_balance_add(&j->error.balance, m);
  rve_doubts_add(&j->doubts, m);
}

/* The row on the path whose results are written. */
static gh_status reach(job *j, long step, const double from[4], const double to[4], double A[16]) {
  gh_rve_way way = {
      .halvings = j->whole ? 1 : 0, .want = j->tangent ? GH_WANT_TANGENT : 0, .count = count_part, .data = j};
  memcpy(way.from, from, sizeof way.from);
  memcpy(way.to, to, sizeof way.to);
  GH_TRY(gh_rve_reach(j->rve, &way, A));
  if (way.cuts > 0)
    gh_log(j->ctx, GH_LEVEL_INFO, "step %ld: no equilibrium at once, reached in %d parts", step, way.parts);
  return GH_OK;
}

/* The second path goes on from where the first one is. */
static gh_status join(job *j) {
  size_t size = gh_rve_trial_size(j->rve);
  double *state;
  GH_TRY(gh_alloc(j->ctx, size, sizeof *state, &state));
  gh_rve_save_trial(j->rve, state);
  gh_status status = gh_rve_load(j->whole, state, size);
  free(state);
  return status;
}

/* The row on the second path, compared with the trial state of the first. */
static gh_status compare(job *j, long step, const double from[4], const double to[4]) {
  gh_rve_way way = {0};
  memcpy(way.from, from, sizeof way.from);
  memcpy(way.to, to, sizeof way.to);
  gh_status status = gh_rve_reach(j->whole, &way, NULL);
  if (status != GH_OK && status != GH_DIVERGED) return status;
  const double *whole = status == GH_OK ? gh_rve_measure(j->whole)->P : NULL;
  const bool branched = rve_error_compare(&j->error, gh_rve_measure(j->rve)->P, whole, &j->args->rve);
  gh_log(j->ctx, GH_LEVEL_INFO, "step %ld: estimated error of the stress %.2g of the largest%s", step,
         j->error.now > 0 ? j->error.now / j->error.scale : 0, branched ? "; the path branches here" : "");
  return branched ? join(j) : gh_rve_commit(j->whole);
}

static gh_status walk(job *j) {
  gh_work work;
  double from[4];
  gh_status status = start_of_path(j, from);
  int row = 0, rows = j->path.csv->nrows;
  gh_work_begin(j->ctx, &work, "rve", "increments", rows);
  for (; row < rows && status == GH_OK; row++) {
    double F[4], A[16];
    path_F(&j->path, row, F);
    long step = path_step(&j->path, row);
    status = reach(j, step, from, F, A);
    if (status == GH_OK)
      status = gh_limits_check(j->ctx, &j->args->rve, gh_rve_measure(j->rve), "the packing", &j->warned);
    if (status == GH_OK) status = write_row(j, step, A);
    if (status == GH_OK && j->whole) status = compare(j, step, from, F);
    if (status == GH_OK) status = gh_rve_commit(j->rve);
    j->rows += status == GH_OK;
    memcpy(from, F, sizeof from);
    if (status != GH_OK) gh_prefix(j->ctx, status, "step %ld: ", step);
    gh_work_advance(j->ctx, &work, row + 1);
    if (status == GH_OK && (row == 0 || gh_seconds() - j->written > WRITE_EVERY))
      status = write_files(j, false);
  }
  gh_work_end(j->ctx, &work, row);
  rve_error_tell(j->ctx, &j->error);
  return status;
}

/* What was computed is written also when an increment failed. */
static gh_status write_last(void *data, bool good) {
  job *j = data;
  GH_TRY(write_files(j, true));
  if (!good || !j->args->save) return GH_OK;
  return rve_state_save(j->ctx, j->args->save, j->rve, &j->args->rve, j->packing);
}

static gh_status rve(job *j) {
  const arguments *a = j->args;
  if ((a->save || a->load) && !gh_h5_available())
    return gh_fail(
        j->ctx, GH_INPUT,
        "--save-state and --load-state need HDF5, and this granhom was built without (make HDF5=0)");
  GH_TRY(gh_packing_read(j->ctx, a->packing, &j->packing));
  GH_TRY(path_read(j->ctx, a->path, &j->path));
  GH_TRY(cli_check_outputs(j->ctx, (const char *const[]){a->output, a->tangent, a->dump, a->save}, 4));
  GH_TRY(cli_check_inputs_kept(j->ctx, (const char *const[]){a->output, a->tangent, a->dump, a->save}, 4,
                               (const char *const[]){a->packing, a->path, a->load}, 3));
  GH_TRY(path_check(j->ctx, a->path, &j->path, &a->rve, j->packing));
  contact_note(j->ctx, &a->contact, &a->rve.law);
  GH_TRY(cli_mpi(j->ctx, true));
  GH_TRY(gh_rve_create(j->ctx, j->packing, &a->rve, &j->rve));
  if (a->load) GH_TRY(rve_state_load(j->ctx, a->load, j->rve, &a->rve, j->packing));
  if (a->estimate) GH_TRY(gh_rve_create(j->ctx, j->packing, &a->rve, &j->whole));
  if (a->estimate) GH_TRY(join(j));
  GH_TRY(gh_text_create(j->ctx, &j->out));
  if (a->tangent) GH_TRY(gh_text_create(j->ctx, &j->tangent));
  if (a->dump) GH_TRY(gh_text_create(j->ctx, &j->dump));
  write_headers(j);
  gh_status status = walk(j);
  status = cli_end_of_rows(status, j->rows);
  return status == GH_INPUT ? status : cli_finish(j->ctx, status, write_last, j);
}

static int run(int argc, char **argv) {
  arguments args;
  int usage = parse(argc, argv, &args);
  if (usage) return usage;
  job j = {.ctx = cli_open(), .args = &args};
  if (!j.ctx) return 1;
  gh_status status = rve(&j);
  gh_rve_destroy(&j.rve);
  gh_rve_destroy(&j.whole);
  gh_text_destroy(&j.out);
  gh_text_destroy(&j.tangent);
  gh_text_destroy(&j.dump);
  gh_csv_destroy(&j.path.csv);
  gh_packing_destroy(&j.packing);
  return cli_close(j.ctx, status);
}

const cli_command cli_rve = {"rve", "one material point along a path of deformation gradients", help, run};
