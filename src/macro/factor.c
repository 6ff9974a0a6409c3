/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Factors of a sparse matrix: CHOLMOD for symmetric positive definite ones, UMFPACK for all, behind one
 * table. */
#include "macro/internal.h"

#include <cholmod.h>
#include <stdlib.h>
#include <string.h>
#include <umfpack.h>

/* Estimated reciprocal condition numbers below this are singular to round-off. */
static const double singular = 1e-15;

typedef struct factor_ops {
  char letter;
  gh_status (*update)(gh_factor *f, const gh_factor_matrix *K);
  gh_status (*solve)(gh_factor *f, const gh_factor_matrix *K, double *b, double *x);
} factor_ops;

struct gh_factor {
  gh_context *ctx;
  const factor_ops *ops; /* of the last update */
  cholmod_common common;
  cholmod_factor *L;
  void *symbolic, *numeric; /* of UMFPACK */
};

gh_status gh_factor_create(gh_context *ctx, gh_factor **factor) {
  GH_TRY(gh_alloc(ctx, 1, sizeof **factor, factor));
  gh_factor *f = *factor;
  f->ctx = ctx;
  cholmod_start(&f->common);
  f->common.print = 0;
  f->common.final_ll = 1; /* an LDL' of an indefinite matrix would pass unnoticed */
  return GH_OK;
}

void gh_factor_forget(gh_factor *f) {
  if (f->numeric) umfpack_di_free_numeric(&f->numeric);
  if (f->L) cholmod_free_factor(&f->L, &f->common);
  if (f->symbolic) umfpack_di_free_symbolic(&f->symbolic);
}

void gh_factor_destroy(gh_factor **factor) {
  if (!factor || !*factor) return;
  gh_factor_forget(*factor);
  cholmod_finish(&(*factor)->common);
  free(*factor);
  *factor = NULL;
}

char gh_factor_letter(const gh_factor *f) {
  return f->ops ? f->ops->letter : 0;
}

static gh_status factor_solve_cholmod(gh_factor *f, const gh_factor_matrix *K, double *b, double *x) {
  size_t n = (size_t)K->n;
  cholmod_dense B = {
      .nrow = n, .ncol = 1, .nzmax = n, .d = n, .x = b, .xtype = CHOLMOD_REAL, .dtype = CHOLMOD_DOUBLE};
  cholmod_dense *X = cholmod_solve(CHOLMOD_A, f->L, &B, &f->common);
  if (!X) return gh_fail(f->ctx, GH_MEMORY, "no memory to solve %zu equations", n);
  memcpy(x, X->x, n * sizeof *x);
  cholmod_free_dense(&X, &f->common);
  return GH_OK;
}

/* GH_DIVERGED without a message: not positive definite. */
static gh_status factor_update_cholmod(gh_factor *f, const gh_factor_matrix *K) {
  size_t n = (size_t)K->n;
  cholmod_common *common = &f->common;
  cholmod_sparse upper = {.nrow = n,
                          .ncol = n,
                          .nzmax = (size_t)K->p[n],
                          .p = K->p,
                          .i = K->i,
                          .x = K->x,
                          .stype = 1,
                          .itype = CHOLMOD_INT,
                          .xtype = CHOLMOD_REAL,
                          .dtype = CHOLMOD_DOUBLE,
                          .sorted = 1,
                          .packed = 1};
  if (!f->L) f->L = cholmod_analyze(&upper, common);
  if (!f->L) return gh_fail(f->ctx, GH_MEMORY, "no memory to analyse %zu equations", n);
  cholmod_factorize(&upper, f->L, common);
  if (common->status == CHOLMOD_OUT_OF_MEMORY)
    return gh_fail(f->ctx, GH_MEMORY, "no memory to factorise %zu equations", n);
  if (common->status != CHOLMOD_OK || f->L->minor < n || !(cholmod_rcond(f->L, common) > singular))
    return GH_DIVERGED;
  return GH_OK;
}

static gh_status umfpack_failure(gh_factor *f, const gh_factor_matrix *K, int code) {
  if (code == UMFPACK_ERROR_out_of_memory)
    return gh_fail(f->ctx, GH_MEMORY, "no memory for %d equations", K->n);
  if (code == UMFPACK_WARNING_singular_matrix)
    return gh_fail(f->ctx, GH_DIVERGED, "the stiffness matrix is singular");
  return gh_fail(f->ctx, GH_INTERNAL, "UMFPACK reports error %d", code);
}

static gh_status factor_solve_umfpack(gh_factor *f, const gh_factor_matrix *K, double *b, double *x) {
  double info[UMFPACK_INFO];
  int code = umfpack_di_solve(UMFPACK_A, K->p, K->i, K->x, x, b, f->numeric, NULL, info);
  return code == UMFPACK_OK ? GH_OK : umfpack_failure(f, K, code);
}

static gh_status factor_update_umfpack(gh_factor *f, const gh_factor_matrix *K) {
  double info[UMFPACK_INFO];
  int code =
      f->symbolic ? UMFPACK_OK : umfpack_di_symbolic(K->n, K->n, K->p, K->i, K->x, &f->symbolic, NULL, info);
  if (f->numeric) umfpack_di_free_numeric(&f->numeric);
  if (code == UMFPACK_OK) code = umfpack_di_numeric(K->p, K->i, K->x, f->symbolic, &f->numeric, NULL, info);
  if (code == UMFPACK_OK && !(info[UMFPACK_RCOND] > singular)) code = UMFPACK_WARNING_singular_matrix;
  return code == UMFPACK_OK ? GH_OK : umfpack_failure(f, K, code);
}

static const factor_ops methods[] = {
    [GH_FACTOR_CHOLMOD] = {'c', factor_update_cholmod, factor_solve_cholmod},
    [GH_FACTOR_UMFPACK] = {'u', factor_update_umfpack, factor_solve_umfpack},
};

gh_status gh_factor_update(gh_factor *f, gh_factor_method method, const gh_factor_matrix *K) {
  f->ops = &methods[method];
  return f->ops->update(f, K);
}

gh_status gh_factor_solve(gh_factor *f, const gh_factor_matrix *K, double *b, double *x) {
  return f->ops->solve(f, K, b, x);
}
