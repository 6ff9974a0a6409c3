/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom direct: the same scene with grains everywhere. */
#include "cli.h"
#include "folder_options.h"

#include "granhom/scene.h"

typedef struct arguments {
  folder_options f;
  int engine; /* gh_engine_kind; -1: the scene's */
  int grains, seed, every;
  bool tile, restart;
} arguments;

static const char *const engines[] = {[GH_ENGINE_LAMMPS] = "lammps", [GH_ENGINE_NATIVE] = "native", NULL};

static const option_row rows[] = {
    {.name = "output",
     .letter = 'o',
     .argument = "DIR",
     .kind = OPTION_TEXT,
     .place = offsetof(arguments, f.folder),
     .help = "folder for the results, made where it is missing"},
    {.name = "grains",
     .argument = "N",
     .kind = OPTION_INTEGER,
     .low = 10,
     .high = 100000000,
     .place = offsetof(arguments, grains),
     .help = "grains in the area of the mesh, which sets their size; the outline takes some more"},
    {.name = "tile",
     .kind = OPTION_FLAG,
     .place = offsetof(arguments, tile),
     .help = "fills the outline with copies of the scene's (first) packing, instead of one large packing "
             "with its "
             "diameters, which is grown and brought to its pressure"},
    {.name = "seed",
     .argument = "S",
     .kind = OPTION_INTEGER,
     .low = 0,
     .high = 2147483647,
     .place = offsetof(arguments, seed),
     .help = "of the large packing: another seed is another specimen"},
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
         "continues from DIR/checkpoint.h5 to the same results as without a stop; from the start where there "
         "is none"},
    {.name = "checkpoint-every",
     .argument = "N",
     .kind = OPTION_INTEGER,
     .low = 1,
     .high = 1000000000,
     .place = offsetof(arguments, every),
     .standard = "1",
     .help = "increments from one checkpoint to the next"},
    {0}};

static void arguments_default(void *data) {
  arguments *a = data;
  a->engine = -1, a->grains = 5000, a->seed = 1;
}

typedef struct outcome {
  gh_context *ctx;
  gh_direct_summary summary;
  const char *folder;
} outcome;

static gh_status summary_print(void *data, bool good) {
  const outcome *o = data;
  const gh_direct_summary *m = &o->summary;
  gh_text *text;
  (void)good;
  GH_TRY(gh_text_create(o->ctx, &text));
  gh_text_print(
      text,
      "%d of %d step%s, %d increment%s of %d grains in %d substep%s (%d bisection%s), %ld relaxation steps, "
      "%.1f s\nresults in %s\n",
      m->steps, m->planned, GH_S(m->planned), m->increments, GH_S(m->increments), m->grains, m->substeps,
      GH_S(m->substeps), m->cuts, GH_S(m->cuts), m->relaxation_steps, m->seconds, o->folder);
  return cli_print_last(o->ctx, &text);
}

static gh_status direct_work(gh_context *ctx, void *data) {
  const arguments *a = data;
  gh_scene *scene = NULL;
  folder_begin(ctx, &a->f);
  GH_TRY(cli_mpi(ctx, true));
  GH_TRY(gh_scene_read(ctx, a->f.file, &scene));
  if (a->engine >= 0) gh_scene_set_engine(scene, (gh_engine_kind)a->engine);
  const gh_direct_run_options options = {.grains = a->grains,
                                         .tile = a->tile,
                                         .seed = a->seed,
                                         .restart = a->restart,
                                         .checkpoint_every = a->every,
                                         .stop = cli_stop};
  outcome o = {.ctx = ctx, .folder = a->f.folder};
  gh_status status = gh_scene_direct(scene, a->f.folder, &options, &o.summary);
  if (!a->f.quiet && (o.summary.increments > 0 || status == GH_OK))
    status = cli_finish(ctx, status, summary_print, &o);
  gh_scene_destroy(&scene);
  return status;
}

const cli_command cli_direct = {
    .name = "direct",
    .summary = "solves a scene with grains everywhere, to compare with `run`",
    .usage = "usage: granhom direct SCENE.yaml -o DIR [options]\n",
    .about =
        "Fills the outline of a scene's mesh with grains and leads them through its steps: the reference for "
        "`granhom run`. Edges are boundary grains. One process. What is in DIR is replaced.\n",
    .notes =
        "DIR holds, complete after each increment: history.csv (the columns of `granhom run` that have a "
        "meaning), dumps/point_0.dump and point_0.contacts.dump (for OVITO), results.h5 and results.xdmf "
        "(displacements and stresses on the mesh), timing.csv, run.json, checkpoint.h5 (for --restart).\n",
    .options = (const option_group[]){{rows, 0}, {cli_screen_rows, offsetof(arguments, f.quiet)}, {0}},
    .noun = "scene",
    .missing = "a scene file is needed",
    .operand = offsetof(arguments, f.file),
    .size = sizeof(arguments),
    .defaults = arguments_default,
    .check = folder_check,
    .work = direct_work};
