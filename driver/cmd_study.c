/* granhom study: error against run time. SPDX-License-Identifier: GPL-2.0-or-later */
#include "cli.h"
#include "granhom/study.h"

#include <signal.h>
#include <string.h>

static const char help[] =
    "usage: granhom study STUDY.yaml -o DIR [options]\n"
    "       mpirun -n N granhom study STUDY.yaml -o DIR [options]\n"
    "       granhom study STUDY.yaml --explain\n"
    "\n"
    "Runs one problem (a scene, or one packing along a path of deformation gradients) with each combination "
    "of\n"
    "the values of some of its keys, compares every answer with a reference, and says what accuracy costs.\n"
    "\n"
    "  -o, --output DIR       folder for records, tables and pictures\n"
    "  --quick                the small study that the file has under `quick`, in the place of the whole "
    "one\n"
    "  --fresh                forgets the records that DIR has of these runs, and repeats all; otherwise a "
    "run that\n"
    "                         has a record is not repeated\n"
    "  --explain              says what would be run, and runs nothing\n"
    "  --quiet                only warnings and errors on the screen\n"
    "\n"
    "DIR holds study.md (the table, and a sentence for each goal), study.csv (the table in full), "
    "curves.csv\n"
    "(the answers), work-precision.png and other pictures (they need gnuplot), and runs/ with a record of "
    "each\n"
    "run. Runs spread over the ranks of mpirun, one at a time on each. A run that fails is listed with its\n"
    "reason. Ctrl-C ends a study within a moment; runs that are finished stay, and the same command goes on\n"
    "with the others. A second Ctrl-C ends it at once.\n"
    "`granhom help keys study` describes the study file.\n"
    "\n"
    "Exit status: 0 done, also when single runs have failed; 1 no setting has a result, the system refused\n"
    "a run (no memory, a program that is not installed), or the study was stopped; 2 wrong input.\n";

typedef struct arguments {
  const char *study, *folder;
  bool quick, fresh, explain, quiet;
} arguments;

static int parse(int argc, char **argv, arguments *a) {
  for (int k = 1; k < argc; k++) {
    const char *word = argv[k];
    bool output = strcmp(word, "-o") == 0 || strcmp(word, "--output") == 0;
    if (output && k + 1 >= argc) return cli_usage(&cli_study, "%s needs a value", word);
    if (output) a->folder = argv[++k];
    else if (strcmp(word, "--quick") == 0) a->quick = true;
    else if (strcmp(word, "--fresh") == 0) a->fresh = true;
    else if (strcmp(word, "--explain") == 0) a->explain = true;
    else if (strcmp(word, "--quiet") == 0) a->quiet = true;
    else if (word[0] == '-' && word[1]) return cli_usage(&cli_study, "there is no option '%s'", word);
    else if (a->study) return cli_usage(&cli_study, "one study at a time, not '%s' and '%s'", a->study, word);
    else a->study = word;
  }
  if (!a->study) return cli_usage(&cli_study, "a study file is needed");
  if (!a->folder && !a->explain) return cli_usage(&cli_study, "-o DIR is needed: the folder for results");
  return 0;
}

static gh_status say(gh_context *ctx, const gh_study *study,
                     void (*print)(const gh_study *study, gh_text *out)) {
  gh_text *text;
  if (cli_rank() > 0) return GH_OK;
  GH_TRY(gh_text_create(ctx, &text));
  print(study, text);
  gh_status status = cli_print(ctx, text);
  gh_text_destroy(&text);
  return status;
}

/* All ranks read the study, which none of them changes; where one cannot, none goes on. */
static gh_status read_together(gh_context *ctx, const arguments *a, gh_study **study) {
  gh_status status = gh_study_read(ctx, a->study, a->quick, study), first = (gh_status)cli_share((int)status);
  if (status == GH_OK || first != GH_OK) return first;
  fprintf(stderr, "granhom: rank %d: %s\n", cli_rank(), gh_message(ctx));
  cli_abort(gh_exit_status(status));
  return status;
}

static gh_status study(gh_context *ctx, const arguments *a) {
  gh_study *study = NULL;
  gh_status status = read_together(ctx, a, &study);
  if (status == GH_OK && a->explain) {
    status = say(ctx, study, gh_study_explain);
  } else if (status == GH_OK) {
    gh_study_options options = {.stop = cli_stop, .comm = cli_world(), .fresh = a->fresh};
    status = gh_study_run(study, a->folder, &options);
    if (status == GH_OK && !a->quiet) status = say(ctx, study, gh_study_print);
  }
  gh_study_destroy(&study);
  return status;
}

static int run(int argc, char **argv) {
  arguments a = {0};
  gh_context *ctx = cli_open();
  if (!ctx) return 1;
  gh_status status = cli_mpi(ctx, false);
  if (status != GH_OK) return cli_close(ctx, status);
  int code = parse(argc, argv, &a);
  if (code) {
    gh_context_destroy(&ctx);
    return code;
  }
  if (a.quiet) cli_quiet(ctx);
  if (!a.explain) cli_catch_signals();
  signal(SIGPIPE, SIG_IGN); /* gnuplot and who reads may end early: it is told */
  return cli_close(ctx, study(ctx, &a));
}

const cli_command cli_study = {"study", "one problem with many settings: error against run time", help, run};
