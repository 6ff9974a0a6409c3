/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom compare: a run beside others of the same scene. */
#include "cli.h"
#include "granhom/report.h"

typedef struct compare_arguments {
  const char *folder, *csv, *png;
  option_more others;
} compare_arguments;

static const option_row rows[] = {
    {.name = "output",
     .letter = 'o',
     .argument = "FILE.csv",
     .kind = OPTION_TEXT,
     .place = offsetof(compare_arguments, csv),
     .help = "all increments as a table; -: standard output, instead of the summary"},
    {.name = "picture",
     .argument = "FILE.png",
     .kind = OPTION_TEXT,
     .place = offsetof(compare_arguments, png),
     .help = "the curves and the gap; needs gnuplot"},
    {0}};

static gh_status arguments_check(gh_context *ctx, void *data) {
  const compare_arguments *a = data;
  if (a->others.n == 0)
    return gh_fail(ctx, GH_INPUT, "a second folder is needed, to compare '%s' to", a->folder);
  return GH_OK;
}

static bool to_stdout(const char *path) {
  return path && path[0] == '-' && path[1] == 0;
}

static gh_status table_write(gh_context *ctx, const gh_comparison *c, const char *path) {
  gh_text *out;
  GH_TRY(gh_text_create(ctx, &out));
  gh_comparison_table(c, out);
  gh_status status = to_stdout(path) ? cli_print(ctx, out) : gh_text_commit(out, path);
  gh_text_destroy(&out);
  return status;
}

static gh_status summary_print(gh_context *ctx, const gh_comparison *c) {
  gh_text *out;
  GH_TRY(gh_text_create(ctx, &out));
  gh_comparison_print(c, out);
  gh_status status = cli_print(ctx, out);
  gh_text_destroy(&out);
  return status;
}

static gh_status compare_show(gh_context *ctx, const compare_arguments *a, const gh_comparison *c) {
  if (a->png) GH_TRY(gh_comparison_picture(c, NULL));
  if (a->csv) GH_TRY(table_write(ctx, c, a->csv));
  if (a->png) GH_TRY(gh_comparison_picture(c, a->png));
  return to_stdout(a->csv) ? GH_OK : summary_print(ctx, c);
}

static gh_status compare_work(gh_context *ctx, void *data) {
  const compare_arguments *a = data;
  gh_comparison *comparison;
  const gh_output outputs[] = {{a->csv, GH_FILE_PATH}, {a->png, GH_FILE_PICTURE}};
  GH_TRY(cli_check_outputs_of(ctx, outputs, 2, a->folder, &a->others));
  GH_TRY(gh_comparison_create(ctx, a->folder, a->others.word, a->others.n, &comparison));
  gh_status status = compare_show(ctx, a, comparison);
  gh_comparison_destroy(&comparison);
  return status;
}

const cli_command cli_compare = {
    .name = "compare",
    .summary = "a run beside others of the same scene, or beside direct simulations",
    .usage = "usage: granhom compare DIR OTHER... [options]\n",
    .about =
        "Reactions, dilatancy, coordination number and anisotropy of DIR beside the mean of the others, over "
        "the "
        "increments that all have: the gap, of reactions in per cent of the largest one, and the scatter of "
        "the others. All must come from one scene: the same driven set, displaced alike.\n",
    .notes = "",
    .options = (const option_group[]){{rows, 0}, {0}},
    .noun = "folder",
    .missing = "two folders of results are needed",
    .operand = offsetof(compare_arguments, folder),
    .more = offsetof(compare_arguments, others),
    .size = sizeof(compare_arguments),
    .check = arguments_check,
    .work = compare_work};
