/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the writers of results share. */
#ifndef GRANHOM_RESULTS_INTERNAL_H
#define GRANHOM_RESULTS_INTERNAL_H

#include "granhom/results.h"

#include <sys/types.h>

struct gh_results {
  gh_context *ctx;
  const gh_solver_results *solver;
  char *folder;
  int points; /* integration points: 4 per element */
  gh_text *history, *convergence, *timing, *xdmf, *points_xdmf;
  bool begun; /* the folder is there */
  int frames; /* complete increments on disk */
  char started[40];
  off_t *dump_end; /* dumps.c: lengths of the files */
  double *value;   /* scratch: of the largest field, or a row of history.csv */
};

/* folder.c: a file of the folder; the caller frees. */
gh_status results_path(const gh_results *r, const char *name, char **path);
/* results.c: the texts that grow with the run. */
typedef struct results_text {
  const char *name;
  gh_text *text;
} results_text;
enum { RESULTS_TEXTS = 5 };
void results_texts(const gh_results *r, results_text list[RESULTS_TEXTS]);
/* Nodes, cells or integration points. */
static inline size_t results_field_rows(const gh_results *r, const gh_field *field) {
  const gh_mesh *m = r->solver->mesh;
  return (size_t)(field->place == GH_AT_NODES   ? m->nnodes
                  : field->place == GH_AT_CELLS ? m->nelements
                                                : r->points);
}
/* The folder is that of a run with `frames` complete increments; what came behind them is removed. */
gh_status results_resume(gh_results *r, int frames);

/* columns.c */
extern const gh_term results_timing_columns[], results_convergence_columns[], results_grain_columns[],
    results_grain_friction[], results_grain_frame[], results_contact_columns[], results_contact_friction[],
    results_history_columns[];

/* xdmf.c */
void results_xdmf_begin(gh_text *out);
void results_xdmf_step(gh_text *out, const gh_solver_results *s, const gh_frame *f);   /* of results.xdmf */
void results_xdmf_points(gh_text *out, const gh_solver_results *s, const gh_frame *f); /* of points.xdmf */
void results_xdmf_end(gh_text *out);

/* fields_h5.c, rves_h5.c, dumps.c */
gh_status results_write_fields(gh_results *r, const gh_frame *f);
gh_status results_write_rves(gh_results *r, const gh_frame *f);
gh_status results_write_dumps(gh_results *r, const gh_frame *f);

#endif
