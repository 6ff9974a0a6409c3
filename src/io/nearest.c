/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The known word that a mistyped one is nearest to. */
#include "granhom/io.h"

#include <limits.h>
#include <string.h>

/* Edit distance of Levenshtein: how many letters to insert, drop or replace. Words beyond the limit count as
 * far away. */
static int edit_distance(const char *a, const char *b) {
  enum { LIMIT = 64 };
  int row[LIMIT + 1], na = (int)strnlen(a, LIMIT + 1), nb = (int)strnlen(b, LIMIT + 1);
  if (na > LIMIT || nb > LIMIT) return INT_MAX;
  for (int j = 0; j <= nb; j++) row[j] = j;
  for (int i = 1; i <= na; i++) {
    int diagonal = row[0];
    row[0] = i;
    for (int j = 1; j <= nb; j++) {
      int best = diagonal + (a[i - 1] != b[j - 1]);
      if (row[j] + 1 < best) best = row[j] + 1;
      if (row[j - 1] + 1 < best) best = row[j - 1] + 1;
      diagonal = row[j];
      row[j] = best;
    }
  }
  return row[nb];
}

const char *gh_nearest(const char *word, const char *const *known) {
  const char *nearest = NULL;
  int least = INT_MAX;
  for (; *known; known++) {
    int d = edit_distance(word, *known);
    if (d < least) nearest = *known;
    if (d < least) least = d;
  }
  return nearest && least <= 1 + (int)strlen(word) / 3 ? nearest : NULL;
}
