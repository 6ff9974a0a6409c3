/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Growth: the cell, the grids of hulls and the lists of neighbours. */
#include "packing/grow.h"
#include "packing/large.h"

#include <stdlib.h>
#include <string.h>

enum { FIRST = DIM == 2 ? 16 : 32, TOP = 3 }; /* entries that each list has room for from the start */
static const double THIN = 0.003;             /* thinnest shell over the radius at volume fraction 1 */

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
    double width = fmax(1.2 * l->a_max, pow(1.0 * count[k] + 1000, -1.0 / DIM));
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

/* The next `bytes` of a block, from a cache line on; NULL when only their size is wanted. */
static void *part(char *block, size_t *at, size_t bytes) {
  void *p = block ? block + *at : NULL;
  *at += (bytes + 63) / 64 * 64;
  return p;
}

/* Places the arrays in a block; returns its size. */
static size_t lay_out(growth *g, char *block, neighbour **entries) {
  size_t n = (size_t)g->n, at = 0;
  g->grain = part(block, &at, n * sizeof *g->grain);
  *entries = part(block, &at, n * FIRST * sizeof **entries);
  g->list = part(block, &at, n * sizeof *g->list);
  g->hull = part(block, &at, n * sizeof *g->hull);
  g->event = part(block, &at, n * sizeof *g->event);
  g->queue.slot = part(block, &at, (n + TOP) * sizeof *g->queue.slot);
  if (block) g->queue.slot += TOP; /* then four children share a cache line */
  int **integers[] = {&g->queue.place, &g->id, &g->in_level, &g->in_cell, &g->next, &g->previous};
  for (size_t k = 0; k < sizeof integers / sizeof *integers; k++)
    *integers[k] = part(block, &at, n * sizeof(int));
  return at;
}

static gh_status make_arrays(gh_context *ctx, growth *g) {
  neighbour *entries;
  size_t bytes = lay_out(g, NULL, &entries);
  GH_TRY(packing_large(ctx, bytes, &g->memory));
  (void)lay_out(g, g->memory, &entries);
  for (int i = 0; i < g->n; i++) {
    g->list[i].entry = entries + (size_t)i * FIRST;
    g->list[i].capacity = FIRST;
  }
  g->queue.n = g->n;
  for (int k = 0; k < 3; k++) g->queue.risen[k] = -1;
  return GH_OK;
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
  double volume = 0, largest = 0;
  for (int i = 0; i < n; i++) largest = fmax(largest, diameter[i]);
  for (int i = 0; i < n; i++) {
    double a = g->grain[i].a = diameter[i] / largest;
    volume += DIM == 2 ? GH_PI * a * a : 4 * GH_PI / 3 * a * a * a;
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
  for (int k = 0; k < g->levels; k++) free(g->level[k].head);
  free(g->memory);
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

/* Each step of the way to a far entry is fetched for all neighbours before the next one is taken. */
static void forget(growth *g, int i) {
  list *a = &g->list[i];
  for (int k = 0; k < a->n; k++) __builtin_prefetch(&g->list[a->entry[k].j]);
  for (int k = 0; k < a->n; k++) {
    const list *b = &g->list[a->entry[k].j];
    __builtin_prefetch(&b->entry[a->entry[k].back]);
    __builtin_prefetch(&b->entry[b->n - 1]);
  }
  for (int k = 0; k < a->n; k++) {
    const list *b = &g->list[a->entry[k].j];
    __builtin_prefetch(&g->list[b->entry[b->n - 1].j]);
  }
  for (int k = 0; k < a->n; k++) {
    list *b = &g->list[a->entry[k].j];
    int hole = (int)a->entry[k].back;
    neighbour moved = b->entry[--b->n];
    b->entry[hole] = moved;
    if (hole < b->n) g->list[moved.j].entry[moved.back].back = (unsigned)hole;
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
  a->entry[a->n] = (neighbour){j, (unsigned)image, (unsigned)b->n};
  b->entry[b->n++] = (neighbour){i, (unsigned)(IMAGES - 1 - image), (unsigned)a->n++};
  return GH_OK;
}

enum { MANY = 64 };
/* Grains on the way to a list: the memory of many is fetched before the first is looked at. */
typedef struct found {
  int n;
  struct {
    int i, image;
  } of[MANY];
} found;

/* Joins i with those found, and forgets them. */
static gh_status join_all(growth *g, int i, found *f) {
  for (int k = 0; k < f->n; k++) {
    const list *b = &g->list[f->of[k].i];
    __builtin_prefetch(&b->entry[b->n]);
  }
  for (int k = 0; k < f->n; k++) GH_TRY(join(g, i, f->of[k].i, f->of[k].image));
  f->n = 0;
  return GH_OK;
}

/* Joins i with those of the chains' grains whose hulls meet its own. */
static gh_status join_cells(growth *g, int i, found *first) {
  const hull a = g->hull[i];
  found near;
  near.n = 0;
  for (int c = 0; c < first->n; c++) {
    const double *shift = g->box.shift[first->of[c].image];
    for (int j = first->of[c].i; j >= 0; j = g->next[j]) {
      const hull *b = &g->hull[j];
      double l[DIM], reach = a.reach + b->reach;
      if (j == i) continue;
      for (int k = 0; k < DIM; k++) l[k] = b->home[k] + shift[k] - a.home[k];
      if (!(dot(l, l) < reach * reach)) continue;
      __builtin_prefetch(&g->list[j]);
      near.of[near.n].i = j, near.of[near.n++].image = first->of[c].image;
      if (near.n == MANY) GH_TRY(join_all(g, i, &near));
    }
  }
  first->n = 0;
  return join_all(g, i, &near);
}

static int floor_div(int a, int b) {
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

/* A row of cells along the first lattice vector, from `low` to `high`; at and image: of the row. */
static gh_status search_row(growth *g, int i, const level *l, int at, int image, int low, int high,
                            found *f) {
  int shift = floor_div(low, l->m[0]), c = low - shift * l->m[0];
  const int *head = l->head + (size_t)at * (size_t)l->m[0];
  for (image = image * SPAN + shift + FAR; low <= high; low++) {
    if (head[c] >= 0) {
      f->of[f->n].i = head[c], f->of[f->n++].image = image;
      __builtin_prefetch(&g->hull[head[c]]);
      __builtin_prefetch(&g->next[head[c]]);
      if (f->n == MANY) GH_TRY(join_cells(g, i, f));
    }
    if (++c == l->m[0]) c = 0, image++;
  }
  return GH_OK;
}

/* All cells of a level within the reach of i's hull and those of the level; cells beyond the faces are
 * images. */
static gh_status search(growth *g, int i, const level *l) {
  double s[DIM];
  int low[DIM], high[DIM], c[DIM];
  found first;
  first.n = 0;
  lattice_coordinates(&g->box, g->hull[i].home, s);
  for (int k = 0; k < DIM; k++) {
    double reach = (g->hull[i].reach + l->reach) / g->box.height[k] + 1e-9;
    low[k] = c[k] = (int)fmax(floor((s[k] - reach) * l->m[k]), -FAR * l->m[k]);
    high[k] = (int)fmin(floor((s[k] + reach) * l->m[k]), (FAR + 1) * l->m[k] - 1);
  }
  for (int k = 0; k < DIM;) {
    int at = 0, image = 0;
    for (int d = DIM - 1; d > 0; d--) {
      int shift = floor_div(c[d], l->m[d]);
      at = at * l->m[d] + c[d] - shift * l->m[d];
      image = image * SPAN + shift + FAR;
    }
    GH_TRY(search_row(g, i, l, at, image, low[0], high[0], &first));
    for (k = 1; k < DIM && ++c[k] > high[k]; k++) c[k] = low[k];
  }
  return join_cells(g, i, &first);
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
