/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Do the supports hold the mesh? */
#include "macro/internal.h"

#include <stdlib.h>

/* Rigid motions of a body about its first node: x, y, rotation over the body's size. Each fixed degree of
 * freedom is a linear form on them; gram = sum of its outer products has full rank when nothing is free. */
typedef struct body {
  int node; /* its first */
  double gram[3][3];
  double low[2], high[2];
} body;

static int body_find_root(int *parent, int a) {
  while (parent[a] != a) a = parent[a] = parent[parent[a]];
  return a;
}

static void bodies_join(int *parent, int a, int b) {
  a = body_find_root(parent, a);
  b = body_find_root(parent, b);
  if (a < b) parent[b] = a;
  else parent[a] = b;
}

/* parent[a] becomes the lowest node of the body that node a belongs to. */
static void bodies_connect(const gh_mesh *mesh, int nfootings, const gh_footing *footing, int *parent) {
  for (int a = 0; a < mesh->nnodes; a++) parent[a] = a;
  for (int e = 0; e < mesh->nelements; e++)
    for (int k = 1; k < 4; k++) bodies_join(parent, mesh->quad[e][0], mesh->quad[e][k]);
  for (int f = 0; f < nfootings; f++)
    for (int k = 1; k < footing[f].set->nnodes; k++)
      bodies_join(parent, footing[f].set->nodes[0], footing[f].set->nodes[k]);
  for (int a = 0; a < mesh->nnodes; a++) parent[a] = body_find_root(parent, a);
}

static void bodies_gather(const gh_mesh *mesh, const unsigned char *fixed, const int *parent, body *bodies) {
  for (int a = 0; a < mesh->nnodes; a++) {
    body *b = bodies + parent[a];
    for (int i = 0; i < 2; i++) {
      double x = mesh->X[2 * a + i];
      b->low[i] = parent[a] == a ? x : fmin(b->low[i], x);
      b->high[i] = parent[a] == a ? x : fmax(b->high[i], x);
    }
  }
  for (int a = 0; a < mesh->nnodes; a++) {
    body *b = bodies + parent[a];
    double size = hypot(b->high[0] - b->low[0], b->high[1] - b->low[1]);
    double x = (mesh->X[2 * a] - mesh->X[2 * parent[a]]) / size;
    double y = (mesh->X[2 * a + 1] - mesh->X[2 * parent[a] + 1]) / size;
    double form[2][3] = {{1, 0, -y}, {0, 1, x}};
    for (int i = 0; i < 2; i++)
      if (fixed[2 * a + i])
        for (int p = 0; p < 3; p++)
          for (int q = 0; q < 3; q++) b->gram[p][q] += form[i][p] * form[i][q];
  }
}

/* What the supports leave free; NULL when nothing. The rotation is what remains after x and y are eliminated.
 */
static const char *body_free_motion(const double g[3][3]) {
  if (g[0][0] == 0 && g[1][1] == 0) return "in x, in y and in rotation";
  if (g[0][0] == 0) return "in x";
  if (g[1][1] == 0) return "in y";
  /* Forms of x and of y share the rotation alone, so gram[0][1] = 0 and the Schur complement is this. */
  double rest = g[2][2] - g[0][2] * g[0][2] / g[0][0] - g[1][2] * g[1][2] / g[1][1];
  return rest <= 1e-12 * (g[0][0] + g[1][1]) ? "in rotation" : NULL;
}

gh_status gh_supports_check(gh_context *ctx, const gh_mesh *mesh, const unsigned char *fixed, int nfootings,
                            const gh_footing *footing) {
  int *parent = NULL;
  body *bodies = NULL;
  gh_status status;
  GH_TRY_OR(gh_alloc(ctx, (size_t)mesh->nnodes, sizeof *parent, &parent), done);
  GH_TRY_OR(gh_alloc(ctx, (size_t)mesh->nnodes, sizeof *bodies, &bodies), done);
  bodies_connect(mesh, nfootings, footing, parent);
  bodies_gather(mesh, fixed, parent, bodies);
  for (int a = 0; a < mesh->nnodes && status == GH_OK; a++) {
    const char *what = parent[a] == a ? body_free_motion((const double(*)[3])bodies[a].gram) : NULL;
    if (what)
      status = gh_fail(ctx, GH_INPUT, "the supports leave the body with node %d at (%g, %g) free %s", a,
                       mesh->X[2 * a], mesh->X[2 * a + 1], what);
  }
done:
  free(parent);
  free(bodies);
  return status;
}
