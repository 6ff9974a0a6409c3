/* granhom run: a scene from file to results. SPDX-License-Identifier: GPL-2.0-or-later */
#include "cli.h"
#include "granhom/scene.h"

#include <string.h>

typedef struct run_arguments {
  const char *scene, *folder, *engine;
  long every;
  bool explain, quiet, restart, no_share, no_balance, estimate;
} run_arguments;

/* 0, or the exit status after a message. */
static int parse(int argc, char **argv, run_arguments *a) {
  for (int k = 1; k < argc; k++) {
    const char *word = argv[k];
    bool every = strcmp(word, "--checkpoint-every") == 0;
    bool takes_value =
        every || strcmp(word, "-o") == 0 || strcmp(word, "--output") == 0 || strcmp(word, "--engine") == 0;
    if (takes_value && k + 1 >= argc) return cli_usage(&cli_run, "%s needs a value", word);
    if (every && !gh_parse_integer(argv[++k], 1, 1000000000, &a->every))
      return cli_usage(&cli_run, "--checkpoint-every '%s' is no number of increments", argv[k]);
    if (every) continue;
    if (strcmp(word, "--engine") == 0) a->engine = argv[++k];
    else if (takes_value) a->folder = argv[++k];
    else if (strcmp(word, "--restart") == 0) a->restart = true;
    else if (strcmp(word, "--no-share") == 0) a->no_share = true;
    else if (strcmp(word, "--no-balance") == 0) a->no_balance = true;
    else if (strcmp(word, "--estimate-error") == 0) a->estimate = true;
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

static gh_status explain(gh_context *ctx, const gh_scene *scene) {
  gh_text *text;
  GH_TRY(gh_text_create(ctx, &text));
  gh_scene_explain(scene, text);
  gh_status status = cli_print(ctx, text);
  gh_text_destroy(&text);
  return status;
}

typedef struct outcome {
  gh_context *ctx;
  gh_run_summary summary;
  const char *folder;
} outcome;

static gh_status summarise(void *data, bool good) {
  const outcome *o = data;
  gh_context *ctx = o->ctx;
  gh_text *text;
  (void)good;
  GH_TRY(gh_text_create(ctx, &text));
  gh_summary_print(&o->summary, o->folder, text);
  gh_status status = cli_print(ctx, text);
  gh_text_destroy(&text);
  return status;
}

static gh_status work(gh_context *ctx, const run_arguments *a) {
  gh_scene *scene = NULL;
  GH_TRY(gh_scene_read(ctx, a->scene, &scene));
  if (a->engine)
    gh_scene_set_engine(scene, strcmp(a->engine, "native") == 0 ? GH_ENGINE_NATIVE : GH_ENGINE_LAMMPS);
  gh_scene_set_sharing(scene, !a->no_share);
  gh_scene_set_estimate(scene, a->estimate);
  gh_scene_set_ranks(scene, cli_ranks(), a->no_balance);
  gh_status status;
  if (a->explain) {
    status = explain(ctx, scene);
  } else {
    gh_run_options options = {.stop = cli_stop,
                              .comm = cli_world(),
                              .no_balance = a->no_balance,
                              .restart = a->restart,
                              .checkpoint_every = (int)a->every};
    outcome o = {.ctx = ctx, .folder = a->folder};
    status = gh_scene_run(scene, a->folder, &options, &o.summary);
    if (!a->quiet && (o.summary.increments > 0 || status == GH_OK))
      status = cli_finish(ctx, status, summarise, &o);
  }
  gh_scene_destroy(&scene);
  return status;
}

/* Rank 0 runs the scene, the others serve its farm. All end with the status of rank 0. */
static gh_status share_work(gh_context *ctx, const run_arguments *a) {
  gh_status status;
  if (cli_rank() == 0) {
    status = work(ctx, a);
    gh_farm_dismiss(cli_world());
  } else if ((status = gh_farm_serve(ctx, cli_world(), cli_stop, NULL)) != GH_OK) {
    fprintf(stderr, "granhom: rank %d: %s\n", cli_rank(), gh_message(ctx)); /* rank 0 may be waiting for it */
    cli_abort(gh_exit_status(status));
  }
  return (gh_status)cli_share((int)status);
}

static int run(int argc, char **argv) {
  run_arguments a = {0};
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
  return cli_close(ctx, share_work(ctx, &a));
}

const cli_command cli_run = {
    .name = "run",
    .summary = "solves a scene: a structure whose material is a packing of grains",
    .help =
        "usage: granhom run SCENE.yaml -o DIR [options]\n"
        "       mpirun -n N granhom run SCENE.yaml -o DIR [options]\n"
        "       granhom run SCENE.yaml --explain\n\n"
        "  -o DIR, --output DIR      folder for the results, made where it is missing; what is in it is "
        "replaced\n"
        "  --engine lammps|native    who relaxes the grains, instead of the scene's `micro: {engine: ...}`\n"
        "  --explain                 says what the scene switches on and what it leaves out, and runs "
        "nothing\n"
        "  --restart                 goes on from DIR/checkpoint.h5 as if nothing had happened, also with "
        "another "
        "number of\n"
        "                            ranks; from the start where there is none\n"
        "  --checkpoint-every N      increments from one checkpoint to the next (1); a run that is stopped "
        "or "
        "fails writes\n"
        "                            one of its last complete increment too\n"
        "  --estimate-error          solves each increment a second time in two halves and goes on from "
        "these: "
        "an estimate of\n"
        "                            the error of the path, for about three times the time\n"
        "  --no-share                computes each integration point, also where others have the same "
        "packing "
        "and the same\n"
        "                            history; the results are the same\n"
        "  --no-balance              leaves integration points on the rank where they began\n"
        "  --quiet                   only warnings and errors on the screen\n\n"
        "DIR holds, complete after each increment: results.h5 and results.xdmf (open the latter in "
        "ParaView),\n"
        "history.csv (loads, reactions, dilatancy), convergence.csv (residuals), rves.h5 (grains and "
        "contacts),\n"
        "timing.csv, run.json (versions, options, outcome), checkpoint.h5 (for --restart). `granhom report "
        "DIR` "
        "makes a page of them, `granhom plot DIR` pictures.\n"
        "A second run in a folder that another one writes into is refused at once, with exit status 1.\n"
        "Ctrl-C ends the run within a moment; a second one ends it at once. What is on disk is complete up "
        "to "
        "the increment before.\n"
        "`granhom help keys scene` describes the scene file.\n",
    .run = run};
