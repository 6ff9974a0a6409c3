/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Histories of contacts, sorted by (i, j, image[1], image[0]): their order, and what is left of contacts that
 * have opened (Table 7.1; method 8.10). Inline: engines and RVE share them. */
#ifndef GRANHOM_CONTACT_SLIPS_H
#define GRANHOM_CONTACT_SLIPS_H

#include "granhom/contact.h"

/* Negative: a comes before b; 0: the same contact. */
static inline int gh_slip_order(const gh_slip *a, const gh_slip *b) {
  if (a->i != b->i) return a->i < b->i ? -1 : 1;
  if (a->j != b->j) return a->j < b->j ? -1 : 1;
  if (a->image[1] != b->image[1]) return a->image[1] < b->image[1] ? -1 : 1;
  return a->image[0] < b->image[0] ? -1 : a->image[0] > b->image[0];
}

/* Adds those of the history `old` that `now` lacks to it: a contact that has opened keeps its hardening, and
 * nothing else. Both are sorted; `now` has `count` and room for `nold` more. Returns how many it has then. */
static inline int gh_slips_add_opened(gh_slip *now, int count, const gh_slip *old, int nold) {
  int opened = 0;
  for (int a = 0, b = 0; b < nold; b++) {
    while (a < count && gh_slip_order(&now[a], &old[b]) < 0) a++;
    opened += old[b].alpha != 0 && (a == count || gh_slip_order(&now[a], &old[b]) != 0);
  }
  const int all = count + opened;
  for (int a = count - 1, b = nold - 1, k = all - 1; opened > 0 && b >= 0;) { /* merged from the end */
    const int order = a >= 0 ? gh_slip_order(&now[a], &old[b]) : -1;
    if (order > 0) {
      now[k--] = now[a--];
    } else if (order == 0 || old[b].alpha == 0) {
      b--;
    } else {
      now[k] = old[b--];
      now[k].gamma = now[k].gamma_pl = 0;
      k--;
    }
  }
  return all;
}

#endif
