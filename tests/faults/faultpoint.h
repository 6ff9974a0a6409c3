/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What faultpoint.c and faultcalls.c share: the state of the library, and whether a call is the one to
 * fail. */
#ifndef GRANHOM_FAULTPOINT_H
#define GRANHOM_FAULTPOINT_H

#include <limits.h>
#include <link.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#pragma GCC visibility push(hidden) /* nothing but the replaced calls is seen from outside */

/* own: allocations of granhom's code; lib: those of the libraries; io: calls on files. */
typedef enum kind { NONE, OWN, LIB, IO } kind;
/* hard: the error that the call has most often; soft: EINTR, or a short count, where the call may give it;
 * full: the device stays full from the point on. */
typedef enum flavour { HARD, SOFT, SHORT, FULL } flavour;
typedef enum caller { OTHER, PROGRAM, LIBRARY } caller;

enum { MOST_PATHS = 1 << 17, DEPTH = 64, INNER = 3 };

/* In memory that a child shares with the server. path: of each point, a sum over the calls that led to it,
 * for the first MOST_PATHS when all are counted; of an allocation in a library, over the INNER last calls of
 * libraries and of granhom, because their recursion leads to the same few places in endless variety. */
typedef struct record {
  long points;
  int met;
  char what[200];
  char library[64], crash[64]; /* of the caller of the point; whose code a signal has ended */
  unsigned path[MOST_PATHS];
} record;

typedef struct range {
  uintptr_t low, high;
  caller who;
} range;

enum { MOST_RANGES = 64, MOST_FILES = 1024 };
typedef struct fault_state {
  kind kind;
  flavour flavour;
  long at;
  bool on;
  record *record, own;
  range range[MOST_RANGES];
  int ranges;
  char marked[MOST_FILES];
  char folder[PATH_MAX];
  size_t length;
} fault_state;
extern fault_state fault;

/* Finds the code of granhom and of the libraries again. */
void ranges_find(void);
caller caller_of(const void *address);

/* True when the call counts as a point and this point is the one to fail; errno is set. `from`: the address
 * that the call returns to. */
bool fail_memory(const char *call, const void *from);
bool path_counts(const char *path, const void *from);
void file_mark(int fd, bool counts);
/* A call that takes room on the device (`writes`), or not. */
bool fail_path(const char *call, const char *path, int reason, bool writes, const void *from);
/* ... on an open file. `soft`: the call may be interrupted. */
bool fail_file(const char *call, int fd, int reason, bool writes, bool soft, const void *from);
/* Number of bytes of a count that is cut short, or 0 when it is not. */
size_t fail_short(const char *call, int fd, size_t n, const void *from);

#pragma GCC visibility pop

#endif
