/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Names of sets of a scene, checked against the columns and datasets that they will become. */
#include "io/file.h"
#include "scene/output.h"

#include <stdlib.h>
#include <string.h>

static gh_status set_check(const gh_scene *s, const char *set) {
  char what[GH_QUOTE], quoted[GH_QUOTE];
  if (gh_unprintable(set, what))
    return gh_fail(s->ctx, GH_INPUT, "%s:%d: mesh: the name of the set '%s' holds %s", s->path, s->mesh_line,
                   gh_quote(set, quoted), what);
  if (strlen(set) < GH_COLUMN) return GH_OK;
  return gh_fail(s->ctx, GH_INPUT,
                 "%s:%d: mesh: the name of the set '%s' has %zu bytes, at most %d are possible", s->path,
                 s->mesh_line, gh_quote(set, quoted), strlen(set), GH_COLUMN - 1);
}

static gh_status twice(const gh_scene *s, const char *what, const char *name) {
  char quoted[GH_QUOTE];
  return gh_fail(
      s->ctx, GH_INPUT,
      "%s:%d: mesh: two %s would be called '%s': in names of sets a comma, a blank or a quote becomes "
      "'_'; rename one of them",
      s->path, s->mesh_line, what, gh_quote(name, quoted));
}

static int by_text(const void *p, const void *q) {
  return strcmp(*(char *const *)p, *(char *const *)q);
}

/* GH_INPUT where two of the n names are the same; sorts them. */
static gh_status list_check(const gh_scene *s, const char *what, char **name, int n) {
  if (n > 0) qsort(name, (size_t)n, sizeof *name, by_text);
  for (int k = 1; k < n; k++)
    if (strcmp(name[k - 1], name[k]) == 0) return twice(s, what, name[k]);
  return GH_OK;
}

/* The columns as history.csv will have them: a set 'left_x' with a pressure and a set 'p_left' meet in
 * 'p_left_x'. */
static gh_status columns_check(const gh_scene *s) {
  gh_column *column = NULL;
  char **name = NULL;
  int n;
  gh_status status;
  GH_TRY_OR(scene_columns_create(s, &column, &n), done);
  GH_TRY_OR(gh_alloc(s->ctx, (size_t)n, sizeof *name, &name), done);
  for (int k = 0; k < n; k++) name[k] = column[k].name;
  status = list_check(s, "columns of history.csv", name, n);
done:
  free(name);
  free(column);
  return status;
}

static gh_status datasets_check(const gh_scene *s) {
  size_t n = (size_t)s->nsets;
  char(*text)[GH_COLUMN] = NULL, **name = NULL;
  gh_status status;
  GH_TRY_OR(gh_alloc(s->ctx, n, sizeof *text, &text), done);
  GH_TRY_OR(gh_alloc(s->ctx, n, sizeof *name, &name), done);
  for (size_t k = 0; k < n; k++) {
    gh_dataset_name(s->mesh->sets[k].name, text[k]);
    name[k] = text[k];
  }
  status = list_check(s, "sets of results.h5", name, s->nsets);
done:
  free(name);
  free(text);
  return status;
}

gh_status scene_names_check(const gh_scene *s) {
  for (int k = 0; k < s->nsets; k++) GH_TRY(set_check(s, s->mesh->sets[k].name));
  GH_TRY(columns_check(s));
  return datasets_check(s);
}
