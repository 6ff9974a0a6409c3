/* SPDX-License-Identifier: GPL-2.0-or-later */
/* history.csv as it was written: a table with words in it, and which of its columns make the curves. */
#include "io/file.h"
#include "report/page.h"

#include <stdlib.h>
#include <string.h>

void report_table_free(report_table *t) {
  free(t->text);
  free(t->cell);
  free(t->name);
  free(t->path);
}

/* Cuts a line at its commas; returns how many parts there are, of which the first `max` are stored. */
static int cut(char *line, char **part, int max) {
  int n = 0;
  for (char *p = line; p; n++) {
    char *comma = strchr(p, ',');
    if (comma) *comma = 0;
    if (n < max) part[n] = p;
    p = comma ? comma + 1 : NULL;
  }
  return n;
}

static int count(const char *text, char c) {
  int n = 0;
  for (; *text; text++) n += *text == c;
  return n;
}

static gh_status read_rows(gh_context *ctx, const char *path, report_table *t) {
  size_t length = strlen(t->text);
  if (length == 0 || t->text[length - 1] != '\n')
    return gh_fail(ctx, GH_INPUT, "%s: the last line is cut off", path);
  int lines = count(t->text, '\n');
  char *line = t->text, *end = strchr(line, '\n');
  *end = 0;
  t->ncols = count(line, ',') + 1;
  size_t cols = (size_t)t->ncols;
  GH_TRY(gh_alloc(ctx, cols, sizeof *t->name, &t->name));
  GH_TRY(gh_alloc(ctx, cols * (size_t)lines, sizeof *t->cell, &t->cell));
  cut(line, t->name, t->ncols);
  for (int k = 1; k < lines; k++) {
    line = end + 1;
    end = strchr(line, '\n');
    *end = 0;
    int n = cut(line, t->cell + cols * (size_t)t->nrows, t->ncols);
    if (n != t->ncols)
      return gh_fail(ctx, GH_INPUT, "%s:%d: has %d fields, the header has %d", path, k + 1, n, t->ncols);
    t->nrows++;
  }
  return GH_OK;
}

gh_status report_table_read(gh_context *ctx, const char *folder, const char *file, report_table *t) {
  *t = (report_table){0};
  t->path = gh_path_join(folder, file);
  if (!t->path) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  GH_TRY(gh_file_regular(ctx, t->path));
  GH_TRY(gh_file_text(ctx, t->path, &t->text));
  GH_TRY(read_rows(ctx, t->path, t));
  return t->nrows > 0 ? GH_OK : gh_fail(ctx, GH_INPUT, "%s: holds no increment", t->path);
}

int report_table_column(const report_table *t, const char *name) {
  for (int k = 0; k < t->ncols; k++)
    if (strcmp(t->name[k], name) == 0) return k;
  return -1;
}

const char *report_table_text(const report_table *t, int row, int column) {
  return column < 0 ? "" : t->cell[(size_t)row * (size_t)t->ncols + (size_t)column];
}

double report_table_number(const report_table *t, int row, int column) {
  double value;
  return gh_parse_number(report_table_text(t, row, column), &value) ? value : NAN;
}

/* The settlement of the first footing and the force on it, where there is one and nothing is driven. */
static bool choose_footing(const report_table *h, const char *unit, const char *force_unit, report_curve *c) {
  static const char key[] = "footing_uy_";
  char name[GH_COLUMN + 32];
  for (int k = 0; k < h->ncols; k++) {
    if (strncmp(h->name[k], key, strlen(key)) != 0) continue;
    c->x = k;
    snprintf(name, sizeof name, "footing_fy_%s", h->name[k] + strlen(key));
    c->force = report_table_column(h, name);
    c->sign = -1;
    snprintf(c->x_label, sizeof c->x_label, "settlement of the footing%s", unit);
    snprintf(c->force_label, sizeof c->force_label, "force on the footing in y%s", force_unit);
    return true;
  }
  return false;
}

/* The displacement of the driven set and the force on it; GH_INPUT where run.json names a set whose columns
 * are not there. */
static gh_status choose_driven(gh_context *ctx, const report_table *h, const report_labels *l,
                               const char *unit, const char *force_unit, report_curve *c) {
  char set[GH_COLUMN], name[GH_COLUMN + 8], quoted[GH_QUOTE];
  gh_column_name(l->driven_set, set);
  snprintf(name, sizeof name, "u%c_%s", l->driven_direction, set);
  c->x = report_table_column(h, name);
  if (c->x < 0)
    return gh_fail(ctx, GH_INPUT, "%s: has no column %s, and run.json has '%s' as the driven set", h->path,
                   gh_quote(name, quoted), l->driven_set);
  c->driven = true;
  c->sign = report_table_number(h, h->nrows - 1, c->x) < 0 ? -1 : 1;
  snprintf(name, sizeof name, "%s_%c", set, l->driven_direction);
  c->force = report_table_column(h, name);
  snprintf(c->x_label, sizeof c->x_label, "displacement of %s in %s%c%s", l->driven_set,
           c->sign < 0 ? "-" : "", l->driven_direction, unit);
  snprintf(c->force_label, sizeof c->force_label, "support force on %s in %c%s", l->driven_set,
           l->driven_direction, force_unit);
  return GH_OK;
}

/* The force at the bottom over the load steps. */
static void choose_time(const report_table *h, const char *force_unit, report_curve *c) {
  c->x = report_table_column(h, "time");
  c->force = report_table_column(h, "bottom_y");
  snprintf(c->x_label, sizeof c->x_label, "load steps");
  snprintf(c->force_label, sizeof c->force_label, "support force on bottom in y%s", force_unit);
}

/* Whether the run has come to a step that prescribes the displacement: before, it is nan. */
static bool has_moved(const report_table *h, int column) {
  for (int k = 0; k < h->nrows; k++)
    if (isfinite(report_table_number(h, k, column))) return true;
  return false;
}

/* The row before the driven set first moves. */
static void choose_first(const report_table *h, report_curve *c) {
  for (int k = 1; c->driven && k < h->nrows; k++) {
    double now = report_table_number(h, k, c->x), before = report_table_number(h, k - 1, c->x);
    if (isfinite(now) && isfinite(before) && now != before) return;
    c->first = k < h->nrows - 1 ? k : 0;
  }
}

gh_status report_curve_choose(gh_context *ctx, const report_table *h, const report_labels *l,
                              report_curve *c) {
  char unit[100] = "", force_unit[100] = "";
  *c = (report_curve){.sign = 1};
  if (*l->length) snprintf(unit, sizeof unit, " (%s)", l->length);
  if (*l->force) snprintf(force_unit, sizeof force_unit, " (%s)", l->force);
  const bool drives = *l->driven_set != 0;
  if (drives) GH_TRY(choose_driven(ctx, h, l, unit, force_unit, c));
  const bool stands = drives && !has_moved(h, c->x);
  if (stands) *c = (report_curve){.sign = 1};
  if (stands || (!drives && !choose_footing(h, unit, force_unit, c))) choose_time(h, force_unit, c);
  c->dilatancy = report_table_column(h, "dilatancy");
  if (c->x < 0 || c->dilatancy < 0)
    return gh_fail(ctx, GH_INPUT, "%s: lacks the columns to draw (time, dilatancy)", h->path);
  choose_first(h, c);
  return GH_OK;
}
