/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom report: one HTML page about a folder of results. */
#include "cli.h"
#include "granhom/report.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_POINTS = 12 };

typedef struct report_arguments {
  const char *folder, *html;
  option_more others;
  int points[MOST_POINTS], npoints;
} report_arguments;

/* "0,7,17" */
static gh_status points_read(gh_context *ctx, const char *where, const char *text, void *group) {
  report_arguments *a = group;
  char *copy = strdup(text), *rest = NULL;
  gh_status status = copy ? GH_OK : gh_fail(ctx, GH_MEMORY, "%s: no memory", where);
  a->npoints = 0;
  for (char *word = copy ? strtok_r(copy, ",", &rest) : NULL; word && status == GH_OK;
       word = strtok_r(NULL, ",", &rest)) {
    long point;
    if (a->npoints == MOST_POINTS)
      status = gh_fail(ctx, GH_INPUT, "%s: at most %d points", where, MOST_POINTS);
    else if (!gh_parse_integer(word, 0, 1000000000, &point))
      status =
          gh_fail(ctx, GH_INPUT, "%s '%s': '%s' is no number of an integration point", where, text, word);
    else a->points[a->npoints++] = (int)point;
  }
  free(copy);
  if (status == GH_OK && a->npoints == 0)
    return gh_fail(ctx, GH_INPUT, "%s '%s' holds no number", where, text);
  return status;
}

static const option_row rows[] = {
    {.name = "output",
     .letter = 'o',
     .argument = "FILE",
     .kind = OPTION_TEXT,
     .place = offsetof(report_arguments, html),
     .standard = "DIR/report.html",
     .help = "the page"},
    {.name = "points",
     .argument = "0,7,17",
     .kind = OPTION_OWN,
     .read = points_read,
     .help = "integration points whose packings and stress paths are shown, counted from 0; without it the "
             "largest von Mises stress, the smallest acoustic eigenvalue, and the first of the points whose "
             "grains are recorded"},
    {0}};

static gh_status report_work(gh_context *ctx, void *data) {
  const report_arguments *a = data;
  gh_comparison *comparison = NULL;
  char *own = a->html ? NULL : gh_path_join(a->folder, "report.html");
  const char *html = a->html ? a->html : own;
  gh_status status = html ? GH_OK : gh_fail(ctx, GH_MEMORY, "no memory for a path");
  const gh_output page = {html, GH_FILE_UNKNOWN};
  if (status == GH_OK && a->html) status = cli_check_outputs_of(ctx, &page, 1, a->folder, &a->others);
  if (status == GH_OK && !a->html) status = gh_file_regular(ctx, html);
  if (status == GH_OK) status = cli_mpi(ctx, true);
  if (status == GH_OK && a->others.n > 0)
    status = gh_comparison_create(ctx, a->folder, a->others.word, a->others.n, &comparison);
  if (status == GH_OK) status = gh_report_write(ctx, a->folder, a->points, a->npoints, comparison, html);
  if (status == GH_OK) printf("%s\n", html);
  gh_comparison_destroy(&comparison);
  free(own);
  return status;
}

const cli_command cli_report = {
    .name = "report",
    .summary = "one HTML page about the results of `granhom run`",
    .usage = "usage: granhom report DIR [OTHER...] [options]\n",
    .about =
        "The page needs nothing but a browser: whether the run converged, curves, fields on the "
        "deformed mesh, "
        "force networks, residuals, times; with other folders also the comparison of `granhom compare`. It "
        "can be made while the run is under way.\n",
    .notes = "",
    .options = (const option_group[]){{rows, 0}, {0}},
    .noun = "folder",
    .missing = "a folder of results is needed",
    .operand = offsetof(report_arguments, folder),
    .more = offsetof(report_arguments, others),
    .size = sizeof(report_arguments),
    .work = report_work};
