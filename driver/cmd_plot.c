/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom plot: pictures of a folder of results. */
#include "cli.h"
#include "granhom/io.h"
#include "granhom/report.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct plot_arguments {
  const char *results, *folder;
  long point; /* -1: the most loaded */
} plot_arguments;

static const option_row rows[] = {
    {.name = "output",
     .letter = 'o',
     .argument = "DIR2",
     .kind = OPTION_TEXT,
     .place = offsetof(plot_arguments, folder),
     .standard = "DIR",
     .help = "folder for the pictures"},
    {.name = "point",
     .argument = "N",
     .kind = OPTION_LONG,
     .high = 100000000,
     .place = offsetof(plot_arguments, point),
     .standard = "the one with the largest von Mises stress among those that are recorded",
     .help = "integration point for rve.png, counted from 0"},
    {0}};

static void arguments_default(void *data) {
  ((plot_arguments *)data)->point = -1;
}

static gh_status arguments_check(gh_context *ctx, void *data) {
  plot_arguments *a = data;
  (void)ctx;
  if (!a->folder) a->folder = a->results;
  return GH_OK;
}

static gh_status rve(gh_context *ctx, const plot_arguments *a, const char *png) {
  return gh_picture_rve(ctx, a->results, (int)a->point, png);
}
static gh_status mesh(gh_context *ctx, const plot_arguments *a, const char *png) {
  return gh_picture_mesh(ctx, a->results, png);
}
static gh_status curves(gh_context *ctx, const plot_arguments *a, const char *png) {
  return gh_picture_curves(ctx, a->results, png);
}
static gh_status convergence(gh_context *ctx, const plot_arguments *a, const char *png) {
  return gh_picture_convergence(ctx, a->results, png);
}

typedef gh_status picture(gh_context *ctx, const plot_arguments *a, const char *png);

/* A picture that this folder or this build cannot have: a scene may record no packings. */
static bool left_out(const plot_arguments *a, picture *draw) {
  if (!gh_h5_available() && draw == mesh) return true;
  if (draw != rve) return false;
  char *path = gh_path_join(a->results, "rves.h5");
  bool none = !path || access(path, F_OK) != 0;
  free(path);
  return none || !gh_h5_available();
}

static const struct {
  const char *name;
  picture *draw;
} pictures[] = {
    {"mesh.png", mesh}, {"rve.png", rve}, {"curves.png", curves}, {"convergence.png", convergence}};
enum { PICTURES = sizeof pictures / sizeof *pictures };

/* Which pictures can be drawn; what is wrong with a folder is said before anything is written. */
static gh_status pictures_choose(gh_context *ctx, const plot_arguments *a, bool chosen[PICTURES]) {
  for (int k = 0; k < PICTURES; k++) {
    gh_status status = pictures[k].draw(ctx, a, NULL);
    chosen[k] = status == GH_OK;
    bool none = status == GH_INPUT && a->point < 0 && left_out(a, pictures[k].draw);
    if (!chosen[k] && !none) return status;
    if (none) fprintf(stderr, "granhom: no %s: %s\n", pictures[k].name, gh_message(ctx));
  }
  return GH_OK;
}

static gh_status pictures_draw(gh_context *ctx, const plot_arguments *a) {
  bool chosen[PICTURES];
  GH_TRY(gh_results_check(ctx, a->results));
  GH_TRY(gh_output_folder_check(ctx, a->folder));
  GH_TRY(pictures_choose(ctx, a, chosen));
  GH_TRY(gh_folder_make(ctx, a->folder));
  for (int k = 0; k < PICTURES; k++) {
    if (!chosen[k]) continue;
    GH_TRY(gh_output_within(ctx, a->folder, pictures[k].name, false));
    char *png = gh_path_join(a->folder, pictures[k].name);
    if (!png) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
    gh_status status = pictures[k].draw(ctx, a, png);
    if (status == GH_OK) printf("%s\n", png);
    free(png);
    GH_TRY(status);
  }
  return GH_OK;
}

static gh_status plot_work(gh_context *ctx, void *data) {
  signal(SIGPIPE, SIG_IGN); /* who reads the list may end early */
  GH_TRY(cli_mpi(ctx, true));
  return pictures_draw(ctx, data);
}

const cli_command cli_plot = {
    .name = "plot",
    .summary = "draws the results of `granhom run`",
    .usage = "usage: granhom plot DIR [options]\n",
    .about =
        "Draws mesh.png (deformed mesh, von Mises stress), rve.png (grains and forces of one integration "
        "point), curves.png (force and dilatancy) and convergence.png (residuals). Curves need gnuplot.\n",
    .notes = "",
    .options = (const option_group[]){{rows, 0}, {0}},
    .noun = "folder",
    .missing = "a folder of results is needed",
    .operand = offsetof(plot_arguments, results),
    .size = sizeof(plot_arguments),
    .defaults = arguments_default,
    .check = arguments_check,
    .work = plot_work};
