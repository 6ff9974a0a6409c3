/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The sparse system of the free degrees of freedom: CHOLMOD while it is symmetric and positive definite,
 * UMFPACK otherwise. */
#include "macro/internal.h"

#include <stdlib.h>
#include <string.h>

/* A matrix counts as symmetric up to this, relative to its largest entry: relaxed packings give tangents that
 * are symmetric to their residual, and what is dropped only slows Newton's iteration by that factor. */
static const double asymmetry = 1e-9;

/* A share of an entry of the whole matrix in the reduced one: at (row, col), times the rotation of the nodes
 * at turn_row and turn_col (degrees of freedom; -1: times 1). */
typedef struct share {
  int row, col, source, turn_row, turn_col, target;
} share;

struct gh_system {
  gh_context *ctx;
  int ndof, nfree;
  int *start, *row; /* compressed columns of the whole matrix, rows ascending */
  int *mirror;      /* where the transposed entry is */
  double *value;
  unsigned char *fixed;
  bool constrained;
  int nbodies;
  int *owner;                          /* nnodes: the rigid body of a node, -1 for none */
  double *turn;                        /* ndof: displacement for a unit rotation of the body */
  double *spring;                      /* of each body */
  int *free_start, *free_row, *source; /* the same of the free part, the bodies' three last; source: its
                                          entries in `value`, -1 where shares are added up */
  share *shares;
  int nshares;
  int *dof; /* of a free column: entry of b and x */
  double *free_value, *b, *x;
  gh_factor *factor;
};

static int int_compare(const void *p, const void *q) {
  return *(const int *)p - *(const int *)q;
}

/* Neighbours of each node (itself among them), ascending: CSR in first, list. */
static gh_status mesh_node_graph(gh_context *ctx, const gh_mesh *mesh, int **first, int **list) {
  GH_TRY(gh_alloc(ctx, (size_t)mesh->nnodes + 1, sizeof **first, first));
  int *f = *first;
  for (int e = 0; e < mesh->nelements; e++)
    for (int a = 0; a < 4; a++) f[mesh->quad[e][a] + 1] += 4;
  for (int a = 0; a < mesh->nnodes; a++) f[a + 1] += f[a];
  GH_TRY(gh_alloc(ctx, (size_t)f[mesh->nnodes], sizeof **list, list));
  for (int e = 0; e < mesh->nelements; e++)
    for (int a = 0; a < 4; a++)
      for (int b = 0; b < 4; b++) (*list)[f[mesh->quad[e][a]]++] = mesh->quad[e][b];
  int begin = 0, kept = 0; /* f[a] is now the end of a's run */
  for (int a = 0; a < mesh->nnodes; a++) {
    int end = f[a], run = kept;
    qsort(*list + begin, (size_t)(end - begin), sizeof **list, int_compare);
    for (int k = begin; k < end; k++)
      if (kept == run || (*list)[k] != (*list)[kept - 1]) (*list)[kept++] = (*list)[k];
    f[a] = run;
    begin = end;
  }
  f[mesh->nnodes] = kept;
  return GH_OK;
}

static int matrix_find_entry(const gh_system *s, int row, int col) {
  int low = s->start[col], high = s->start[col + 1] - 1;
  while (low < high) {
    int middle = (low + high) / 2;
    if (s->row[middle] < row) low = middle + 1;
    else high = middle;
  }
  return low;
}

static gh_status matrix_make_pattern(gh_system *s, const gh_mesh *mesh) {
  int *first = NULL, *list = NULL;
  gh_status status;
  GH_TRY_OR(mesh_node_graph(s->ctx, mesh, &first, &list), done);
  size_t entries = 4 * (size_t)first[mesh->nnodes];
  GH_TRY_OR(gh_alloc(s->ctx, (size_t)s->ndof + 1, sizeof *s->start, &s->start), done);
  GH_TRY_OR(gh_alloc(s->ctx, entries, sizeof *s->row, &s->row), done);
  GH_TRY_OR(gh_alloc(s->ctx, entries, sizeof *s->mirror, &s->mirror), done);
  GH_TRY_OR(gh_alloc(s->ctx, entries, sizeof *s->value, &s->value), done);
  int n = 0;
  for (int col = 0; col < s->ndof; col++) {
    s->start[col] = n;
    for (int k = first[col / 2]; k < first[col / 2 + 1]; k++)
      for (int i = 0; i < 2; i++) s->row[n++] = 2 * list[k] + i;
  }
  s->start[s->ndof] = n;
  for (int col = 0; col < s->ndof; col++)
    for (int k = s->start[col]; k < s->start[col + 1]; k++)
      s->mirror[k] = matrix_find_entry(s, col, s->row[k]);
done:
  free(first);
  free(list);
  return status;
}

gh_status gh_system_create(gh_context *ctx, const gh_mesh *mesh, gh_system **system) {
  GH_TRY(gh_alloc(ctx, 1, sizeof **system, system));
  gh_system *s = *system;
  s->ctx = ctx;
  s->ndof = 2 * mesh->nnodes;
  gh_status status;
  GH_TRY_OR(gh_factor_create(ctx, &s->factor), failed);
  GH_TRY_OR(matrix_make_pattern(s, mesh), failed);
  size_t n = (size_t)s->ndof;
  GH_TRY_OR(gh_alloc(ctx, n, sizeof *s->fixed, &s->fixed), failed);
  GH_TRY_OR(gh_alloc(ctx, n / 2, sizeof *s->owner, &s->owner), failed);
  GH_TRY_OR(gh_alloc(ctx, n, sizeof *s->turn, &s->turn), failed);
  GH_TRY_OR(gh_alloc(ctx, n, sizeof *s->spring, &s->spring), failed);
  GH_TRY_OR(gh_alloc(ctx, n + 1, sizeof *s->free_start, &s->free_start), failed);
  GH_TRY_OR(gh_alloc(ctx, n, sizeof *s->dof, &s->dof), failed);
  GH_TRY_OR(gh_alloc(ctx, n, sizeof *s->b, &s->b), failed);
  GH_TRY_OR(gh_alloc(ctx, n, sizeof *s->x, &s->x), failed);
  return GH_OK;
failed:
  gh_system_destroy(system);
  return status;
}

void gh_system_destroy(gh_system **system) {
  if (!system || !*system) return;
  gh_system *s = *system;
  gh_factor_destroy(&s->factor);
  free(s->start);
  free(s->row);
  free(s->mirror);
  free(s->value);
  free(s->fixed);
  free(s->owner);
  free(s->turn);
  free(s->spring);
  free(s->shares);
  free(s->free_start);
  free(s->free_row);
  free(s->source);
  free(s->dof);
  free(s->free_value);
  free(s->b);
  free(s->x);
  free(s);
  *system = NULL;
}

/* Unknowns that degree of freedom d depends on: none, itself, or a displacement and the rotation of its body.
 */
static int dof_unknowns(const gh_system *s, const int *place, int d, int unknown[2], int turn[2]) {
  int body = s->owner[d / 2], first = s->nfree - 3 * (s->nbodies - body);
  turn[0] = -1, turn[1] = d;
  if (body < 0) {
    unknown[0] = place[d];
    return s->fixed[d] ? 0 : 1;
  }
  unknown[0] = first + d % 2;
  unknown[1] = first + 2;
  return 2;
}

/* Counts the shares of all entries that touch a body, and writes them where `list` is given. */
static int shares_find(const gh_system *s, const int *place, share *list) {
  int n = 0;
  for (int c = 0; c < s->ndof; c++)
    for (int k = s->start[c]; k < s->start[c + 1]; k++) {
      int r = s->row[k], col[2], row[2], turn_col[2], turn_row[2];
      if (s->owner[c / 2] < 0 && s->owner[r / 2] < 0) continue;
      int cols = dof_unknowns(s, place, c, col, turn_col), rows = dof_unknowns(s, place, r, row, turn_row);
      for (int i = 0; i < cols; i++)
        for (int j = 0; j < rows; j++, n++)
          if (list) list[n] = (share){row[j], col[i], k, turn_row[j], turn_col[i], 0};
    }
  return n;
}

static int share_compare(const void *p, const void *q) {
  const share *a = p, *b = q;
  return a->col != b->col ? a->col - b->col : a->row != b->row ? a->row - b->row : a->source - b->source;
}

static gh_status shares_collect(gh_system *s, const int *place) {
  free(s->shares);
  s->shares = NULL;
  s->nshares = s->nbodies > 0 ? shares_find(s, place, NULL) : 0;
  if (s->nshares == 0) return GH_OK;
  GH_TRY(gh_alloc(s->ctx, (size_t)s->nshares, sizeof *s->shares, &s->shares));
  shares_find(s, place, s->shares);
  if (s->nshares > 0) qsort(s->shares, (size_t)s->nshares, sizeof *s->shares, share_compare);
  return GH_OK;
}

/* Rows of column c of the free part: those of its own degree of freedom, then those of bodies. */
static int free_part_fill_column(gh_system *s, const int *place, int c, int n, int *next) {
  int d = s->dof[c];
  for (int k = d < s->ndof ? s->start[d] : 0; d < s->ndof && k < s->start[d + 1]; k++) {
    int r = s->row[k];
    if (s->fixed[r] || s->owner[r / 2] >= 0) continue;
    s->free_row[n] = place[r];
    s->source[n++] = k;
  }
  for (int last = -1; *next < s->nshares && s->shares[*next].col == c; ++*next) {
    share *part = s->shares + *next;
    if (part->row != last) {
      s->free_row[n] = last = part->row;
      s->source[n++] = -1;
    }
    part->target = n - 1;
  }
  return n;
}

static gh_status free_part_make(gh_system *s, const int *place) {
  GH_TRY(shares_collect(s, place));
  size_t most = (size_t)s->start[s->ndof] + (size_t)s->nshares;
  free(s->free_row);
  free(s->source);
  free(s->free_value);
  s->free_row = s->source = NULL;
  s->free_value = NULL;
  GH_TRY(gh_alloc(s->ctx, most, sizeof *s->free_row, &s->free_row));
  GH_TRY(gh_alloc(s->ctx, most, sizeof *s->source, &s->source));
  GH_TRY(gh_alloc(s->ctx, most, sizeof *s->free_value, &s->free_value));
  int n = 0, next = 0;
  for (int c = 0; c < s->nfree; c++) {
    s->free_start[c] = n;
    n = free_part_fill_column(s, place, c, n, &next);
  }
  s->free_start[s->nfree] = n;
  return GH_OK;
}

gh_status gh_system_constrain(gh_system *s, const unsigned char *fixed, int n, const int *owner) {
  size_t nnodes = (size_t)s->ndof / 2;
  bool same = s->constrained && n == s->nbodies && memcmp(s->fixed, fixed, (size_t)s->ndof) == 0;
  gh_factor_forget(s->factor);
  if (same && (n == 0 || memcmp(s->owner, owner, nnodes * sizeof *owner) == 0)) return GH_OK;
  int *place = NULL;
  GH_TRY(gh_alloc(s->ctx, (size_t)s->ndof, sizeof *place, &place));
  s->constrained = false;
  memcpy(s->fixed, fixed, (size_t)s->ndof);
  for (size_t a = 0; a < nnodes; a++) s->owner[a] = n > 0 ? owner[a] : -1;
  s->nbodies = n;
  s->nfree = 0;
  for (int d = 0; d < s->ndof; d++) {
    place[d] = s->nfree;
    if (!fixed[d] && s->owner[d / 2] < 0) s->dof[s->nfree++] = d;
  }
  for (int k = 0; k < 3 * n; k++) s->dof[s->nfree++] = s->ndof + k;
  gh_status status = free_part_make(s, place);
  s->constrained = status == GH_OK;
  free(place);
  return status;
}

void gh_system_turn(gh_system *s, int node, const double turn[2]) {
  for (int i = 0; i < 2; i++) s->turn[2 * node + i] = turn[i];
}

void gh_system_spring(gh_system *s, int body, double spring) {
  s->spring[body] = spring;
}

void gh_system_clear(gh_system *s) {
  memset(s->value, 0, (size_t)s->start[s->ndof] * sizeof *s->value);
}

void gh_system_add(gh_system *s, int n, const int *dof, const double *K) {
  for (int c = 0; c < n; c++)
    for (int r = 0; r < n; r++) s->value[matrix_find_entry(s, dof[r], dof[c])] += K[r * n + c];
}

void gh_system_multiply(const gh_system *s, const double *x, double *y) {
  for (int c = 0; c < s->ndof; c++)
    for (int k = s->start[c]; k < s->start[c + 1]; k++) y[s->row[k]] += s->value[k] * x[c];
}

double gh_system_diagonal(const gh_system *s) {
  gh_squares entries = {0};
  for (int d = 0; d < s->ndof; d++) gh_squares_add(&entries, s->value[matrix_find_entry(s, d, d)]);
  return gh_squares_root(&entries);
}

char gh_system_method(const gh_system *s) {
  return gh_factor_letter(s->factor);
}

/* Factorises the free part and solves. */
static gh_status system_solve_by(gh_system *s, gh_factor_method method) {
  const gh_factor_matrix K = {s->nfree, s->free_start, s->free_row, s->free_value};
  GH_TRY(gh_factor_update(s->factor, method, &K));
  return gh_factor_solve(s->factor, &K, s->b, s->x);
}

static bool matrix_is_symmetric(const gh_system *s) {
  double largest = 0, difference = 0;
  for (int k = 0; k < s->free_start[s->nfree] + s->nshares; k++) {
    int end = s->free_start[s->nfree], source = k < end ? s->source[k] : s->shares[k - end].source;
    if (source < 0) continue;
    largest = gh_max(largest, fabs(s->value[source]));
    difference = gh_max(difference, fabs(s->value[source] - s->value[s->mirror[source]]));
  }
  return difference <= asymmetry * largest;
}

static double matrix_entry(const gh_system *s, int k, bool symmetric) {
  return symmetric ? 0.5 * (s->value[k] + s->value[s->mirror[k]]) : s->value[k];
}

/* The free part and its right-hand side. `symmetric`: of the symmetric part, which a descent needs; what
 * friction adds against it is left out there. */
static void free_part_assemble(gh_system *s, const double *b, bool symmetric) {
  for (int k = 0; k < s->free_start[s->nfree]; k++)
    s->free_value[k] = s->source[k] < 0 ? 0 : matrix_entry(s, s->source[k], symmetric);
  for (int k = 0; k < s->nshares; k++) {
    const share *part = s->shares + k;
    double factor = (part->turn_row < 0 ? 1 : s->turn[part->turn_row]) *
                    (part->turn_col < 0 ? 1 : s->turn[part->turn_col]);
    s->free_value[part->target] += factor * matrix_entry(s, part->source, symmetric);
  }
  for (int k = 0; k < s->nbodies; k++) {
    int c = s->nfree - 3 * (s->nbodies - k) + 2, at = s->free_start[c];
    while (s->free_row[at] != c) at++;
    s->free_value[at] += s->spring[k];
  }
  for (int c = 0; c < s->nfree; c++) s->b[c] = b[s->dof[c]];
}

static void free_part_shift(gh_system *s, double shift) {
  for (int c = 0; c < s->nfree; c++)
    for (int k = s->free_start[c]; k < s->free_start[c + 1]; k++)
      if (s->free_row[k] == c) s->free_value[k] += shift;
}

/* The solution in s->x to where it belongs. */
static gh_status solution_scatter(gh_system *s, double *x) {
  if (!gh_finite(s->x, (size_t)s->nfree))
    return gh_fail(
        s->ctx, GH_DIVERGED,
        "the displacements that the stiffness matrix gives are not finite: it is nearly singular, or "
        "the loads are too large for it");
  for (int c = 0; c < s->nfree; c++) x[s->dof[c]] = s->x[c];
  return GH_OK;
}

gh_status gh_system_descend(gh_system *s, const double *b, double *x) {
  enum { SHIFTS = 40 };
  if (s->nfree == 0) return GH_OK;
  double added = 0, shift = 0, first = 1e-3 * gh_system_diagonal(s) / sqrt((double)s->ndof);
  free_part_assemble(s, b, true);
  for (int k = 0; k < SHIFTS; k++) {
    free_part_shift(s, shift - added);
    added = shift;
    gh_status status = system_solve_by(s, GH_FACTOR_CHOLMOD);
    if (status == GH_OK) return solution_scatter(s, x);
    if (status != GH_DIVERGED) return status;
    shift = shift > 0 ? 3 * shift : first;
  }
  return gh_fail(s->ctx, GH_DIVERGED, "the stiffness matrix is singular");
}

gh_status gh_system_solve(gh_system *s, const double *b, double *x) {
  if (s->nfree == 0) return GH_OK;
  free_part_assemble(s, b, false);
  gh_status status = GH_DIVERGED;
  if (matrix_is_symmetric(s)) status = system_solve_by(s, GH_FACTOR_CHOLMOD);
  if (status == GH_DIVERGED) status = system_solve_by(s, GH_FACTOR_UMFPACK);
  GH_TRY(status);
  return solution_scatter(s, x);
}

gh_status gh_system_again(gh_system *s, const double *b, double *x) {
  if (s->nfree == 0) return GH_OK;
  for (int c = 0; c < s->nfree; c++) s->b[c] = b[s->dof[c]];
  const gh_factor_matrix K = {s->nfree, s->free_start, s->free_row, s->free_value};
  GH_TRY(gh_factor_solve(s->factor, &K, s->b, s->x));
  return solution_scatter(s, x);
}
