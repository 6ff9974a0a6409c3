/* granhom plot: pictures of a folder of results. SPDX-License-Identifier: GPL-2.0-or-later */
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

static int parse(int argc, char **argv, plot_arguments *a) {
  for (int k = 1; k < argc; k++) {
    const char *word = argv[k];
    bool output = strcmp(word, "-o") == 0 || strcmp(word, "--output") == 0,
         point = strcmp(word, "--point") == 0;
    if ((output || point) && k + 1 >= argc) return cli_usage(&cli_plot, "%s needs a value", word);
    if (output) a->folder = argv[++k];
    else if (point) {
      if (!gh_parse_integer(argv[++k], 0, 100000000, &a->point))
        return cli_usage(&cli_plot, "--point '%s' is no number of an integration point", argv[k]);
    } else if (word[0] == '-' && word[1]) return cli_usage(&cli_plot, "there is no option '%s'", word);
    else if (a->results)
      return cli_usage(&cli_plot, "one folder at a time, not '%s' and '%s'", a->results, word);
    else a->results = word;
  }
  if (!a->results) return cli_usage(&cli_plot, "a folder of results is needed");
  if (!a->folder) a->folder = a->results;
  return 0;
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

static gh_status work(gh_context *ctx, const plot_arguments *a) {
  bool chosen[PICTURES];
  GH_TRY(gh_results_check(ctx, a->results));
  GH_TRY(gh_output_folder_check(ctx, a->folder));
  GH_TRY(pictures_choose(ctx, a, chosen));
  GH_TRY(gh_folder_make(ctx, a->folder));
  for (int k = 0; k < PICTURES; k++) {
    if (!chosen[k]) continue;
    char *png = gh_path_join(a->folder, pictures[k].name);
    if (!png) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
    gh_status status = pictures[k].draw(ctx, a, png);
    if (status == GH_OK) printf("%s\n", png);
    free(png);
    GH_TRY(status);
  }
  return GH_OK;
}

static int run(int argc, char **argv) {
  plot_arguments a = {.point = -1};
  int code = parse(argc, argv, &a);
  if (code) return code;
  gh_context *ctx = cli_open();
  if (!ctx) return 1;
  signal(SIGPIPE, SIG_IGN); /* who reads the list may end early */
  gh_status status = cli_mpi(ctx, true);
  if (status == GH_OK) status = work(ctx, &a);
  return cli_close(ctx, status);
}

const cli_command cli_plot = {
    .name = "plot",
    .summary = "draws the results of `granhom run`",
    .help = "usage: granhom plot DIR [options]\n\n"
            "  -o DIR2, --output DIR2    folder for the pictures; default: DIR\n"
            "  --point N                 integration point for rve.png, counted from 0; default: the one "
            "with the\n"
            "                            largest von Mises stress among those that are recorded\n\n"
            "Draws mesh.png (deformed mesh, von Mises stress), rve.png (grains and forces of one integration "
            "point),\n"
            "curves.png (force and dilatancy) and convergence.png (residuals). Curves need gnuplot.\n",
    .run = run};
