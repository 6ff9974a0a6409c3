/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the files of the study module share: a study as it was read, its runs, and what came of them.
 *
 * A configuration is one combination of the values of the parameters. It has as many runs as there are
 * packings in its ensemble (one without). A reference by `set` is a configuration too, with some parameters
 * changed; so each configuration may have a reference of its own. */
#ifndef GRANHOM_STUDY_INTERNAL_H
#define GRANHOM_STUDY_INTERNAL_H

#include "study/study.h"

/* One thing that is varied. */
typedef struct study_parameter {
  char *name; /* key of the scene or of the rve, with dots ("micro.tolerance", "steps.2.increments"); or
                 "refine", "packing" */
  int nvalues;
  char **value;   /* as written in the file: what tables show */
  double *number; /* the values as numbers; NAN where one is a word */
  int line;
} study_parameter;

/* A key with a value that a study sets: in `base`, or in a reference. */
typedef struct study_entry {
  char *key, *value;
  int line;
} study_entry;

/* How an answer changes along the path: rows of quantities over the path's parameter t (load steps, or rows
 * of the coarsest path, from 0). */
typedef struct study_curve {
  int n;
  double *t;
  double *value; /* n x ncolumns of the study */
} study_curve;

typedef struct study_run {
  char id[20];         /* hash of all that the answer depends on: name of its record */
  const char *packing; /* file of this member; belongs to the configuration */
  bool finished;       /* there is a record; failed runs are finished, too */
  bool other_build;    /* and it was written by another build of granhom */
  gh_status status;    /* GH_OK, or why it ended early: the curve then is what came before */
  char message[512];
  char warning[512]; /* of a state beyond granhom/limits.h, the first one; "" when read from a record */
  double wall, core; /* seconds: of the clock; of the processor, all threads */
  long force_evaluations, pair_evaluations, factorisations,
      evaluations;                /* of packings: machine-independent counts */
  long iterations, cuts, jumps;   /* of the macro problem; cuts alone for a path */
  double residual, energy_defect; /* the error that the run reports of itself; NAN: nothing */
  study_curve curve;
} study_run;

typedef struct study_config {
  char **value;  /* nparameters; for a reference that sets something which is no parameter, see `also` */
  int *choice;   /* nparameters: index into the parameter's values; -1: a value that only a reference has */
  char *also;    /* "key: value, ..." set by the reference beside the parameters; "" */
  bool extra;    /* needed as a reference alone: no row of its own */
  int reference; /* configuration that this one is compared with; -1: a closed form or a file is */
  int nruns;
  study_run *runs;
  char **files; /* nruns: packings of the members; NULL where the study names none, but its scene does */
} study_config;

/* A group of columns that is compared as a whole. */
typedef struct study_quantity {
  const char *name; /* "stress", "energy", "force", "dilatancy" */
  int first, count; /* columns */
} study_quantity;

typedef enum study_reference_kind { STUDY_CONFIG, STUDY_CLOSED_FORM, STUDY_FILE } study_reference_kind;

struct gh_study {
  gh_context *ctx;
  char *path, *title, *length_unit, *force_unit;
  bool quick, scene; /* scene: a macro problem; else one packing along a path */
  int nparameters;
  study_parameter *parameters;
  int nconfigs;
  study_config
      *configs; /* rows first in the order of the file (last parameter fastest), then the extra ones */
  int ncolumns;
  char **column;         /* "P11", ... "energy"; "P11" ... "force_x", "force_y", "dilatancy" */
  int nquantities, main; /* main: the quantity that sentences and pictures speak of */
  study_quantity *quantities;
  study_reference_kind reference;
  char *reference_text; /* in words, for tables */
  study_curve
      given; /* closed form or file: its curve; closed forms are evaluated at each t of the finest path */
  int ngoals;
  double *goals; /* descending: 1e-2, 1e-3, 1e-6 */
  int order;     /* parameter whose order of convergence is stated; -1: none */
  int series; /* parameter whose values are points of one curve in the pictures (the others make the curves);
                 default 0 */
  int nplots, *plots;            /* columns drawn with error bars over t in curves.png; may be none */
  struct study_verdict *verdict; /* judge.c; NULL before */
  /* what only reading and running use: */
  char *folder;        /* of the study's file */
  char *scene_path;    /* NULL: one packing along a path */
  int problem_line;    /* of `scene` or `rve` */
  int nbase, ntighter; /* entries of `base`; of `reference: {set: ...}` */
  study_entry *base, *tighter;
  char *reference_file; /* NULL: none */
  int reference_line;
  int ninputs;
  char **inputs; /* files that it was read from, but for the packings of configurations */
};

/* A value as people read it: a text that stands in quotes for YAML's sake without them. Returns `text`. */
const char *study_plain(const char *value, char *text, size_t size);

/* ---- judge.c and below it: what follows from the runs (no file is read here, nothing is run) ---- */

/* One configuration against its reference. NAN where there is nothing to compare. */
typedef struct study_judged {
  int members;     /* runs that came to the end */
  int points;      /* values of t in common with the reference, t = 0 among them */
  bool paired;     /* the reference has the same packings: each member is compared with itself, and members
                      that one of the two has not finished are left out */
  const char *why; /* why the main quantity has no error, in words; NULL: it has one, or is the reference */
  double *l2, *largest; /* nquantities: of the mean over the members: |q - q_ref| in the l2 norm over the
                           common points over that of q_ref; largest |q - q_ref| over the largest |q_ref| */
  double *single; /* nquantities: root mean square over the members of their own l2 error: what a user with
                     one packing has */
  double *confidence; /* nquantities: half width of the 95 % interval of the mean (Student's t) at each t and
                         column, all of these in the l2 norm over that of q_ref; NAN with one member */
  double *chance; /* nquantities: the same of the difference between mean and reference: an l2 below it cannot
                  be distinguished from chance. Paired: from the differences of the pairs. Else: root of the
                  sum of squares of both intervals (where the reference is no ensemble: the confidence) */
  double wall, core, force_evaluations, pair_evaluations, factorisations, evaluations, iterations, cuts,
      jumps;                      /* means over the members */
  double residual, energy_defect; /* largest (the defect: in magnitude, with its sign) over the members that
                                     tell theirs; NAN: none does */
  bool pareto, pareto_count; /* no other configuration is at least as accurate and as cheap, and better in one
                                of the two: by core seconds; by pair evaluations, or by factorisations in a
                                study without pair evaluations */
  double order;              /* between this value of the order parameter and the coarser one before; NAN */
} study_judged;

typedef struct study_verdict {
  study_judged *row; /* nconfigs */
  int nfits;         /* one for each combination of the other parameters when `order` is given */
  struct study_fit {
    int first;    /* a configuration of that combination */
    double order; /* least squares of log error over log parameter, where the error falls; sign so that
                     convergence is positive */
    int from,
        to; /* indices of the parameter's values that were used, the coarsest and the finest; -1: no fit */
    bool monotone;      /* the error falls over all values, or lies below 1e-13 */
    int up_from, up_to; /* where it does not: the first two values between which it does not fall; -1 */
  } * fits;
  bool grows; /* the order parameter: larger values are the finer ones */
} study_verdict;

gh_status study_judge(gh_study *s);
void study_verdict_destroy(gh_study *s);
/* Student's t: the 97.5 % quantile for that many degrees of freedom. */
double study_student(int freedom);
/* Tables and sentences of a judged study: study.csv, study.md, curves.csv as text; pictures into the folder.
 */
void study_write_csv(const gh_study *s, gh_text *out);
void study_write_markdown(const gh_study *s, gh_text *out);
void study_write_curves(const gh_study *s, gh_text *out);
gh_status study_draw(const gh_study *s, const char *folder);

#endif
