/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom element: one material point under prescribed stresses and strains. */
#include "cli.h"
#include "element_spec.h"
#include "packing_options.h"
#include "reference.h"
#include "rve_doubts.h"
#include "rve_state.h"
#include "rve_table.h"

#include "granhom/io.h"
#include "granhom/limits.h"

#include <stdlib.h>
#include <string.h>

static const double WRITE_EVERY = 2; /* seconds */

typedef struct arguments {
  packing_options p;
  state_options state;
  const char *control, *path, *output;
  gh_control_options options;
  bool stop_at_jumps, quiet;
} arguments;

typedef struct job {
  gh_context *ctx;
  const arguments *args;
  gh_packing *packing;
  element_spec spec;
  gh_rve *rve;
  gh_control *control;
  rve_doubts doubts; /* of the increment under way */
  gh_text *out;
  int row, jumps, jumped; /* rows written; jumps in all, and increments that had some */
  double written;
  bool warned; /* of overlaps */
} job;

/* ---- options ---- */

static const option_row file_rows[] = {
    {.name = "control",
     .argument = "FILE",
     .kind = OPTION_TEXT,
     .place = offsetof(arguments, control),
     .help =
         "YAML: steps, each with three conditions, or four (`granhom help keys element`), on F11 F12 F21 "
         "F22, volume (det F), Cauchy stresses s11 s12 s22, pressure (-(s11 + s22)/2), Piola stresses P11 "
         "P12 P21 P22, and sums: \"s22 - 0.5 s11\". With three, F21 is fixed: what is horizontal stays "
         "so"},
    {.name = "path",
     .argument = "FILE",
     .kind = OPTION_TEXT,
     .place = offsetof(arguments, path),
     .help = "CSV: a column for each of the conditions, a row of targets per increment; - is standard input"},
    {0}};

static const option_row control_rows[] = {
    {.name = "stress-tolerance",
     .argument = "T",
     .kind = OPTION_NUMBER,
     .below = 1,
     .place = offsetof(arguments, options.tolerance),
     .help = "lack of a prescribed stress over the largest stress"},
    {.name = "cut-steps",
     .argument = "N",
     .kind = OPTION_INTEGER,
     .high = 30,
     .place = offsetof(arguments, options.cut_steps),
     .help = "depth to which a failing increment is bisected, 0 to 30"},
    {.name = "stop-at-jumps",
     .kind = OPTION_FLAG,
     .place = offsetof(arguments, stop_at_jumps),
     .help = "fails at an instability of the packing, or a limit load, that has no equilibrium near, instead "
             "of stepping over it by servo control"},
    {0}};

static void arguments_default(void *data) {
  arguments *a = data;
  packing_defaults(&a->p);
  a->p.rve.tolerance = 1e-10;
  a->options = gh_control_defaults();
}

static gh_status arguments_check(gh_context *ctx, void *data) {
  arguments *a = data;
  if (!a->control == !a->path)
    return gh_fail(ctx, GH_INPUT, "give one of --control and --path, which say what is prescribed");
  GH_TRY(packing_check(ctx, &a->p));
  a->options.stiffness = a->p.rve.law.normal_stiffness;
  a->options.pass_jumps = !a->stop_at_jumps;
  return GH_OK;
}

/* ---- results ---- */

static void write_header(job *j) {
  rve_table_header(j->out, &j->args->p.rve);
  gh_text_print(j->out, ",");
  gh_terms_header(j->out, columns_control, ",");
  gh_text_print(j->out, "\n");
}

static gh_status write_row(job *j, int load_step, const gh_control_report *r, double seconds) {
  const gh_rve_measures *m = gh_rve_measure(j->rve);
  size_t row;
  gh_text_get(j->out, &row);
  rve_table_row(j->out, j->row, m, gh_max(j->doubts.residual, m->residual), seconds, &j->args->p.rve);
  gh_text_print(j->out, ",%d,%.17g,%.17g,%d,%d,%d,%d,%.6g\n", load_step, gh_det2(m->F),
                -(m->cauchy[0] + m->cauchy[3]) / 2, r->iterations, r->parts, r->cuts, r->jumps, r->mismatch);
  GH_TRY(gh_text_check_row(j->out, row, j->args->output ? j->args->output : "the result"));
  rve_doubts_tell(j->ctx, &j->doubts, j->row);
  j->row++;
  j->jumps += r->jumps;
  j->jumped += r->jumps > 0;
  return GH_OK;
}

/* The file appears whole, the first time after the first increment, so that wrong input writes nothing; a
 * killed run leaves what it had. */
static gh_status write_file(job *j, bool last) {
  j->written = gh_seconds();
  return rve_table_write(j->ctx, j->out, j->args->output, last);
}

/* ---- the test ---- */

static void count_part(void *data) {
  job *j = data;
  rve_doubts_add(&j->doubts, gh_rve_measure(j->rve));
}

/* A target that was not known when the file was read; zero is met within the tolerance of the stresses. */
static gh_status check_target(job *j, const element_step *s, int k, double from, double to) {
  char where[512];
  if (s->way[k] == ELEMENT_TO || s->line[k] == 0 || fabs(to) <= 1e-4 * fabs(from)) return GH_OK;
  snprintf(where, sizeof where, "%s:%d", j->spec.path, s->line[k]);
  gh_status status = element_check_target(j->ctx, where, &s->condition[k], to, &j->args->p.rve,
                                          gh_packing_volume_fraction(j->packing), &j->warned);
  if (status == GH_OK) return GH_OK;
  char *message = strdup(gh_message(j->ctx)); /* the rows before are on disk: no wrong input any more */
  status = gh_fail(j->ctx, GH_LIMIT, "%s", message ? message : where);
  free(message);
  return status;
}

/* Where the conditions are at the start of a step, and where they go. */
static gh_status set_out(job *j, const element_step *s, double from[4], double to[4]) {
  for (int k = 0; k < 4; k++) {
    from[k] = gh_condition_value(&s->condition[k], gh_control_F(j->control), gh_control_P(j->control));
    to[k] = s->way[k] == ELEMENT_TO   ? s->value[k]
            : s->way[k] == ELEMENT_BY ? from[k] + s->value[k]
                                      : from[k] * s->value[k];
    GH_TRY(check_target(j, s, k, from[k], to[k]));
  }
  return GH_OK;
}

static bool beyond(const job *j, const element_step *s) {
  return gh_condition_value(&s->end, gh_control_F(j->control), gh_control_P(j->control)) > s->level;
}

static gh_status check_state(job *j) {
  return gh_limits_check(j->ctx, &j->args->p.rve, gh_rve_measure(j->rve), "the packing", &j->warned);
}

static gh_status increment(job *j, const element_step *s, int number, int k, const double from[4],
                           const double to[4]) {
  double start = gh_seconds(), target[4], t = (k + 1.) / s->increments;
  gh_control_report report;
  for (int c = 0; c < 4; c++) target[c] = k + 1 < s->increments ? from[c] + t * (to[c] - from[c]) : to[c];
  gh_status status = gh_control_solve(j->control, s->condition, target, &report);
  if (status == GH_OK) status = check_state(j);
  if (status != GH_OK)
    return gh_prefix(j->ctx, status, "%s, increment %d of %d: ", s->name, k + 1, s->increments);
  GH_TRY(write_row(j, number, &report, gh_seconds() - start));
  return GH_OK;
}

static gh_status step(job *j, int number, gh_work *work, int before) {
  const element_step *s = &j->spec.steps[number - 1];
  double from[4], to[4];
  GH_TRY(set_out(j, s, from, to));
  bool side = s->until && beyond(j, s);
  for (int k = 0; k < s->increments; k++) {
    GH_TRY(increment(j, s, number, k, from, to));
    gh_work_advance(j->ctx, work, before + k + 1);
    if (j->row == 2 || gh_seconds() - j->written > WRITE_EVERY) GH_TRY(write_file(j, false));
    if (s->until && beyond(j, s) != side) return GH_OK;
  }
  return GH_OK;
}

/* What an engine cannot take is the packing's fault. */
static gh_status blame(job *j, gh_status status) {
  return status == GH_INPUT ? gh_prefix(j->ctx, status, "%s: ", j->args->p.packing) : status;
}

static gh_status walk(job *j) {
  gh_work work;
  int before = 0;
  double start = gh_seconds();
  gh_control_report none = {.parts = 1, .iterations = 1};
  GH_TRY(blame(j, gh_control_start(j->control, gh_rve_F(j->rve))));
  GH_TRY(check_state(j));
  GH_TRY(write_row(j, 0, &none, gh_seconds() - start));
  gh_work_begin(j->ctx, &work, "element", "increments", j->spec.increments);
  gh_status status = GH_OK;
  for (int n = 1; n <= j->spec.nsteps && status == GH_OK; n++) {
    status = step(j, n, &work, before);
    before += j->spec.steps[n - 1].increments;
  }
  gh_work_end(j->ctx, &work, j->row - 1);
  if (j->jumps)
    gh_log(j->ctx, GH_LEVEL_INFO, "%d jump%s of the packing passed by servo control, in %d of %d increments",
           j->jumps, j->jumps == 1 ? "" : "s", j->jumped, j->row - 1);
  return status;
}

/* What was computed is written also when an increment failed. */
static gh_status write_last(void *data, bool good) {
  job *j = data;
  GH_TRY(write_file(j, true));
  if (!good || !j->args->state.save) return GH_OK;
  return rve_state_save(j->ctx, j->args->state.save, j->rve, &j->args->p.rve, j->packing);
}

static gh_status element(job *j) {
  const arguments *a = j->args;
  GH_TRY(a->control ? element_spec_read(j->ctx, a->control, &j->spec)
                    : element_spec_read_path(j->ctx, a->path, &j->spec));
  GH_TRY(gh_packing_read(j->ctx, a->p.packing, &j->packing));
  const gh_output outputs[] = {{a->output, GH_FILE_PATH}, {a->state.save, GH_FILE_STATE}};
  GH_TRY(cli_check_outputs(j->ctx, outputs, 2,
                           (const char *const[]){a->p.packing, a->control, a->path, a->state.load}, 4));
  bool warned = false;
  if (!a->state.load)
    GH_TRY(gh_limits_check_packing(j->ctx, &a->p.rve, a->p.packing, j->packing, 1, 1, &warned));
  GH_TRY(element_spec_check(j->ctx, &j->spec, &a->p.rve, j->packing, a->state.load != NULL));
  packing_note(j->ctx, &a->p);
  GH_TRY(cli_mpi(j->ctx, true));
  const gh_status fits = gh_rve_check_packing(j->ctx, j->packing, &a->p.rve);
  if (fits != GH_OK) return gh_prefix(j->ctx, fits, "%s: ", a->p.packing);
  GH_TRY(gh_rve_create(j->ctx, j->packing, &a->p.rve, &j->rve));
  if (a->state.load) GH_TRY(rve_state_load(j->ctx, a->state.load, j->rve, &a->p.rve, j->packing));
  GH_TRY(gh_control_create_rve(j->ctx, j->rve, &a->options, &j->control));
  gh_control_set_count(j->control, count_part, j);
  GH_TRY(gh_text_create(j->ctx, &j->out));
  write_header(j);
  gh_status status = walk(j);
  status = cli_end_of_rows(status, j->row - 1); /* without row 0, the start */
  return status == GH_INPUT ? status : cli_finish(j->ctx, status, write_last, j);
}

static gh_status element_work(gh_context *ctx, void *data) {
  job j = {.ctx = ctx, .args = data};
  if (j.args->quiet) cli_quiet(ctx);
  gh_status status = element(&j);
  gh_control_destroy(&j.control);
  gh_rve_destroy(&j.rve);
  gh_text_destroy(&j.out);
  element_spec_free(&j.spec);
  gh_packing_destroy(&j.packing);
  return status;
}

const cli_command cli_element = {
    .name = "element",
    .summary = "element test: a packing under prescribed stresses and strains",
    .usage = "usage: granhom element PACKING --control SPEC.yaml [options] [-o OUT.csv]\n"
             "       granhom element PACKING --path TABLE.csv [options] [-o OUT.csv]\n",
    .about =
        "An element test: any mix of stresses and strains is prescribed for one packing, and F is found.\n",
    .notes = "`granhom help columns rve` describes the results. Row 0 is the start: the packing as read, in "
             "equilibrium.\n\n"
             "Exit status: 0 done, 1 an increment did not converge (the rows before it are written), 2 wrong "
             "input.\n",
    .options = (const option_group[]){{file_rows, 0},
                                      {rve_table_option, offsetof(arguments, output)},
                                      {packing_condition_rows, offsetof(arguments, p)},
                                      {packing_contact_rows, offsetof(arguments, p)},
                                      {packing_solver_rows, offsetof(arguments, p)},
                                      {packing_accept_rows, offsetof(arguments, p)},
                                      {control_rows, 0},
                                      {packing_state_rows, offsetof(arguments, state)},
                                      {cli_screen_rows, offsetof(arguments, quiet)},
                                      {0}},
    .noun = "packing",
    .missing = "which packing?",
    .operand = offsetof(arguments, p.packing),
    .size = sizeof(arguments),
    .defaults = arguments_default,
    .check = arguments_check,
    .work = element_work};
