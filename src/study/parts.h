/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What reading, running and keeping share. */
#ifndef GRANHOM_STUDY_PARTS_H
#define GRANHOM_STUDY_PARTS_H

#include "study/internal.h"

#include "granhom/crosscheck.h"

#include <stdint.h>

typedef gh_yaml_node node;

/* ---- keys.c: what each map of a study file may hold ---- */

extern const gh_term study_keys[], study_rve_keys[], study_path_keys[], study_leg_keys[], study_units_keys[],
    study_reference_keys[], study_quick_keys[];

void study_curve_free(study_curve *curve);

/* ---- configs.c: combinations of values, references, members ---- */

/* Fills configurations, with their references and members, from parameters, base and reference. */
gh_status study_plan(gh_study *s);
/* The value that a configuration has for a key ("micro.tolerance", "refine", "packing"); NULL: that of the
 * file. */
const char *study_value(const gh_study *s, const study_config *config, const char *key);
/* The line of the study's file that sets a key for a configuration. */
int study_line(const gh_study *s, const study_config *config, const char *key);
/* Keys are set one after the other: base, parameters, reference. GH_INPUT: a later one would replace the map
 * or list that an earlier one has an entry of. */
gh_status study_check_keys(const gh_study *s);
/* All keys that a configuration sets, each once, in the order of base, parameters and reference. The strings
 * belong to the study, *list to the caller. `line`: of the key in the study's file; may be NULL. */
gh_status study_overrides(const gh_study *s, const study_config *config, gh_override **list, int **line,
                          int *count);
/* "micro.tolerance 1e-6, packing a.data": what a run is called; member -1: the configuration alone. */
void study_run_name(const gh_study *s, int config, int member, char *text, size_t size);
void study_configs_destroy(gh_study *s);

/* ---- path.c: a path of deformation gradients ---- */

typedef struct study_path {
  int rows;   /* the first is F = I at t = 0 */
  double *t;  /* rows; whole numbers are rows of the path as it is written */
  double *F;  /* rows x 4 */
  char *file; /* NULL: none */
} study_path;
/* `path` of an rve, each increment in `refine` substeps; files are relative to folder. */
gh_status study_path_read(gh_context *ctx, node path, const char *folder, long refine, study_path *out);
void study_path_free(study_path *path);
/* At every t that both have, F is the same. False: *t is the first where it is not. */
bool study_path_agree(const study_path *a, const study_path *b, double *t);

/* ---- problem.c: what one run computes ---- */

enum { STUDY_NO_PEER = -1 };

typedef struct study_problem {
  gh_context *ctx;
  char id[20];
  gh_scene *scene; /* or: */
  gh_packing *packing;
  gh_rve_options rve;
  int peer; /* gh_peer_kind, or STUDY_NO_PEER */
  study_path path;
} study_problem;
/* Reads all that the run depends on, and hashes it. A key that is `without` (index among study_overrides, -1:
 * none) stays as in the file. Messages go to ctx. To be closed also after a failure. */
gh_status study_problem_open(gh_context *ctx, const gh_study *s, int config, int member, int without,
                             study_problem *p);
void study_problem_close(study_problem *p);

/* ---- outputs.c ---- */

/* Notes the files that the study and its first problem were read from: the others differ in their packings. */
gh_status study_inputs_note(gh_study *s, const study_problem *p);
void study_inputs_free(gh_study *s);
/* GH_INPUT: one of them, or a packing, is a file that the study writes. */
gh_status study_inputs_kept(const gh_study *s, const char *folder);

/* ---- columns.c ---- */

/* Columns and quantities that answers have. The problem is one of the study's. */
gh_status study_columns(gh_study *s, const study_problem *p);

/* Whether the response of a scene is a force on a set that is displaced; else it is a displacement. */
bool study_measures_force(const gh_scene *scene);

/* ---- follow.c, scene_run.c: runs ---- */

typedef struct study_stop {
  bool (*asked)(void *data);
  void *data;
} study_stop;
bool study_stopped(const study_stop *stop); /* NULL: never */

/* Adds a row to a curve that has room for *capacity of them. */
gh_status study_curve_add(gh_context *ctx, study_curve *curve, size_t *capacity, int ncolumns, double t,
                          const double *value);
/* Follow the path, run the scene: counts, curve, residual and energy imbalance into *run; status and message
 * are returned as everywhere. */
gh_status study_follow(study_problem *p, const study_stop *stop, study_run *run);
gh_status study_scene_run(study_problem *p, const study_stop *stop, study_run *run);

/* ---- record.c ---- */

/* A finished run as JSON with a checksum. */
gh_status study_record_print(const gh_study *s, int config, const study_run *run, gh_text *out);
/* Fills *run. GH_INPUT: damaged, or of another run; *run is then as it was. */
gh_status study_record_parse(const gh_study *s, const char *text, study_run *run);
/* folder/runs/ID.json; the caller frees. */
gh_status study_record_path(const gh_study *s, const char *folder, const char *id, char **path);
/* GH_INPUT: what is in the place of the record is no file: a pipe would wait for its other end. */
gh_status study_record_check(const gh_study *s, const char *folder, const study_run *run);
/* There is a whole record of the run, and it is in *run now. */
bool study_record_find(const gh_study *s, const char *folder, study_run *run);

/* ---- reference.c, lattice.c ---- */

/* The curve of a file or a closed form into s->given. All configurations are known. */
gh_status study_reference(gh_study *s);
/* Stress and energy of equal disks on a triangular lattice, all of which move with F: three bonds a grain. */
typedef struct study_lattice {
  double radius, spacing, angle, stiffness;
} study_lattice;
/* GH_INPUT: the packing is no such lattice, or the law has friction. */
gh_status study_lattice_find(gh_context *ctx, const gh_packing *packing, const gh_contact_law *law,
                             study_lattice *lattice);
/* P, s and energy, the columns of a path. GH_INPUT: grains touch that are no neighbours. */
gh_status study_lattice_answer(gh_context *ctx, const study_lattice *lattice, const double F[4],
                               double answer[9]);

/* ---- team_mpi.c, team_alone.c: the ranks that share the runs ---- */

typedef struct study_team study_team;
/* Collective. comm NULL: this process alone. stop is called on each rank; once it has returned true on one,
 * study_team_stopped is true on all. It fails on all ranks or on none. */
gh_status study_team_create(gh_context *ctx, const void *comm, const study_stop *stop, study_team **team);
void study_team_destroy(study_team **team); /* collective */
int study_team_rank(const study_team *team);
long study_team_next(study_team *team); /* 0, 1, 2, ...: each number once among all ranks */
void study_team_stop(study_team *team); /* on all ranks */
bool study_team_stopped(void *team);
/* Rank 0 hears what others have done when it listens next. note: of at most STUDY_NOTE bytes with the 0. */
enum { STUDY_NOTE = 1024 };
void study_team_tell(study_team *team, const char *note);
/* On rank 0: hear(data, note) for each note that has come. Elsewhere nothing. */
void study_team_listen(study_team *team, void (*hear)(void *data, const char *note), void *data);
/* The worst status of all ranks, with a message on those that have none. Collective. */
gh_status study_team_worst(study_team *team, gh_status status);
/* Whether all ranks have this number. Collective. */
bool study_team_alike(study_team *team, uint64_t number);
/* The flags of rank 0, on all. */
void study_team_share(study_team *team, unsigned char *flags, int n);
/* Every rank gives its text, rank 0 takes those of all others, in the order of the ranks; waits for them, and
 * listens meanwhile. take(data, text). */
gh_status study_team_gather(study_team *team, const char *mine,
                            gh_status (*take)(void *data, const char *text), void *data,
                            void (*hear)(void *data, const char *note), void *hear_data);
/* The number of rank 0, on all ranks; waits without using the processor. */
int study_team_agree(study_team *team, int number);

#endif
