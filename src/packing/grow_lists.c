/* Growth: the cell, the grids of hulls and the lists of neighbours. SPDX-License-Identifier: GPL-2.0-or-later
 */
#include "packing/grow.h"

#include <stdlib.h>
#include <string.h>

enum { FIRST = DIM == 2 ? 12 : 24 }; /* entries that each list has room for from the start */
static const double THIN = 0.003;    /* thinnest shell over the radius at volume fraction 1 */

/* ---- the cell ---- */

static void fill_box(box *b) {
  memset(b->inverse, 0, sizeof b->inverse);
  for (int c = 0; c < DIM; c++) /* upper triangular: back substitution */
    for (int r = c; r >= 0; r--) {
      double sum = r == c;
      for (int k = r + 1; k <= c; k++) sum -= b->cell[r][k] * b->inverse[k][c];
      b->inverse[r][c] = sum / b->cell[r][r];
    }
  for (int r = 0; r < DIM; r++) b->height[r] = 1 / sqrt(dot(b->inverse[r], b->inverse[r]));
  for (int m = 0; m < IMAGES; m++)
    for (int r = 0; r < DIM; r++) {
      b->shift[m][r] = 0;
      for (int c = 0, rest = m; c < DIM; c++, rest /= SPAN)
        b->shift[m][r] += b->cell[r][c] * (rest % SPAN - FAR);
    }
}

void growth_box_fit2(const double *shape, box *b) {
  double volume = 1;
  memcpy(b->cell, shape, sizeof b->cell);
  for (int k = 0; k < DIM; k++) volume *= b->cell[k][k];
  double scale = pow(volume, -1.0 / DIM);
  for (int r = 0; r < DIM; r++)
    for (int c = 0; c < DIM; c++) b->cell[r][c] *= scale;
  for (int c = 1; c < DIM;
       c++) /* multiples of earlier lattice vectors taken off leave the lattice as it is */
    for (int r = c - 1; r >= 0; r--) {
      double times = nearbyint(b->cell[r][c] / b->cell[r][r]);
      for (int k = 0; k <= r; k++) b->cell[k][c] -= times * b->cell[k][r];
    }
  fill_box(b);
}

static void lattice_coordinates(const box *b, const double *x, double *s) {
  for (int k = 0; k < DIM; k++) s[k] = dot(b->inverse[k], x);
}

static void wrap(const box *b, double *x) {
  double s[DIM];
  lattice_coordinates(b, x, s);
  for (int c = 0; c < DIM; c++) {
    double times = floor(s[c]);
    if (times != 0)
      for (int k = 0; k <= c; k++) x[k] -= times * b->cell[k][c];
  }
}

/* ---- creation ---- */

/* Grids for the sizes that occur, from the largest down. */
static gh_status make_levels(growth *g) {
  double a_max = 0;
  for (int i = 0; i < g->n; i++) a_max = fmax(a_max, g->grain[i].a);
  int used[MAX_LEVELS], count[MAX_LEVELS] = {0};
  for (int i = 0; i < g->n; i++) {
    int k = (int)floor(log2(a_max / g->grain[i].a));
    g->in_level[i] = k < MAX_LEVELS ? k : MAX_LEVELS - 1;
    count[g->in_level[i]]++;
  }
  for (int k = 0; k < MAX_LEVELS; k++) {
    if (!count[k]) continue;
    level *l = &g->level[used[k] = g->levels++];
    size_t cells = 1;
    l->a_max = ldexp(a_max, -k);
    /* not much more cells than grains, however small these are */
    double width = fmax(1.2 * l->a_max, pow(4.0 * count[k] + 1000, -1.0 / DIM));
    for (int d = 0; d < DIM; d++) {
      l->m[d] = (int)fmin(fmax(1, floor(g->box.height[d] / width)), 1 << 10);
      cells *= (size_t)l->m[d];
    }
    GH_TRY(gh_alloc(g->ctx, cells, sizeof(int), &l->head));
    memset(l->head, -1, cells * sizeof(int));
  }
  for (int i = 0; i < g->n; i++) g->in_level[i] = used[g->in_level[i]];
  return GH_OK;
}

static gh_status make_arrays(gh_context *ctx, growth *g) {
  size_t n = (size_t)g->n;
  g->queue.n = g->n;
  g->grain = aligned_alloc(_Alignof(grain), n * sizeof *g->grain);
  if (!g->grain) return gh_fail(ctx, GH_MEMORY, "no memory for %zu grains", n);
  memset(g->grain, 0, n * sizeof *g->grain);
  GH_TRY(gh_alloc(ctx, n, sizeof *g->list, &g->list));
  GH_TRY(gh_alloc(ctx, n, sizeof *g->hull, &g->hull));
  GH_TRY(gh_alloc(ctx, n * FIRST, sizeof *g->entries, &g->entries));
  for (size_t i = 0; i < n; i++) {
    g->list[i].entry = g->entries + i * FIRST;
    g->list[i].capacity = FIRST;
  }
  GH_TRY(gh_alloc(ctx, n, sizeof *g->event, &g->event));
  GH_TRY(gh_alloc(ctx, n, sizeof *g->when, &g->when));
  GH_TRY(gh_alloc(ctx, n, sizeof *g->queue.slot, &g->queue.slot));
  GH_TRY(gh_alloc(ctx, n, sizeof *g->queue.place, &g->queue.place));
  GH_TRY(gh_alloc(ctx, n, sizeof(int), &g->id));
  GH_TRY(gh_alloc(ctx, n, sizeof(int), &g->in_level));
  GH_TRY(gh_alloc(ctx, n, sizeof(int), &g->in_cell));
  GH_TRY(gh_alloc(ctx, n, sizeof(int), &g->next));
  return gh_alloc(ctx, n, sizeof(int), &g->previous);
}

gh_status growth_create2(gh_context *ctx, int n, const double *diameter, growth **out) {
  growth *g;
  *out = NULL;
  GH_TRY(gh_alloc(ctx, 1, sizeof *g, &g));
  g->ctx = ctx, g->n = n;
  gh_status status = make_arrays(ctx, g);
  if (status != GH_OK) {
    growth_destroy2(&g);
    return status;
  }
  const double pi = 3.14159265358979323846;
  double volume = 0, largest = 0;
  for (int i = 0; i < n; i++) largest = fmax(largest, diameter[i]);
  for (int i = 0; i < n; i++) {
    double a = g->grain[i].a = diameter[i] / largest;
    volume += DIM == 2 ? pi * a * a : 4 * pi / 3 * a * a * a;
    g->id[i] = i;
    g->in_cell[i] = -1;
    g->list[i].shell = pow(n, -1.0 / DIM) / 2;
  }
  for (int i = 0; i < n; i++) g->grain[i].a *= pow(volume, -1.0 / DIM);
  *out = g;
  return GH_OK;
}

void growth_destroy2(growth **out) {
  growth *g = *out;
  if (!g) return;
  for (int i = 0; g->list && i < g->n; i++)
    if (g->list[i].capacity > FIRST) free(g->list[i].entry);
  free(g->entries);
  for (int k = 0; k < g->levels; k++) free(g->level[k].head);
  free(g->grain), free(g->list), free(g->hull), free(g->event), free(g->when), free(g->queue.slot),
      free(g->queue.place);
  free(g->id), free(g->in_level), free(g->in_cell), free(g->next), free(g->previous);
  free(g);
  *out = NULL;
}

/* ---- cells ---- */

static int cell_of(const growth *g, const level *l, const double *x) {
  double s[DIM];
  int c = 0;
  lattice_coordinates(&g->box, x, s);
  for (int k = DIM - 1; k >= 0; k--) {
    int p = (int)(s[k] * l->m[k]); /* s may be 1 or below 0 by round-off */
    c = c * l->m[k] + (p < 0 ? 0 : p < l->m[k] ? p : l->m[k] - 1);
  }
  return c;
}

static void settle(growth *g, int i) {
  level *l = &g->level[g->in_level[i]];
  int c = cell_of(g, l, g->hull[i].home);
  l->reach = fmax(l->reach, g->hull[i].reach);
  if (c == g->in_cell[i]) return;
  int before = g->previous[i], after = g->next[i];
  if (g->in_cell[i] >= 0) {
    if (before >= 0) g->next[before] = after;
    else l->head[g->in_cell[i]] = after;
    if (after >= 0) g->previous[after] = before;
  }
  g->in_cell[i] = c;
  g->previous[i] = -1;
  g->next[i] = l->head[c];
  if (l->head[c] >= 0) g->previous[l->head[c]] = i;
  l->head[c] = i;
}

/* ---- lists ---- */

static void forget(growth *g, int i) {
  list *a = &g->list[i];
  for (int k = 0; k < a->n; k++) {
    list *b = &g->list[a->entry[k].j];
    int hole = a->entry[k].back;
    neighbour moved = b->entry[--b->n];
    b->entry[hole] = moved;
    if (hole < b->n) g->list[moved.j].entry[moved.back].back = hole;
  }
  a->n = 0;
}

/* Room for one more entry. The first entries of all lists lie in one block, in the order of the grains. */
static gh_status make_room(growth *g, list *a) {
  neighbour *entry = a->entry;
  if (a->n < a->capacity) return GH_OK;
  int capacity = 2 * a->capacity;
  if (a->capacity == FIRST) {
    GH_TRY(gh_alloc(g->ctx, (size_t)capacity, sizeof *entry, &entry));
    memcpy(entry, a->entry, FIRST * sizeof *entry);
  } else {
    entry = realloc(entry, (size_t)capacity * sizeof *entry);
    if (!entry) return gh_fail(g->ctx, GH_MEMORY, "no memory for a list of %d neighbours", capacity);
  }
  a->entry = entry;
  a->capacity = capacity;
  return GH_OK;
}

static gh_status join(growth *g, int i, int j, int image) {
  list *a = &g->list[i], *b = &g->list[j];
  GH_TRY(make_room(g, a));
  GH_TRY(make_room(g, b));
  a->entry[a->n] = (neighbour){j, image, b->n};
  b->entry[b->n++] = (neighbour){i, IMAGES - 1 - image, a->n++};
  return GH_OK;
}

/* Joins i with those of a cell's grains, shifted by an image, whose hulls meet its own. */
static gh_status join_cell(growth *g, int i, int first, int image) {
  const hull a = g->hull[i];
  for (int j = first; j >= 0; j = g->next[j]) {
    const hull *b = &g->hull[j];
    double l[DIM], reach = a.reach + b->reach;
    if (j == i) continue;
    for (int k = 0; k < DIM; k++) l[k] = b->home[k] + g->box.shift[image][k] - a.home[k];
    if (dot(l, l) < reach * reach) GH_TRY(join(g, i, j, image));
  }
  return GH_OK;
}

static int floor_div(int a, int b) {
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

/* All cells of a level within the reach of i's hull and those of the level; cells beyond the faces are
 * images. */
static gh_status search(growth *g, int i, const level *l) {
  double s[DIM];
  int low[DIM], high[DIM], c[DIM];
  lattice_coordinates(&g->box, g->hull[i].home, s);
  for (int k = 0; k < DIM; k++) {
    double reach = (g->hull[i].reach + l->reach) / g->box.height[k] + 1e-9;
    low[k] = c[k] = (int)fmax(floor((s[k] - reach) * l->m[k]), -FAR * l->m[k]);
    high[k] = (int)fmin(floor((s[k] + reach) * l->m[k]), (FAR + 1) * l->m[k] - 1);
  }
  for (int k = 0; k < DIM;) {
    int at = 0, image = 0;
    for (int d = DIM - 1; d >= 0; d--) {
      int shift = floor_div(c[d], l->m[d]);
      at = at * l->m[d] + c[d] - shift * l->m[d];
      image = image * SPAN + shift + FAR;
    }
    if (l->head[at] >= 0) GH_TRY(join_cell(g, i, l->head[at], image));
    for (k = 0; k < DIM && ++c[k] > high[k]; k++) c[k] = low[k];
  }
  return GH_OK;
}

/* The shell is best when making lists costs about as much as looking through them. At most half the mean
 * spacing: beyond, a list grows faster than the time it lasts. */
static void adapt(growth *g, int i, double r) {
  list *a = &g->list[i];
  double cost = growth_list_cost(a), thickest = pow(g->n, -1.0 / DIM) / 2;
  if (a->work < cost / 2) a->shell *= 1.3;
  else if (a->work > 2 * cost) a->shell *= 0.75;
  a->shell = fmin(fmax(a->shell, THIN * g->grain[i].a), thickest);
  a->work = 0;
  g->hull[i].reach = r + a->shell;
}

gh_status growth_list2(growth *g, int i) {
  adapt(g, i, g->grain[i].a * (g->s0 + g->rate * g->now));
  forget(g, i);
  wrap(&g->box, g->grain[i].x);
  memcpy(g->hull[i].home, g->grain[i].x, sizeof g->hull[i].home);
  settle(g, i);
  for (int k = 0; k < g->levels; k++) GH_TRY(search(g, i, &g->level[k]));
  return GH_OK;
}

gh_status growth_list_all2(growth *g) {
  if (!g->levels) GH_TRY(make_levels(g));
  for (int i = 0; i < g->n; i++) GH_TRY(growth_list2(g, i));
  return GH_OK;
}

/* ---- order ---- */

typedef struct keyed {
  unsigned long long key;
  int i;
} keyed;

static int by_key(const void *a, const void *b) {
  const keyed *p = a, *q = b;
  return p->key != q->key ? (p->key > q->key) - (p->key < q->key) : (p->i > q->i) - (p->i < q->i);
}

/* Morton's curve: the bits of the lattice coordinates in turn. */
static unsigned long long morton(const box *b, const double *x) {
  enum { BITS = 16 };
  unsigned long long key = 0;
  double s[DIM];
  lattice_coordinates(b, x, s);
  for (int bit = BITS - 1; bit >= 0; bit--)
    for (int k = 0; k < DIM; k++)
      key = key << 1 | (((unsigned)(fmin(fmax(s[k], 0), 1) * ((1 << BITS) - 1)) >> bit) & 1);
  return key;
}

static void clear_grids(growth *g) {
  for (int i = 0; i < g->n; i++) {
    g->list[i].n = 0;
    g->in_cell[i] = -1;
  }
  for (int k = 0; k < g->levels; k++) {
    size_t cells = 1;
    for (int d = 0; d < DIM; d++) cells *= (size_t)g->level[k].m[d];
    memset(g->level[k].head, -1, cells * sizeof(int));
  }
}

gh_status growth_order2(growth *g) {
  struct moved {
    grain p;
    double shell;
    int id, level;
  } * copy;
  size_t n = (size_t)g->n;
  keyed *order;
  if (!g->levels) GH_TRY(make_levels(g));
  copy = aligned_alloc(_Alignof(struct moved), n * sizeof *copy);
  if (!copy) return gh_fail(g->ctx, GH_MEMORY, "no memory to order %zu grains", n);
  gh_status status;
  GH_TRY_OR(gh_alloc(g->ctx, n, sizeof *order, &order), done);
  for (int i = 0; i < g->n; i++) {
    wrap(&g->box, g->grain[i].x);
    order[i] = (keyed){morton(&g->box, g->grain[i].x), i};
    copy[i] = (struct moved){g->grain[i], g->list[i].shell, g->id[i], g->in_level[i]};
  }
  qsort(order, n, sizeof *order, by_key);
  for (int i = 0; i < g->n; i++) {
    const struct moved *from = &copy[order[i].i];
    g->grain[i] = from->p;
    g->list[i].shell = from->shell;
    g->id[i] = from->id;
    g->in_level[i] = from->level;
  }
  free(order);
  clear_grids(g);
  status = growth_list_all2(g);
done:
  free(copy);
  return status;
}
