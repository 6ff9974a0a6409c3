/* granhom report: one HTML page about a folder of results. SPDX-License-Identifier: GPL-2.0-or-later */
#include "cli.h"
#include "granhom/report.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_POINTS = 12 };

typedef struct report_arguments {
  const char *folder, *html;
  int points[MOST_POINTS], npoints;
} report_arguments;

/* "0,7,17"; 0, or the exit status after a message. */
static int parse_points(const char *text, report_arguments *a) {
  char *copy = strdup(text), *rest = NULL;
  int code = copy ? 0 : 1;
  for (char *word = copy ? strtok_r(copy, ",", &rest) : NULL; word && !code;
       word = strtok_r(NULL, ",", &rest)) {
    long point;
    if (a->npoints == MOST_POINTS) code = cli_usage(&cli_report, "--points: at most %d points", MOST_POINTS);
    else if (!gh_parse_integer(word, 0, 1000000000, &point))
      code = cli_usage(&cli_report, "--points '%s': '%s' is no number of an integration point", text, word);
    else a->points[a->npoints++] = (int)point;
  }
  free(copy);
  if (!code && a->npoints == 0) return cli_usage(&cli_report, "--points '%s' holds no number", text);
  return code;
}

static int parse(int argc, char **argv, report_arguments *a) {
  for (int k = 1; k < argc; k++) {
    const char *word = argv[k];
    bool output = strcmp(word, "-o") == 0 || strcmp(word, "--output") == 0,
         points = strcmp(word, "--points") == 0;
    if ((output || points) && k + 1 >= argc) return cli_usage(&cli_report, "%s needs a value", word);
    if (output) a->html = argv[++k];
    else if (points) {
      int code = parse_points(argv[++k], a);
      if (code) return code;
    } else if (word[0] == '-' && word[1]) return cli_usage(&cli_report, "there is no option '%s'", word);
    else if (a->folder)
      return cli_usage(&cli_report, "one folder at a time, not '%s' and '%s'", a->folder, word);
    else a->folder = word;
  }
  return a->folder ? 0 : cli_usage(&cli_report, "a folder of results is needed");
}

static int run(int argc, char **argv) {
  report_arguments a = {0};
  int code = parse(argc, argv, &a);
  if (code) return code;
  gh_context *ctx = cli_open();
  if (!ctx) return 1;
  char *own = a.html ? NULL : gh_path_join(a.folder, "report.html");
  const char *html = a.html ? a.html : own;
  gh_status status = html ? GH_OK : gh_fail(ctx, GH_MEMORY, "no memory for a path");
  if (status == GH_OK && a.html) status = gh_output_check(ctx, a.html);
  if (status == GH_OK) status = cli_mpi(ctx, true);
  if (status == GH_OK) status = gh_report_write(ctx, a.folder, a.points, a.npoints, html);
  if (status == GH_OK) printf("%s\n", html);
  free(own);
  return cli_close(ctx, status);
}

const cli_command cli_report = {
    .name = "report",
    .summary = "one HTML page about the results of `granhom run`",
    .help = "usage: granhom report DIR [options]\n\n"
            "  -o FILE, --output FILE    the page; default: DIR/report.html\n"
            "  --points 0,7,17           integration points whose packings and stress paths are shown, "
            "counted from "
            "0;\n"
            "                            default: the largest von Mises stress, the smallest acoustic "
            "eigenvalue, "
            "the first\n"
            "                            of the points whose grains are recorded\n\n"
            "The page needs nothing but a browser: whether the run converged, curves, fields on the deformed "
            "mesh, "
            "force\n"
            "networks, residuals, times. It can be made while the run is under way.\n",
    .run = run};
