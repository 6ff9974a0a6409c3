/* SPDX-License-Identifier: GPL-2.0-or-later */
/* rves.h5: grains and contacts of the recorded material points at the last increment; traces.h5: where their
 * grains were at all increments. */
#include "results/results.h"

#include <stdlib.h>
#include <string.h>

static gh_status rve_put(gh_results *r, gh_h5 *file, int point) {
  gh_rve_view v;
  const gh_rve_measures *m;
  GH_TRY(r->solver->inspect(r->solver->data, point, &v, &m));
  if (!m) return GH_OK;
  size_t n = (size_t)v.n, nc = (size_t)v.ncontacts, most = n > nc ? n : nc;
  char name[64];
  double *row = NULL;
  int *pairs = NULL, periodic = v.periodic;
  gh_status status;
#define PUT(kind, what, rows, cols, data)                                                                    \
  snprintf(name, sizeof name, "/rve/%04d/%s", point, what);                                                  \
  GH_TRY_OR(gh_h5_put_##kind(file, name, rows, cols, data), done)
  GH_TRY_OR(gh_alloc(r->ctx, 4 * most, sizeof *row, &row), done);
  GH_TRY_OR(gh_alloc(r->ctx, 2 * most, sizeof *pairs, &pairs), done);
  PUT(doubles, "positions", n, 2, v.x);
  PUT(doubles, "radii", n, 1, v.radius);
  PUT(ints, "ids", n, 1, v.id);
  PUT(ints, "types", n, 1, v.type);
  for (size_t k = 0; k < n; k++) pairs[k] = v.flags[k];
  PUT(ints, "flags", n, 1, pairs);
  PUT(doubles, "cell", 1, 4, v.cell);
  PUT(doubles, "low", 1, 2, v.low);
  PUT(ints, "periodic", 1, 1, &periodic);
  PUT(doubles, "cauchy", 1, 4, m->cauchy);
  for (size_t k = 0; k < nc; k++) {
    pairs[2 * k] = v.contacts[k].i, pairs[2 * k + 1] = v.contacts[k].j;
    memcpy(row + 4 * k, v.contacts[k].l, 2 * sizeof *row);
    memcpy(row + 4 * k + 2, v.contacts[k].f, 2 * sizeof *row);
  }
  PUT(ints, "contact_pairs", nc, 2, pairs);
  PUT(doubles, "contact_branch_force", nc, 4, row);
  if (v.theta) {
    PUT(doubles, "rotations", n, 1, v.theta);
  }
  for (size_t k = 0; k < nc && v.friction; k++) pairs[k] = v.friction[k].slides != 0;
  if (v.friction) {
    PUT(ints, "contact_sliding", nc, 1, pairs);
  }
#undef PUT
done:
  free(row);
  free(pairs);
  return status;
}

/* What is recorded of a point: 0 nothing, 1 the last increment, 2 all positions too. */
enum { LAST = 1, ALL_INCREMENTS = 2, REPLICA = 4 /* flag of a grain */ };

static void list_take(unsigned char *take, int points, gh_point_list list) {
  const bool all = list.count == GH_ALL_POINTS;
  for (int k = 0; k < (all ? points : list.count); k++) take[all ? k : list.point[k]] = ALL_INCREMENTS;
}

/* What the user asks for, and what is dumped; without a wish all points if they are few, else the first, the
 * most loaded and the one nearest to losing ellipticity. The latter two change from increment to increment.
 */
static void points_choose(const gh_results *r, const gh_frame *f, unsigned char *take) {
  const gh_solver_results *s = r->solver;
  list_take(take, r->points, s->dumped);
  if (s->recorded.count != GH_FEW_POINTS) list_take(take, r->points, s->recorded);
  else if (r->points <= GH_FEW) list_take(take, r->points, (gh_point_list){.count = GH_ALL_POINTS});
  else {
    take[0] = ALL_INCREMENTS;
    if (!take[f->most_loaded]) take[f->most_loaded] = LAST;
    if (!take[f->least_stable]) take[f->least_stable] = LAST;
  }
}

/* The primary grains come first; replicas follow them. */
static size_t primaries_count(const gh_rve_view *v) {
  size_t n = 0;
  while (n < (size_t)v->n && !(v->flags[n] & REPLICA)) n++;
  return n;
}

static gh_status trace_put(gh_results *r, gh_h5 *file, int point, int counter) {
  gh_rve_view v;
  const gh_rve_measures *m;
  char name[64];
  GH_TRY(r->solver->inspect(r->solver->data, point, &v, &m));
  if (!m) return GH_OK;
  bool there = counter > 0; /* a run that continues from a checkpoint may have written further than that */
  for (int k = counter; there; k++) {
    snprintf(name, sizeof name, "/trace/%04d/step%04d", point, k);
    GH_TRY(gh_h5_remove(file, name, &there));
  }
  snprintf(name, sizeof name, "/trace/%04d/step%04d", point, counter);
  return gh_h5_put_doubles(file, name, primaries_count(&v), 2, v.x);
}

/* rves.h5 is of this increment alone, traces.h5 grows. */
static gh_status file_write(gh_results *r, const gh_frame *f, const unsigned char *take, bool traces) {
  char *path;
  gh_h5 *file = NULL;
  const char *name = traces ? "traces.h5" : "rves.h5";
  GH_TRY(results_path(r, name, &path));
  gh_status status = gh_h5_open(r->ctx, path, gh_results_kind(name), traces && f->counter > 0, &file);
  free(path);
  if (status != GH_OK) return status;
  GH_TRY_OR(gh_h5_put_ints(file, "/step", 1, 1, &f->counter), failed);
  for (int k = 0; k < r->points; k++) {
    if (traces && take[k] == ALL_INCREMENTS) GH_TRY_OR(trace_put(r, file, k, f->counter), failed);
    if (!traces && take[k]) GH_TRY_OR(rve_put(r, file, k), failed);
  }
  return gh_h5_commit(&file);
failed:
  gh_h5_close(&file);
  return status;
}

gh_status results_write_rves(gh_results *r, const gh_frame *f) {
  unsigned char *take;
  size_t points = (size_t)r->points;
  GH_TRY(gh_alloc(r->ctx, points, 1, &take));
  points_choose(r, f, take);
  bool traces = memchr(take, ALL_INCREMENTS, points), any = traces || memchr(take, LAST, points);
  gh_status status = any ? file_write(r, f, take, false) : GH_OK;
  if (status == GH_OK && traces) status = file_write(r, f, take, true);
  free(take);
  return status;
}
