/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Random histories of contacts. */
#ifndef GRANHOM_TESTS_SLIPS_HELP_H
#define GRANHOM_TESTS_SLIPS_HELP_H

#include "../help.h"

/* Slips of the contacts in the list, beyond the friction limit and below it; returns their number. */
static inline int draw_slips(unsigned long long *seed, const gh_contact_list *list, double largest, int most,
                             gh_slip *slips) {
  assert_in_range(list->count, 0, most);
  for (int c = 0; c < list->count; c++) {
    slips[c] = list->friction[c].slip;
    slips[c].gamma = 0.02 * largest * (uniform(seed) - 0.5);
    slips[c].gamma_pl = slips[c].gamma + 0.2 * largest * (uniform(seed) - 0.5);
    slips[c].alpha = 0.002 * largest * uniform(seed);
  }
  return list->count;
}

#endif
