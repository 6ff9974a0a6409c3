/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A command line by the rows of a table, with getopt_long. */
#include "options.h"

#include "granhom/io.h"

#include <getopt.h>
#include <string.h>

/* More than any command has, and the first value that is no character. */
enum { MOST = 64, FIRST = 512 };

/* The table as getopt_long wants it; row k has the value FIRST + k. */
typedef struct line_table {
  int rows;
  const option_row *row[MOST];
  size_t place[MOST]; /* of its group */
  struct option words[MOST + 1];
  char letters[2 * MOST + 3];
} line_table;

static void table_add(line_table *t, const option_row *row, size_t place) {
  const int takes = row->kind == OPTION_FLAG ? no_argument
                    : row->optional          ? optional_argument
                                             : required_argument;
  t->row[t->rows] = row;
  t->place[t->rows] = place;
  t->words[t->rows] = (struct option){row->name, takes, NULL, FIRST + t->rows};
  t->rows++;
  if (!row->letter) return;
  const size_t used = strlen(t->letters);
  snprintf(t->letters + used, sizeof t->letters - used, "%c%s", row->letter, takes == no_argument ? "" : ":");
}

/* "-": operands are handed over where they stand, whatever POSIXLY_CORRECT states; ":": a missing value is
 * distinguished from an unknown option. */
static void table_set(line_table *t, const option_group *groups) {
  *t = (line_table){.letters = "-:"};
  for (; groups->rows; groups++)
    for (const option_row *row = groups->rows; row->name; row++)
      if (row->kind != OPTION_HEADING && row->name[0] != '-' && t->rows < MOST)
        table_add(t, row, groups->place);
}

/* The number of the row that getopt_long has found. */
static int table_row(const line_table *t, int c) {
  for (int k = 0; k < t->rows; k++)
    if (c == FIRST + k || c == t->row[k]->letter) return k;
  return -1;
}

/* An abbreviation with several meanings names them; another word the nearest. */
static gh_status word_refuse(gh_context *ctx, const line_table *t, const char *word) {
  const char *known[MOST + 2];
  char name[80], list[256] = "";
  int meant = 0;
  size_t used = 0;
  snprintf(name, sizeof name, "%.*s", (int)strcspn(word + 2, "="), word + 2);
  for (int k = 0; k < t->rows; k++) {
    known[k] = t->row[k]->name;
    if (!*name || strncmp(known[k], name, strlen(name)) != 0) continue;
    used += (size_t)snprintf(list + used, sizeof list - used, "%s--%s", meant++ ? ", " : "", known[k]);
    if (used >= sizeof list) used = sizeof list - 1;
  }
  known[t->rows] = "help";
  known[t->rows + 1] = NULL;
  if (meant > 1) return gh_fail(ctx, GH_INPUT, "the option --%s is ambiguous: %s", name, list);
  const char *nearest = gh_nearest(name, known);
  if (nearest) return gh_fail(ctx, GH_INPUT, "unknown option %s; did you mean --%s?", word, nearest);
  return gh_fail(ctx, GH_INPUT, "unknown option %s", word);
}

/* getopt_long has returned '?': a word, a letter, or a value for an option that takes none. */
static gh_status option_refuse(gh_context *ctx, const line_table *t, const char *word) {
  const int row = optopt ? table_row(t, optopt) : -1;
  if (row >= 0) return gh_fail(ctx, GH_INPUT, "--%s takes no value: %s", t->row[row]->name, word);
  if (strncmp(word, "--", 2) == 0) return word_refuse(ctx, t, word);
  return gh_fail(ctx, GH_INPUT, "unknown option -%c", optopt);
}

static gh_status operand_add(gh_context *ctx, option_line *line, const char *word) {
  option_more *more = line->more;
  if (line->operand && !more)
    return gh_fail(ctx, GH_INPUT, "one %s at a time, not '%s' and '%s'", line->noun, line->operand, word);
  if (line->operand && more->n == OPTION_MORE)
    return gh_fail(ctx, GH_INPUT, "at most %d more %ss behind '%s'", OPTION_MORE, line->noun, line->operand);
  if (line->operand) more->word[more->n++] = word;
  else line->operand = word;
  return GH_OK;
}

/* The next option or operand, -1 at the end. A number behind an option whose value is optional is its value:
 * "--allow-overlap 0.3" as well as "--allow-overlap=0.3". */
static int line_next(const line_table *t, const option_line *line) {
  double number;
  const int c = getopt_long(line->argc, line->argv, t->letters, t->words, NULL), row = table_row(t, c);
  if (row >= 0 && t->row[row]->optional && !optarg && optind < line->argc &&
      gh_parse_number(line->argv[optind], &number))
    optarg = line->argv[optind++];
  return c;
}

static void line_rewind(void) {
  opterr = 0;
  optind = 0; /* getopt starts again with another string of letters */
}

bool options_help_wanted(int argc, char **argv) {
  for (int k = 1; k < argc && strcmp(argv[k], "--") != 0; k++)
    if (strcmp(argv[k], "--help") == 0 || strcmp(argv[k], "-h") == 0) return true;
  return false;
}

gh_status options_scan(gh_context *ctx, option_line *line) {
  line_table t;
  table_set(&t, line->groups);
  line_rewind();
  for (int c; (c = line_next(&t, line)) != -1;) {
    if (c == '?') return option_refuse(ctx, &t, line->argv[optind - 1]);
    if (c == ':') return gh_fail(ctx, GH_INPUT, "%s needs a value", line->argv[optind - 1]);
    if (c == 1) GH_TRY(operand_add(ctx, line, optarg));
  }
  for (int k = optind; k < line->argc; k++) GH_TRY(operand_add(ctx, line, line->argv[k]));
  return GH_OK;
}

gh_status options_read(gh_context *ctx, const option_line *line, void *arguments) {
  line_table t;
  table_set(&t, line->groups);
  line_rewind();
  for (int c; (c = line_next(&t, line)) != -1;) {
    const int row = table_row(&t, c);
    if (row < 0) continue;
    char where[80], *group = (char *)arguments + t.place[row];
    snprintf(where, sizeof where, "--%s", t.row[row]->name);
    if (t.row[row]->optional && !optarg) *(double *)(group + t.row[row]->place) = INFINITY;
    else GH_TRY(option_set(ctx, t.row[row], where, optarg, group));
  }
  return GH_OK;
}
