/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Which rank computes what, by measured cost. */
#include "farm/books.h"

#include <stdlib.h>

/* Ranks are left alone while the slowest has at most this much more than the mean: costs change from one
 * evaluation to the next by more than what could be won. */
static const double worth = 0.03;
/* A move must win this many seconds: what sending a state costs, with a margin. */
static const double price = 1e-4;

/* Jobs of one rank, dearest first. */
typedef struct balance_rank {
  double load;
  int first, n;
} balance_rank;

typedef struct balance_job {
  double cost;
  int rank, job;
} balance_job;

static int job_compare(const void *x, const void *y) {
  const balance_job *a = x, *b = y;
  if (a->rank != b->rank) return a->rank < b->rank ? -1 : 1;
  if (a->cost != b->cost) return a->cost > b->cost ? -1 : 1;
  return (a->job > b->job) - (a->job < b->job);
}

/* Costs that are not known yet count as the mean of the known ones; false when none is known. */
static bool costs_fill(farm_books *b, double *total) {
  double sum = 0;
  int known = 0;
  for (int j = 0; j < b->njobs; j++)
    if (b->jobs[j].cost > 0) sum += b->jobs[j].cost, known++;
  for (int j = 0; j < b->njobs && known > 0; j++)
    if (!(b->jobs[j].cost > 0)) b->jobs[j].cost = sum / known;
  *total = known > 0 ? sum / known * b->njobs : 0;
  return known > 0;
}

/* The job of the slowest rank whose move to the fastest leaves the smaller maximum of the two; -1: none is
 * worth it. */
static int move_find_best(const balance_job *jobs, const balance_rank *from, const balance_rank *to,
                          double mean) {
  double excess = from->load - mean, room = mean - to->load, most = excess < room ? excess : room;
  int best = -1;
  double won = price > 0.1 * worth * mean ? price : 0.1 * worth * mean;
  for (int k = from->first; k < from->first + from->n; k++) {
    double c = jobs[k].cost, after = from->load - c > to->load + c ? from->load - c : to->load + c;
    if (jobs[k].rank < 0 || from->load - after <= won) continue;
    won = from->load - after;
    best = k;
    if (c <= most) break; /* the rest is cheaper still */
  }
  return best;
}

static void jobs_move(farm_books *b, balance_job *jobs, balance_rank *ranks, double mean) {
  for (int moves = 0; moves < b->njobs; moves++) {
    int slow = 0, fast = 0;
    for (int r = 1; r < b->ranks; r++) {
      if (ranks[r].load > ranks[slow].load) slow = r;
      if (ranks[r].load < ranks[fast].load) fast = r;
    }
    if (ranks[slow].load <= (1 + worth) * mean) return;
    int k = move_find_best(jobs, ranks + slow, ranks + fast, mean);
    if (k < 0) return;
    farm_job *job = b->jobs + jobs[k].job;
    job->rank = b->home[job->task.point] = fast;
    jobs[k].rank = -1; /* a job moves once */
    ranks[slow].load -= jobs[k].cost;
    ranks[fast].load += jobs[k].cost;
  }
}

gh_status farm_balance(farm_books *b) {
  double total;
  balance_job *jobs = NULL;
  balance_rank *ranks = NULL;
  gh_status status;
  if (!costs_fill(b, &total)) return GH_OK;
  GH_TRY_OR(gh_alloc(b->ctx, (size_t)b->njobs, sizeof *jobs, &jobs), done);
  GH_TRY_OR(gh_alloc(b->ctx, (size_t)b->ranks, sizeof *ranks, &ranks), done);
  for (int j = 0; j < b->njobs; j++)
    jobs[j] = (balance_job){.cost = b->jobs[j].cost, .rank = b->jobs[j].rank, .job = j};
  if (b->njobs > 0) qsort(jobs, (size_t)b->njobs, sizeof *jobs, job_compare);
  for (int j = b->njobs; j-- > 0;) {
    balance_rank *r = ranks + jobs[j].rank;
    r->load += jobs[j].cost;
    r->first = j;
    r->n++;
  }
  jobs_move(b, jobs, ranks, total / b->ranks);
done:
  free(jobs);
  free(ranks);
  return status;
}
