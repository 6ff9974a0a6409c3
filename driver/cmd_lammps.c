/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom lammps: runs a LAMMPS input script with granhom's styles. */
#include "cli.h"

#include "granhom/lammps.h"

#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The file after -in; NULL when there is none: LAMMPS reads standard input. */
static const char *script_of(int argc, char **argv) {
  for (int k = 1; k + 1 < argc; k++)
    if (!strcmp(argv[k], "-in") || !strcmp(argv[k], "-i")) return argv[k + 1];
  return NULL;
}

/* LAMMPS reads the script on rank 0 and sends it to the others. */
static gh_status check_script(gh_context *ctx, const char *path) {
  int there = 1;
  if (cli_rank() == 0 && path && strcmp(path, "none")) {
    struct stat info;
    /* a device without an end would be read for ever */
    there = access(path, R_OK) == 0 && stat(path, &info) == 0 &&
            (S_ISREG(info.st_mode) || S_ISFIFO(info.st_mode));
  }
  return cli_share(there) ? GH_OK : gh_fail(ctx, GH_INPUT, "cannot open the input script %s", path);
}

static const option_row rows[] = {
    {.name = "-in",
     .kind = OPTION_TEXT,
     .argument = "FILE",
     .help = "the input script; without it, standard input"},
    {.name = "-var", .kind = OPTION_TEXT, .argument = "NAME VALUE...", .help = "sets an index variable"},
    {.name = "-log", .kind = OPTION_TEXT, .argument = "FILE|none", .help = "log file (log.lammps)"},
    {.name = "-screen",
     .kind = OPTION_TEXT,
     .argument = "FILE|none",
     .help = "screen output (standard output)"},
    {.name = "-echo", .kind = OPTION_TEXT, .argument = "WORD", .help = "none, screen, log or both"},
    {.name = "allow-shell",
     .kind = OPTION_FLAG,
     .help =
         "the script may run other programs: the commands shell, python and plugin, Python in variables, "
         "fixes "
         "and pair styles, dump movie, models of KIM, and names of compressed files with special characters. "
         "Without it these are errors. Use it for scripts that you trust."},
    {0}};

/* Takes --allow-shell, which is not LAMMPS's, off the arguments; *mistyped: a word that is nearly one of
 * granhom's own. */
static bool allow_shell_take(int *argc, char **argv, const char **mistyped, const char **meant) {
  static const char *const own[] = {"--allow-shell", "--help", NULL};
  int kept = 1;
  for (int k = 1; k < *argc; k++) {
    if (!strcmp(argv[k], own[0])) continue;
    const char *nearest = strncmp(argv[k], "--", 2) == 0 ? gh_nearest(argv[k], own) : NULL;
    if (nearest && !*mistyped) *mistyped = argv[k];
    if (nearest) *meant = nearest;
    argv[kept++] = argv[k];
  }
  const bool found = kept < *argc;
  argv[ *argc = kept] = NULL;
  return found;
}

/* LAMMPS has a -h of its own, for its own help. */
static bool help_wanted(int argc, char **argv) {
  for (int k = 1; k < argc; k++)
    if (!strcmp(argv[k], "--help")) return true;
  return argc > 1 && !strcmp(argv[1], "-h");
}

static int run(int argc, char **argv) {
  const char *mistyped = NULL, *meant = NULL;
  if (help_wanted(argc, argv)) {
    cli_help(stdout, &cli_lammps);
    return 0;
  }
  const bool programs = allow_shell_take(&argc, argv, &mistyped, &meant);
  if (mistyped) return cli_usage(&cli_lammps, "unknown option %s; did you mean %s?", mistyped, meant);
  gh_context *ctx = cli_open();
  if (!ctx) return 1;
  int exit_status = 0;
  bool alone = false;
  gh_status status = cli_mpi(ctx, false);
  if (status == GH_OK) status = check_script(ctx, script_of(argc, argv));
  if (status == GH_OK) status = gh_lmp_program(ctx, argc, argv, programs, &exit_status, &alone);
  if (alone && cli_rank() > 0) fprintf(stderr, "granhom: %s\n", gh_message(ctx));
  int code = cli_close(ctx, status);
  if (alone) cli_abort(code);
  return code ? code : exit_status;
}

const cli_command cli_lammps = {
    .name = "lammps",
    .summary = "run a LAMMPS input script with granhom's styles",
    .usage = "usage: granhom lammps -in FILE [options of lmp]\n"
             "       mpirun -n N granhom lammps -in FILE [options of lmp]\n",
    .about =
        "Runs the input script as LAMMPS's own program lmp does, log.lammps included, with styles of its "
        "own:\n"
        "  pair_style granhom/normal           one-sided harmonic normal contact\n"
        "  pair_style granhom/coulomb          the same with Coulomb friction (2d)\n"
        "  fix ID group granhom/relax          dynamic relaxation to a residual\n"
        "  compute ID group granhom/contact/local   the contacts: branch vectors, forces, stiffness, slip\n"
        "  compute ID all granhom/stress       the homogenised stress\n"
        "  compute ID group granhom/tangent    the homogenised tangent (2d)\n"
        "They are there after `clear` too, and in included files, jumps and loops.\n",
    .notes = "All other options are those of lmp: `granhom lammps -help` lists them.\n\n"
             "Exit status: 0, or that of the script's `quit`; 1 an error of LAMMPS; 2 no such input script.\n"
             "Example scripts: lammps-inputs/.\n",
    .options = (const option_group[]){{rows, 0}, {0}},
    .size = sizeof(const char *),
    .run = run};
