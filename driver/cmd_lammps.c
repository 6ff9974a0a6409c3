/* granhom lammps: runs a LAMMPS input script with granhom's styles. SPDX-License-Identifier: GPL-2.0-or-later
 */
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

/* Takes the option, which is not LAMMPS's, off the arguments. */
static bool take_allow_shell(int *argc, char **argv) {
  int kept = 1;
  for (int k = 1; k < *argc; k++)
    if (strcmp(argv[k], "--allow-shell")) argv[kept++] = argv[k];
  bool found = kept < *argc;
  argv[ *argc = kept] = NULL;
  return found;
}

static int run(int argc, char **argv) {
  const bool programs = take_allow_shell(&argc, argv);
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
    .help =
        "usage: granhom lammps -in FILE [options of lmp]\n"
        "       mpirun -n N granhom lammps -in FILE [options of lmp]\n"
        "\n"
        "Runs the input script as LAMMPS's own program lmp does, log.lammps included, with styles of "
        "its own:\n"
        "  pair_style granhom/normal           one-sided harmonic normal contact\n"
        "  pair_style granhom/coulomb          the same with Coulomb friction (2d)\n"
        "  fix ID group granhom/relax          dynamic relaxation to a residual\n"
        "  compute ID group granhom/contact/local   the contacts: branch vectors, forces, stiffness, slip\n"
        "  compute ID all granhom/stress       the homogenised stress\n"
        "  compute ID group granhom/tangent    the homogenised tangent (2d)\n"
        "They are there after `clear` too, and in included files, jumps and loops.\n"
        "\n"
        "  -in FILE            the input script; without it, standard input\n"
        "  -var NAME VALUE...  sets an index variable\n"
        "  -log FILE|none      log file (log.lammps)\n"
        "  -screen FILE|none   screen output (standard output)\n"
        "  -echo none|screen|log|both\n"
        "  --allow-shell       the script may run other programs: the commands shell, python and plugin,\n"
        "                      Python in variables, fixes and pair styles, dump movie, models of KIM, and\n"
        "                      names of compressed files with special characters. Without it these are\n"
        "                      errors. Use it for scripts that you trust.\n"
        "and all others of lmp: `granhom lammps -help` lists them.\n"
        "\n"
        "Exit status: 0, or that of the script's `quit`; 1 an error of LAMMPS; 2 no such input script.\n"
        "Example scripts: lammps-inputs/.\n",
    .run = run};
