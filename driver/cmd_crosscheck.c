/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom crosscheck: one packing and path through several programs. */
#include "cli.h"
#include "packing_options.h"
#include "path.h"

#include "granhom/crosscheck.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>

typedef struct arguments {
  packing_options p;
  const char *path, *folder;
  gh_crosscheck_options o;
  bool quiet;
} arguments;

typedef struct cross_job {
  gh_context *ctx;
  arguments *args;
  gh_lock *lock; /* of the folder */
  gh_packing *packing;
  path_rows path;
  double *F;
  long *step;
  gh_crosscheck *c;
} cross_job;

/* ---- options ---- */

static int engine_find(const char *text, size_t length) {
  for (int k = 0; k < GH_CROSS_ENGINES; k++)
    if (strlen(gh_cross_word(k)) == length && strncmp(gh_cross_word(k), text, length) == 0) return k;
  return -1;
}

/* "gran,native" */
static gh_status engines_read(gh_context *ctx, const char *where, const char *text, void *group) {
  gh_crosscheck_options *o = &((arguments *)group)->o;
  o->engines = 0;
  for (const char *at = text;; at++) {
    const size_t length = strcspn(at, ",");
    const int k = engine_find(at, length);
    if (k < 0)
      return gh_fail(ctx, GH_INPUT, "%s are lammps, native, gran and liggghts, not \"%.*s\"", where,
                     (int)length, at);
    for (int e = 0; e < o->engines; e++)
      if (o->engine[e] == k) return gh_fail(ctx, GH_INPUT, "%s names %s twice", where, gh_cross_word(k));
    o->engine[o->engines++] = k;
    at += length;
    if (!*at) break;
  }
  if (o->engines > 1) return GH_OK;
  return gh_fail(ctx, GH_INPUT, "%s must name two or more: there is nothing to compare", where);
}

static gh_status boundary_read(gh_context *ctx, const char *where, const char *text, void *group) {
  (void)group;
  if (strcmp(text, "periodic") == 0) return GH_OK;
  return gh_fail(
      ctx, GH_INPUT,
      "the other programs relax all grains of a periodic cell: %s can only be periodic, not \"%s\"", where,
      text);
}

static const option_row file_rows[] = {
    {.name = "output",
     .letter = 'o',
     .argument = "DIR",
     .kind = OPTION_TEXT,
     .place = offsetof(arguments, folder),
     .help = "folder of the results: crosscheck.csv, crosscheck.png (needs gnuplot), and refine.csv with "
             "--refine"},
    {.name = "boundary",
     .argument = "NAME",
     .kind = OPTION_OWN,
     .read = boundary_read,
     .standard = "periodic",
     .help = "periodic is the only one that the other programs have"},
    {0}};

static const option_row engine_rows[] = {
    {.name = "engines",
     .argument = "LIST",
     .kind = OPTION_OWN,
     .read = engines_read,
     .standard = "lammps,native,gran,liggghts",
     .help = "of the words above, with commas; all others are compared with the first"},
    {.name = "increment-steps",
     .argument = "N",
     .kind = OPTION_INTEGER,
     .low = 1,
     .high = 1000000,
     .place = offsetof(arguments, o.steps_per_row),
     .help = "time steps over which gran and liggghts spread an increment"},
    {.name = "refine",
     .argument = "K",
     .kind = OPTION_INTEGER,
     .low = 1,
     .high = GH_CROSS_LEVELS,
     .place = offsetof(arguments, o.levels),
     .help = "also with each increment in 2, 4, ... 2^(K-1) substeps; 1 to 8"},
    {.name = "liggghts",
     .argument = "PROGRAM",
     .kind = OPTION_TEXT,
     .place = offsetof(arguments, o.liggghts),
     .standard = "liggghts",
     .help = "LIGGGHTS's program"},
    {.name = "time-limit",
     .argument = "S",
     .kind = OPTION_NUMBER,
     .place = offsetof(arguments, o.seconds),
     .help = "seconds after which gran and liggghts are stopped, on each path"},
    {0}};

static void arguments_default(void *data) {
  arguments *a = data;
  packing_defaults(&a->p);
  if (a->p.rve.max_steps == 0) a->p.rve.max_steps = 400000;
  a->o = (gh_crosscheck_options){
      .steps_per_row = 50, .seconds = 600, .engines = GH_CROSS_ENGINES, .engine = {0, 1, 2, 3}, .levels = 1};
}

static gh_status arguments_check(gh_context *ctx, void *data) {
  arguments *a = data;
  if (!a->path) return gh_fail(ctx, GH_INPUT, "--path is missing");
  if (!a->folder) return gh_fail(ctx, GH_INPUT, "-o is missing: a folder for the results");
  GH_TRY(packing_check(ctx, &a->p));
  a->o.rve = a->p.rve;
  if (a->p.rve.law.hardening > 0)
    return gh_fail(ctx, GH_INPUT, "--hardening must be 0: the other programs have none");
  return GH_OK;
}

/* ---- the work ---- */

static gh_status path_set(cross_job *j) {
  const size_t rows = (size_t)j->path.csv->nrows;
  GH_TRY(gh_alloc(j->ctx, rows, 4 * sizeof *j->F, &j->F));
  GH_TRY(gh_alloc(j->ctx, rows, sizeof *j->step, &j->step));
  for (int row = 0; row < j->path.csv->nrows; row++) {
    path_F(&j->path, row, j->F + 4 * row);
    j->step[row] = path_step(&j->path, row);
  }
  gh_crosscheck_options *o = &j->args->o;
  o->packing = j->packing;
  o->rows = j->path.csv->nrows;
  o->F = j->F;
  o->step = j->step;
  return GH_OK;
}

static gh_status table_print(const cross_job *j) {
  gh_text *text;
  GH_TRY(gh_text_create(j->ctx, &text));
  gh_crosscheck_print(j->c, text);
  return cli_print_last(j->ctx, &text);
}

static gh_status crosscheck(cross_job *j) {
  const arguments *a = j->args;
  GH_TRY(gh_packing_read(j->ctx, a->p.packing, &j->packing));
  GH_TRY(path_read(j->ctx, a->path, &j->path));
  GH_TRY(path_check(j->ctx, a->path, &j->path, &a->p.rve, a->p.packing, j->packing));
  GH_TRY(cli_mpi(j->ctx, true));
  GH_TRY(path_set(j));
  GH_TRY(gh_crosscheck_create(j->ctx, &a->o, &j->c));
  GH_TRY(gh_output_folder_check(j->ctx, a->folder));
  GH_TRY(gh_outputs_within(j->ctx, a->folder,
                           (const char *const[]){"crosscheck.csv", "refine.csv", "crosscheck.png", NULL},
                           (const char *const[]){a->p.packing, a->path}, 2));
  GH_TRY(gh_lock_create(j->ctx, a->folder, &j->lock));
  GH_TRY(gh_crosscheck_run(j->c, a->folder));
  if (!a->quiet) GH_TRY(table_print(j));
  gh_status drawn = gh_crosscheck_draw(j->c, a->folder);
  if (drawn != GH_OK && drawn != GH_ENGINE) return drawn; /* a picture that cannot be written is missing */
  if (drawn != GH_OK) gh_log(j->ctx, GH_LEVEL_WARNING, "no picture: %s", gh_message(j->ctx));
  return gh_crosscheck_verdict(j->c);
}

static void job_free(cross_job *j) {
  gh_crosscheck_destroy(&j->c);
  free(j->F);
  free(j->step);
  gh_csv_destroy(&j->path.csv);
  gh_packing_destroy(&j->packing);
  gh_lock_destroy(&j->lock);
}

static gh_status crosscheck_work(gh_context *ctx, void *data) {
  cross_job j = {.ctx = ctx, .args = data};
  if (j.args->quiet) cli_quiet(ctx);
  signal(SIGPIPE, SIG_IGN); /* gnuplot may end early: its status reports it */
  gh_status status = crosscheck(&j);
  job_free(&j);
  return status;
}

const cli_command cli_crosscheck = {
    .name = "crosscheck",
    .summary = "one packing and path through several programs, compared",
    .usage = "usage: granhom crosscheck PACKING --path PATH.csv [options] -o DIR\n",
    .about = "Takes one packing (a LAMMPS data file, atom_style sphere) in its periodic cell along a path of "
             "deformation gradients with several programs, and compares their stresses:\n"
             "  lammps     granhom on LAMMPS\n"
             "  native     granhom's own engine\n"
             "  gran       LAMMPS's pair style gran/hooke/history\n"
             "  liggghts   LIGGGHTS, gran model hooke/stiffness tangential history, when it is installed; no "
             "shear\n"
             "The last two integrate the slip of a contact over the time steps of a damped motion; granhom "
             "takes it "
             "from one converged state to the next. --refine shows how the difference shrinks with the "
             "increments. They have no --hardening, and --relaxation is that of lammps and native alone.\n",
    .notes = "Exit status: 0 done, also when LIGGGHTS is missing or cannot do the path (the table reports "
             "it); 1 a "
             "program failed or was stopped (what there is is written), 2 wrong input.\n",
    .options = (const option_group[]){{path_option, offsetof(arguments, path)},
                                      {file_rows, 0},
                                      {engine_rows, 0},
                                      {packing_contact_rows, offsetof(arguments, p)},
                                      {packing_solver_rows, offsetof(arguments, p)},
                                      {cli_screen_rows, offsetof(arguments, quiet)},
                                      {0}},
    .noun = "packing",
    .missing = "which packing?",
    .operand = offsetof(arguments, p.packing),
    .size = sizeof(arguments),
    .defaults = arguments_default,
    .check = arguments_check,
    .work = crosscheck_work};
