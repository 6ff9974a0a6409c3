/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Keys and columns with what they mean. */
#include "granhom/io.h"

void gh_terms_header(gh_text *out, const gh_term *terms, const char *separator) {
  for (const gh_term *t = terms; t->name; t++)
    gh_text_print(out, "%s%s", t == terms ? "" : separator, t->name);
}

/* Terms without a text share the line of the one before them. */
void gh_terms_print(gh_text *out, const gh_term *terms) {
  for (const gh_term *t = terms; t->name;) {
    const gh_term *described = t;
    gh_text_print(out, "- `%s`", t->name);
    for (t++; t->name && !*t->text; t++) gh_text_print(out, ", `%s`", t->name);
    gh_text_print(out, ": %s\n", described->text);
  }
}

gh_status gh_yaml_terms(gh_yaml_node map, const gh_term *known) {
  enum { MOST = 31 };
  const char *names[MOST + 1] = {0};
  for (int k = 0; k < MOST && known[k].name; k++) names[k] = known[k].name;
  return gh_yaml_keys(map, names);
}
