/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Words of Gmsh meshes. */
#include "mesh/gmsh.h"

#include <limits.h>
#include <string.h>

gh_status gh_msh_open(gh_msh_words *s) {
  enum { MOST_MEGABYTES = 512 }; /* millions of elements, and each needs four packings */
  gh_status status = gh_reader_open_most(s->ctx, s->path, MOST_MEGABYTES, &s->file);
  if (s->file.empty) return gh_fail(s->ctx, GH_INPUT, "%s:1: the file is empty", s->path);
  if (status != GH_OK) return status;
  s->at = s->file.next;
  s->line = 1;
  return GH_OK;
}

bool gh_msh_next(gh_msh_words *s) {
  if (s->cut) *s->cut = s->kept;
  s->cut = NULL;
  for (; *s->at && strchr(" \t\r\n", *s->at); s->at++) s->line += *s->at == '\n';
  if (!*s->at) return false;
  bool quoted = *s->at == '"';
  char *begin = s->at + quoted, *end = begin + strcspn(begin, quoted ? "\"\n" : " \t\r\n");
  s->at = end + (quoted && *end == '"');
  s->word = begin;
  s->cut = end;
  s->kept = *end;
  *end = '\0';
  return true;
}

gh_status gh_msh_word(gh_msh_words *s, const char *what) {
  if (gh_msh_next(s)) return GH_OK;
  return GH_MSH_FAIL(s, "the file ends where %s should stand (truncated?)", what);
}

gh_status gh_msh_integer(gh_msh_words *s, const char *what, long low, long high, long *value) {
  char quoted[GH_QUOTE];
  GH_TRY(gh_msh_word(s, what));
  if (!gh_parse_integer(s->word, LONG_MIN, LONG_MAX, value))
    return GH_MSH_FAIL(s, "\"%s\" is not an integer (%s)", gh_quote(s->word, quoted), what);
  if (*value < low || *value > high)
    return GH_MSH_FAIL(s, "%s is %ld, not within %ld to %ld", what, *value, low, high);
  return GH_OK;
}

gh_status gh_msh_number(gh_msh_words *s, const char *what, double *value) {
  char quoted[GH_QUOTE];
  GH_TRY(gh_msh_word(s, what));
  if (!gh_parse_number(s->word, value))
    return GH_MSH_FAIL(s, "\"%s\" is not a finite number (%s)%s", gh_quote(s->word, quoted), what,
                       gh_number_hint(s->word));
  return GH_OK;
}

gh_status gh_msh_count(gh_msh_words *s, const char *what, long *value) {
  GH_TRY(gh_msh_integer(s, what, 0, INT_MAX / 8, value));
  if (s->file.text + s->file.length - s->at < *value)
    return GH_MSH_FAIL(s, "%s is %ld, more than the rest of the file can hold", what, *value);
  return GH_OK;
}

static bool word_ends_section(const char *word, const char *section) {
  return strncmp(word, "$End", 4) == 0 && strcmp(word + 4, section) == 0;
}

gh_status gh_msh_end(gh_msh_words *s, const char *section) {
  char quoted[GH_QUOTE];
  GH_TRY(gh_msh_word(s, "the end of a section"));
  if (word_ends_section(s->word, section)) return GH_OK;
  return GH_MSH_FAIL(s, "\"%s\" where $End%s should stand", gh_quote(s->word, quoted), section);
}

gh_status gh_msh_skip(gh_msh_words *s, const char *section) {
  int line = s->line;
  while (gh_msh_next(s))
    if (word_ends_section(s->word, section)) return GH_OK;
  return gh_fail(s->ctx, GH_INPUT, "%s:%d: $%s has no $End%s (truncated?)", s->path, line, section, section);
}
