/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The linear system of an RVE under traction: K with the rows of sum w (x) area = 0 as a border, four, or two where
 * all areas are parallel.
 *
 * K alone is that of a body in free space: it has translations, and a rotation, which the constraint alone prevents.
 * One grain is taken out (a translation is no solution of the border), and another far away put into the border.
 * What is left is held at two places, and is positive definite where the packing is stable, so that the solver for
 * cells and clusters factors it; the border, of six rows at most, is dense:
 *
 *   [ K_mm  B ] [ x ]   [ f ]
 *   [ C     D ] [ z ] = [ g ],   S = D - C K_mm^-1 B.
 *
 * K is positive definite on what the constraint allows where K_mm is and S has as many negative eigenvalues as there
 * are rows of the constraint. */
#include "micro/internal.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 6 };

typedef struct framed {
  gh_solver base;
  gh_solver *inner;
  bool symmetric;
  const gh_rve_frame *frame;
  unsigned char *held;                      /* of the inner solver */
  int far;                                  /* the grain in the border; -1: none */
  int rows, nb;                             /* of the constraint; of the border */
  double scale;                             /* of the areas, so that the border has one unit */
  double *right, *left, *solved, *solution; /* inner unknowns x MOST: B, C^T, K_mm^-1 B; n x 4 */
  size_t capacity[4];
  double S[MOST * MOST]; /* its LU factor, by rows */
  int exchange[MOST];
} framed;

/* ---- numbering ---- */

/* A member that stands at one end of the packing: the least of sign (x + y). */
static int member_at_end(const framed *s, const gh_solver_input *in, double sign) {
  int best = -1;
  for (int i = 0; i < s->base.members; i++) {
    const double *x = &s->frame->x[2 * i];
    if (in->rattler[i] || (in->held && in->held[i])) continue;
    if (best < 0 || sign * (x[0] + x[1]) < sign * (s->frame->x[2 * best] + s->frame->x[2 * best + 1]))
      best = i;
  }
  return best;
}

static gh_solver_input inner_input(const framed *s, const gh_solver_input *in) {
  gh_solver_input inner = *in;
  inner.held = s->held;
  inner.pin = false;
  return inner;
}

static gh_status frame_number(gh_context *ctx, gh_solver *base, const gh_solver_input *in) {
  framed *s = (framed *)base;
  s->far = -1;
  for (int i = 0; i < base->members; i++) s->held[i] = in->held ? in->held[i] : 0;
  if (!in->held) {
    const int near = member_at_end(s, in, 1);
    s->far = member_at_end(s, in, -1);
    if (near >= 0) s->held[near] = s->held[s->far] = 1;
    if (s->far == near) s->far = -1;
  }
  const gh_solver_input inner = inner_input(s, in);
  GH_TRY(gh_solver_number(ctx, s->inner, &inner));
  memcpy(base->unknown, s->inner->unknown, 3 * (size_t)base->members * sizeof(int));
  base->n = s->inner->n;
  for (int k = 0; k < 2 && s->far >= 0; k++) base->unknown[3 * s->far + k] = base->n++;
  s->rows = 2 * s->frame->rank;
  s->nb = s->rows + base->n - s->inner->n;
  double **const arrays[] = {&s->right, &s->left, &s->solved, &s->solution};
  for (int k = 0; k < 4; k++)
    GH_TRY(gh_grow(ctx, MOST * ((size_t)base->n + 1), sizeof(double), &s->capacity[k], arrays[k]));
  return gh_grow(ctx, 4 * ((size_t)base->n + 1), sizeof(double), &base->rhs_capacity, &base->rhs);
}

/* ---- the border ---- */

/* Row `row` and column `column` of the whole system get a value; inner ones are in K_mm already. */
static void border_add(framed *s, int row, int column, double value) {
  const int n = s->inner->n;
  if (row < n && column >= n) s->right[n * (column - n) + row] += value;
  else if (row >= n && column < n) s->left[n * (row - n) + column] += value;
  else if (row >= n) s->S[MOST * (row - n) + column - n] += value;
}

/* The stiffness of a contact in the unknowns of its ends (u_x, u_y, theta). */
static void contact_add(framed *s, const gh_solver_input *in, int c) {
  const gh_contact *q = &in->list->contacts[c];
  const int end[2] = {q->i, q->j};
  double d[9] = {q->h[0], q->h[1], 0, q->h[1], q->h[2], 0, 0, 0, 0};
  if (s->symmetric && (in->rattler[q->i] || in->rattler[q->j])) return;
  if (!s->symmetric) memcpy(d, in->list->friction[c].d, sizeof d);
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++)
      for (int h = 0; h < 3; h++)
        for (int k = 0; k < 3; k++) {
          const int row = s->base.unknown[3 * end[a] + h], column = s->base.unknown[3 * end[b] + k];
          const double left = h < 2 ? gh_end_sign(a) : in->radius[end[a]],
                       right = k < 2 ? gh_end_sign(b) : in->radius[end[b]];
          if (row >= 0 && column >= 0) border_add(s, row, column, left * d[3 * h + k] * right);
        }
}

static void border_fill(framed *s, const gh_solver_input *in, double shift) {
  const size_t n = (size_t)s->inner->n;
  double size = 0, area = 0;
  memset(s->right, 0, MOST * n * sizeof(double));
  memset(s->left, 0, MOST * n * sizeof(double));
  memset(s->S, 0, sizeof s->S);
  for (int c = 0; c < in->list->count; c++) {
    const gh_contact *q = &in->list->contacts[c];
    size = gh_max(size, q->h[0] + q->h[2]);
    if (q->i == s->far || q->j == s->far) contact_add(s, in, c);
  }
  for (int i = 0; i < 2 * s->base.members; i++) area = gh_max(area, fabs(s->frame->area[i]));
  s->scale = area > 0 ? size / area : 0;
  for (int k = 0; k < 2 && s->far >= 0; k++) s->S[(MOST + 1) * k] += shift;
  for (int i = 0; i < s->base.members; i++)
    for (int k = 0; k < s->rows; k++) {
      const int u = s->base.unknown[3 * i + k % 2], row = (int)n + s->nb - s->rows + k;
      const double *axis = s->frame->axes + k / 2 * 2, *a = &s->frame->area[2 * i];
      const double value = s->scale * (axis[0] * a[0] + axis[1] * a[1]);
      if (u < 0 || value == 0) continue;
      border_add(s, row, u, value);
      border_add(s, u, row, value);
    }
}

/* K_mm^-1 of the columns of the border, four at a time. */
static gh_status border_solve(gh_context *ctx, framed *s) {
  const size_t n = (size_t)s->inner->n;
  for (int first = 0; first < s->nb && n > 0; first += 4) {
    const size_t count = (size_t)(s->nb - first < 4 ? s->nb - first : 4);
    const double *X;
    memset(s->inner->rhs, 0, 4 * n * sizeof(double));
    memcpy(s->inner->rhs, s->right + n * (size_t)first, count * n * sizeof(double));
    GH_TRY(gh_solver_solve(ctx, s->inner, 4, &X));
    memcpy(s->solved + n * (size_t)first, X, count * n * sizeof(double));
  }
  return GH_OK;
}

/* ---- S ---- */

/* Number of negative eigenvalues of a symmetric matrix, by Jacobi's rotations; -1: one is zero to round-off. */
static int negative_eigenvalues(int n, const double *S) {
  double a[MOST][MOST], size = 0;
  int negative = 0;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) a[i][j] = 0.5 * (S[MOST * i + j] + S[MOST * j + i]);
  for (int sweep = 0; sweep < 30; sweep++)
    for (int p = 0; p < n; p++)
      for (int q = p + 1; q < n; q++) {
        if (a[p][q] == 0) continue;
        const double turn = 0.5 * atan2(2 * a[p][q], a[q][q] - a[p][p]), c = cos(turn), t = sin(turn);
        for (int k = 0; k < n; k++) {
          const double x = a[p][k], y = a[q][k];
          a[p][k] = c * x - t * y, a[q][k] = t * x + c * y;
        }
        for (int k = 0; k < n; k++) {
          const double x = a[k][p], y = a[k][q];
          a[k][p] = c * x - t * y, a[k][q] = t * x + c * y;
        }
      }
  for (int i = 0; i < n; i++) size = gh_max(size, fabs(a[i][i]));
  for (int i = 0; i < n; i++) {
    if (!(fabs(a[i][i]) > 1e-13 * size)) return -1;
    negative += a[i][i] < 0;
  }
  return negative;
}

static bool schur_factor(framed *s) {
  double *S = s->S, largest = 0;
  for (int i = 0; i < s->nb; i++)
    for (int j = 0; j < s->nb; j++) largest = gh_max(largest, fabs(S[MOST * i + j]));
  for (int c = 0; c < s->nb; c++) {
    int pivot = c;
    for (int r = c + 1; r < s->nb; r++)
      if (fabs(S[MOST * r + c]) > fabs(S[MOST * pivot + c])) pivot = r;
    if (!(fabs(S[MOST * pivot + c]) > 1e-14 * largest)) return false;
    s->exchange[c] = pivot;
    for (int k = 0; k < s->nb; k++) {
      const double x = S[MOST * c + k];
      S[MOST * c + k] = S[MOST * pivot + k], S[MOST * pivot + k] = x;
    }
    for (int r = c + 1; r < s->nb; r++) {
      S[MOST * r + c] /= S[MOST * c + c];
      for (int k = c + 1; k < s->nb; k++) S[MOST * r + k] -= S[MOST * r + c] * S[MOST * c + k];
    }
  }
  return true;
}

static void schur_solve(const framed *s, double *z) {
  for (int c = 0; c < s->nb; c++) {
    const double x = z[c];
    z[c] = z[s->exchange[c]], z[s->exchange[c]] = x;
  }
  for (int c = 0; c < s->nb; c++)
    for (int r = c + 1; r < s->nb; r++) z[r] -= s->S[MOST * r + c] * z[c];
  for (int c = s->nb - 1; c >= 0; c--) {
    z[c] /= s->S[(MOST + 1) * c];
    for (int r = 0; r < c; r++) z[r] -= s->S[MOST * r + c] * z[c];
  }
}

/* ---- factor and solution ---- */

static gh_status frame_factor(gh_context *ctx, gh_solver *base, const gh_solver_input *in, double shift,
                              bool *good) {
  framed *s = (framed *)base;
  const gh_solver_input inner = inner_input(s, in);
  const int n = s->inner->n;
  GH_TRY(gh_solver_factor(ctx, s->inner, &inner, shift, good));
  base->factorisations = s->inner->factorisations;
  base->analyses = s->inner->analyses;
  base->fallbacks = s->inner->fallbacks;
  base->negative = s->inner->negative;
  if (!*good) return GH_OK;
  border_fill(s, in, shift);
  GH_TRY(border_solve(ctx, s));
  for (int r = 0; r < s->nb; r++)
    for (int c = 0; c < s->nb; c++)
      for (int u = 0; u < n; u++) s->S[MOST * r + c] -= s->left[n * r + u] * s->solved[n * c + u];
  *good = !s->symmetric || negative_eigenvalues(s->nb, s->S) == s->rows;
  if (*good) *good = schur_factor(s);
  return GH_OK;
}

static gh_status frame_solve(gh_context *ctx, gh_solver *base, int ncol, const double **X) {
  framed *s = (framed *)base;
  const size_t n = (size_t)s->inner->n, all = (size_t)base->n;
  const double *inner = NULL;
  *X = s->solution;
  for (size_t k = 0; k < (size_t)ncol && n > 0; k++)
    memcpy(s->inner->rhs + n * k, base->rhs + all * k, n * sizeof(double));
  if (n > 0) GH_TRY(gh_solver_solve(ctx, s->inner, ncol, &inner));
  for (size_t k = 0; k < (size_t)ncol; k++) {
    double z[MOST] = {0}, *x = s->solution + all * k;
    if (n > 0) memcpy(x, inner + n * k, n * sizeof(double));
    for (size_t u = n; u < all; u++) z[u - n] = base->rhs[all * k + u];
    for (size_t r = 0; r < (size_t)s->nb; r++)
      for (size_t u = 0; u < n; u++) z[r] -= s->left[n * r + u] * x[u];
    schur_solve(s, z);
    for (size_t c = 0; c < (size_t)s->nb; c++)
      for (size_t u = 0; u < n; u++) x[u] -= s->solved[n * c + u] * z[c];
    for (size_t u = n; u < all; u++) x[u] = z[u - n];
  }
  if (!gh_finite(s->solution, all * (size_t)ncol))
    return gh_fail(ctx, GH_DIVERGED, "the solution with the stiffness of the packing is not finite");
  return GH_OK;
}

static void frame_release(gh_solver *base) {
  framed *s = (framed *)base;
  gh_solver_destroy(&s->inner);
  void *const arrays[] = {s->held, s->right, s->left, s->solved, s->solution};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
}

static const gh_solver_ops frame_ops = {.name = "blocks with a border",
                                        .number = frame_number,
                                        .factor = frame_factor,
                                        .solve = frame_solve,
                                        .release = frame_release};

gh_status gh_solver_frame(gh_context *ctx, int members, bool symmetric, const gh_rve_frame *frame,
                          gh_solver **solver) {
  framed *s;
  *solver = NULL;
  GH_TRY(gh_alloc(ctx, 1, sizeof *s, &s));
  *s = (framed){.base = {.ops = &frame_ops, .members = members}, .symmetric = symmetric, .frame = frame};
  gh_status status = gh_alloc(ctx, 3 * (size_t)members, sizeof(int), &s->base.unknown);
  if (status == GH_OK) status = gh_alloc(ctx, (size_t)members, 1, &s->held);
  if (status == GH_OK) status = gh_solver_block(ctx, members, symmetric, &s->inner);
  *solver = &s->base;
  if (status != GH_OK) gh_solver_destroy(solver);
  return status;
}
