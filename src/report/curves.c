/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Curves of a run, drawn by gnuplot. */
#include "report/gnuplot.h"
#include "report/report.h"

#include <stdlib.h>

/* ---- the script ---- */

static gh_status drawing_begin(gh_context *ctx, int width, int height, gh_text **out) {
  GH_TRY(gh_text_create(ctx, out));
  gh_text_print(*out, "set terminal pngcairo size %d,%d enhanced font 'sans,13' linewidth 1.6\n", width,
                height);
  gh_text_print(*out, "set encoding utf8\nset grid lc rgb '#dddddd' lw 0.6\nset border 3\n"
                      "set tics nomirror\nset key noenhanced\n");
  return GH_OK;
}

/* Draws when all went well so far and there is a file to draw into, and frees. */
static gh_status drawing_end(gh_context *ctx, gh_text **out, const char *png, gh_status status) {
  if (status == GH_OK) status = gh_text_check(*out);
  if (status == GH_OK && png) status = report_gnuplot(ctx, gh_text_get(*out, NULL), png);
  gh_text_destroy(out);
  return status;
}

/* ---- curves.png ---- */

static void write_data(gh_text *out, const report_table *h, const report_curve *c) {
  gh_text_print(out, "$data << EOD\n");
  for (int k = c->first; k < h->nrows; k++)
    gh_text_print(out, "%.17g %.17g %.17g\n", c->sign * report_table_number(h, k, c->x),
                  fabs(report_table_number(h, k, c->force)), report_table_number(h, k, c->dilatancy));
  gh_text_print(out, "EOD\n");
}

static void write_curves(gh_text *out, const report_table *h, const report_curve *c, const report_labels *l) {
  bool two = c->force >= 0;
  write_data(out, h, c);
  gh_text_print(out, "set multiplot layout %d,1 title ", two ? 2 : 1);
  gh_picture_string(out, l->title);
  gh_text_print(out, " noenhanced\nset lmargin 12\nset rmargin 3\nunset key\nset xlabel ");
  gh_picture_string(out, c->x_label);
  gh_text_print(out, " noenhanced\n");
  if (two) {
    gh_text_print(out, "set ylabel ");
    gh_picture_string(out, c->force_label);
    gh_text_print(out, " noenhanced\nplot $data using 1:2 with linespoints lc rgb '#31688e' pt 7 ps 0.6\n");
  }
  gh_text_print(
      out, "set ylabel 'dilatancy, 100 (v/V - 1) (%%)' noenhanced\nplot $data using 1:3 with linespoints "
           "lc rgb '#35b779' pt 7 ps 0.6\nunset multiplot\n");
}

gh_status gh_picture_curves(gh_context *ctx, const char *folder, const char *png) {
  report_table h;
  report_labels l;
  report_curve c = {0};
  gh_text *out = NULL;
  GH_TRY(report_labels_read(ctx, folder, &l));
  gh_status status = report_table_read(ctx, folder, "history.csv", &h);
  if (status == GH_OK) status = report_curve_choose(ctx, &h, &l, &c);
  if (status == GH_OK) status = drawing_begin(ctx, 800, 900, &out);
  if (status == GH_OK) write_curves(out, &h, &c, &l);
  status = drawing_end(ctx, &out, png, status);
  report_table_free(&h);
  return status;
}

/* ---- convergence.png ---- */

enum { MOST_CURVES = 6 };

/* One curve per increment, broken where a cut or a jump starts the iteration again. */
static void write_residuals(gh_text *out, const gh_csv *csv, const report_labels *l) {
  int step = gh_csv_find(csv, "step"), relative = gh_csv_find(csv, "relative"),
      iteration = gh_csv_find(csv, "iteration");
  int last = (int)csv->value[(csv->nrows - 1) * csv->ncols + step], first = last - MOST_CURVES + 1;
  if (first < 0) first = 0;
  for (int s = first; s <= last; s++) {
    gh_text_print(out, "$step%d << EOD\n", s);
    int at = 0;
    for (int k = 0; k < csv->nrows; k++) {
      const double *row = csv->value + (size_t)k * (size_t)csv->ncols;
      if ((int)row[step] != s || !(row[relative] > 0)) continue;
      if (at > 0 && row[iteration] == 0) gh_text_print(out, "\n");
      gh_text_print(out, "%d %.17g\n", at++, row[relative]);
    }
    gh_text_print(out, "EOD\n");
  }
  gh_text_print(out, "set title ");
  gh_picture_string(out, l->title);
  gh_text_print(
      out,
      " noenhanced\nset logscale y\nset format y '10^{%%T}'\nset xlabel 'evaluation of the residual'\nset "
      "ylabel 'relative residual'\nset key outside right top\n"
      "set palette defined (0 '#440154', 1 '#3b528b', 2 '#21918c', 3 '#5ec962', 4 '#d0c11d')\nset "
      "cbrange [0:%d]\nunset colorbox\nplot ",
      last > first ? last - first : 1);
  for (int s = first; s <= last; s++)
    gh_text_print(out,
                  "%s$step%d using 1:2 with linespoints lc palette cb %d pt 7 ps 0.8 title 'increment %d'",
                  s > first ? ", " : "", s, s - first, s);
  gh_text_print(out, "\n");
}

gh_status gh_picture_convergence(gh_context *ctx, const char *folder, const char *png) {
  gh_csv *csv = NULL;
  report_labels l;
  gh_text *out = NULL;
  char *path = gh_path_join(folder, "convergence.csv");
  gh_status status =
      path ? report_residuals_read(ctx, path, &csv) : gh_fail(ctx, GH_MEMORY, "no memory for a path");
  if (status == GH_OK) status = report_labels_read(ctx, folder, &l);
  if (status == GH_OK) status = drawing_begin(ctx, 900, 560, &out);
  if (status == GH_OK) write_residuals(out, csv, &l);
  status = drawing_end(ctx, &out, png, status);
  gh_csv_destroy(&csv);
  free(path);
  return status;
}

/* ---- drawings of others ---- */

gh_status gh_picture_script(gh_context *ctx, const char *commands, int width, int height, const char *png) {
  gh_text *out = NULL;
  gh_status status = drawing_begin(ctx, width, height, &out);
  if (status == GH_OK) gh_text_print(out, "%s", commands);
  return drawing_end(ctx, &out, png, status);
}
