/* What is derived from the stresses of the material points. SPDX-License-Identifier: GPL-2.0-or-later */
#include "scene/internal.h"

#include <stdlib.h>
#include <string.h>

/* sqrt(3/2 s_dev : s_dev) with the deviator of the plane (dissertation 6.4.2): zero under equal pressure. */
double scene_mises(const double s[4]) {
  double shear = 0.5 * (s[1] + s[2]);
  return sqrt(0.75 * (s[0] - s[3]) * (s[0] - s[3]) + 3 * shear * shear);
}

void scene_cell_average(int nelements, int cols, const double *points, double *cells) {
  for (int e = 0; e < nelements; e++)
    for (int c = 0; c < cols; c++) {
      double sum = 0;
      for (int g = 0; g < 4; g++) sum += points[(4 * e + g) * cols + c];
      cells[e * cols + c] = sum / 4;
    }
}

static const double corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

/* Shape function of corner a at (r, s). */
static double shape(int a, double r, double s) {
  return 0.25 * (1 + corner[a][0] * r) * (1 + corner[a][1] * s);
}

/* Which corner of the element the Gauss point at x belongs to. */
static int corner_of(const gh_mesh *mesh, int e, const double x[2]) {
  int best = 0;
  double least = INFINITY;
  for (int c = 0; c < 4; c++) {
    double y[2] = {0, 0};
    for (int a = 0; a < 4; a++)
      for (int i = 0; i < 2; i++)
        y[i] += shape(a, corner[c][0] / sqrt(3), corner[c][1] / sqrt(3)) * mesh->X[2 * mesh->quad[e][a] + i];
    double off = hypot(x[0] - y[0], x[1] - y[1]);
    if (off < least) least = off, best = c;
  }
  return best;
}

gh_status scene_nodal_mises(gh_context *ctx, const gh_mesh *mesh, const double *cauchy, double *nodes) {
  double *gauss = NULL, *sum = NULL;
  size_t nnodes = (size_t)mesh->nnodes;
  gh_status status;
  GH_TRY_OR(gh_alloc(ctx, 8 * (size_t)mesh->nelements, sizeof *gauss, &gauss), done);
  GH_TRY_OR(gh_alloc(ctx, 5 * nnodes, sizeof *sum, &sum), done); /* stress and number of elements */
  gh_mesh_gauss(mesh, gauss);
  for (int e = 0; e < mesh->nelements; e++)
    for (int g = 0; g < 4; g++) {
      int c = corner_of(mesh, e, gauss + 2 * (4 * e + g));
      for (int a = 0; a < 4;
           a++) { /* extrapolate: the Gauss points are the corners of a square of half size 1/sqrt(3) */
        double weight = shape(c, sqrt(3) * corner[a][0], sqrt(3) * corner[a][1]),
               *at = sum + 5 * mesh->quad[e][a];
        for (int k = 0; k < 4; k++) at[k] += weight * cauchy[4 * (4 * e + g) + k];
        at[4] += 0.25;
      }
    }
  for (size_t n = 0; n < nnodes; n++) {
    double s[4];
    for (int k = 0; k < 4; k++) s[k] = sum[5 * n + k] / fmax(sum[5 * n + 4], 1);
    nodes[n] = scene_mises(s);
  }
  status = GH_OK;
done:
  free(gauss);
  free(sum);
  return status;
}
