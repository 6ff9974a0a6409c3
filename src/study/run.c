/* SPDX-License-Identifier: GPL-2.0-or-later */
/* All runs of a study, spread over the ranks; then tables and pictures. */
#include "granhom/limits.h"
#include "study/parts.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

/* A run among all. */
typedef struct place {
  int config, member;
} place;

typedef struct job {
  gh_study *s;
  const char *folder;
  study_team *team;
  gh_lock *lock; /* rank 0: of the folder */
  bool fresh;
  int total;   /* all runs */
  place *all;  /* by id; those of one id are one run, the first of them does it */
  place *todo; /* what has no record yet */
  int count;
  gh_text *given;   /* what this rank has done, for rank 0 */
  gh_work progress; /* rank 0 */
  int told;         /* rank 0: runs done, by whomever */
  gh_status other;  /* rank 0: how another rank has failed, and its message */
  char message[2048];
  double listened;
} job;

static study_run *run_at(const gh_study *s, place p) {
  return s->configs[p.config].runs + p.member;
}

/* ---- what is reported ---- */

static const char warned_words[] = "beyond known limits: ";

static void job_hear(void *data, const char *note) {
  job *j = data;
  const gh_level level = strstr(note, warned_words) ? GH_LEVEL_WARNING : GH_LEVEL_INFO;
  gh_log(j->s->ctx, level, "%d of %d: %s", ++j->told, j->count, note);
  gh_work_advance(j->s->ctx, &j->progress, j->told);
}

static void job_tell(job *j, place p) {
  char note[STUDY_NOTE], name[256];
  const study_run *run = run_at(j->s, p);
  study_run_name(j->s, p.config, p.member, name, sizeof name);
  const char *words = *run->warning ? warned_words : "", *comma = *run->warning ? ", " : "";
  if (run->status == GH_OK)
    snprintf(note, sizeof note - 1, "%s: done, %.3g s%s%s%s", name, run->wall, comma, words, run->warning);
  else snprintf(note, sizeof note - 1, "%s: failed after %.3g s: %s", name, run->wall, run->message);
  if (study_team_rank(j->team) == 0) job_hear(j, note);
  else study_team_tell(j->team, note);
}

/* Called within runs. */
static bool job_stopped(void *data) {
  enum { EVERY = 100 }; /* ms */
  job *j = data;
  double now = gh_seconds();
  if (now - j->listened > 1e-3 * EVERY) {
    j->listened = now;
    study_team_listen(j->team, job_hear, j);
  }
  return study_team_stopped(j->team);
}

/* ---- one run ---- */

/* Of this process and the children that it has waited for, all threads. */
static double core_seconds(void) {
  struct timespec own;
  struct rusage children;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &own);
  getrusage(RUSAGE_CHILDREN, &children);
  return (double)own.tv_sec + 1e-9 * (double)own.tv_nsec +
         (double)(children.ru_utime.tv_sec + children.ru_stime.tv_sec) +
         1e-6 * (double)(children.ru_utime.tv_usec + children.ru_stime.tv_usec);
}

static void run_clear(study_run *run) {
  study_run empty = {.packing = run->packing, .residual = NAN, .energy_defect = NAN};
  memcpy(empty.id, run->id, sizeof empty.id);
  study_curve_free(&run->curve);
  *run = empty;
}

static void run_measure(job *j, study_problem *p, study_run *run) {
  const study_stop stop = {.asked = job_stopped, .data = j};
  double begin = gh_seconds(), core = core_seconds();
  run->status = p->scene ? study_scene_run(p, &stop, run) : study_follow(p, &stop, run);
  run->wall = gh_seconds() - begin;
  run->core = core_seconds() - core;
  run->finished = run->status != GH_STOPPED;
  snprintf(run->message, sizeof run->message, "%s", run->status == GH_OK ? "" : gh_message(p->ctx));
}

static void warning_note(void *data, gh_level level, const char *line) {
  study_run *run = data;
  if (level == GH_LEVEL_WARNING && !*run->warning && gh_limits_is_warning(line))
    snprintf(run->warning, sizeof run->warning, "%s", line);
}

/* In a context of its own, so that nothing but its end and a warning of limits is logged. */
static gh_status run_compute(job *j, place at, study_run *run) {
  gh_context *quiet;
  study_problem p;
  if (gh_context_create(&quiet) != GH_OK) return gh_fail(j->s->ctx, GH_MEMORY, "no memory for a run");
  gh_set_log(quiet, warning_note, run);
  gh_status status = study_problem_open(quiet, j->s, at.config, at.member, -1, &p);
  if (status != GH_OK) { /* it was in order when the study was read */
    status = gh_fail(j->s->ctx, status == GH_INPUT ? GH_SYSTEM : status, "%s", gh_message(quiet));
  } else if (strcmp(p.id, run->id) != 0) {
    status = gh_fail(j->s->ctx, GH_SYSTEM, "files of this run have changed since the study began");
  } else {
    run_measure(j, &p, run);
  }
  study_problem_close(&p);
  gh_context_destroy(&quiet);
  return status;
}

/* What the system refused may succeed another time: no record. */
static bool is_kept(const study_run *run) {
  return run->status != GH_SYSTEM && run->status != GH_MEMORY;
}

static gh_status run_keep(job *j, place at) {
  const study_run *run = run_at(j->s, at);
  gh_text *record;
  char *path = NULL;
  GH_TRY(gh_text_create(j->s->ctx, &record));
  gh_status status = study_record_print(j->s, at.config, run, record);
  if (status == GH_OK) status = study_record_path(j->s, j->folder, run->id, &path);
  if (status == GH_OK && is_kept(run)) status = gh_text_commit(record, path);
  if (status == GH_OK && study_team_rank(j->team) > 0) {
    size_t length;
    if (gh_text_get(record, &length)) gh_text_print(j->given, "%d %d %zu\n", at.config, at.member, length);
    gh_text_join(j->given, record);
  }
  free(path);
  gh_text_destroy(&record);
  return status;
}

static gh_status do_run(job *j, place at) {
  char name[256];
  study_run *run = run_at(j->s, at);
  run_clear(run);
  study_run_name(j->s, at.config, at.member, name, sizeof name);
  gh_status status = run_compute(j, at, run);
  if (status == GH_OK && !run->finished) return gh_fail(j->s->ctx, GH_STOPPED, "stopped on request");
  if (status == GH_OK) status = run_keep(j, at);
  if (status != GH_OK) return gh_prefix(j->s->ctx, status, "%s: ", name);
  job_tell(j, at);
  return GH_OK;
}

/* Runs as long as there are some; a failure of the system ends it on all ranks. */
static gh_status job_work(job *j) {
  gh_status status = GH_OK;
  while (status == GH_OK) {
    if (job_stopped(j)) return gh_fail(j->s->ctx, GH_STOPPED, "stopped on request");
    long next = study_team_next(j->team);
    if (next >= j->count) return GH_OK;
    status = do_run(j, j->todo[next]);
  }
  study_team_stop(j->team);
  return status;
}

/* ---- what others have done ---- */

/* "STATUS MESSAGE\n", then "CONFIGURATION MEMBER LENGTH\n" and a record for each run. */
static gh_status job_take(void *data, const char *text) {
  job *j = data;
  gh_study *s = j->s;
  gh_status first = GH_OK;
  int status = 0, used = 0;
  const char *end = strchr(text, '\n');
  if (!end || sscanf(text, "%d%n", &status, &used) != 1)
    return gh_fail(s->ctx, GH_INTERNAL, "a rank has reported nothing");
  for (const char *at = end + 1; *at && first == GH_OK;) {
    place p;
    size_t length;
    if (sscanf(at, "%d %d %zu%n", &p.config, &p.member, &length, &used) != 3 || p.config < 0 ||
        p.config >= s->nconfigs || p.member < 0 || p.member >= s->configs[p.config].nruns)
      return gh_fail(s->ctx, GH_INTERNAL, "a rank has reported what cannot be read");
    at += used + 1;
    char *record = strndup(at, length);
    first = record ? study_record_parse(s, record, run_at(s, p)) : gh_fail(s->ctx, GH_MEMORY, "no memory");
    free(record);
    at += length;
  }
  if (first != GH_OK || status == GH_OK) return first;
  if (j->other == GH_OK || j->other == GH_STOPPED) { /* a stop may follow from a failure elsewhere */
    j->other = (gh_status)status;
    snprintf(j->message, sizeof j->message, "%.*s", (int)(end - text - used - 1), text + used + 1);
  }
  return GH_OK;
}

/* Rank 0 has all runs afterwards, and fails as the first rank that did. */
static gh_status job_collect(job *j, gh_status status) {
  char message[2048] = "", failure[2100];
  gh_text *all = NULL;
  if (status != GH_OK) snprintf(message, sizeof message, "%s", gh_message(j->s->ctx));
  for (char *c = message; *c; c++)
    if (*c == '\n') *c = ' ';
  gh_status told = gh_text_create(j->s->ctx, &all), given;
  if (told == GH_OK) {
    gh_text_print(all, "%d %s\n", (int)status, message);
    if (j->given) gh_text_join(all, j->given);
    told = gh_text_check(all);
  }
  snprintf(failure, sizeof failure, "%d %s\n", (int)told, gh_message(j->s->ctx)); /* rank 0 waits for it */
  given =
      study_team_gather(j->team, told == GH_OK ? gh_text_get(all, NULL) : failure, job_take, j, job_hear, j);
  if (given == GH_OK) given = told;
  gh_text_destroy(&all);
  if (status != GH_OK && status != GH_STOPPED) return gh_fail(j->s->ctx, status, "%s", message);
  if (given != GH_OK) return given;
  if (j->other != GH_OK) return gh_fail(j->s->ctx, j->other, "%s", j->message);
  return status;
}

static bool is_first(const job *j, int k) {
  return k == 0 || strcmp(run_at(j->s, j->all[k])->id, run_at(j->s, j->all[k - 1])->id) != 0;
}

/* Configurations may come to the same: one of them has run, and it is the first of those with its id. */
static gh_status job_copy_twins(job *j) {
  gh_study *s = j->s;
  gh_text *text;
  for (int k = 1; k < j->total; k++) {
    const study_run *twin = run_at(s, j->all[k - 1]);
    if (is_first(j, k) || !twin->finished) continue;
    GH_TRY(gh_text_create(s->ctx, &text));
    gh_status status = study_record_print(s, j->all[k - 1].config, twin, text);
    if (status == GH_OK) status = gh_text_check(text);
    if (status == GH_OK) status = study_record_parse(s, gh_text_get(text, NULL), run_at(s, j->all[k]));
    gh_text_destroy(&text);
    GH_TRY(status);
  }
  return GH_OK;
}

/* ---- before ---- */

/* A run with its id and its number in the order of the file. */
typedef struct entry {
  const char *id;
  int number;
  place at;
} entry;

static int entries_by_id(const void *a, const void *b) {
  const entry *x = a, *y = b;
  int order = strcmp(x->id, y->id);
  return order ? order : x->number - y->number;
}

static gh_status job_list_runs(job *j) {
  gh_study *s = j->s;
  entry *list;
  for (int k = 0; k < s->nconfigs; k++) j->total += s->configs[k].nruns;
  GH_TRY(gh_alloc(s->ctx, (size_t)j->total, sizeof *j->all, &j->all));
  GH_TRY(gh_alloc(s->ctx, (size_t)j->total, sizeof *j->todo, &j->todo));
  GH_TRY(gh_alloc(s->ctx, (size_t)j->total, sizeof *list, &list));
  for (int k = 0, n = 0; k < s->nconfigs; k++)
    for (int m = 0; m < s->configs[k].nruns; m++, n++)
      list[n] = (entry){.id = s->configs[k].runs[m].id, .number = n, .at = {k, m}};
  if (j->total > 0) qsort(list, (size_t)j->total, sizeof *list, entries_by_id);
  for (int k = 0; k < j->total; k++) j->all[k] = list[k].at;
  free(list);
  return GH_OK;
}

/* All ranks have read the same study: they refer to runs by numbers. */
static gh_status job_agree(job *j) {
  uint64_t sum = gh_sum_bytes(GH_SUM_BEGIN, &j->total, sizeof j->total);
  for (int k = 0; k < j->total; k++) {
    const char *id = run_at(j->s, j->all[k])->id;
    sum = gh_sum_bytes(gh_sum_bytes(sum, id, strlen(id)), j->all + k, sizeof *j->all);
  }
  if (study_team_alike(j->team, sum)) return GH_OK;
  return gh_fail(j->s->ctx, GH_INPUT,
                 "the ranks have read different studies: each must see the same files (this one: %d runs)",
                 j->total);
}

/* The folder for records, which can be written. */
static gh_status job_make_folder(const job *j) {
  gh_context *ctx = j->s->ctx;
  char *runs = gh_path_join(j->folder, "runs");
  if (!runs) return gh_fail(ctx, GH_MEMORY, "no memory for a path");
  gh_status status = gh_output_folder_check(ctx, runs);
  if (status == GH_OK) status = gh_folder_make(ctx, runs);
  free(runs);
  return status;
}

/* An old record would be taken for a new one where a fresh study is stopped and continued. */
static gh_status record_forget(const job *j, const study_run *run) {
  char *path;
  GH_TRY(study_record_path(j->s, j->folder, run->id, &path));
  gh_status status = unlink(path) == 0 || errno == ENOENT
                         ? GH_OK
                         : gh_fail(j->s->ctx, GH_SYSTEM, "%s: cannot remove: %s", path, strerror(errno));
  free(path);
  return status;
}

/* Rank 0: folders, and which runs have no record (flags by `all`). */
static gh_status job_prepare(job *j, unsigned char *flags) {
  gh_study *s = j->s;
  int others = 0;
  GH_TRY(gh_output_folder_check(s->ctx, j->folder));
  GH_TRY(study_inputs_kept(s, j->folder));
  GH_TRY(gh_lock_create(s->ctx, j->folder, &j->lock));
  GH_TRY(gh_output_unmixed(s->ctx, j->folder, (const char *const[]){"run.json", NULL}, "run"));
  GH_TRY(job_make_folder(j));
  for (int k = 0; k < j->total; k++) {
    study_run *run = run_at(s, j->all[k]);
    run->finished = false;
    if (!is_first(j, k)) continue;
    if (j->fresh) GH_TRY(record_forget(j, run));
    GH_TRY(study_record_check(s, j->folder, run));
    flags[k] = !study_record_find(s, j->folder, run);
    others += run->finished && run->other_build;
  }
  if (others > 0)
    gh_log(s->ctx, GH_LEVEL_WARNING,
           "%d runs have a record of another build of granhom, which may answer otherwise: a fresh study "
           "repeats them",
           others);
  return GH_OK;
}

static int places_by_config(const void *a, const void *b) {
  const place *x = a, *y = b;
  return x->config != y->config ? x->config - y->config : x->member - y->member;
}

/* What is to be done, in the order of the file. On all ranks or on none. */
static gh_status job_plan(job *j) {
  unsigned char *flags = NULL;
  gh_status status = gh_text_create(j->s->ctx, &j->given);
  if (status == GH_OK) status = job_list_runs(j);
  if (status == GH_OK) status = gh_alloc(j->s->ctx, (size_t)j->total, sizeof *flags, &flags);
  status = study_team_worst(j->team, status);
  if (status == GH_OK) status = job_agree(j);
  if (status == GH_OK && flags && study_team_rank(j->team) == 0) status = job_prepare(j, flags);
  status = study_team_worst(j->team, status);
  if (status == GH_OK && flags) {
    study_team_share(j->team, flags, j->total);
    for (int k = 0; k < j->total; k++)
      if (flags[k]) j->todo[j->count++] = j->all[k];
    if (j->count > 0) qsort(j->todo, (size_t)j->count, sizeof *j->todo, places_by_config);
  }
  free(flags);
  return status;
}

/* ---- after ---- */

static gh_status write_text(gh_study *s, const char *folder, const char *name,
                            void (*print)(const gh_study *s, gh_text *out)) {
  gh_text *text;
  char *path = gh_path_join(folder, name);
  if (!path) return gh_fail(s->ctx, GH_MEMORY, "no memory for a path");
  gh_status status = gh_text_create(s->ctx, &text);
  if (status == GH_OK) {
    print(s, text);
    status = gh_text_commit(text, path);
    gh_text_destroy(&text);
  }
  free(path);
  return status;
}

/* What an earlier study of this folder has left: its pictures may be none of this one's. */
static gh_status job_clear_old(const job *j) {
  for (const char *const *name = gh_study_files(); *name; name++) {
    char *path = gh_path_join(j->folder, *name);
    if (!path) return gh_fail(j->s->ctx, GH_MEMORY, "no memory for a path");
    unlink(path); /* what cannot be removed cannot be written either, and that is reported */
    free(path);
  }
  return GH_OK;
}

/* A study without any answer has failed; its tables show why. */
static gh_status look_for_results(gh_study *s) {
  char name[256];
  for (int k = 0; k < s->nconfigs; k++)
    for (int m = 0; m < s->configs[k].nruns && !s->configs[k].extra; m++)
      if (s->configs[k].runs[m].status == GH_OK) return GH_OK;
  study_run_name(s, 0, 0, name, sizeof name);
  return gh_fail(s->ctx, GH_DIVERGED, "no configuration has a result; the first one, %s: %s", name,
                 s->configs[0].runs[0].message);
}

/* What the system refused is no result: the tables have a gap that another attempt may fill. */
static gh_status look_for_refused(gh_study *s) {
  char name[256];
  int runs = 0, refused = 0, config = 0, member = 0;
  for (int k = 0; k < s->nconfigs; k++)
    for (int m = 0; m < s->configs[k].nruns; m++, runs++)
      if (!is_kept(s->configs[k].runs + m) && refused++ == 0) config = k, member = m;
  if (refused == 0) return GH_OK;
  const study_run *run = s->configs[config].runs + member;
  study_run_name(s, config, member, name, sizeof name);
  return gh_fail(s->ctx, run->status,
                 "the system refused %d of %d runs; the first one, %s: %s; the same command repeats them",
                 refused, runs, name, run->message);
}

static gh_status job_conclude(job *j) {
  gh_study *s = j->s;
  const char *folder = j->folder;
  GH_TRY(job_copy_twins(j));
  study_verdict_destroy(s);
  GH_TRY(study_judge(s));
  GH_TRY(job_clear_old(j));
  GH_TRY(write_text(s, folder, "study.csv", study_write_csv));
  GH_TRY(write_text(s, folder, "curves.csv", study_write_curves));
  GH_TRY(write_text(s, folder, "study.md", study_write_markdown));
  gh_status drawn = study_draw(s, folder);
  if (drawn != GH_OK && drawn != GH_ENGINE) return drawn; /* a picture that cannot be written is missing */
  if (drawn != GH_OK) gh_log(s->ctx, GH_LEVEL_WARNING, "no pictures: %s", gh_message(s->ctx));
  GH_TRY(look_for_results(s));
  return look_for_refused(s);
}

static gh_status job_tell_stop(job *j) {
  int finished = 0;
  bool done = false;
  for (int k = 0; k < j->total; k++) {
    done = is_first(j, k) ? run_at(j->s, j->all[k])->finished : done; /* twins share a record */
    finished += done;
  }
  return gh_fail(
      j->s->ctx, GH_STOPPED,
      "stopped on request: %d of %d runs are finished and kept; the same command%s continues with the "
      "others",
      finished, j->total, j->fresh ? " without --fresh" : "");
}

/* All ranks go through the same steps, whatever becomes of them. */
static gh_status job_run(job *j) {
  GH_TRY(job_plan(j));
  const bool first = study_team_rank(j->team) == 0;
  const int had = j->total - j->count;
  if (first && had > 0)
    gh_log(j->s->ctx, GH_LEVEL_INFO, "%d of %d runs have a record, or come to the same as another one", had,
           j->total);
  if (first && j->count > 0) gh_work_begin(j->s->ctx, &j->progress, "study", "runs", j->count);
  gh_status status = job_collect(j, job_work(j));
  if (first && j->count > 0) gh_work_end(j->s->ctx, &j->progress, j->told);
  if (first && status == GH_OK) status = job_conclude(j);
  if (first && status == GH_STOPPED) job_tell_stop(j);
  return (gh_status)study_team_agree(j->team, (int)status);
}

gh_status gh_study_run(gh_study *s, const char *folder, const gh_study_options *options) {
  const gh_study_options none = {0}, *o = options ? options : &none;
  const study_stop stop = {.asked = o->stop, .data = o->stop_data};
  job j = {.s = s, .folder = folder, .fresh = o->fresh};
  GH_TRY(study_team_create(s->ctx, o->comm, &stop, &j.team));
  gh_status status = job_run(&j);
  gh_text_destroy(&j.given);
  free(j.all);
  free(j.todo);
  gh_lock_destroy(&j.lock);
  study_team_destroy(&j.team);
  return status;
}
