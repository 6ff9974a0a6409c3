/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Primary grains and replicas; boundary sets (3.14, 3.15; method 8.1). */
#include "granhom/packing.h"

#include <stdlib.h>
#include <string.h>

void gh_cluster_destroy(gh_cluster **cluster) {
  if (!cluster || !*cluster) return;
  gh_cluster *c = *cluster;
  free(c->grain);
  free(c->image);
  free(c->boundary);
  free(c->x);
  free(c->radius);
  free(c->type);
  free(c);
  *cluster = NULL;
}

/* Shifts along direction k that put a replica beside the cell: +1 if the closed disk reaches the low face, -1
 * for the high face. low[k], high[k] tell; height: distance of the two faces. */
static void reaches(const gh_packing *p, const double inverse[4], int i, bool low[2], bool high[2]) {
  double s[2] = {p->x[2 * i] - p->low[0], p->x[2 * i + 1] - p->low[1]};
  gh_apply2(inverse, s, s);
  for (int k = 0; k < 2; k++) {
    double height = 1 / hypot(inverse[2 * k], inverse[2 * k + 1]);
    low[k] = s[k] * height <= p->radius[i];
    high[k] = (1 - s[k]) * height <= p->radius[i];
  }
}

/* Calls for each replica of each primary grain; with c NULL it only counts. */
static int replicas(const gh_packing *p, gh_cluster *c) {
  double inverse[4];
  gh_inv2(p->cell, inverse);
  int n = p->n;
  for (int i = 0; i < p->n; i++) {
    bool low[2], high[2];
    reaches(p, inverse, i, low, high);
    for (int a = -1; a <= 1; a++)
      for (int b = -1; b <= 1; b++) {
        bool x = a == 0 || (a > 0 ? low[0] : high[0]), y = b == 0 || (b > 0 ? low[1] : high[1]);
        if ((!a && !b) || !x || !y) continue;
        if (c) {
          c->grain[n] = i;
          c->image[n][0] = a;
          c->image[n][1] = b;
          c->boundary[n] = c->boundary[i] = 1;
        }
        n++;
      }
  }
  return n;
}

gh_status gh_cluster_create(gh_context *ctx, const gh_packing *p, gh_cluster **cluster) {
  *cluster = NULL;
  gh_cluster *c;
  GH_TRY(gh_alloc(ctx, 1, sizeof *c, &c));
  gh_status status;
  c->n = replicas(p, NULL);
  size_t n = (size_t)c->n;
  GH_TRY_OR(gh_alloc(ctx, n, sizeof(int), &c->grain), failed);
  GH_TRY_OR(gh_alloc(ctx, n, sizeof *c->image, &c->image), failed);
  GH_TRY_OR(gh_alloc(ctx, n, 1, &c->boundary), failed);
  GH_TRY_OR(gh_alloc(ctx, 2 * n, sizeof(double), &c->x), failed);
  GH_TRY_OR(gh_alloc(ctx, n, sizeof(double), &c->radius), failed);
  GH_TRY_OR(gh_alloc(ctx, n, sizeof(int), &c->type), failed);
  for (int i = 0; i < p->n; i++) c->grain[i] = i;
  replicas(p, c);
  for (int m = 0; m < c->n; m++) {
    int i = c->grain[m];
    c->radius[m] = p->radius[i];
    c->type[m] = p->type[i];
    for (int k = 0; k < 2; k++)
      c->x[2 * m + k] =
          p->x[2 * i + k] + p->cell[2 * k] * c->image[m][0] + p->cell[2 * k + 1] * c->image[m][1];
  }
  *cluster = c;
  return GH_OK;
failed:
  gh_cluster_destroy(&c);
  return status;
}
