/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Options of a command line as rows of a table: one parser, one help text, and the keys of a YAML file where
 * a command has one.
 *
 * A command has a struct of arguments, filled with its defaults, and groups of rows, which say where in it
 * the values go. Groups that several commands share stand in packing_options.h and folder_options.h. */
#ifndef GRANHOM_OPTIONS_H
#define GRANHOM_OPTIONS_H

#include "granhom/base.h"

#include <stddef.h>
#include <stdio.h>

typedef enum option_kind {
  OPTION_TEXT,    /* const char *: points into argv */
  OPTION_FLAG,    /* bool: becomes true; takes no value */
  OPTION_NUMBER,  /* double: above 0, or 0 too (`zero`); below `below` unless that is 0 */
  OPTION_INTEGER, /* int from low to high */
  OPTION_LONG,    /* long from low to high */
  OPTION_CHOICE,  /* int or enum: number of the word among `words` */
  OPTION_OWN,     /* by `read` */
  OPTION_HEADING  /* a heading of the help, no option */
} option_kind;

/* Reads a value into the struct of the row's group. `where` opens the message. */
typedef gh_status option_reader(gh_context *ctx, const char *where, const char *text, void *group);

typedef struct option_row {
  const char *name; /* without dashes; NULL ends a group. With one dash in front: a word of LAMMPS's own */
  char letter;      /* 'o' for -o; 0: none */
  option_kind kind;
  const char *argument; /* its name in the help */
  size_t place;         /* offset in the struct of the group */
  bool zero;
  double below;
  long low, high;
  const char *const *words; /* NULL-terminated */
  option_reader *read;
  bool optional;        /* OPTION_NUMBER: without a value it is INFINITY */
  bool key;             /* also a key of the command's YAML file, with _ for - */
  const char *wanted;   /* "must be ...", where kind and bounds do not say it */
  const char *standard; /* the default, where the struct does not hold it before options are read */
  const char *help;
} option_row;

typedef struct option_group {
  const option_row *rows; /* NULL ends the list */
  size_t place;           /* offset of the group's struct in the arguments */
} option_group;

/* Sets one value by its text. `where` opens the message: "--rate" or "sand.yaml:3: rate". GH_INPUT: what it
 * must be. */
gh_status option_set(gh_context *ctx, const option_row *row, const char *where, const char *text,
                     void *group);
/* What a value of the row must be: "a positive number". */
void option_wanted(const option_row *row, char text[160]);
/* The help of a row with its default, which the struct of its group holds. */
enum { OPTION_MOST_TEXT = 1152 };
void option_text(const option_row *row, const void *group, char text[OPTION_MOST_TEXT]);
/* The row of this name, NULL: none. */
const option_row *option_find(const option_row *rows, const char *name);

/* Operands behind the first, where a command takes several. */
enum { OPTION_MORE = 32 };
typedef struct option_more {
  int n;
  const char *word[OPTION_MORE];
} option_more;

/* What a command line consists of. Operands (files or folders) may stand anywhere; "--" ends the options; an
 * option that is given twice counts with its last value. */
typedef struct option_line {
  const option_group *groups;
  int argc;
  char **argv;
  const char *noun;    /* of the operand: "packing" */
  const char *operand; /* found by options_scan; NULL: none */
  option_more *more;   /* those behind it; NULL: there may be none */
} option_line;

/* Whether --help or -h stands in front of "--". */
bool options_help_wanted(int argc, char **argv);
/* Finds the operands. GH_INPUT: an unknown option (with the nearest known one), an ambiguous abbreviation, a
 * value missing or one too many, too many operands. */
gh_status options_scan(gh_context *ctx, option_line *line);
/* Sets the values, after options_scan. GH_INPUT: "--rate must be a positive number, not ..." */
gh_status options_read(gh_context *ctx, const option_line *line, void *arguments);

/* Rows as help: name, argument, text and default, which `arguments` hold. */
void options_print(FILE *out, const option_group *groups, const void *arguments);
/* Text with its lines broken at the width of a help page; a broken line continues below its own first letter.
 */
void help_print(FILE *out, const char *text);

#endif
