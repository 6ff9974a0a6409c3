/* Curves of a run, drawn by gnuplot as a child process. SPDX-License-Identifier: GPL-2.0-or-later */
#include "scene/page.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- gnuplot ---- */

/* Text between single quotes of gnuplot. */
static void quote(FILE *out, const char *text) {
  fputc('\'', out);
  for (; *text; text++) fputs(*text == '\'' ? "''" : (char[2]){*text, 0}, out);
  fputc('\'', out);
}

/* Runs gnuplot on the script, which writes the new file; then puts that into place. */
static gh_status draw(gh_context *ctx, const char *script, gh_temp **temp, const char *png) {
  int code = system("command -v gnuplot >/dev/null 2>&1");
  if (code != 0)
    return gh_fail(ctx, GH_SYSTEM, "%s: gnuplot is not installed (Debian: apt-get install gnuplot-nox)", png);
  FILE *gnuplot = popen("gnuplot", "w");
  if (!gnuplot) return gh_fail(ctx, GH_SYSTEM, "%s: gnuplot cannot be started: %s", png, strerror(errno));
  fputs(script, gnuplot);
  code = pclose(gnuplot);
  if (code == -1 || !WIFEXITED(code) || WEXITSTATUS(code) != 0)
    return gh_fail(ctx, GH_SYSTEM, "%s: gnuplot failed (status %d)", png,
                   code == -1 ? -1 : WEXITSTATUS(code));
  return gh_temp_commit(temp);
}

/* A script of gnuplot in memory; it draws into temp. */
typedef struct drawing {
  FILE *out;
  char *script; /* whole once out is closed */
  gh_temp *temp;
  size_t length;
} drawing;

static gh_status drawing_begin(gh_context *ctx, const char *png, int width, int height, drawing *d) {
  GH_TRY(gh_temp_create(ctx, png, &d->temp));
  d->out = open_memstream(&d->script, &d->length);
  if (!d->out) return gh_fail(ctx, GH_MEMORY, "no memory for a script of gnuplot");
  fprintf(d->out, "set terminal pngcairo size %d,%d enhanced font 'sans,13' linewidth 1.6\n", width, height);
  fprintf(d->out, "set encoding utf8\nset output ");
  quote(d->out, gh_temp_name(d->temp));
  fprintf(d->out,
          "\nset grid lc rgb '#dddddd' lw 0.6\nset border 3\nset tics nomirror\nset key noenhanced\n");
  return GH_OK;
}

/* Draws when all went well so far, and frees. */
static gh_status drawing_end(gh_context *ctx, drawing *d, const char *png, gh_status status) {
  bool bad = d->out && fclose(d->out) != 0;
  if (status == GH_OK && bad) status = gh_fail(ctx, GH_MEMORY, "no memory for a script of gnuplot");
  if (status == GH_OK) status = draw(ctx, d->script, &d->temp, png);
  free(d->script);
  gh_temp_destroy(&d->temp);
  return status;
}

/* ---- curves.png ---- */

static void write_data(FILE *out, const scene_table *h, const scene_curve *c) {
  fprintf(out, "$data << EOD\n");
  for (int k = c->first; k < h->nrows; k++)
    fprintf(out, "%.17g %.17g %.17g\n", c->sign * scene_table_number(h, k, c->x),
            fabs(scene_table_number(h, k, c->force)), scene_table_number(h, k, c->dilatancy));
  fprintf(out, "EOD\n");
}

static void write_curves(FILE *out, const scene_table *h, const scene_curve *c, const scene_labels *l) {
  bool two = c->force >= 0;
  write_data(out, h, c);
  fprintf(out, "set multiplot layout %d,1 title ", two ? 2 : 1);
  quote(out, l->title);
  fprintf(out, " noenhanced\nset lmargin 12\nset rmargin 3\nunset key\nset xlabel ");
  quote(out, c->x_label);
  fprintf(out, " noenhanced\n");
  if (two) {
    fprintf(out, "set ylabel ");
    quote(out, c->force_label);
    fprintf(out, " noenhanced\nplot $data using 1:2 with linespoints lc rgb '#31688e' pt 7 ps 0.6\n");
  }
  fprintf(out, "set ylabel 'dilatancy, 100 (v/V - 1) (%%)' noenhanced\nplot $data using 1:3 with linespoints "
               "lc rgb '#35b779' pt 7 ps 0.6\nunset multiplot\n");
}

gh_status gh_picture_curves(gh_context *ctx, const char *folder, const char *png) {
  scene_table h;
  scene_labels l;
  scene_curve c = {0};
  drawing d = {0};
  GH_TRY(scene_labels_read(ctx, folder, &l));
  gh_status status = scene_table_read(ctx, folder, "history.csv", &h);
  if (status == GH_OK) status = scene_curve_choose(ctx, &h, &l, &c);
  if (status == GH_OK) status = drawing_begin(ctx, png, 800, 900, &d);
  if (status == GH_OK) write_curves(d.out, &h, &c, &l);
  status = drawing_end(ctx, &d, png, status);
  scene_table_free(&h);
  return status;
}

/* ---- convergence.png ---- */

enum { MOST_CURVES = 6 };

/* One curve per increment, broken where a cut or a jump starts the iteration anew. */
static void write_residuals(FILE *out, const gh_csv *csv, const scene_labels *l) {
  int step = gh_csv_find(csv, "step"), relative = gh_csv_find(csv, "relative"),
      iteration = gh_csv_find(csv, "iteration");
  int last = (int)csv->value[(csv->nrows - 1) * csv->ncols + step], first = last - MOST_CURVES + 1;
  if (first < 0) first = 0;
  for (int s = first; s <= last; s++) {
    fprintf(out, "$step%d << EOD\n", s);
    int at = 0;
    for (int k = 0; k < csv->nrows; k++) {
      const double *row = csv->value + (size_t)k * (size_t)csv->ncols;
      if ((int)row[step] != s || !(row[relative] > 0)) continue;
      if (at > 0 && row[iteration] == 0) fprintf(out, "\n");
      fprintf(out, "%d %.17g\n", at++, row[relative]);
    }
    fprintf(out, "EOD\n");
  }
  fprintf(out, "set title ");
  quote(out, l->title);
  fprintf(
      out,
      " noenhanced\nset logscale y\nset format y '10^{%%T}'\nset xlabel 'evaluation of the residual'\nset "
      "ylabel 'relative residual'\nset key outside right top\n"
      "set palette defined (0 '#440154', 1 '#3b528b', 2 '#21918c', 3 '#5ec962', 4 '#d0c11d')\nset "
      "cbrange [0:%d]\nunset colorbox\nplot ",
      last > first ? last - first : 1);
  for (int s = first; s <= last; s++)
    fprintf(out, "%s$step%d using 1:2 with linespoints lc palette cb %d pt 7 ps 0.8 title 'increment %d'",
            s > first ? ", " : "", s, s - first, s);
  fprintf(out, "\n");
}

gh_status gh_picture_convergence(gh_context *ctx, const char *folder, const char *png) {
  gh_csv *csv = NULL;
  scene_labels l;
  drawing d = {0};
  char *path = gh_path_join(folder, "convergence.csv");
  gh_status status = path ? gh_csv_read(ctx, path, &csv) : gh_fail(ctx, GH_MEMORY, "no memory for a path");
  if (status == GH_OK && (csv->nrows == 0 || gh_csv_find(csv, "step") < 0 ||
                          gh_csv_find(csv, "iteration") < 0 || gh_csv_find(csv, "relative") < 0))
    status = gh_fail(ctx, GH_INPUT, "%s: holds no residuals", path);
  if (status == GH_OK) status = scene_labels_read(ctx, folder, &l);
  if (status == GH_OK) status = drawing_begin(ctx, png, 900, 560, &d);
  if (status == GH_OK) write_residuals(d.out, csv, &l);
  status = drawing_end(ctx, &d, png, status);
  gh_csv_destroy(&csv);
  free(path);
  return status;
}

/* ---- drawings of others ---- */

gh_status gh_picture_script(gh_context *ctx, const char *commands, int width, int height, const char *png) {
  drawing d = {0};
  gh_status status = drawing_begin(ctx, png, width, height, &d);
  if (status == GH_OK) fputs(commands, d.out);
  return drawing_end(ctx, &d, png, status);
}
