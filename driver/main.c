/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: finds the subcommand. */
#include "cli.h"
#include "reference.h"

#include "granhom/io.h"
#include "granhom/granhom.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

static const cli_command *const commands[] = {&cli_run,    &cli_direct,     &cli_rve,   &cli_element,
                                              &cli_study,  &cli_crosscheck, &cli_pack,  &cli_plot,
                                              &cli_report, &cli_compare,    &cli_lammps};
enum { COMMANDS = sizeof commands / sizeof *commands };

static void print_help(FILE *out) {
  fprintf(
      out,
      "granhom: how structures of grains deform, by finite elements whose material is a packing of grains\n\n"
      "usage: granhom COMMAND [arguments]\n\n");
  for (int k = 0; k < COMMANDS; k++) fprintf(out, "  %-10s %s\n", commands[k]->name, commands[k]->summary);
  fprintf(out, "  %-10s %s\n", "help",
          "this page; `granhom help COMMAND` describes a command and its options,");
  fprintf(out, "  %-10s %s\n", "",
          "`granhom help keys` the keys of all input files, `granhom help columns` what results hold");
  fprintf(out, "\n`granhom --version` prints the versions. Exit status: 0 done; 1 the computation failed; 2 "
               "the input is wrong.\n");
}

static const cli_command *command_find(const char *name) {
  for (int k = 0; k < COMMANDS; k++)
    if (strcmp(commands[k]->name, name) == 0) return commands[k];
  return NULL;
}

static int command_unknown(const char *name) {
  const char *known[COMMANDS + 2] = {[COMMANDS] = "help"};
  for (int k = 0; k < COMMANDS; k++) known[k] = commands[k]->name;
  const char *nearest = gh_nearest(name, known);
  fprintf(stderr, "granhom: there is no command '%s'", name);
  if (nearest) fprintf(stderr, "; did you mean '%s'?", nearest);
  fprintf(stderr, "\nTry `granhom help`.\n");
  return 2;
}

static int help_command(const char *name, const char *file) {
  const int code = name ? reference_help(name, file) : -1;
  if (code >= 0) return code;
  const cli_command *command = name ? command_find(name) : NULL;
  if (name && !command && strcmp(name, "help") != 0) return command_unknown(name);
  if (command) cli_help(stdout, command);
  else print_help(stdout);
  return 0;
}

/* Of LAMMPS, what the engine was built with: to ask the library itself takes ten times as long. */
static int version_print(void) {
  const int lammps = gh_engine_lammps_built();
  printf("granhom %s\nLAMMPS ", GH_VERSION);
  if (lammps > 0) printf("%d\n", lammps);
  else printf("cannot be used: granhom-lammps.so is not there\n");
  printf("MPI %s\nHDF5 %s\n", cli_ranks() ? "yes" : "no (make MPI=0)",
         gh_h5_available() ? "yes" : "no (make HDF5=0)");
  return 0;
}

/* Standard streams that the caller has closed: files that are opened later must not get their numbers, and
 * what is printed must fail. A line of standard error goes out whole: of lines in pieces, Open MPI 5 puts
 * some on standard output, or into the line of another rank. */
static void streams_open(void) {
  static char line[8192];
  setvbuf(stderr, line, _IOLBF, sizeof line);
  for (int fd = 0; fd <= 2; fd++)
    if (fcntl(fd, F_GETFD) == -1 && open("/dev/null", fd == 2 ? O_WRONLY : O_RDONLY) != fd) return;
}

static int command_run(int argc, char **argv) {
  const char *word = argv[1];
  if (strcmp(word, "help") == 0 || strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0)
    return help_command(argv[2], argv[2] ? argv[3] : NULL);
  if (strcmp(word, "--version") == 0 || strcmp(word, "version") == 0) return version_print();
  const cli_command *command = command_find(word);
  if (!command) return command_unknown(word);
  if (!command->run && options_help_wanted(argc - 1, argv + 1)) return help_command(word, NULL);
  return cli_command_run(command, argc - 1, argv + 1);
}

int main(int argc, char **argv) {
  streams_open();
  signal(SIGXFSZ, SIG_IGN); /* a file that grows too large is an error of write(), with a message */
  if (argc < 2) {
    print_help(stderr);
    return 2;
  }
  int code = command_run(argc, argv);
  if (fflush(stdout) == 0 && !ferror(stdout)) return code;
  if (code == 0)
    fprintf(stderr, "granhom: standard output cannot be written\n"); /* else it has been reported */
  return code ? code : 1;
}
