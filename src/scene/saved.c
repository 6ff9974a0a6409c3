/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What a run needs to continue, for its checkpoint: position, summary, body, packings. */
#include "scene/output.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { POSITION = 3 };

/* ---- marks ---- */

static uint64_t scene_sum(const gh_scene *s) {
  uint64_t sum = gh_sum_bytes(GH_SUM_BEGIN, s->text, strlen(s->text));
  for (int k = 0; k < s->noverrides; k++) {
    sum = gh_sum_bytes(sum, s->override_key[k], strlen(s->override_key[k]) + 1);
    sum = gh_sum_bytes(sum, s->override_value[k], strlen(s->override_value[k]) + 1);
  }
  return sum;
}

static uint64_t mesh_sum(const gh_scene *s) {
  const gh_mesh *m = s->mesh;
  uint64_t sum = gh_sum_bytes(GH_SUM_BEGIN, m->X, 2 * (size_t)m->nnodes * sizeof *m->X);
  sum = gh_sum_bytes(sum, m->quad, (size_t)m->nelements * sizeof *m->quad);
  for (int k = 0; k < s->nsets; k++) {
    const gh_mesh_set *set = m->sets + k;
    sum = gh_sum_bytes(sum, set->name, strlen(set->name));
    sum = gh_sum_bytes(sum, set->nodes, (size_t)set->nnodes * sizeof *set->nodes);
    if (set->nedges > 0) sum = gh_sum_bytes(sum, set->edges, (size_t)set->nedges * sizeof *set->edges);
  }
  return sum;
}

static uint64_t packings_sum(const gh_scene *s) {
  uint64_t sum =
      gh_sum_bytes(GH_SUM_BEGIN, s->packing_of, 4 * (size_t)s->mesh->nelements * sizeof *s->packing_of);
  for (int k = 0; k < s->npackings; k++) {
    const gh_packing *p = s->packings[k];
    size_t n = (size_t)p->n;
    sum = gh_sum_bytes(sum, p->id, n * sizeof *p->id);
    sum = gh_sum_bytes(sum, p->type, n * sizeof *p->type);
    sum = gh_sum_bytes(sum, p->radius, n * sizeof *p->radius);
    sum = gh_sum_bytes(sum, p->x, 2 * n * sizeof *p->x);
    sum = gh_sum_bytes(sum, p->cell, sizeof p->cell);
    sum = gh_sum_bytes(sum, p->low, sizeof p->low);
  }
  return sum;
}

static void mark_sum(gh_mark *mark, uint64_t sum) {
  snprintf(mark->value, sizeof mark->value, "%016" PRIx64, sum);
}

int scene_marks_common(const gh_scene *s, gh_mark *list) {
  static const gh_mark names[] = {{"/made/scene", "belongs to another scene file", ""},
                                  {"/made/mesh", "belongs to another mesh", ""},
                                  {"/made/packings", "belongs to other packings", ""},
                                  {"/made/engine", "was made with another engine", ""}};
  memcpy(list, names, sizeof names);
  mark_sum(list + 0, scene_sum(s));
  mark_sum(list + 1, mesh_sum(s));
  mark_sum(list + 2, packings_sum(s));
  snprintf(list[3].value, sizeof list[3].value, "%s",
           s->micro.engine == GH_ENGINE_NATIVE ? "native" : "lammps");
  return (int)(sizeof names / sizeof *names);
}

int scene_marks(void *data, gh_mark *list) {
  const scene_output *out = data;
  const int n = scene_marks_common(out->scene, list);
  list[n] = (gh_mark){.name = "/made/estimate", .what = "was made with another choice of --estimate-error"};
  snprintf(list[n].value, sizeof list[n].value, "%s", out->scene->estimate ? "yes" : "no");
  return n + 1;
}

/* ---- writing ---- */

static const char *name_join(char name[64], const char *folder, const char *what) {
  snprintf(name, 64, "%s/%s", folder, what);
  return name;
}

static gh_status position_put(gh_archive *a, const scene_output *o) {
  const scene_position *p = o->position;
  const int where[POSITION] = {p->counter, p->step, p->increment};
  size_t ndof = 2 * (size_t)o->scene->mesh->nnodes;
  char name[64];
  GH_TRY(gh_archive_put_ints(a, "/run/position", POSITION, where));
  GH_TRY(gh_archive_put_bytes(a, "/run/summary", sizeof p->sum, &p->sum));
  for (int k = 1; k <= p->step; k++) {
    snprintf(name, sizeof name, "/run/begin%04d", k);
    GH_TRY(gh_archive_put_doubles(a, name, ndof, p->begin_u[k]));
  }
  return GH_OK;
}

static gh_status macro_put(gh_archive *a, const char *name, const scene_output *o) {
  size_t n = gh_macro_state_size(o->macro);
  double *state;
  GH_TRY(gh_alloc(o->ctx, n, sizeof *state, &state));
  gh_macro_save(o->macro, state);
  gh_status status = gh_archive_put_doubles(a, name, n, state);
  free(state);
  return status;
}

static gh_status farm_put(gh_archive *a, const char *folder, const scene_output *o) {
  gh_farm_image f;
  char name[64];
  gh_status status;
  double *sizes = NULL;
  GH_TRY_OR(gh_farm_save(o->farm, &f), done);
  size_t n = (size_t)f.npoints, ns = (size_t)f.nstates;
  GH_TRY_OR(gh_alloc(o->ctx, ns + 1, sizeof *sizes, &sizes), done);
  for (size_t k = 0; k <= ns; k++) sizes[k] = (double)f.start[k];
  GH_TRY_OR(gh_archive_put_ints(a, name_join(name, folder, "state"), n, f.state), done);
  GH_TRY_OR(gh_archive_put_doubles(a, name_join(name, folder, "start"), ns + 1, sizes), done);
  GH_TRY_OR(gh_archive_put_doubles(a, name_join(name, folder, "data"), f.start[ns], f.data), done);
  status = gh_archive_put_doubles(a, name_join(name, folder, "measure"), n * (size_t)f.nwords, f.measure);
done:
  free(sizes);
  gh_farm_image_free(&f);
  return status;
}

/* The body that goes in whole increments for an estimate of the error. */
static gh_status whole_put(gh_archive *a, const scene_output *o) {
  const int apart = gh_macro_apart(o->macro);
  GH_TRY(gh_archive_put_ints(a, "/whole/apart", 1, &apart));
  if (!apart) return GH_OK;
  GH_TRY(gh_macro_exchange(o->macro));
  GH_TRY(macro_put(a, "/whole/macro", o));
  GH_TRY(farm_put(a, "/whole/farm", o));
  return gh_macro_exchange(o->macro);
}

gh_status scene_save(void *data, gh_archive *a) {
  const scene_output *o = data;
  GH_TRY(position_put(a, o));
  GH_TRY(macro_put(a, "/macro", o));
  GH_TRY(farm_put(a, "/farm", o));
  return o->scene->estimate ? whole_put(a, o) : GH_OK;
}

/* ---- reading ---- */

/* All that was saved, before any of it is put to use. */
struct scene_loaded {
  int *where;
  char *summary;
  double **begin_u, *macro, *whole_macro;
  gh_farm_image farm, whole_farm;
  size_t summary_size, macro_size, whole_size;
  bool apart; /* the two whole_ are there */
};

void scene_loaded_destroy(scene_output *o) {
  scene_loaded *c = o->loaded;
  if (!c) return;
  free(c->where);
  free(c->summary);
  free(c->macro);
  free(c->whole_macro);
  for (int k = 0; c->begin_u && k <= o->scene->nsteps; k++) free(c->begin_u[k]);
  free(c->begin_u);
  gh_farm_image_free(&c->farm);
  gh_farm_image_free(&c->whole_farm);
  free(c);
  o->loaded = NULL;
}

static gh_status position_get(gh_archive *a, const gh_scene *s, scene_loaded *c) {
  size_t n, ndof = 2 * (size_t)s->mesh->nnodes;
  char name[64];
  GH_TRY(gh_archive_get_ints(a, "/run/position", &n, &c->where));
  if (n != POSITION || c->where[0] < 0 || c->where[1] < 0 || c->where[1] > s->nsteps || c->where[2] < 1 ||
      c->where[2] > gh_scene_increments(s, c->where[1]))
    return gh_fail(s->ctx, GH_INPUT, "/run/position is none of this scene");
  GH_TRY(gh_archive_get_bytes(a, "/run/summary", &c->summary_size, &c->summary));
  if (c->summary_size != sizeof(gh_run_summary))
    return gh_fail(s->ctx, GH_INPUT, "it was made by another version of granhom");
  for (int k = 1; k <= c->where[1]; k++) {
    snprintf(name, sizeof name, "/run/begin%04d", k);
    GH_TRY(gh_archive_get_doubles(a, name, &n, &c->begin_u[k]));
    if (n != ndof) return gh_fail(s->ctx, GH_INPUT, "%s has %zu numbers instead of %zu", name, n, ndof);
  }
  return GH_OK;
}

static gh_status farm_get(gh_context *ctx, gh_archive *a, const char *folder, gh_farm_image *f) {
  char name[64];
  size_t n, starts, nmeasure, ndata;
  double *start = NULL;
  gh_status status;
  GH_TRY_OR(gh_archive_get_ints(a, name_join(name, folder, "state"), &n, &f->state), done);
  GH_TRY_OR(gh_archive_get_doubles(a, name_join(name, folder, "start"), &starts, &start), done);
  GH_TRY_OR(gh_archive_get_doubles(a, name_join(name, folder, "data"), &ndata, &f->data), done);
  GH_TRY_OR(gh_archive_get_doubles(a, name_join(name, folder, "measure"), &nmeasure, &f->measure), done);
  GH_TRY_OR(gh_alloc(ctx, starts + 1, sizeof *f->start, &f->start), done);
  bool fits = starts >= 1;
  for (size_t k = 0; k < starts; k++) {
    fits = fits && start[k] >= (k ? start[k - 1] : 0) && start[k] <= (double)ndata;
    f->start[k] = fits ? (size_t)start[k] : 0;
  }
  f->npoints = (int)n;
  f->nstates = (int)starts - 1;
  f->nwords = n > 0 ? (int)(nmeasure / n) : 0;
  if (n < 1 || !fits || f->start[starts - 1] != ndata || nmeasure != n * (size_t)f->nwords)
    status = gh_fail(ctx, GH_INPUT, "the lists in %s do not fit each other", folder);
done:
  free(start);
  return status;
}

static gh_status whole_get(gh_context *ctx, gh_archive *a, scene_loaded *c) {
  size_t n;
  int *apart = NULL;
  gh_status status = gh_archive_get_ints(a, "/whole/apart", &n, &apart);
  c->apart = status == GH_OK && n == 1 && apart[0];
  free(apart);
  if (!c->apart) return status;
  GH_TRY(gh_archive_get_doubles(a, "/whole/macro", &c->whole_size, &c->whole_macro));
  return farm_get(ctx, a, "/whole/farm", &c->whole_farm);
}

gh_status scene_load(void *data, gh_archive *a) {
  scene_output *o = data;
  scene_loaded_destroy(o);
  GH_TRY(gh_alloc(o->ctx, 1, sizeof *o->loaded, &o->loaded));
  scene_loaded *c = o->loaded;
  GH_TRY(gh_alloc(o->ctx, (size_t)o->scene->nsteps + 1, sizeof *c->begin_u, &c->begin_u));
  GH_TRY(position_get(a, o->scene, c));
  GH_TRY(gh_archive_get_doubles(a, "/macro", &c->macro_size, &c->macro));
  GH_TRY(farm_get(o->ctx, a, "/farm", &c->farm));
  return o->scene->estimate ? whole_get(o->ctx, a, c) : GH_OK;
}

static void position_use(scene_loaded *c, scene_position *p) {
  p->counter = c->where[0], p->step = c->where[1], p->increment = c->where[2];
  memcpy(&p->sum, c->summary, sizeof p->sum);
  for (int k = 1; k <= p->step; k++) {
    p->begin_u[k] = c->begin_u[k];
    c->begin_u[k] = NULL;
  }
}

gh_status scene_resume(void *data) {
  scene_output *o = data;
  scene_loaded *c = o->loaded;
  position_use(c, o->position);
  if (c->apart) {
    GH_TRY(gh_macro_load(o->macro, c->whole_macro, c->whole_size));
    GH_TRY(gh_farm_load(o->farm, &c->whole_farm));
    GH_TRY(gh_macro_part(o->macro));
  }
  GH_TRY(gh_macro_load(o->macro, c->macro, c->macro_size));
  GH_TRY(gh_farm_load(o->farm, &c->farm));
  scene_loaded_destroy(o);
  return scene_output_inspect(o);
}
