/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the file formats share: whole files in and out, lines, words. */
#ifndef GRANHOM_IO_FILE_H
#define GRANHOM_IO_FILE_H

#include "granhom/io.h"

#include <locale.h>

/* ---- replace.c: files as a whole ---- */

/* Writes length bytes so that path holds either all of them or what it held before: another name, fsync,
 * rename. A device or a pipe is written directly, a symbolic link keeps pointing where it did, the
 * permissions of a file that is replaced stay. GH_SYSTEM with the reason. */
gh_status gh_file_write(gh_context *ctx, const char *path, const void *bytes, size_t length);

/* ---- target.c ---- */

/* The file behind symbolic links, also where the last of them leads to one that is still to be made; a device
 * or a pipe as it is named. The caller frees. 0, or errno. */
int gh_file_target(const char *path, char **target);

/* ---- kind.c ---- */

/* GH_INPUT: there is a file that is evidently of another kind than `written`. */
gh_status gh_kind_kept(gh_context *ctx, const char *path, gh_file_kind written);

/* ---- read.c ---- */

/* Whose fault it is that a file cannot be opened or read: GH_INPUT for a wrong name or missing permission,
 * GH_SYSTEM for a device, a limit of the system and the like, GH_MEMORY. */
gh_status gh_read_status(int reason);

/* A text file in memory, walked line by line. */
typedef struct gh_reader {
  const char *path; /* name for messages */
  char *text;       /* owned; the file and a final 0 */
  size_t length;
  char *next; /* what gh_reader_line hands out next */
  int line;   /* number of the line handed out last */
  bool empty; /* the file holds nothing, which is why it could not be opened */
} gh_reader;

/* Reads the whole file ("-": standard input), at most so many MiB of it. gh_read_status, and GH_INPUT when it
 * is missing, a folder, a pipe that nobody writes into, empty, larger, or no text (a zero byte; UTF-16,
 * archives and binary meshes are named). The byte order mark of UTF-8 is dropped, and lines may end with CR
 * LF, LF or CR alone. The path is not copied. */
gh_status gh_reader_open_most(gh_context *ctx, const char *path, int megabytes, gh_reader *reader);
/* The same for at most 1 GiB. */
gh_status gh_reader_open(gh_context *ctx, const char *path, gh_reader *reader);
void gh_reader_close(gh_reader *reader);
/* The whole file as a text that the caller frees; errors of gh_reader_open. */
gh_status gh_file_text(gh_context *ctx, const char *path, char **text);
/* The next line without its end, to be changed at will; NULL at the end. */
char *gh_reader_line(gh_reader *reader);

/* Cuts text at white space in place; returns how many words there are, storing the first `max` of them. */
int gh_words(char *text, int max, char **word);
/* Takes white space off both ends in place. */
char *gh_trim(char *text);

enum { GH_QUOTE = 64 };
/* text made fit for a message: control characters become '?', long texts are cut with "...". Returns out. */
const char *gh_quote(const char *text, char out[GH_QUOTE]);

/* ---- unprintable.c ---- */

/* What a text of one line does not hold: control characters (line breaks and tabs among them), bytes that are
 * not UTF-8. NULL: it holds none; else `name`, filled with words for a message: "a line break". */
const char *gh_unprintable(const char *text, char name[GH_QUOTE]);

/* ---- number.c ---- */

/* Numbers are read and written with a decimal point whatever the locale of the program is. A begin belongs to
 * each end. */
typedef struct gh_c_locale {
  locale_t ours, theirs;
} gh_c_locale;
gh_c_locale gh_c_locale_begin(void);
void gh_c_locale_end(gh_c_locale l);

#endif
