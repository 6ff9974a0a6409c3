/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom study: error against run time. */
#include "cli.h"
#include "folder_options.h"

#include "study/study.h"

#include <signal.h>

typedef struct arguments {
  folder_options f;
  bool quick, fresh;
} arguments;

static const option_row rows[] = {
    {.name = "quick",
     .kind = OPTION_FLAG,
     .place = offsetof(arguments, quick),
     .help = "the small study that the file has under `quick`, in the place of the whole one"},
    {.name = "fresh",
     .kind = OPTION_FLAG,
     .place = offsetof(arguments, fresh),
     .help =
         "drops the records that DIR has of these runs, and repeats all; otherwise a run that has a record "
         "is not repeated"},
    {0}};

static gh_status study_print(gh_context *ctx, const gh_study *study,
                             void (*print)(const gh_study *study, gh_text *out)) {
  gh_text *text;
  GH_TRY(gh_text_create(ctx, &text));
  print(study, text);
  return cli_print_last(ctx, &text);
}

/* All ranks read the study, which none of them changes; where one cannot, none continues. */
static gh_status study_read(gh_context *ctx, const arguments *a, gh_study **study) {
  gh_status status = gh_study_read(ctx, a->f.file, a->quick, study),
            first = (gh_status)cli_share((int)status);
  if (status == GH_OK || first != GH_OK) return first;
  fprintf(stderr, "granhom: rank %d: %s\n", cli_rank(), gh_message(ctx));
  cli_abort(gh_exit_status(status));
  return status;
}

static gh_status study_work(gh_context *ctx, void *data) {
  const arguments *a = data;
  gh_study *study = NULL;
  folder_begin(ctx, &a->f);
  signal(SIGPIPE, SIG_IGN); /* gnuplot and who reads may end early: it is reported */
  gh_status status = study_read(ctx, a, &study);
  if (status == GH_OK && a->f.explain) {
    status = study_print(ctx, study, gh_study_explain);
  } else if (status == GH_OK) {
    gh_study_options options = {.stop = cli_stop, .comm = cli_world(), .fresh = a->fresh};
    status = gh_study_run(study, a->f.folder, &options);
    if (status == GH_OK && !a->f.quiet) status = study_print(ctx, study, gh_study_print);
  }
  gh_study_destroy(&study);
  return status;
}

const cli_command cli_study = {
    .name = "study",
    .summary = "one problem with many configurations: error against run time",
    .usage = "usage: granhom study STUDY.yaml -o DIR [options]\n"
             "       mpirun -n N granhom study STUDY.yaml -o DIR [options]\n"
             "       granhom study STUDY.yaml --explain\n",
    .about = "Runs one problem (a scene, or one packing along a path of deformation gradients) with each "
             "combination of the values of some of its keys, compares every answer with a reference, and "
             "reports what accuracy costs. `granhom help keys study` describes the study file.\n",
    .notes =
        "DIR holds study.md (the table, and a sentence for each goal), study.csv (the table in full), "
        "curves.csv (the answers), work-precision.png and other pictures (they need gnuplot), and runs/ with "
        "a record of each run. Runs spread over the ranks of mpirun, one at a time on each. A run that fails "
        "is listed with its reason. Ctrl-C ends a study within a moment; runs that are finished stay, and "
        "the "
        "same command continues with the others. A second Ctrl-C ends it at once.\n\n"
        "Exit status: 0 done, also when single runs have failed; 1 no combination has a result, the system "
        "refused "
        "a run (no memory, a program that is not installed), or the study was stopped; 2 wrong input.\n",
    .options = (const option_group[]){{folder_rows, offsetof(arguments, f)},
                                      {rows, 0},
                                      {cli_screen_rows, offsetof(arguments, f.quiet)},
                                      {0}},
    .noun = "study",
    .missing = "a study file is needed",
    .operand = offsetof(arguments, f.file),
    .size = sizeof(arguments),
    .check = folder_check,
    .ranks = true,
    .work = study_work};
