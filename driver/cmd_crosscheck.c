/* granhom crosscheck: one packing and path through several programs. SPDX-License-Identifier:
 * GPL-2.0-or-later */
#include "cli.h"
#include "contact_options.h"
#include "path.h"

#include "granhom/crosscheck.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "usage: granhom crosscheck PACKING --path PATH.csv [options] -o DIR\n"
    "\n"
    "Takes one packing (a LAMMPS data file, atom_style sphere) in its periodic cell along a path of\n"
    "deformation gradients with several programs, and compares their stresses:\n"
    "  lammps     granhom on LAMMPS\n"
    "  native     granhom's own engine\n"
    "  gran       LAMMPS's pair style gran/hooke/history\n"
    "  liggghts   LIGGGHTS, gran model hooke/stiffness tangential history, when it is installed; no shear\n"
    "The last two integrate the slip of a contact over the time steps of a damped motion; granhom takes it\n"
    "from one converged state to the next. --refine shows how the difference shrinks with the increments.\n"
    "\n"
    "  --path FILE            CSV with the columns F11 F12 F21 F22 (and step), a row per increment; - is\n"
    "                         standard input\n"
    "  -o, --output DIR       folder of the results: crosscheck.csv, crosscheck.png (needs gnuplot), and\n"
    "                         refine.csv with --refine\n" CONTACT_HELP
    "                         --hardening must be 0 here: the other programs have none\n"
    "  --engines LIST         of the words above, with commas; all others are compared with the first\n"
    "                         (default lammps,native,gran,liggghts)\n"
    "  --tolerance T          largest force on a grain over the mean contact force (default "
    "1e-8)\n" CLI_RELAXATION_HELP
    "                         (of lammps and native: the other programs have their own)\n"
    "  --max-steps N          relaxation steps after which an increment has failed (default 400000)\n"
    "  --increment-steps N    time steps over which gran and liggghts spread an increment (default 50)\n"
    "  --refine K             also with each increment cut into 2, 4, ... 2^(K-1) parts; 1 to 8 (default 1)\n"
    "  --liggghts PROGRAM     LIGGGHTS's program (default liggghts)\n"
    "  --time-limit S         seconds after which gran and liggghts are stopped, on each path (default 600)\n"
    "\n"
    "Exit status: 0 done, also when LIGGGHTS is missing or cannot do the path (the table says so); 1 a "
    "program\n"
    "failed or was stopped (what there is is written), 2 wrong input.\n";

typedef struct cross_job {
  gh_context *ctx;
  const char *packing_file, *path_file, *folder;
  gh_lock *lock; /* of the folder */
  gh_packing *packing;
  path_rows path;
  double *F;
  long *step;
  gh_crosscheck_options o;
  gh_crosscheck *c;
} cross_job;

/* ---- options ---- */

static int find_engine(const char *text, size_t length) {
  for (int k = 0; k < GH_CROSS_ENGINES; k++)
    if (strlen(gh_cross_word(k)) == length && strncmp(gh_cross_word(k), text, length) == 0) return k;
  return -1;
}

static int parse_engines(const char *text, cross_job *j) {
  j->o.engines = 0;
  for (const char *at = text;; at++) {
    size_t length = strcspn(at, ",");
    int k = find_engine(at, length);
    if (k < 0)
      return cli_usage(&cli_crosscheck, "--engines are lammps, native, gran and liggghts, not \"%.*s\"",
                       (int)length, at);
    for (int e = 0; e < j->o.engines; e++)
      if (j->o.engine[e] == k)
        return cli_usage(&cli_crosscheck, "--engines names %s twice", gh_cross_word(k));
    j->o.engine[j->o.engines++] = k;
    at += length;
    if (!*at) break;
  }
  if (j->o.engines > 1) return 0;
  return cli_usage(&cli_crosscheck, "--engines must name two or more: there is nothing to compare");
}

static int parse_option(int c, void *data) {
  cross_job *j = data;
  long value = 1;
  int status;
  switch (c) {
  case 'p':
    j->path_file = optarg;
    return 0;
  case 'o':
    j->folder = optarg;
    return 0;
  case 'l':
    j->o.liggghts = optarg;
    return 0;
  case 'e':
    return parse_engines(optarg, j);
  case 'T':
    return cli_positive(&cli_crosscheck, "--tolerance", optarg, 1, &j->o.rve.tolerance);
  case 't':
    return cli_positive(&cli_crosscheck, "--time-limit", optarg, INFINITY, &j->o.seconds);
  case 'n':
    return cli_integer(&cli_crosscheck, "--max-steps", optarg, 1, 1000000000, &j->o.rve.max_steps);
  case 'w':
    return cli_relaxation(&cli_crosscheck, optarg, &j->o.rve.relaxation);
  case 'i':
    status = cli_integer(&cli_crosscheck, "--increment-steps", optarg, 1, 1000000, &value);
    j->o.steps_per_row = (int)value;
    return status;
  case 'r':
    status = cli_integer(&cli_crosscheck, "--refine", optarg, 1, GH_CROSS_LEVELS, &value);
    j->o.levels = (int)value;
    return status;
  default: /* b */
    if (strcmp(optarg, "periodic") == 0) return 0;
    return cli_usage(&cli_crosscheck,
                     "the other programs relax all grains of a periodic cell: --boundary "
                     "can only be periodic, not \"%s\"",
                     optarg);
  }
}

static int parse(int argc, char **argv, cross_job *j) {
  static const struct option options[] = {{"path", 1, 0, 'p'},
                                          {"output", 1, 0, 'o'},
                                          {"boundary", 1, 0, 'b'},
                                          {"engines", 1, 0, 'e'},
                                          {"tolerance", 1, 0, 'T'},
                                          {"max-steps", 1, 0, 'n'},
                                          {"increment-steps", 1, 0, 'i'},
                                          {"refine", 1, 0, 'r'},
                                          {"relaxation", 1, 0, 'w'},
                                          {"liggghts", 1, 0, 'l'},
                                          {"time-limit", 1, 0, 't'},
                                          CONTACT_OPTIONS,
                                          {0, 0, 0, 0}};
  contact_options contact = {0};
  int status =
      contact_arguments(&cli_crosscheck, argc, argv, options, &contact, parse_option, j, &j->packing_file);
  if (status) return status;
  if (!j->path_file) return cli_usage(&cli_crosscheck, "--path is missing");
  if (!j->folder) return cli_usage(&cli_crosscheck, "-o is missing: a folder for the results");
  j->o.rve.allow_overlap = contact_allowed(&contact);
  status = contact_law(&cli_crosscheck, &contact, &j->o.rve.law);
  if (status == 0 && j->o.rve.law.hardening > 0)
    return cli_usage(&cli_crosscheck, "--hardening must be 0: the other programs have none");
  return status;
}

/* ---- the work ---- */

static gh_status path_set(cross_job *j) {
  const size_t rows = (size_t)j->path.csv->nrows;
  GH_TRY(gh_alloc(j->ctx, rows, 4 * sizeof *j->F, &j->F));
  GH_TRY(gh_alloc(j->ctx, rows, sizeof *j->step, &j->step));
  for (int row = 0; row < j->path.csv->nrows; row++) {
    path_F(&j->path, row, j->F + 4 * row);
    j->step[row] = path_step(&j->path, row);
  }
  j->o.packing = j->packing;
  j->o.rows = j->path.csv->nrows;
  j->o.F = j->F;
  j->o.step = j->step;
  return GH_OK;
}

static gh_status table_print(const cross_job *j) {
  gh_text *text;
  GH_TRY(gh_text_create(j->ctx, &text));
  gh_crosscheck_print(j->c, text);
  gh_status status = cli_print(j->ctx, text);
  gh_text_destroy(&text);
  return status;
}

static gh_status crosscheck(cross_job *j) {
  GH_TRY(gh_packing_read(j->ctx, j->packing_file, &j->packing));
  GH_TRY(path_read(j->ctx, j->path_file, &j->path));
  GH_TRY(path_check(j->ctx, j->path_file, &j->path, &j->o.rve, j->packing));
  GH_TRY(cli_mpi(j->ctx, true));
  GH_TRY(path_set(j));
  GH_TRY(gh_crosscheck_create(j->ctx, &j->o, &j->c));
  GH_TRY(gh_output_folder_check(j->ctx, j->folder));
  GH_TRY(gh_lock_create(j->ctx, j->folder, &j->lock));
  GH_TRY(gh_crosscheck_run(j->c, j->folder));
  GH_TRY(table_print(j));
  gh_status drawn = gh_crosscheck_draw(j->c, j->folder);
  if (drawn != GH_OK && drawn != GH_ENGINE) return drawn; /* a picture that cannot be written is missing */
  if (drawn != GH_OK) gh_log(j->ctx, GH_LEVEL_WARNING, "no picture: %s", gh_message(j->ctx));
  return gh_crosscheck_verdict(j->c);
}

static void job_free(cross_job *j) {
  gh_crosscheck_destroy(&j->c);
  free(j->F);
  free(j->step);
  gh_csv_destroy(&j->path.csv);
  gh_packing_destroy(&j->packing);
  gh_lock_destroy(&j->lock);
}

static int run(int argc, char **argv) {
  cross_job j = {.o = {.rve = gh_rve_defaults(),
                       .steps_per_row = 50,
                       .seconds = 600,
                       .engines = GH_CROSS_ENGINES,
                       .engine = {0, 1, 2, 3},
                       .levels = 1}};
  j.o.rve.boundary = GH_PERIODIC;
  if (j.o.rve.max_steps == 0) j.o.rve.max_steps = 400000;
  int usage = parse(argc, argv, &j);
  if (usage) return usage;
  signal(SIGPIPE, SIG_IGN); /* gnuplot may end early: its status tells */
  j.ctx = cli_open();
  if (!j.ctx) return 1;
  gh_status status = crosscheck(&j);
  job_free(&j);
  return cli_close(j.ctx, status);
}

const cli_command cli_crosscheck = {"crosscheck", "one packing and path through several programs, compared",
                                    help, run};
