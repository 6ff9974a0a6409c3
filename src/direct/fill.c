/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Grains for an outline: copies of a periodic packing, cut by it. */
#include "direct/outline.h"
#include "granhom/direct.h"
#include "granhom/finish.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum { CUTS = 16 };               /* places of the cut that are tried, within a mean diameter */
static const double exact = 1e-9; /* a centre so near to the cut, over the mean diameter, is inside */

double gh_direct_bytes(double grains) {
  return 10e3 * grains + 30e6; /* measured with 5000: 3 kB a grain (native engine) */
}

/* Grains within the box around the outline and `margin`, and their depths. */
typedef struct candidates {
  size_t n, capacity, depth_capacity, grain_capacity;
  double *x, *depth;
  int *grain;
} candidates;

static void candidates_free(candidates *c) {
  free(c->x);
  free(c->depth);
  free(c->grain);
}

static gh_status candidate_add(gh_context *ctx, const outline *o, int grain, const double X[2], double margin,
                               candidates *c) {
  for (int i = 0; i < 2; i++)
    if (X[i] < o->low[i] - margin || X[i] > o->high[i] + margin) return GH_OK;
  const double depth = outline_depth(o, X);
  if (depth < -margin) return GH_OK;
  GH_TRY(gh_grow(ctx, 2 * c->n + 2, sizeof(double), &c->capacity, &c->x));
  GH_TRY(gh_grow(ctx, c->n + 1, sizeof(double), &c->depth_capacity, &c->depth));
  GH_TRY(gh_grow(ctx, c->n + 1, sizeof(int), &c->grain_capacity, &c->grain));
  memcpy(c->x + 2 * c->n, X, 2 * sizeof *X);
  c->depth[c->n] = depth;
  c->grain[c->n++] = grain;
  return GH_OK;
}

/* Images of the scaled cell whose corner is that of the box. */
static gh_status candidates_find(gh_context *ctx, const outline *o, const gh_packing *p, double scale,
                                 double margin, candidates *c) {
  const double *L = p->cell, wide = o->high[0] - o->low[0] + 2 * margin,
               high = o->high[1] - o->low[1] + 2 * margin;
  const int rows = (int)ceil(high / (scale * L[3])) + 2;
  for (int k1 = -2; k1 <= rows; k1++) {
    const double tilt = L[1] * k1;
    const int first = (int)floor((-tilt - margin / scale) / L[0]) - 2,
              last = (int)ceil((wide / scale - tilt) / L[0]) + 2;
    for (int k0 = first; k0 <= last; k0++)
      for (int i = 0; i < p->n; i++) {
        const double X[2] = {o->low[0] + scale * (p->x[2 * i] - p->low[0] + L[0] * k0 + tilt),
                             o->low[1] + scale * (p->x[2 * i + 1] - p->low[1] + L[3] * k1)};
        GH_TRY(candidate_add(ctx, o, i, X, margin, c));
      }
  }
  return GH_OK;
}

static gh_status body_create(gh_context *ctx, size_t n, gh_packing **body) {
  GH_TRY(gh_alloc(ctx, 1, sizeof **body, body));
  gh_packing *b = *body;
  b->n = (int)n;
  gh_status status = gh_alloc(ctx, n, sizeof *b->id, &b->id);
  if (status == GH_OK) status = gh_alloc(ctx, n, sizeof *b->type, &b->type);
  if (status == GH_OK) status = gh_alloc(ctx, n, sizeof *b->radius, &b->radius);
  if (status == GH_OK) status = gh_alloc(ctx, 2 * n, sizeof *b->x, &b->x);
  if (status != GH_OK) gh_packing_destroy(body);
  return status;
}

/* The candidates whose centres lie at most `cut` outside. */
static gh_status body_cut(gh_context *ctx, const outline *o, const gh_packing *p, double scale,
                          const candidates *c, double cut, gh_packing **body) {
  size_t n = 0;
  for (size_t k = 0; k < c->n; k++) n += c->depth[k] >= -cut;
  if (n < 1 || n > INT_MAX)
    return gh_fail(ctx, GH_INPUT, "the outline takes %zu grains: it must take 1 to %d", n, INT_MAX);
  GH_TRY(body_create(ctx, n, body));
  gh_packing *b = *body;
  n = 0;
  for (size_t k = 0; k < c->n; k++) {
    if (!(c->depth[k] >= -cut)) continue;
    memcpy(b->x + 2 * n, c->x + 2 * k, 2 * sizeof *b->x);
    b->radius[n] = scale * p->radius[c->grain[k]];
    b->type[n] = p->type[c->grain[k]];
    b->id[n] = (int)n + 1;
    n++;
  }
  memcpy(b->cell, (double[4]){o->high[0] - o->low[0], 0, 0, o->high[1] - o->low[1]}, sizeof b->cell);
  memcpy(b->low, o->low, sizeof b->low);
  return GH_OK;
}

/* How far from the outline the boundary grains of a cut are in the mean. */
static gh_status cut_try(gh_context *ctx, const outline *o, const gh_packing *p, double scale,
                         const candidates *c, double cut, double *off) {
  gh_packing *body = NULL;
  chain boundary;
  GH_TRY(body_cut(ctx, o, p, scale, c, cut, &body));
  gh_status status = chain_create(ctx, o, body, &boundary);
  *off = fabs(boundary.depth);
  chain_destroy(&boundary);
  gh_packing_destroy(&body);
  return status;
}

gh_status gh_direct_fill(gh_context *ctx, const gh_mesh *mesh, const gh_packing *p, double grains,
                         gh_packing **body) {
  outline o;
  candidates c = {0};
  gh_status status;
  *body = NULL;
  GH_TRY_OR(outline_create(ctx, mesh, &o), done);
  const double scale = sqrt(o.area * p->n / (gh_det2(p->cell) * grains)),
               wide = 2 * scale * gh_packing_mean_radius(p);
  double best = INFINITY, cut = 0;
  GH_TRY_OR(candidates_find(ctx, &o, p, scale, 1.01 * wide, &c), done);
  for (int k = 0; k <= CUTS; k++) {
    const double here = wide * ((double)k / CUTS + exact);
    double off;
    GH_TRY_OR(cut_try(ctx, &o, p, scale, &c, here, &off), done);
    if (off < best - exact * wide) best = off, cut = here;
  }
  status = body_cut(ctx, &o, p, scale, &c, cut, body);
done:
  candidates_free(&c);
  outline_destroy(&o);
  return status;
}

/* ---- one large packing ---- */

static int diameter_compare(const void *p, const void *q) {
  const double *a = p, *b = q;
  return (a[0] < b[0]) - (a[0] > b[0]);
}

/* n diameters and types with the shares that they have in the packings, largest first. */
static gh_status grains_draw(gh_context *ctx, int npackings, const gh_packing *const *like, int n,
                             double *diameter, int *type) {
  size_t total = 0, at = 0;
  double(*all)[2];
  for (int k = 0; k < npackings; k++) total += (size_t)like[k]->n;
  GH_TRY(gh_alloc(ctx, total, sizeof *all, &all));
  for (int k = 0; k < npackings; k++)
    for (int i = 0; i < like[k]->n; i++) {
      all[at][0] = 2 * like[k]->radius[i];
      all[at++][1] = like[k]->type[i];
    }
  qsort(all, total, sizeof *all, diameter_compare);
  for (int i = 0; i < n; i++) {
    const size_t from = (size_t)(((double)i + 0.5) / n * (double)total);
    diameter[i] = all[from][0], type[i] = (int)all[from][1];
  }
  free(all);
  return GH_OK;
}

/* As soft as the packing that it stands for; one without pressure is left with grains that touch. */
static gh_status grown_finish(gh_context *ctx, const gh_packing *like, const gh_rve_options *options,
                              const gh_packing *hard, gh_packing **soft) {
  gh_finish_options o = gh_finish_defaults();
  gh_finish_report report;
  o.normal_stiffness = options->law.normal_stiffness;
  o.cell = GH_FINISH_CELL_SCALED;
  GH_TRY(gh_finish_measure(ctx, like, &o, &report));
  o.goal = report.pressure > 0 ? GH_FINISH_PRESSURE : GH_FINISH_OVERLAP;
  o.target = report.pressure > 0 ? report.pressure : 1e-4;
  return gh_finish(ctx, hard, &o, soft, &report);
}

gh_status gh_direct_grow(gh_context *ctx, const gh_mesh *mesh, int npackings, const gh_packing *const *like,
                         const gh_rve_options *options, double grains, unsigned long long seed,
                         gh_packing **packing) {
  outline o;
  gh_grains *grown = NULL;
  gh_packing *hard = NULL;
  gh_grow_result result;
  double *diameter = NULL;
  int *type = NULL;
  gh_status status;
  *packing = NULL;
  GH_TRY_OR(outline_create(ctx, mesh, &o), done);
  const double wide = o.high[0] - o.low[0], high = o.high[1] - o.low[1],
               count = fmax(1, nearbyint(grains * wide * high / o.area));
  GH_TRY_OR(gh_alloc(ctx, (size_t)count, sizeof *diameter, &diameter), done);
  GH_TRY_OR(gh_alloc(ctx, (size_t)count, sizeof *type, &type), done);
  GH_TRY_OR(grains_draw(ctx, npackings, like, (int)count, diameter, type), done);
  gh_grow_options grow = gh_grow_defaults(2);
  grow.seed = seed;
  memcpy(grow.shape, (double[4]){wide, 0, 0, high}, 4 * sizeof *grow.shape);
  GH_TRY_OR(gh_packing_grow2(ctx, (int)count, diameter, type, &grow, &grown, &result), done);
  GH_TRY_OR(gh_grains_packing(ctx, grown, &hard), done);
  status = grown_finish(ctx, like[0], options, hard, packing);
done:
  free(diameter);
  free(type);
  gh_grains_destroy(&grown);
  gh_packing_destroy(&hard);
  outline_destroy(&o);
  return status;
}
