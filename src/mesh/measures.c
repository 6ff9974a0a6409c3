/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What is derived from the stresses of the material points. */
#include "granhom/mesh.h"

#include <stdlib.h>
#include <string.h>

/* sqrt(3/2 s_dev : s_dev) with the deviator of the plane (dissertation 6.4.2): zero under equal pressure. */
double gh_mises2(const double s[4]) {
  double shear = 0.5 * (s[1] + s[2]);
  return sqrt(0.75 * (s[0] - s[3]) * (s[0] - s[3]) + 3 * shear * shear);
}

void gh_mesh_cell_average(int nelements, int cols, const double *points, double *cells) {
  for (int e = 0; e < nelements; e++)
    for (int c = 0; c < cols; c++) {
      double sum = 0;
      for (int g = 0; g < 4; g++) sum += points[(4 * e + g) * cols + c];
      cells[e * cols + c] = sum / 4;
    }
}

static const double corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

/* Shape function of corner a at (r, s). */
static double shape_at_corner(int a, double r, double s) {
  return 0.25 * (1 + corner[a][0] * r) * (1 + corner[a][1] * s);
}

int gh_mesh_gauss_corner(const gh_mesh *mesh, int e, const double x[2]) {
  int best = 0;
  double least = INFINITY;
  for (int c = 0; c < 4; c++) {
    double y[2] = {0, 0};
    for (int a = 0; a < 4; a++)
      for (int i = 0; i < 2; i++)
        y[i] += shape_at_corner(a, corner[c][0] / sqrt(3), corner[c][1] / sqrt(3)) *
                mesh->X[2 * mesh->quad[e][a] + i];
    double off = hypot(x[0] - y[0], x[1] - y[1]);
    if (off < least) least = off, best = c;
  }
  return best;
}

gh_status gh_mesh_nodal_average(gh_context *ctx, const gh_mesh *mesh, int cols, const double *points,
                                double *nodes) {
  double *gauss = NULL, *weights = NULL;
  size_t nnodes = (size_t)mesh->nnodes, n = (size_t)cols;
  gh_status status;
  GH_TRY_OR(gh_alloc(ctx, 8 * (size_t)mesh->nelements, sizeof *gauss, &gauss), done);
  GH_TRY_OR(gh_alloc(ctx, nnodes, sizeof *weights, &weights), done); /* number of elements */
  gh_mesh_gauss(mesh, gauss);
  memset(nodes, 0, n * nnodes * sizeof *nodes);
  for (int e = 0; e < mesh->nelements; e++)
    for (int g = 0; g < 4; g++) {
      size_t p = 4 * (size_t)e + (size_t)g;
      int c = gh_mesh_gauss_corner(mesh, e, gauss + 2 * p);
      for (int a = 0; a < 4;
           a++) { /* extrapolate: the Gauss points are the corners of a square of half size 1/sqrt(3) */
        double weight = shape_at_corner(c, sqrt(3) * corner[a][0], sqrt(3) * corner[a][1]);
        size_t node = (size_t)mesh->quad[e][a];
        for (size_t k = 0; k < n; k++) nodes[n * node + k] += weight * points[n * p + k];
        weights[node] += 0.25;
      }
    }
  for (size_t k = 0; k < n * nnodes; k++) nodes[k] /= fmax(weights[k / n], 1);
  status = GH_OK;
done:
  free(gauss);
  free(weights);
  return status;
}

gh_status gh_mesh_nodal_mises(gh_context *ctx, const gh_mesh *mesh, const double *cauchy, double *nodes) {
  double *stress;
  GH_TRY(gh_alloc(ctx, 4 * (size_t)mesh->nnodes, sizeof *stress, &stress));
  gh_status status = gh_mesh_nodal_average(ctx, mesh, 4, cauchy, stress);
  for (int n = 0; n < mesh->nnodes && status == GH_OK; n++) nodes[n] = gh_mises2(stress + 4 * n);
  free(stress);
  return status;
}
