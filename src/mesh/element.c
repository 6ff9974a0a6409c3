/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The reference element: Q1, 2 x 2 Gauss points, total Lagrangian. */
#include "granhom/mesh.h"

#include <stdlib.h>
#include <string.h>

/* Corners of the unit square [-1, 1]^2, counter-clockwise; the Gauss points run row by row from below. */
static const double corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
static const double gauss[4][2] = {{-0.57735026918962576, -0.57735026918962576},
                                   {0.57735026918962576, -0.57735026918962576},
                                   {-0.57735026918962576, 0.57735026918962576},
                                   {0.57735026918962576, 0.57735026918962576}};

void gh_shape_values(int g, double N[4]) {
  for (int a = 0; a < 4; a++)
    N[a] = 0.25 * (1 + corner[a][0] * gauss[g][0]) * (1 + corner[a][1] * gauss[g][1]);
}

void gh_shape_gradients(const double x[4][2], int g, double grad[4][2], double *area) {
  double d[4][2], J[4] = {0, 0, 0, 0}, inverse[4]; /* J_iK = dX_i/dxi_K */
  for (int a = 0; a < 4; a++) {
    d[a][0] = 0.25 * corner[a][0] * (1 + corner[a][1] * gauss[g][1]);
    d[a][1] = 0.25 * corner[a][1] * (1 + corner[a][0] * gauss[g][0]);
    for (int i = 0; i < 2; i++)
      for (int k = 0; k < 2; k++) J[2 * i + k] += x[a][i] * d[a][k];
  }
  gh_inv2(J, inverse);
  for (int a = 0; a < 4; a++)
    for (int j = 0; j < 2; j++) grad[a][j] = d[a][0] * inverse[j] + d[a][1] * inverse[2 + j];
  *area = gh_det2(J); /* weights of the 2 x 2 rule are 1 */
}

gh_status gh_shapes_create(gh_context *ctx, const gh_mesh *mesh, gh_shapes *s) {
  size_t npoints = 4 * (size_t)mesh->nelements;
  GH_TRY(gh_alloc(ctx, npoints, sizeof *s->grad, &s->grad));
  GH_TRY(gh_alloc(ctx, npoints, sizeof *s->weight, &s->weight));
  for (int e = 0; e < mesh->nelements; e++) {
    double x[4][2];
    for (int a = 0; a < 4; a++) memcpy(x[a], mesh->X + 2 * mesh->quad[e][a], sizeof x[a]);
    for (int g = 0; g < 4; g++)
      gh_shape_gradients((const double(*)[2])x, g, s->grad[4 * e + g], s->weight + 4 * e + g);
  }
  return GH_OK;
}

void gh_shapes_destroy(gh_shapes *s) {
  free(s->grad);
  free(s->weight);
  *s = (gh_shapes){0};
}

void gh_element_deformation(const gh_shapes *s, const gh_mesh *mesh, int e, const double *u, double *F) {
  for (int g = 0; g < 4; g++, F += 4) {
    const double(*grad)[2] = (const double(*)[2])s->grad[4 * e + g];
    F[0] = F[3] = 1;
    F[1] = F[2] = 0;
    for (int a = 0; a < 4; a++)
      for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) F[2 * i + j] += u[2 * mesh->quad[e][a] + i] * grad[a][j];
  }
}

void gh_element_force(const gh_shapes *s, int e, const double *P, double f[8]) {
  memset(f, 0, 8 * sizeof *f);
  for (int g = 0; g < 4; g++, P += 4) {
    const double(*grad)[2] = (const double(*)[2])s->grad[4 * e + g], w = s->weight[4 * e + g];
    for (int a = 0; a < 4; a++)
      for (int i = 0; i < 2; i++) f[2 * a + i] += w * (P[2 * i] * grad[a][0] + P[2 * i + 1] * grad[a][1]);
  }
}

void gh_element_stiffness(const gh_shapes *s, int e, const double *A, double K[8][8]) {
  memset(K, 0, 64 * sizeof(double));
  for (int g = 0; g < 4; g++, A += 16) {
    const double(*grad)[2] = (const double(*)[2])s->grad[4 * e + g], w = s->weight[4 * e + g];
    for (int b = 0; b < 4; b++)
      for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++) {
          const double *a0 = A + 8 * i + 2 * k, *a1 = a0 + 4; /* J = 0, 1 */
          double p0 = w * (a0[0] * grad[b][0] + a0[1] * grad[b][1]);
          double p1 = w * (a1[0] * grad[b][0] + a1[1] * grad[b][1]);
          for (int a = 0; a < 4; a++) K[2 * a + i][2 * b + k] += grad[a][0] * p0 + grad[a][1] * p1;
        }
  }
}
