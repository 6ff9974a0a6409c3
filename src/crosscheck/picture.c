/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The picture of a cross-check. */
#include "crosscheck/crosscheck.h"

#include "granhom/report.h"

#include <stdlib.h>

static const char colour[GH_CROSS_ENGINES][8] = {"#1b1b1b", "#31688e", "#cc3311", "#e69f00"};
static const int point[GH_CROSS_ENGINES] = {7, 4, 6, 8};
static const double LEAST = 1e-16; /* on a logarithmic axis */

/* Data blocks $e: step, the components, the difference of each row. */
static void data_print(const gh_crosscheck *c, gh_text *t) {
  const cross_level *level = &c->level[0];
  double scale = cross_scale(c, level, 0);
  for (int e = 0; e < c->o.engines; e++) {
    gh_text_print(t, "$e%d << EOD\n", e);
    for (int row = 0; row < c->o.rows; row++) {
      const gh_peer_row *r = cross_row(level, e, row);
      if (!r) continue;
      double d = e ? cross_difference(level, e, row) / scale : 0;
      gh_text_print(t, "%ld", c->o.step[row]);
      for (int k = 0; k < CROSS_COMPONENTS; k++) gh_text_print(t, " %.17g", r->cauchy[cross_component[k]]);
      gh_text_print(t, " %.17g\n", isfinite(d) ? fmax(d, LEAST) : LEAST);
    }
    gh_text_print(t, "EOD\n");
  }
}

static bool engine_drawn(const gh_crosscheck *c, int e) {
  return e < GH_CROSS_ENGINES && c->level[0].trace[e].result.rows > 0;
}

/* The component's name beside the last point of the reference. */
static void components_label(const gh_crosscheck *c, gh_text *t) {
  const cross_level *level = &c->level[0];
  int last = 0;
  for (int row = 0; row < c->o.rows; row++)
    if (cross_row(level, 0, row)) last = row;
  for (int k = 0; k < CROSS_COMPONENTS; k++)
    gh_text_print(t, "set label %d 's_{%s}' at first %ld,%.17g offset char 0.8,0\n", k + 1,
                  cross_component_name[k], c->o.step[last],
                  level->trace[0].rows[level->path.of_row[last]].cauchy[cross_component[k]]);
}

static void stresses_draw(const gh_crosscheck *c, gh_text *t) {
  const char *comma = "";
  components_label(c, t);
  gh_text_print(t, "set xlabel 'step'\nset ylabel 'Cauchy stress'\nset key outside right top\nplot ");
  for (int e = 0; e < c->o.engines; e++)
    for (int k = 0; k < CROSS_COMPONENTS && engine_drawn(c, e); k++) {
      gh_text_print(t, "%s$e%d using 1:%d with %s lc rgb '%s' ", comma, e, k + 2, e ? "points" : "lines",
                    colour[e]);
      if (e) gh_text_print(t, "pt %d ps %.1f ", point[e], e == 1 ? 1.6 : 1.0);
      if (k) gh_text_print(t, "notitle");
      else gh_text_print(t, "title '%s'", cross_title(c, e));
      comma = ", ";
    }
  gh_text_print(t, "\n");
  for (int k = 0; k < CROSS_COMPONENTS; k++) gh_text_print(t, "unset label %d\n", k + 1);
}

static void differences_draw(const gh_crosscheck *c, gh_text *t) {
  const char *comma = "";
  gh_text_print(t,
                "set key title 'to %s:' left\nset ylabel 'relative difference'\nset logscale y\nset format y "
                "'10^{%%T}'\nplot ",
                cross_title(c, 0));
  for (int e = 1; e < c->o.engines; e++) {
    if (!engine_drawn(c, e)) continue;
    gh_text_print(t, "%s$e%d using 1:5 with linespoints lc rgb '%s' pt %d ps 0.8 title '%s'", comma, e,
                  colour[e], point[e], cross_title(c, e));
    comma = ", ";
  }
  gh_text_print(t, "\n");
}

/* Differences that are no more than what the residual leaves would only stretch the axis. */
static bool refinement_drawn(const gh_crosscheck *c, int e) {
  for (int k = 0; k < c->o.levels; k++)
    if (cross_refined(c, k, e, false) > cross_round_off(c)) return true;
  return false;
}

static void refinement_draw(const gh_crosscheck *c, gh_text *t) {
  const char *comma = "";
  for (int e = 1; e < c->o.engines; e++) {
    gh_text_print(t, "$r%d << EOD\n", e);
    for (int k = 0; k < c->o.levels; k++) {
      double d = cross_refined(c, k, e, false);
      if (isfinite(d)) gh_text_print(t, "%d %.17g\n", c->level[k].substeps, fmax(d, LEAST));
    }
    gh_text_print(t, "EOD\n");
  }
  gh_text_print(t,
                "set logscale x 2\nset xlabel 'substeps of each increment'\nset ylabel 'largest difference'\n"
                "set xrange [0.9:%g]\nplot ",
                1.1 * c->level[c->o.levels - 1].substeps);
  for (int e = 1; e < c->o.engines; e++) {
    if (!refinement_drawn(c, e)) continue;
    gh_text_print(t, "%s$r%d using 1:2 with linespoints lc rgb '%s' pt %d title '%s'", comma, e, colour[e],
                  point[e], cross_title(c, e));
    comma = ", ";
  }
  gh_text_print(t, "\n");
}

/* Whether any but the reference has come along. */
static bool comparison_drawn(const gh_crosscheck *c) {
  for (int e = 1; e < c->o.engines; e++)
    if (engine_drawn(c, e) && engine_drawn(c, 0)) return true;
  return false;
}

gh_status gh_crosscheck_draw(const gh_crosscheck *c, const char *folder) {
  if (!comparison_drawn(c)) return GH_OK;
  gh_text *t;
  int panels = 2;
  for (int e = 1; e < c->o.engines && c->o.levels > 1; e++)
    if (refinement_drawn(c, e)) panels = 3;
  GH_TRY(gh_text_create(c->ctx, &t));
  data_print(c, t);
  gh_text_print(t, "set multiplot layout %d,1\nset lmargin 12\n", panels);
  stresses_draw(c, t);
  differences_draw(c, t);
  if (panels > 2) refinement_draw(c, t);
  gh_text_print(t, "unset multiplot\n");
  char *png = gh_path_join(folder, "crosscheck.png");
  gh_status status = png ? gh_text_check(t) : gh_fail(c->ctx, GH_MEMORY, "no memory for a path");
  if (status == GH_OK) status = gh_picture_script(c->ctx, gh_text_get(t, NULL), 1000, 340 * panels, png);
  free(png);
  gh_text_destroy(&t);
  return status;
}
