/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The books of a farm on rank 0: which point is in which state, where that lies, and what is to be
 * computed. */
#ifndef GRANHOM_FARM_BOOKS_H
#define GRANHOM_FARM_BOOKS_H

#include "farm/store.h"

/* A buffer in a slot of a rank. States of equal content are equal to the bit. */
typedef struct farm_state {
  int rank, slot; /* FARM_FRESH: the packing as read, which every rank has */
  int packing, users;
  long content;
  bool seen; /* mark of a search */
} farm_state;

/* One evaluation for all points that have the same state and the same F. */
typedef struct farm_job {
  farm_task task;
  int state, result; /* states it reads and writes */
  int near;          /* state near which it may start, -1 */
  int rank;
  double cost; /* expected, seconds */
} farm_job;

/* A state that goes to another rank before the evaluation. */
typedef struct farm_move {
  int from, to; /* states */
} farm_move;

typedef struct farm_list {
  int *item;
  size_t n, capacity;
} farm_list;

typedef struct farm_books {
  gh_context *ctx;
  int n, npackings, ranks;
  bool share, balance, keeps; /* keeps: trial states, for evaluations nearby */
  /* per point */
  int *packing, *state, *job; /* job: of the last evaluation, -1 */
  int *near;                  /* trial state that was stored, -1 */
  int *home;                  /* rank where it is computed */
  double *cost;               /* seconds of an evaluation, running mean; 0 while unknown */
  gh_rve_measures *measure;
  /* states; the first npackings are the packings as read */
  farm_state *states;
  size_t nstates, state_capacity;
  farm_list idle;   /* states without users */
  farm_list *slots; /* ranks: free slots */
  int *next_slot;   /* ranks */
  long content;     /* the last one given out */
  /* the last evaluation */
  farm_job *jobs;
  int njobs, *table;
  size_t job_capacity, table_size;
  farm_move *moves;
  size_t nmoves, move_capacity;
  bool trial; /* it succeeded, and was neither committed nor reverted */
  gh_farm_counts counts;
} farm_books;

gh_status farm_books_create(gh_context *ctx, const gh_farm_setup *setup, int ranks, farm_books *books);
void farm_books_destroy(farm_books *books);
/* Jobs, their ranks, and the moves that they need, for these F. Drops the trial states. */
gh_status farm_books_plan(farm_books *books, const double *F);
/* The moves are done: points follow, and the states that they have left are let go. */
void farm_books_settle(farm_books *books);
/* What came out for one job. */
void farm_books_answer(farm_books *books, int job, const farm_answer *answer);
void farm_books_commit(farm_books *books);
/* Stores the trial states, or releases those that were stored. */
void farm_books_keep(farm_books *books);
void farm_books_forget(farm_books *books);
/* A new state with one user, in a free slot of that rank. */
gh_status farm_books_state(farm_books *books, int packing, int rank, long content, int *state);
void farm_books_release(farm_books *books, int state);
/* The point goes from its state into another. */
void farm_books_enter(farm_books *books, int point, int state);
/* Number of different states that points are in. */
int farm_books_count(const farm_books *books);
/* All points back to the packings as read. */
void farm_books_clear(farm_books *books);

/* balance.c: changes the ranks of jobs, and the homes of their first points, where that is worth it. */
gh_status farm_balance(farm_books *books);

#endif
