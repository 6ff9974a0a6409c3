/* granhom run: a scene from file to results. SPDX-License-Identifier: GPL-2.0-or-later */
#include "cli.h"
#include "granhom/scene.h"

#include <signal.h>
#include <string.h>

typedef struct run_arguments {
  const char *scene, *folder, *engine;
  bool explain, quiet;
} run_arguments;

/* Set by the first SIGINT or SIGTERM, asked before each material point. */
static volatile sig_atomic_t stop_wanted;

static void on_signal(int number) {
  (void)number;
  stop_wanted = 1;
}

/* A second signal ends the program at once: files on disk are whole at any time. */
static void catch_signals(void) {
  struct sigaction action = {.sa_handler = on_signal, .sa_flags = SA_RESTART | (int)SA_RESETHAND};
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
}

static bool stop(void *data) {
  (void)data;
  return stop_wanted;
}

/* 0, or the exit status after a message. */
static int parse(int argc, char **argv, run_arguments *a) {
  for (int k = 1; k < argc; k++) {
    const char *word = argv[k];
    bool takes_value =
        strcmp(word, "-o") == 0 || strcmp(word, "--output") == 0 || strcmp(word, "--engine") == 0;
    if (takes_value && k + 1 >= argc) return cli_usage(&cli_run, "%s needs a value", word);
    if (strcmp(word, "--engine") == 0) a->engine = argv[++k];
    else if (takes_value) a->folder = argv[++k];
    else if (strcmp(word, "--explain") == 0) a->explain = true;
    else if (strcmp(word, "--quiet") == 0) a->quiet = true;
    else if (word[0] == '-' && word[1]) return cli_usage(&cli_run, "there is no option '%s'", word);
    else if (a->scene) return cli_usage(&cli_run, "one scene at a time, not '%s' and '%s'", a->scene, word);
    else a->scene = word;
  }
  if (!a->scene) return cli_usage(&cli_run, "a scene file is needed");
  if (!a->folder && !a->explain) return cli_usage(&cli_run, "-o DIR is needed: the folder for results");
  if (a->engine && strcmp(a->engine, "lammps") != 0 && strcmp(a->engine, "native") != 0)
    return cli_usage(&cli_run, "engine '%s' is none of lammps, native", a->engine);
  return 0;
}

static void warnings_only(void *data, gh_level level, const char *line) {
  (void)data;
  if (level == GH_LEVEL_WARNING) fprintf(stderr, "warning: %s\n", line);
}

static gh_status explain(gh_context *ctx, const gh_scene *scene) {
  gh_text *text;
  GH_TRY(gh_text_create(ctx, &text));
  gh_scene_explain(scene, text);
  fputs(gh_text_get(text, NULL), stdout);
  gh_text_destroy(&text);
  return GH_OK;
}

static gh_status summarise(gh_context *ctx, const gh_run_summary *summary, const char *folder) {
  gh_text *text;
  GH_TRY(gh_text_create(ctx, &text));
  gh_summary_print(summary, folder, text);
  fputs(gh_text_get(text, NULL), stdout);
  gh_text_destroy(&text);
  return GH_OK;
}

static gh_status work(gh_context *ctx, const run_arguments *a) {
  gh_scene *scene = NULL;
  GH_TRY(gh_scene_read(ctx, a->scene, &scene));
  if (a->engine)
    gh_scene_set_engine(scene, strcmp(a->engine, "native") == 0 ? GH_ENGINE_NATIVE : GH_ENGINE_LAMMPS);
  gh_status status;
  if (a->explain) {
    status = explain(ctx, scene);
  } else {
    gh_run_options options = {.stop = stop};
    gh_run_summary summary;
    status = gh_scene_run(scene, a->folder, &options, &summary);
    if (!a->quiet && (summary.increments > 0 || status == GH_OK)) summarise(ctx, &summary, a->folder);
  }
  gh_scene_destroy(&scene);
  return status;
}

static int run(int argc, char **argv) {
  run_arguments a = {0};
  int code = parse(argc, argv, &a);
  if (code) return code;
  gh_context *ctx = cli_open();
  if (!ctx) return 1;
  if (a.quiet) {
    gh_set_log(ctx, warnings_only, NULL);
    gh_set_progress(ctx, NULL, NULL);
  }
  gh_status status = cli_mpi(ctx, true);
  if (status == GH_OK && !a.explain) catch_signals();
  if (status == GH_OK) status = work(ctx, &a);
  return cli_close(ctx, status);
}

const cli_command cli_run = {
    .name = "run",
    .summary = "solves a scene: a structure whose material is a packing of grains",
    .help =
        "usage: granhom run SCENE.yaml -o DIR [options]\n"
        "       granhom run SCENE.yaml --explain\n\n"
        "  -o DIR, --output DIR      folder for the results, made where it is missing; what is in it is "
        "replaced\n"
        "  --engine lammps|native    who relaxes the grains, instead of the scene's `micro: {engine: ...}`\n"
        "  --explain                 says what the scene switches on and what it leaves out, and runs "
        "nothing\n"
        "  --quiet                   only warnings and errors on the screen\n\n"
        "DIR holds, complete after each increment: results.h5 and results.xdmf (open the latter in "
        "ParaView),\n"
        "history.csv (loads, reactions, dilatancy), convergence.csv (residuals), rves.h5 (grains and "
        "contacts),\n"
        "run.json (versions, options, outcome). `granhom report DIR` makes a page of them, `granhom plot "
        "DIR` "
        "pictures.\n"
        "Ctrl-C ends the run within a moment; a second one ends it at once. What is on disk is complete up "
        "to "
        "the increment before.\n"
        "The scene file is described in docs/user-guide.md.\n",
    .run = run};
