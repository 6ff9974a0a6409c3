/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Checkpoints of a direct simulation: position, summary, grains. */
#include "scene/direct.h"

#include <stdlib.h>
#include <string.h>

enum { POSITION = 3 };

int scene_direct_marks(void *data, gh_mark *list) {
  const scene_direct *r = data;
  const int n = scene_marks_common(r->scene, list);
  list[n] =
      (gh_mark){.name = "/made/direct", .what = "was made with other grains (--grains, --tile, --seed)"};
  snprintf(list[n].value, sizeof list[n].value, "%.17g %d %d", r->options->grains, r->options->tile,
           r->options->tile ? 0 : r->options->seed);
  return n + 1;
}

gh_status scene_direct_save(void *data, gh_archive *a) {
  const scene_direct *r = data;
  const int where[POSITION] = {r->counter, r->step, r->increment};
  const size_t ndof = 2 * (size_t)r->scene->mesh->nnodes, n = gh_direct_state_size(r->body);
  char name[64];
  double *state;
  GH_TRY(gh_archive_put_ints(a, "/run/position", POSITION, where));
  GH_TRY(gh_archive_put_bytes(a, "/run/summary", sizeof r->sum, &r->sum));
  for (int k = 1; k <= r->step; k++) {
    snprintf(name, sizeof name, "/run/begin%04d", k);
    GH_TRY(gh_archive_put_doubles(a, name, ndof, r->begin_u[k]));
  }
  GH_TRY(gh_alloc(r->ctx, n, sizeof *state, &state));
  gh_direct_save(r->body, state);
  const gh_status status = gh_archive_put_doubles(a, "/direct", n, state);
  free(state);
  return status;
}

/* All that was saved, before any of it is put to use. */
typedef struct scene_direct_loaded {
  int *where;
  char *summary;
  double **begin_u, *state;
  size_t size;
} scene_direct_loaded;

void scene_direct_loaded_destroy(scene_direct *r) {
  scene_direct_loaded *c = r->loaded;
  if (!c) return;
  for (int k = 0; c->begin_u && k <= r->scene->nsteps; k++) free(c->begin_u[k]);
  free(c->begin_u);
  free(c->where);
  free(c->summary);
  free(c->state);
  free(c);
  r->loaded = NULL;
}

gh_status scene_direct_load(void *data, gh_archive *a) {
  scene_direct *r = data;
  const gh_scene *s = r->scene;
  const size_t ndof = 2 * (size_t)s->mesh->nnodes;
  size_t n;
  char name[64];
  scene_direct_loaded_destroy(r);
  GH_TRY(gh_alloc(r->ctx, 1, sizeof *r->loaded, &r->loaded));
  scene_direct_loaded *c = r->loaded;
  GH_TRY(gh_alloc(r->ctx, (size_t)s->nsteps + 1, sizeof *c->begin_u, &c->begin_u));
  GH_TRY(gh_archive_get_ints(a, "/run/position", &n, &c->where));
  if (n != POSITION || c->where[0] < 0 || c->where[1] < 0 || c->where[1] > s->nsteps || c->where[2] < 1 ||
      c->where[2] > gh_scene_increments(s, c->where[1]))
    return gh_fail(r->ctx, GH_INPUT, "/run/position is none of this scene");
  GH_TRY(gh_archive_get_bytes(a, "/run/summary", &n, &c->summary));
  if (n != sizeof r->sum) return gh_fail(r->ctx, GH_INPUT, "it was made by another version of granhom");
  for (int k = 1; k <= c->where[1]; k++) {
    snprintf(name, sizeof name, "/run/begin%04d", k);
    GH_TRY(gh_archive_get_doubles(a, name, &n, &c->begin_u[k]));
    if (n != ndof) return gh_fail(r->ctx, GH_INPUT, "%s has %zu numbers instead of %zu", name, n, ndof);
  }
  return gh_archive_get_doubles(a, "/direct", &c->size, &c->state);
}

gh_status scene_direct_resume(void *data) {
  scene_direct *r = data;
  scene_direct_loaded *c = r->loaded;
  GH_TRY(gh_direct_load(r->body, c->state, c->size));
  r->counter = c->where[0], r->step = c->where[1], r->increment = c->where[2];
  memcpy(&r->sum, c->summary, sizeof r->sum);
  for (int k = 1; k <= r->step; k++) {
    r->begin_u[k] = c->begin_u[k];
    c->begin_u[k] = NULL;
  }
  scene_direct_loaded_destroy(r);
  return GH_OK;
}
