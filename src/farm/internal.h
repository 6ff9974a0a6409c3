/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Private parts of a farm. */
#ifndef GRANHOM_FARM_INTERNAL_H
#define GRANHOM_FARM_INTERNAL_H

#include "farm/books.h"
#include "farm/ranks.h"

/* A farm of RVEs, on rank 0. */
typedef struct farm_shared {
  gh_context *ctx;
  farm_comm comm;
  int ranks;
  farm_store *store; /* of this rank */
  farm_books books;
  farm_answer *answers; /* of the last evaluation, by jobs */
  unsigned char *done;  /* by jobs */
  size_t answer_capacity, done_capacity;
  farm_transfer *sends, *receives; /* of one rank */
  size_t send_capacity, receive_capacity;
  farm_message message, view;
  bool (*stop)(void *data);
  void *stop_data;
  bool cancelled; /* the other ranks have the order to stop */
} farm_shared;

gh_status farm_shared_create(gh_context *ctx, const gh_farm_setup *setup, farm_shared **shared);
void farm_shared_destroy(farm_shared **shared);
gh_status farm_shared_evaluate(farm_shared *s, const double *F, unsigned want, double *P, double *A);
gh_status farm_shared_look(farm_shared *s, int point, gh_rve_view *view);
void farm_shared_costs(farm_shared *s, gh_rve_cost *sum);

/* A message that starts with a command; to be filled and sent by farm_order. */
farm_message *farm_begin_order(farm_shared *s, farm_command command);
gh_status farm_order(farm_shared *s, int rank);
/* Waits for the reply of a rank, into s->message, and takes its status. */
gh_status farm_reply(farm_shared *s, int rank);

struct gh_farm {
  gh_context *ctx;
  int n;
  gh_point_ops ops; /* of points of any kind */
  void **points;
  farm_shared *shared; /* a farm of RVEs; NULL: points of any kind */
  bool (*stop)(void *data);
  void *stop_data;
};

#endif
