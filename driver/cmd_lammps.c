/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom lammps: runs a LAMMPS input script with granhom's styles. */
#define _GNU_SOURCE 1 /* tee, pipe2 */
#include "cli.h"

#include "granhom/lammps.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { PIPE_WAIT = 5 /* seconds until a pipe has a writer */ };

/* Place of the file after -in; 0 when there is none: LAMMPS reads standard input. */
static int script_of(int argc, char **argv) {
  for (int k = 1; k + 1 < argc; k++)
    if (!strcmp(argv[k], "-in") || !strcmp(argv[k], "-i")) return k + 1;
  return 0;
}

/* Whether somebody writes into a pipe; what is written is not taken out of it. The descriptor does not block.
 */
static bool pipe_has_writer(int fd) {
  const struct timespec moment = {.tv_nsec = 10000000};
  const double begin = gh_seconds();
  int look[2];
  bool found = false;
  if (pipe2(look, O_CLOEXEC) != 0) return true; /* LAMMPS finds out */
  while (!found && gh_seconds() - begin < PIPE_WAIT) {
    found = tee(fd, look[1], 1, SPLICE_F_NONBLOCK) != 0; /* EAGAIN: there is a writer */
    if (!found) nanosleep(&moment, NULL);
  }
  close(look[0]);
  close(look[1]);
  return found;
}

/* The pipe becomes standard input: LAMMPS would wait for a writer that has written all and gone. */
static bool pipe_take(const char *path) {
  const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return false;
  const bool taken = pipe_has_writer(fd) && dup2(fd, STDIN_FILENO) >= 0 &&
                     fcntl(STDIN_FILENO, F_SETFL, fcntl(STDIN_FILENO, F_GETFL) & ~O_NONBLOCK) == 0;
  close(fd);
  return taken;
}

/* LAMMPS reads the script on rank 0 and sends it to the others. A device without an end would be read for ever,
 * a pipe that nobody writes into be waited for. */
static gh_status check_script(gh_context *ctx, int *argc, char **argv) {
  const int at = cli_rank() > 0 ? 0 : script_of(*argc, argv);
  const char *path = at ? argv[at] : "none";
  struct stat info = {.st_mode = S_IFREG};
  int there = !strcmp(path, "none") || (access(path, R_OK) == 0 && stat(path, &info) == 0);
  const bool fifo = there && S_ISFIFO(info.st_mode);
  if (fifo) there = pipe_take(path);
  else there = there && S_ISREG(info.st_mode);
  if (!cli_share(there))
    return gh_fail(ctx, GH_INPUT, "cannot open the input script %s%s", path,
                   fifo ? ": a pipe that nothing is written into" : "");
  if (!fifo) return GH_OK;
  for (int k = at - 1; k + 2 <= *argc; k++) argv[k] = argv[k + 2]; /* with the NULL */
  *argc -= 2;
  return GH_OK;
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
  if (status == GH_OK) status = check_script(ctx, &argc, argv);
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
