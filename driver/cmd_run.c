/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom run: a scene from file to results. */
#include "cli.h"
#include "folder_options.h"

#include "granhom/scene.h"

typedef struct arguments {
  folder_options f;
  int engine; /* gh_engine_kind; -1: the scene's */
  int every;
  bool restart, no_share, no_balance, estimate;
} arguments;

static const char *const engines[] = {[GH_ENGINE_LAMMPS] = "lammps", [GH_ENGINE_NATIVE] = "native", NULL};

static const option_row rows[] = {
    {.name = "engine",
     .argument = "NAME",
     .kind = OPTION_CHOICE,
     .words = engines,
     .place = offsetof(arguments, engine),
     .help = "lammps or native: what relaxes the grains, instead of the scene's `micro: {engine: ...}`"},
    {.name = "restart",
     .kind = OPTION_FLAG,
     .place = offsetof(arguments, restart),
     .help =
         "continues from DIR/checkpoint.h5 to the same results as without a stop, also with another number "
         "of ranks; from the start where there is none"},
    {.name = "checkpoint-every",
     .argument = "N",
     .kind = OPTION_INTEGER,
     .low = 1,
     .high = 1000000000,
     .place = offsetof(arguments, every),
     .standard = "1",
     .help =
         "increments from one checkpoint to the next; a run that is stopped or fails writes one of its last "
         "complete increment too"},
    {.name = "estimate-error",
     .kind = OPTION_FLAG,
     .place = offsetof(arguments, estimate),
     .help = "solves each increment a second time in two halves and continues from these: an estimate of the "
             "error of the path, for about three times the time"},
    {.name = "no-share",
     .kind = OPTION_FLAG,
     .place = offsetof(arguments, no_share),
     .help = "computes each integration point, also where others have the same packing and the same history; "
             "the results are the same"},
    {.name = "no-balance",
     .kind = OPTION_FLAG,
     .place = offsetof(arguments, no_balance),
     .help = "leaves integration points on the rank where they started"},
    {0}};

static void arguments_default(void *data) {
  ((arguments *)data)->engine = -1;
}

static gh_status scene_explain(gh_context *ctx, const gh_scene *scene) {
  gh_text *text;
  GH_TRY(gh_text_create(ctx, &text));
  gh_scene_explain(scene, text);
  return cli_print_last(ctx, &text);
}

typedef struct outcome {
  gh_context *ctx;
  gh_run_summary summary;
  const char *folder;
} outcome;

static gh_status summary_print(void *data, bool good) {
  const outcome *o = data;
  gh_context *ctx = o->ctx;
  gh_text *text;
  (void)good;
  GH_TRY(gh_text_create(ctx, &text));
  gh_summary_print(&o->summary, o->folder, text);
  return cli_print_last(ctx, &text);
}

static gh_status scene_run(gh_context *ctx, const arguments *a) {
  gh_scene *scene = NULL;
  GH_TRY(gh_scene_read(ctx, a->f.file, &scene));
  if (a->engine >= 0) gh_scene_set_engine(scene, (gh_engine_kind)a->engine);
  gh_scene_set_sharing(scene, !a->no_share);
  gh_scene_set_estimate(scene, a->estimate);
  gh_scene_set_ranks(scene, cli_ranks(), a->no_balance);
  gh_status status;
  if (a->f.explain) {
    status = scene_explain(ctx, scene);
  } else {
    gh_run_options options = {.stop = cli_stop,
                              .comm = cli_world(),
                              .no_balance = a->no_balance,
                              .restart = a->restart,
                              .checkpoint_every = a->every};
    outcome o = {.ctx = ctx, .folder = a->f.folder};
    status = gh_scene_run(scene, a->f.folder, &options, &o.summary);
    if (!a->f.quiet && (o.summary.increments > 0 || status == GH_OK))
      status = cli_finish(ctx, status, summary_print, &o);
  }
  gh_scene_destroy(&scene);
  return status;
}

/* Rank 0 runs the scene, the others serve its farm. All end with the status of rank 0. */
static gh_status run_work(gh_context *ctx, void *data) {
  const arguments *a = data;
  gh_status status;
  folder_begin(ctx, &a->f);
  if (cli_rank() == 0) {
    status = scene_run(ctx, a);
    gh_farm_dismiss(cli_world());
  } else if ((status = gh_farm_serve(ctx, cli_world(), cli_stop, NULL)) != GH_OK) {
    fprintf(stderr, "granhom: rank %d: %s\n", cli_rank(), gh_message(ctx)); /* rank 0 may be waiting for it */
    cli_abort(gh_exit_status(status));
  }
  return (gh_status)cli_share((int)status);
}

const cli_command cli_run = {
    .name = "run",
    .summary = "solves a scene: a structure whose material is a packing of grains",
    .usage = "usage: granhom run SCENE.yaml -o DIR [options]\n"
             "       mpirun -n N granhom run SCENE.yaml -o DIR [options]\n"
             "       granhom run SCENE.yaml --explain\n",
    .about = "Solves the finite element problem of a scene file (`granhom help keys scene`), whose material "
             "at each "
             "integration point is a packing. What is in DIR is replaced.\n",
    .notes = "DIR holds, complete after each increment: results.h5 and results.xdmf (open the latter in "
             "ParaView), "
             "history.csv (loads, reactions, dilatancy), convergence.csv (residuals), rves.h5 (grains and "
             "contacts), "
             "timing.csv, run.json (versions, options, outcome), checkpoint.h5 (for --restart). `granhom "
             "report DIR` "
             "makes a page of them, `granhom plot DIR` pictures.\n"
             "A second run in a folder that another one writes into is refused at once, with exit status 1.\n"
             "Ctrl-C ends the run within a moment; a second one ends it at once. What is on disk is complete "
             "up to "
             "the increment before.\n",
    .options = (const option_group[]){{folder_rows, offsetof(arguments, f)},
                                      {rows, 0},
                                      {cli_screen_rows, offsetof(arguments, f.quiet)},
                                      {0}},
    .noun = "scene",
    .missing = "a scene file is needed",
    .operand = offsetof(arguments, f.file),
    .size = sizeof(arguments),
    .defaults = arguments_default,
    .check = folder_check,
    .ranks = true,
    .work = run_work};
