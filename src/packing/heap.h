/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The queue of events: one entry per grain, ordered by time.
 * A heap of four children per node with the place of each grain, so that an entry moves in O(log n). Who
 * rises near the top is reported, so that its memory can be fetched before its event. */
#ifndef GRANHOM_PACKING_HEAP_H
#define GRANHOM_PACKING_HEAP_H

typedef struct heap_slot {
  double t;
  int i;
} heap_slot;

typedef struct heap {
  int n;
  heap_slot *slot; /* n */
  int *place;      /* n, slot of each grain */
  int risen[3];    /* who came last into the first, second and third rank below the top; -1: nobody since */
} heap;

static inline void heap_put(heap *h, int p, heap_slot s) {
  h->slot[p] = s;
  h->place[s.i] = p;
}

static inline void heap_up(heap *h, int p, heap_slot s) {
  while (p > 0) {
    int parent = (p - 1) / 4;
    if (h->slot[parent].t <= s.t) break;
    heap_put(h, p, h->slot[parent]);
    p = parent;
  }
  heap_put(h, p, s);
}

static inline void heap_down(heap *h, int p, heap_slot s) {
  for (;;) {
    int first = 4 * p + 1, last = first + 4 < h->n ? first + 4 : h->n, least = first;
    if (first >= h->n) break;
    if (16 * p + 20 < h->n) /* the grandchildren, while the children are looked at */
      for (int c = 16 * p + 5; c < 16 * p + 21; c += 4) __builtin_prefetch(&h->slot[c]);
    for (int c = first + 1; c < last; c++)
      if (h->slot[c].t < h->slot[least].t) least = c;
    if (h->slot[least].t >= s.t) break;
    heap_put(h, p, h->slot[least]);
    if (p > 0 && p < 85) h->risen[(p > 4) + (p > 20)] = h->slot[p].i;
    p = least;
  }
  heap_put(h, p, s);
}

/* Gives grain i the time t. */
static inline void heap_set(heap *h, int i, double t) {
  int p = h->place[i];
  heap_slot s = {t, i};
  if (t < h->slot[p].t) heap_up(h, p, s);
  else heap_down(h, p, s);
}

/* All grains at the time t, in their order. */
static inline void heap_level(heap *h, double t) {
  for (int i = 0; i < h->n; i++) heap_put(h, i, (heap_slot){t, i});
}

#endif
