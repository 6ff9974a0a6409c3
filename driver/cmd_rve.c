/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom rve: one material point along a path of F. */
#include "cli.h"
#include "packing_options.h"
#include "path.h"
#include "reference.h"
#include "rve_doubts.h"
#include "rve_error.h"
#include "rve_state.h"
#include "rve_table.h"

#include "granhom/io.h"
#include "granhom/limits.h"
#include "granhom/scene.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double WRITE_EVERY = 2; /* seconds */

typedef struct arguments {
  packing_options p;
  state_options state;
  const char *path, *output, *tangent, *dump;
  bool estimate, quiet;
} arguments;

typedef struct job {
  gh_context *ctx;
  const arguments *args;
  gh_packing *packing;
  path_rows path;
  gh_rve *rve, *whole; /* whole: a second path, in whole rows; NULL without an estimate of the error */
  rve_error error;
  rve_doubts doubts;         /* of the increment under way */
  int ramps, events, newton; /* the same: how its equilibria were found */
  gh_text *out, *tangent, *dump;
  double written; /* when the files were last written */
  int rows;       /* complete */
  bool warned;    /* of overlaps */
} job;

/* ---- options ---- */

static const option_row more_rows[] = {
    {.name = "estimate-error",
     .kind = OPTION_FLAG,
     .place = offsetof(arguments, estimate),
     .help = "computes the path in halves of its rows, and once more in whole rows: an estimate of the error "
             "of the stress, for about three times the time"},
    {.name = "tangent",
     .argument = "FILE",
     .kind = OPTION_TEXT,
     .place = offsetof(arguments, tangent),
     .help = "tangent dP/dF of each increment: step,A1111,A1112,...,A2222"},
    {.name = "dump",
     .argument = "FILE",
     .kind = OPTION_TEXT,
     .place = offsetof(arguments, dump),
     .help = "a LAMMPS dump of the grains, one frame per increment, positions with image flags (OVITO reads "
             "it)"},
    {0}};

static void arguments_default(void *data) {
  arguments *a = data;
  packing_defaults(&a->p);
}

static gh_status arguments_check(gh_context *ctx, void *data) {
  arguments *a = data;
  if (!a->path) return gh_fail(ctx, GH_INPUT, "--path is missing");
  return packing_check(ctx, &a->p);
}

/* ---- results ---- */

static void write_headers(job *j) {
  rve_table_header(j->out, &j->args->p.rve);
  if (j->args->p.rve.law.friction) {
    gh_text_print(j->out, ",");
    gh_terms_header(j->out, columns_ramp, ",");
  }
  gh_text_print(j->out, ",");
  gh_terms_header(j->out, columns_path, ",");
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
  rve_table_row(j->out, step, m, j->doubts.residual, m->seconds, &j->args->p.rve);
  if (j->args->p.rve.law.friction) gh_text_print(j->out, ",%d", j->ramps);
  gh_text_print(j->out, ",%d,%d", j->events, j->newton);
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
  j->ramps = j->events = j->newton = 0;
  if (m->regularised)
    gh_log(j->ctx, GH_LEVEL_WARNING, "step %ld: a mode without stiffness: the tangent is regularised", step);
  return j->dump ? write_frame(j, step) : GH_OK;
}

/* Files appear whole, the first time after the first increment, so that wrong input writes nothing; a killed
 * run leaves what it had. */
static gh_status write_files(job *j, bool last) {
  GH_TRY(rve_table_write(j->ctx, j->out, j->args->output, last));
  GH_TRY(rve_table_write(j->ctx, j->tangent, j->args->tangent, last));
  GH_TRY(rve_table_write(j->ctx, j->dump, j->args->dump, last));
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
  j->ramps += m->ramps, j->events += m->events, j->newton += m->newton;
}

/* The row on the path whose results are written. */
static gh_status reach(job *j, long step, const double from[4], const double to[4], double A[16]) {
  gh_rve_way way = {
      .halvings = j->whole ? 1 : 0, .want = j->tangent ? GH_WANT_TANGENT : 0, .count = count_part, .data = j};
  memcpy(way.from, from, sizeof way.from);
  memcpy(way.to, to, sizeof way.to);
  GH_TRY(gh_rve_reach(j->rve, &way, A));
  if (way.cuts > 0)
    gh_log(j->ctx, GH_LEVEL_INFO, "step %ld: no equilibrium at once, reached in %d substeps", step,
           way.parts);
  return GH_OK;
}

/* The second path continues from where the first one is. */
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
  const bool branched = rve_error_compare(&j->error, gh_rve_measure(j->rve)->P, whole, &j->args->p.rve);
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
      status = gh_limits_check(j->ctx, &j->args->p.rve, gh_rve_measure(j->rve), "the packing", &j->warned);
    if (status == GH_OK) status = write_row(j, step, A);
    if (status == GH_OK && j->whole) status = compare(j, step, from, F);
    if (status == GH_OK) status = gh_rve_commit(j->rve);
    j->rows += status == GH_OK;
    memcpy(from, F, sizeof from);
    if (status != GH_OK) gh_prefix(j->ctx, status, "step %ld: ", step);
    if (status == GH_INPUT) gh_prefix(j->ctx, status, "%s: ", j->args->p.packing);
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
  if (!good || !j->args->state.save) return GH_OK;
  return rve_state_save(j->ctx, j->args->state.save, j->rve, &j->args->p.rve, j->packing);
}

static gh_status rve(job *j) {
  const arguments *a = j->args;
  if ((a->state.save || a->state.load) && !gh_h5_available())
    return gh_fail(
        j->ctx, GH_INPUT,
        "--save-state and --load-state need HDF5, and this granhom was built without (make HDF5=0)");
  GH_TRY(gh_packing_read(j->ctx, a->p.packing, &j->packing));
  GH_TRY(path_read(j->ctx, a->path, &j->path));
  const gh_output outputs[] = {{a->output, GH_FILE_PATH},
                               {a->tangent, GH_FILE_PATH},
                               {a->dump, GH_FILE_DUMP},
                               {a->state.save, GH_FILE_STATE}};
  GH_TRY(
      cli_check_outputs(j->ctx, outputs, 4, (const char *const[]){a->p.packing, a->path, a->state.load}, 3));
  GH_TRY(path_check(j->ctx, a->path, &j->path, &a->p.rve, a->p.packing, j->packing));
  packing_note(j->ctx, &a->p);
  GH_TRY(cli_mpi(j->ctx, true));
  const gh_status fits = gh_rve_check_packing(j->ctx, j->packing, &a->p.rve);
  if (fits != GH_OK) return gh_prefix(j->ctx, fits, "%s: ", a->p.packing);
  GH_TRY(gh_rve_create(j->ctx, j->packing, &a->p.rve, &j->rve));
  if (a->state.load) GH_TRY(rve_state_load(j->ctx, a->state.load, j->rve, &a->p.rve, j->packing));
  if (a->estimate) GH_TRY(gh_rve_create(j->ctx, j->packing, &a->p.rve, &j->whole));
  if (a->estimate) GH_TRY(join(j));
  GH_TRY(gh_text_create(j->ctx, &j->out));
  if (a->tangent) GH_TRY(gh_text_create(j->ctx, &j->tangent));
  if (a->dump) GH_TRY(gh_text_create(j->ctx, &j->dump));
  write_headers(j);
  gh_status status = walk(j);
  status = cli_end_of_rows(status, j->rows);
  return status == GH_INPUT ? status : cli_finish(j->ctx, status, write_last, j);
}

static gh_status rve_work(gh_context *ctx, void *data) {
  job j = {.ctx = ctx, .args = data};
  if (j.args->quiet) cli_quiet(ctx);
  gh_status status = rve(&j);
  gh_rve_destroy(&j.rve);
  gh_rve_destroy(&j.whole);
  gh_text_destroy(&j.out);
  gh_text_destroy(&j.tangent);
  gh_text_destroy(&j.dump);
  gh_csv_destroy(&j.path.csv);
  gh_packing_destroy(&j.packing);
  return status;
}

const cli_command cli_rve = {
    .name = "rve",
    .summary = "one material point along a path of deformation gradients",
    .usage = "usage: granhom rve PACKING --path PATH.csv [options] [-o OUT.csv]\n",
    .about =
        "Deforms one packing (a LAMMPS data file, atom_style sphere) along a path of deformation gradients "
        "and writes stress, energy and what else is known of each increment. An increment without "
        "equilibrium is bisected, to a depth of six.\n",
    .notes = "Exit status: 0 done, 1 an increment did not converge (the rows before it are written), 2 wrong "
             "input.\n",
    .options = (const option_group[]){{path_option, offsetof(arguments, path)},
                                      {rve_table_option, offsetof(arguments, output)},
                                      {packing_condition_rows, offsetof(arguments, p)},
                                      {packing_contact_rows, offsetof(arguments, p)},
                                      {packing_solver_rows, offsetof(arguments, p)},
                                      {packing_accept_rows, offsetof(arguments, p)},
                                      {more_rows, 0},
                                      {packing_state_rows, offsetof(arguments, state)},
                                      {cli_screen_rows, offsetof(arguments, quiet)},
                                      {0}},
    .noun = "packing",
    .missing = "which packing?",
    .operand = offsetof(arguments, p.packing),
    .size = sizeof(arguments),
    .defaults = arguments_default,
    .check = arguments_check,
    .work = rve_work};
