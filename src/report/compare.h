/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A run beside others of the same scene: what is compared. */
#ifndef GRANHOM_REPORT_COMPARE_H
#define GRANHOM_REPORT_COMPARE_H

#include "report/page.h"

typedef enum compared_kind { COMPARED_REACTION, COMPARED_NUMBER } compared_kind;

/* One column of history.csv; arrays have a value per row of the comparison. */
typedef struct compared {
  const char *name;
  compared_kind kind;
  double *first, *mean, *scatter, *gap; /* scatter: NULL unless there are two others */
  double *other;                        /* others x rows */
} compared;

struct gh_comparison {
  gh_context *ctx;
  char *folder;
  report_labels labels;
  report_table table; /* of `folder` */
  report_curve curve;
  int rows, from, nothers; /* from: first row whose curves are drawn */
  bool shorter;            /* others end before `folder` does */
  double *time, *x;        /* load steps; what the curves are drawn over */
  char x_label[400];
  double largest; /* reaction */
  int n, shown;   /* quantities; the reaction that is drawn */
  compared *quantity;
  double *memory;
};

/* Unit of a quantity's gap, "" for none, and how it is called in a picture. */
const char *compared_unit(const compared *q);
void compared_label(const gh_comparison *c, const compared *q, char text[256]);

#endif
