/* Tables, files and the picture of `granhom crosscheck`. SPDX-License-Identifier: GPL-2.0-or-later */
#include "crosscheck.h"

#include "granhom/scene.h"

#include <stdlib.h>

/* The components that are told, of s11 s12 s21 s22. */
enum { COMPONENTS = 3 };
static const int component[COMPONENTS] = {0, 3, 1};
static const char *const component_name[COMPONENTS] = {"11", "22", "12"};

static const char *word(const cross_job *j, int e) {
  return cross_engines[j->engine[e]].word;
}

static const char *title(const cross_job *j, int e) {
  return cross_engines[j->engine[e]].title;
}

/* A row of the path as given; NULL when the engine has not come so far. */
static const gh_peer_row *find(const cross_level *level, int e, int row) {
  int k = level->path.of_row[row];
  return k < level->trace[e].result.rows ? level->trace[e].rows + k : NULL;
}

/* ---- standard output ---- */

static void print_engine(const cross_job *j, int e) {
  const cross_level *level = &j->level[0];
  const gh_peer_result *r = &level->trace[e].result;
  long steps = 0;
  int row;
  for (int k = 0; k < r->rows; k++) steps += level->trace[e].rows[k].steps;
  printf("%-26s %-8s", title(j, e), gh_peer_end_text(r->end));
  if (r->rows == 0) {
    printf(" %8s %9s %8s %11s\n", "-", "-", "-", "-");
    return;
  }
  printf(" %8d %9ld %8.3f", level->trace[e].rows[r->rows - 1].contacts, steps, r->seconds);
  double worst = cross_worst(j, level, e, level, 0, &row);
  if (e == 0) printf(" %11s\n", "reference");
  else if (isnan(worst)) printf(" %11s\n", "-");
  else printf(" %11.2e %6ld\n", worst, path_step(&j->path, row));
}

/* Of engine e on level k: its difference to the reference with the same parts or, with `change`, to itself
 * with half as many. NAN where there is none. */
static double refined(const cross_job *j, int k, int e, bool change) {
  int row;
  const cross_level *level = j->level + k;
  if (!change) return cross_worst(j, level, e, level, 0, &row);
  return k > 0 ? cross_worst(j, level, e, level - 1, e, &row) : NAN;
}

/* A line per level; from line to line the values fall as (1/2)^order. What the residual may leave has no
 * order.
 */
static void print_refinement(const cross_job *j, bool change) {
  double rest = 100 * j->rve.tolerance;
  printf("%-6s", "parts");
  for (int e = change ? 0 : 1; e < j->engines; e++) printf(" %10s order", word(j, e));
  printf("\n");
  for (int k = change; k < j->levels; k++) {
    printf("%-6d", j->level[k].parts);
    for (int e = change ? 0 : 1; e < j->engines; e++) {
      double d = refined(j, k, e, change), before = k ? refined(j, k - 1, e, change) : NAN;
      if (isnan(d)) printf(" %10s", "-");
      else printf(" %10.2e", d);
      if (d > rest && before > rest) printf(" %5.2f", log2(before / d));
      else printf(" %5s", "");
    }
    printf("\n");
  }
}

void cross_print(const cross_job *j) {
  printf("%-26s %-8s %8s %9s %8s %11s %6s\n", "engine", "end", "contacts", "steps", "seconds", "difference",
         "step");
  for (int e = 0; e < j->engines; e++) print_engine(j, e);
  printf("difference: of any component of the Cauchy stress, over the largest of %s on the path, %.6g\n",
         title(j, 0), cross_scale(j, j->level, 0));
  if (j->levels > 1) {
    printf("\nEach increment cut into parts: largest difference to %s with the same parts\n", title(j, 0));
    print_refinement(j, false);
    printf("\nChange of each from half as many parts\n");
    print_refinement(j, true);
  }
  for (int k = 0; k < j->levels; k++)
    for (int e = 0; e < j->engines; e++) {
      const gh_peer_result *r = &j->level[k].trace[e].result;
      bool told = k > 0 && (r->end == GH_PEER_MISSING || r->end == GH_PEER_UNABLE);
      if (r->end == GH_PEER_DONE || told) continue;
      printf("%s", title(j, e));
      if (j->levels > 1 && k > 0) printf(" (%d parts)", j->level[k].parts);
      printf(": %s: %s\n", gh_peer_end_text(r->end), r->message);
    }
}

/* ---- files ---- */

static gh_status commit(const cross_job *j, gh_text *text, const char *name) {
  char *path = gh_path_join(j->folder, name);
  gh_status status = path ? gh_text_commit(text, path) : gh_fail(j->ctx, GH_MEMORY, "no memory for a path");
  free(path);
  gh_text_destroy(&text);
  return status;
}

/* A field of a CSV line; empty for what there is not. */
static void field(gh_text *t, int digits, double value) {
  gh_text_print(t, ",");
  if (!isnan(value)) gh_text_print(t, "%.*g", digits, value);
}

static void write_row(const cross_job *j, gh_text *t, int row) {
  const cross_level *level = &j->level[0];
  const gh_peer_row *reference = find(level, 0, row);
  double F[4], scale = cross_scale(j, level, 0);
  path_F(&j->path, row, F);
  gh_text_print(t, "%ld,%.17g,%.17g,%.17g,%.17g", path_step(&j->path, row), F[0], F[1], F[2], F[3]);
  for (int e = 0; e < j->engines; e++) {
    const gh_peer_row *r = find(level, e, row);
    bool both = r && reference && scale > 0;
    for (int c = 0; c < COMPONENTS; c++) field(t, 17, r ? r->cauchy[component[c]] : NAN);
    field(t, 9, r ? r->contacts : NAN);
    field(t, 6, r ? r->residual : NAN);
    field(t, 9, r ? (double)r->steps : NAN);
    for (int c = 0; c < COMPONENTS && e > 0; c++) {
      int n = component[c];
      field(t, 6, both ? (r->cauchy[n] - reference->cauchy[n]) / scale : NAN);
    }
  }
  gh_text_print(t, "\n");
}

static gh_status write_stresses(const cross_job *j) {
  gh_text *t;
  GH_TRY(gh_text_create(j->ctx, &t));
  gh_text_print(t, "step,F11,F12,F21,F22");
  for (int e = 0; e < j->engines; e++) {
    for (int c = 0; c < COMPONENTS; c++) gh_text_print(t, ",%s_s%s", word(j, e), component_name[c]);
    gh_text_print(t, ",%s_contacts,%s_residual,%s_steps", word(j, e), word(j, e), word(j, e));
    for (int c = 0; c < COMPONENTS && e > 0; c++) gh_text_print(t, ",%s_d%s", word(j, e), component_name[c]);
  }
  gh_text_print(t, "\n");
  for (int row = 0; row < j->path.csv->nrows; row++) write_row(j, t, row);
  return commit(j, t, "crosscheck.csv");
}

/* Per level: the difference to the reference, and the change of each engine from the level before. */
static gh_status write_refinement(const cross_job *j) {
  gh_text *t;
  GH_TRY(gh_text_create(j->ctx, &t));
  gh_text_print(t, "parts");
  for (int e = 0; e < j->engines; e++)
    gh_text_print(t, ",%s_difference,%s_change,%s_seconds", word(j, e), word(j, e), word(j, e));
  for (int k = 0; k < j->levels; k++) {
    const cross_level *level = j->level + k;
    gh_text_print(t, "\n%d", level->parts);
    for (int e = 0; e < j->engines; e++) {
      const gh_peer_result *r = &level->trace[e].result;
      field(t, 6, refined(j, k, e, false));
      field(t, 6, refined(j, k, e, true));
      field(t, 6, r->rows ? r->seconds : NAN);
    }
  }
  gh_text_print(t, "\n");
  return commit(j, t, "refine.csv");
}

gh_status cross_write(const cross_job *j) {
  GH_TRY(write_stresses(j));
  return j->levels > 1 ? write_refinement(j) : GH_OK;
}

/* ---- picture ---- */

static const char colour[CROSS_ENGINES][8] = {"#1b1b1b", "#31688e", "#cc3311", "#e69f00"};
static const int point[CROSS_ENGINES] = {7, 4, 6, 8};

/* Data blocks $e: step, the components, the difference of each row. */
static void write_data(const cross_job *j, gh_text *t) {
  const cross_level *level = &j->level[0];
  double scale = cross_scale(j, level, 0);
  for (int e = 0; e < j->engines; e++) {
    gh_text_print(t, "$e%d << EOD\n", e);
    for (int row = 0; row < j->path.csv->nrows; row++) {
      const gh_peer_row *r = find(level, e, row);
      if (!r) continue;
      double d = e ? cross_difference(level, e, level, 0, row) / scale : 0;
      gh_text_print(t, "%ld", path_step(&j->path, row));
      for (int c = 0; c < COMPONENTS; c++) gh_text_print(t, " %.17g", r->cauchy[component[c]]);
      gh_text_print(t, " %.17g\n", isfinite(d) ? fmax(d, 1e-16) : 1e-16);
    }
    gh_text_print(t, "EOD\n");
  }
}

static bool drawn(const cross_job *j, int e) {
  return j->level[0].trace[e].result.rows > 0;
}

/* The component's name beside the last point of the reference. */
static void label_components(const cross_job *j, gh_text *t) {
  const cross_trace *reference = j->level[0].trace;
  int rows = j->path.csv->nrows, last = 0;
  for (int row = 0; row < rows; row++)
    if (find(&j->level[0], 0, row)) last = row;
  for (int c = 0; c < COMPONENTS; c++)
    gh_text_print(t, "set label %d 's_{%s}' at first %ld,%.17g offset char 0.8,0\n", c + 1, component_name[c],
                  path_step(&j->path, last),
                  reference->rows[j->level[0].path.of_row[last]].cauchy[component[c]]);
}

static void draw_stresses(const cross_job *j, gh_text *t) {
  const char *comma = "";
  label_components(j, t);
  gh_text_print(t, "set xlabel 'step'\nset ylabel 'Cauchy stress'\nset key outside right top\nplot ");
  for (int e = 0; e < j->engines; e++)
    for (int c = 0; c < COMPONENTS && drawn(j, e); c++) {
      gh_text_print(t, "%s$e%d using 1:%d with %s lc rgb '%s' ", comma, e, c + 2, e ? "points" : "lines",
                    colour[e]);
      if (e) gh_text_print(t, "pt %d ps %.1f ", point[e], e == 1 ? 1.6 : 1.0);
      if (c) gh_text_print(t, "notitle");
      else gh_text_print(t, "title '%s'", title(j, e));
      comma = ", ";
    }
  gh_text_print(t, "\n");
  for (int c = 0; c < COMPONENTS; c++) gh_text_print(t, "unset label %d\n", c + 1);
}

static void draw_differences(const cross_job *j, gh_text *t) {
  const char *comma = "";
  gh_text_print(t,
                "set key title 'to %s:' left\nset ylabel 'relative difference'\nset logscale y\nset format y "
                "'10^{%%T}'\nplot ",
                title(j, 0));
  for (int e = 1; e < j->engines; e++) {
    if (!drawn(j, e)) continue;
    gh_text_print(t, "%s$e%d using 1:5 with linespoints lc rgb '%s' pt %d ps 0.8 title '%s'", comma, e,
                  colour[e], point[e], title(j, e));
    comma = ", ";
  }
  gh_text_print(t, "\n");
}

/* Differences that are no more than what the residual leaves would only stretch the axis. */
static bool refined_drawn(const cross_job *j, int e) {
  for (int k = 0; k < j->levels; k++)
    if (refined(j, k, e, false) > 100 * j->rve.tolerance) return true;
  return false;
}

static void draw_refinement(const cross_job *j, gh_text *t) {
  const char *comma = "";
  for (int e = 1; e < j->engines; e++) {
    gh_text_print(t, "$r%d << EOD\n", e);
    for (int k = 0; k < j->levels; k++) {
      double d = refined(j, k, e, false);
      if (isfinite(d)) gh_text_print(t, "%d %.17g\n", j->level[k].parts, fmax(d, 1e-16));
    }
    gh_text_print(t, "EOD\n");
  }
  gh_text_print(t,
                "set logscale x 2\nset xlabel 'parts of each increment'\nset ylabel 'largest difference'\n"
                "set xrange [0.9:%g]\nplot ",
                1.1 * j->level[j->levels - 1].parts);
  for (int e = 1; e < j->engines; e++) {
    if (!refined_drawn(j, e)) continue;
    gh_text_print(t, "%s$r%d using 1:2 with linespoints lc rgb '%s' pt %d title '%s'", comma, e, colour[e],
                  point[e], title(j, e));
    comma = ", ";
  }
  gh_text_print(t, "\n");
}

/* Whether any but the reference has come along. */
static bool compared(const cross_job *j) {
  for (int e = 1; e < j->engines; e++)
    if (drawn(j, e) && drawn(j, 0)) return true;
  return false;
}

gh_status cross_draw(const cross_job *j) {
  if (!compared(j)) return GH_OK;
  gh_text *t;
  int panels = 2;
  for (int e = 1; e < j->engines && j->levels > 1; e++)
    if (refined_drawn(j, e)) panels = 3;
  GH_TRY(gh_text_create(j->ctx, &t));
  write_data(j, t);
  gh_text_print(t, "set multiplot layout %d,1\nset lmargin 12\n", panels);
  draw_stresses(j, t);
  draw_differences(j, t);
  if (panels > 2) draw_refinement(j, t);
  gh_text_print(t, "unset multiplot\n");
  char *png = gh_path_join(j->folder, "crosscheck.png");
  gh_status status = png ? gh_text_check(t) : gh_fail(j->ctx, GH_MEMORY, "no memory for a path");
  if (status == GH_OK) status = gh_picture_script(j->ctx, gh_text_get(t, NULL), 1000, 340 * panels, png);
  free(png);
  gh_text_destroy(&t);
  return status;
}
