/* granhom: finds the subcommand. SPDX-License-Identifier: GPL-2.0-or-later */
#include "cli.h"
#include "reference.h"

#include "granhom/io.h"
#include "granhom/granhom.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

static const cli_command *const commands[] = {&cli_run,  &cli_rve,  &cli_element, &cli_study, &cli_crosscheck,
                                              &cli_pack, &cli_plot, &cli_report,  &cli_lammps};
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

static const cli_command *find(const char *name) {
  for (int k = 0; k < COMMANDS; k++)
    if (strcmp(commands[k]->name, name) == 0) return commands[k];
  return NULL;
}

static int least(int a, int b) {
  return a < b ? a : b;
}

/* Number of letters to change, add or drop to come from a to b (Levenshtein), for names of at most 31
 * letters. */
static int distance(const char *a, const char *b) {
  enum { MOST = 32 };
  int row[MOST], n = (int)strlen(b);
  if (n >= MOST || strlen(a) >= MOST) return MOST;
  for (int j = 0; j <= n; j++) row[j] = j;
  for (int i = 1; a[i - 1]; i++) {
    int diagonal = row[0];
    row[0] = i;
    for (int j = 1; j <= n; j++) {
      int change = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = least(change, least(row[j], row[j - 1]) + 1);
    }
  }
  return row[n];
}

static int unknown(const char *name) {
  const char *nearest = "help";
  for (int k = 0; k < COMMANDS; k++)
    if (distance(name, commands[k]->name) < distance(name, nearest)) nearest = commands[k]->name;
  fprintf(stderr, "granhom: there is no command '%s'", name);
  if (distance(name, nearest) <= 2) fprintf(stderr, "; did you mean '%s'?", nearest);
  fprintf(stderr, "\nTry `granhom help`.\n");
  return 2;
}

static int help(int argc, char **argv) {
  if (argc < 2) {
    print_help(stdout);
    return 0;
  }
  const int code = reference_help(argv[1], argc > 2 ? argv[2] : NULL);
  if (code >= 0) return code;
  const cli_command *command = find(argv[1]);
  if (!command) return unknown(argv[1]);
  printf("granhom %s: %s\n\n%s", command->name, command->summary, command->help);
  return 0;
}

/* Of LAMMPS, what the engine was built with: to ask the library itself takes ten times as long. */
static int version(void) {
  const int lammps = gh_engine_lammps_built();
  printf("granhom %s\nLAMMPS ", GH_VERSION);
  if (lammps > 0) printf("%d\n", lammps);
  else printf("cannot be used: granhom-lammps.so is not there\n");
  printf("MPI %s\nHDF5 %s\n", cli_ranks() ? "yes" : "no (make MPI=0)",
         gh_h5_available() ? "yes" : "no (make HDF5=0)");
  return 0;
}

/* Standard streams that the caller has closed: files that are opened later must not get their numbers, and
 * what is printed must fail. */
static void streams_open(void) {
  for (int fd = 0; fd <= 2; fd++)
    if (fcntl(fd, F_GETFD) == -1 && open("/dev/null", fd == 2 ? O_WRONLY : O_RDONLY) != fd) return;
}

static int command_run(int argc, char **argv) {
  const char *word = argv[1];
  if (strcmp(word, "help") == 0 || strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0)
    return help(argc - 1, argv + 1);
  if (strcmp(word, "--version") == 0 || strcmp(word, "version") == 0) return version();
  const cli_command *command = find(word);
  if (!command) return unknown(word);
  if (argc > 2 && (strcmp(argv[2], "--help") == 0 || strcmp(argv[2], "-h") == 0))
    return help(2, (char *[]){argv[2], argv[1], NULL});
  return command->run(argc - 1, argv + 1);
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
