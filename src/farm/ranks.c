/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What is in a message between ranks. */
#include "farm/ranks.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* ---- messages ---- */

void farm_message_free(farm_message *m) {
  free(m->bytes);
  *m = (farm_message){0};
}

void farm_message_begin(farm_message *m) {
  m->size = m->at = 0;
  m->failed = false;
}

void farm_put(farm_message *m, const void *data, size_t size) {
  if (size == 0) return;
  if (gh_grow(NULL, m->size + size, 1, &m->capacity, &m->bytes) != GH_OK) {
    m->failed = true;
    return;
  }
  memcpy(m->bytes + m->size, data, size);
  m->size += size;
}

void farm_put_int(farm_message *m, int value) {
  farm_put(m, &value, sizeof value);
}

const void *farm_take_place(farm_message *m, size_t size) {
  if (size > m->size - m->at) return NULL;
  const char *place = m->bytes + m->at;
  m->at += size;
  return place;
}

bool farm_take(farm_message *m, void *data, size_t size) {
  const void *place = farm_take_place(m, size);
  if (size == 0) return true;
  if (place) memcpy(data, place, size);
  else memset(data, 0, size);
  return place != NULL;
}

int farm_take_int(farm_message *m) {
  int value;
  farm_take(m, &value, sizeof value);
  return value;
}

gh_status farm_message_check(gh_context *ctx, const farm_message *m) {
  if (!m->failed && m->size <= INT_MAX) return GH_OK;
  return gh_fail(ctx, GH_MEMORY, "no memory for a message between ranks (%zu bytes so far)", m->size);
}

/* ---- status and view ---- */

enum { WORDS = 2048 };

void farm_put_status(farm_message *m, gh_context *ctx, gh_status status) {
  char words[WORDS] = "";
  if (status != GH_OK) snprintf(words, sizeof words, "%s", gh_message(ctx));
  int length = (int)strlen(words);
  farm_put_int(m, (int)status);
  farm_put_int(m, length);
  farm_put(m, words, (size_t)length);
}

gh_status farm_take_status(farm_message *m, gh_context *ctx) {
  gh_status status = (gh_status)farm_take_int(m);
  int length = farm_take_int(m);
  char words[WORDS] = "";
  if (length < 0 || length >= WORDS || !farm_take(m, words, (size_t)length))
    return gh_fail(ctx, GH_INTERNAL, "a message between ranks is cut off");
  return status == GH_OK ? GH_OK : gh_fail(ctx, status, "%s", words);
}

/* The arrays of a view: name, numbers for each of what. Those that hold doubles come first, so that each is
 * aligned for its type where it stands in the message. Arrays that a view does not have are NULL on both
 * sides. */
_Static_assert(sizeof(gh_contact) % sizeof(double) == 0 && sizeof(gh_friction) % sizeof(double) == 0,
               "arrays behind one another stay aligned");
#define VIEW_ARRAYS(X)                                                                                       \
  X(x, 2, n)                                                                                                 \
  X(radius, 1, n)                                                                                            \
  X(theta, 1, n)                                                                                             \
  X(support, 3, n)                                                                                           \
  X(contacts, 1, ncontacts)                                                                                  \
  X(friction, 1, ncontacts)                                                                                  \
  X(grain, 1, n) X(type, 1, n) X(id, 1, n) X(flags, 1, n)

void farm_put_view(farm_message *m, const gh_rve_view *v) {
  farm_put(m, v, sizeof *v);
#define PUT(name, times, count)                                                                              \
  if (v->name) farm_put(m, v->name, times *(size_t)v->count * sizeof *v->name);
  VIEW_ARRAYS(PUT)
#undef PUT
}

bool farm_take_view(farm_message *m, gh_rve_view *v) {
  bool whole = farm_take(m, v, sizeof *v);
#define TAKE(name, times, count)                                                                             \
  if (whole && v->name) {                                                                                    \
    v->name = farm_take_place(m, times * (size_t)v->count * sizeof *v->name);                                \
    whole = v->name != NULL;                                                                                 \
  }
  VIEW_ARRAYS(TAKE)
#undef TAKE
  return whole;
}
