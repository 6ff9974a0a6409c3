/* History of the contacts from one converged state to the next (Table 7.1). SPDX-License-Identifier:
 * GPL-2.0-or-later */
#include "micro/internal.h"

static int compare(const gh_slip *a, const gh_slip *b) {
  const int ka[4] = {a->i, a->j, a->image[1], a->image[0]}, kb[4] = {b->i, b->j, b->image[1], b->image[0]};
  for (int k = 0; k < 4; k++)
    if (ka[k] != kb[k]) return ka[k] < kb[k] ? -1 : 1;
  return 0;
}

gh_status gh_slips_advance(gh_context *ctx, const gh_slips *from, const gh_contact_list *list, bool hardening,
                           gh_slips *to) {
  size_t most = (size_t)list->count + (hardening ? (size_t)from->count : 0);
  GH_TRY(gh_grow(ctx, most + 1, sizeof(gh_slip), &to->capacity, &to->slips));
  to->count = 0;
  for (int c = 0, o = 0; c < list->count || o < from->count;) {
    const gh_slip *now = c < list->count ? &list->friction[c].slip : NULL,
                  *old = o < from->count ? &from->slips[o] : NULL;
    int order = !now ? 1 : !old ? -1 : compare(now, old);
    if (order <= 0) { /* it touches */
      if (now->gamma != 0 || now->gamma_pl != 0 || now->alpha != 0) to->slips[to->count++] = *now;
      c++;
      o += order == 0;
    } else { /* it has opened: gamma and gamma_pl are lost */
      if (hardening && old->alpha != 0)
        to->slips[to->count++] =
            (gh_slip){.i = old->i, .j = old->j, .image = {old->image[0], old->image[1]}, .alpha = old->alpha};
      o++;
    }
  }
  return GH_OK;
}
