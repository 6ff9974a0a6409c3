/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Order of elimination of a graph of blocks, by AMD of SuiteSparse, and the pattern of its factor. */
#include "micro/block.h"

#include <amd.h>
#include <stdlib.h>
#include <string.h>

bool gh_block_pattern_is_of(const gh_block_pattern *p, const gh_block_graph *graph) {
  return p->made && p->n == graph->n && p->npairs == graph->npairs &&
         (p->npairs == 0 || !memcmp(p->pairs, graph->pairs, 2 * p->npairs * sizeof(int)));
}

void gh_block_pattern_release(gh_block_pattern *p) {
  void *const arrays[] = {p->pairs,  p->place,  p->a_first, p->a_row,  p->a_slot, p->first, p->row,
                          p->across, p->column, p->entry,   p->joined, p->parent, p->mark,  p->work};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  *p = (gh_block_pattern){0};
}

/* Several arrays of one capacity grow together: the capacity counts only once all have grown. */
static gh_status arrays_grow(gh_context *ctx, int **const *arrays, int count, const int *width, size_t need,
                             size_t *capacity) {
  if (need <= *capacity) return GH_OK;
  size_t grown = 0;
  for (int k = 0; k < count; k++) {
    size_t have = *capacity * (size_t)width[k];
    GH_TRY(gh_grow(ctx, (need + need / 4) * (size_t)width[k], sizeof(int), &have, arrays[k]));
  }
  grown = need + need / 4;
  *capacity = grown;
  return GH_OK;
}

static gh_status pattern_reserve(gh_context *ctx, gh_block_pattern *p, const gh_block_graph *graph) {
  int **const of_blocks[] = {&p->place, &p->a_first, &p->first, &p->across, &p->parent, &p->mark};
  int **const of_pairs[] = {&p->pairs, &p->a_row, &p->a_slot};
  static const int once[] = {1, 1, 1, 1, 1, 1}, twice[] = {2, 2, 2};
  const size_t n = (size_t)graph->n, blocks = p->n_capacity;
  GH_TRY(arrays_grow(ctx, of_blocks, 6, once, n + 2, &p->n_capacity));
  if (p->n_capacity > blocks || !p->joined) {
    size_t have = 0;
    free(p->joined);
    p->joined = NULL;
    GH_TRY(gh_grow(ctx, p->n_capacity, 1, &have, &p->joined));
  }
  GH_TRY(arrays_grow(ctx, of_pairs, 3, twice, graph->npairs + 1, &p->pairs_capacity));
  /* AMD: the graph with room to move it, and nine arrays of one number per block. */
  return gh_grow(ctx, 2 * graph->npairs + graph->npairs / 2 + 10 * n + 16, sizeof(int), &p->work_capacity,
                 &p->work);
}

/* place[b] of each block. AMD's own routine, without its copies of a graph that is symmetric and sorted. */
static void pattern_order(gh_block_pattern *p) {
  const int n = p->n;
  int *array[9], *next = p->work;
  double control[AMD_CONTROL], info[AMD_INFO];
  for (int k = 0; k < 9; k++) array[k] = next, next += n;
  int *start = array[0], *length = array[1], *graph = next;
  const size_t room = 2 * p->npairs + p->npairs / 2 + (size_t)n;
  memset(length, 0, (size_t)n * sizeof(int));
  for (size_t q = 0; q < 2 * p->npairs; q++) length[p->pairs[q]]++;
  for (int b = 0, sum = 0; b < n; b++) start[b] = sum, sum += length[b];
  for (size_t q = 0; q < p->npairs; q++) {
    int i = p->pairs[2 * q], j = p->pairs[2 * q + 1];
    graph[start[i]++] = j;
    graph[start[j]++] = i;
  }
  for (int b = 0; b < n; b++) start[b] -= length[b];
  amd_defaults(control);
  amd_2(n, start, graph, length, (int)room, (int)(2 * p->npairs), array[2], array[3], array[4], array[5],
        array[6], array[7], array[8], control, info);
  memcpy(p->place, array[3], (size_t)n * sizeof(int)); /* the inverse of the order */
}

/* Neighbours of each place, and where the two blocks of each pair are. */
static void pattern_of_matrix(gh_block_pattern *p) {
  int *first = p->a_first, n = p->n;
  memset(first, 0, ((size_t)n + 2) * sizeof(int));
  for (size_t q = 0; q < 2 * p->npairs; q++) first[p->place[p->pairs[q]] + 2]++;
  for (int k = 0; k < n; k++) first[k + 2] += first[k + 1];
  for (size_t q = 0; q < p->npairs; q++) {
    int i = p->place[p->pairs[2 * q]], j = p->place[p->pairs[2 * q + 1]];
    p->a_slot[2 * q] = first[j + 1]++;
    p->a_slot[2 * q + 1] = first[i + 1]++;
    p->a_row[p->a_slot[2 * q]] = i;
    p->a_row[p->a_slot[2 * q + 1]] = j;
  }
}

/* The columns of each row of L, in no order, by the elimination tree: from each neighbour up the tree to the
 * row. p->first[k + 1] counts the rows of column k. */
static gh_status rows_find(gh_context *ctx, gh_block_pattern *p) {
  int **const of_factor[] = {&p->row, &p->column, &p->entry};
  static const int once[] = {1, 1, 1};
  int count = 0;
  memset(p->first, 0, ((size_t)p->n + 2) * sizeof(int));
  for (int j = 0; j < p->n; j++) {
    GH_TRY(arrays_grow(ctx, of_factor, 3, once, (size_t)count + (size_t)j + 1, &p->factor_capacity));
    p->across[j] = count;
    p->parent[j] = -1;
    p->mark[j] = j;
    for (int a = p->a_first[j]; a < p->a_first[j + 1]; a++)
      for (int k = p->a_row[a]; k < j && p->mark[k] != j; k = p->parent[k]) {
        if (p->parent[k] < 0) p->parent[k] = j;
        p->mark[k] = j;
        p->column[count++] = k;
        p->first[k + 1]++;
      }
  }
  p->across[p->n] = count;
  return GH_OK;
}

/* Two transpositions sort both ways: rows of columns, then columns of rows. */
static void factor_sort(gh_block_pattern *p) {
  int n = p->n, *next = p->mark;
  for (int k = 0; k < n; k++) p->first[k + 1] += p->first[k];
  memcpy(next, p->first, (size_t)n * sizeof(int));
  for (int j = 0; j < n; j++)
    for (int q = p->across[j]; q < p->across[j + 1]; q++) p->row[next[p->column[q]]++] = j;
  memcpy(next, p->across, (size_t)n * sizeof(int));
  for (int k = 0; k < n; k++) {
    int height = p->first[k + 1] - p->first[k];
    p->joined[k] = k > 0 && p->parent[k - 1] == k && p->first[k] - p->first[k - 1] == height + 1;
    for (int e = p->first[k]; e < p->first[k + 1]; e++) {
      int q = next[p->row[e]]++;
      p->column[q] = k;
      p->entry[q] = e;
    }
  }
}

gh_status gh_block_pattern_make(gh_context *ctx, gh_block_pattern *p, const gh_block_graph *graph) {
  p->made = false;
  GH_TRY(pattern_reserve(ctx, p, graph));
  p->n = graph->n;
  p->npairs = graph->npairs;
  if (p->npairs > 0) memcpy(p->pairs, graph->pairs, 2 * p->npairs * sizeof(int));
  pattern_order(p);
  pattern_of_matrix(p);
  GH_TRY(rows_find(ctx, p));
  factor_sort(p);
  p->made = true;
  return GH_OK;
}
