/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Random numbers that are the same on every machine.
 * SplitMix64: Steele, Lea, Flood, Fast splittable pseudorandom number generators, OOPSLA 2014. */
#ifndef GRANHOM_PACKING_RANDOM_H
#define GRANHOM_PACKING_RANDOM_H

static inline double random_uniform(unsigned long long *state) { /* in [0, 1) */
  unsigned long long z = *state += 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

#endif
