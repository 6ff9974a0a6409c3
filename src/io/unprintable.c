/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Characters that titles, units and names do not hold. */
#include "io/file.h"

#include <string.h>

/* The code of the character of UTF-8 at *text, which moves behind it; -1: these bytes are none. */
static long next_code(const unsigned char **text) {
  static const long least[] = {0, 0x80, 0x800, 0x10000};
  const unsigned char *c = *text;
  int more = *c < 0x80 ? 0 : (*c & 0xE0) == 0xC0 ? 1 : (*c & 0xF0) == 0xE0 ? 2 : (*c & 0xF8) == 0xF0 ? 3 : -1;
  if (more < 0) return -1;
  long code = more == 0 ? *c : *c & (0x3F >> more);
  for (int k = 1; k <= more; k++) {
    if ((c[k] & 0xC0) != 0x80) return -1;
    code = code << 6 | (c[k] & 0x3F);
  }
  *text = c + more + 1;
  bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  return code < least[more] || code > 0x10FFFF || surrogate ? -1 : code;
}

/* C0, DEL and C1, line and paragraph separators, marks that turn the direction of writing. */
static bool is_control(long code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x2028 || code == 0x2029 ||
         (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
}

const char *gh_unprintable(const char *text, char name[GH_QUOTE]) {
  const unsigned char *at = (const unsigned char *)text;
  while (*at) {
    long code = next_code(&at);
    if (code >= 0 && !is_control(code)) continue;
    if (code < 0) snprintf(name, GH_QUOTE, "bytes that are not UTF-8");
    else if (code == '\n' || code == '\r') snprintf(name, GH_QUOTE, "a line break");
    else if (code == '\t') snprintf(name, GH_QUOTE, "a tab");
    else snprintf(name, GH_QUOTE, "the control character U+%04lX", code);
    return name;
  }
  return NULL;
}
