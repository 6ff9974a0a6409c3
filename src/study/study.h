/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: error against run time: the same problem with many configurations, compared with a reference. */
#ifndef GRANHOM_STUDY_STUDY_H
#define GRANHOM_STUDY_STUDY_H

#include "granhom/io.h"
#include "granhom/report.h"
#include "granhom/scene.h"

typedef struct gh_study gh_study;

/* The keys of a study file, map by map; the columns of study.csv and curves.csv. */
const gh_term_list *gh_study_keys(void);
const gh_term_list *gh_study_columns(void);

/* Reads a study file (docs/reference/keys.md) with the scene or the path, the packings and all values that it
 * names, and checks each run as far as that can be done before it begins. GH_INPUT with file:line. Nothing is
 * written. quick: with what the file's `quick` puts in the place of its `vary` and `base`. */
gh_status gh_study_read(gh_context *ctx, const char *path, bool quick, gh_study **study);
void gh_study_destroy(gh_study **study);
/* What would run, in words: configurations, members, references. */
void gh_study_explain(const gh_study *study, gh_text *out);

/* The names of the files in a study's folder, of which the last is NULL. */
const char *const *gh_study_files(void);

typedef struct gh_study_options {
  bool (*stop)(void *data); /* called before each run and within it; NULL: never */
  void *stop_data;
  const void *comm; /* MPI_Comm * whose ranks all call gh_study_run; NULL: this process alone */
  bool fresh;       /* remove the records of these runs first */
} gh_study_options;

/* Does all runs that have no finished record of the same version, configurations and files in folder/runs,
 * spread over the ranks, then compares them and writes study.csv, study.md, curves.csv and pictures (needs
 * gnuplot) into the folder. A run that fails is a result. Records of other builds (gh_build) are used, and
 * reported. GH_STOPPED: what is finished stays. GH_INPUT, and nothing written: no folder can be there, or the
 * ranks have read different files. GH_DIVERGED: no configuration has a result. GH_SYSTEM: the folder cannot
 * be written, or files have changed meanwhile. Collective over comm; only rank 0 writes tables. */
gh_status gh_study_run(gh_study *study, const char *folder, const gh_study_options *options);
/* The table and the sentences of the last gh_study_run: what study.md holds, for the terminal. */
void gh_study_print(const gh_study *study, gh_text *out);

#endif
