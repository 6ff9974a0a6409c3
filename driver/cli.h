/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What the subcommands of granhom share. */
#ifndef GRANHOM_CLI_H
#define GRANHOM_CLI_H

#include "options.h"

#include "granhom/base.h"
#include "granhom/io.h"
#include "granhom/micro.h"

/* A subcommand. What it is given goes into a struct of its own, which `defaults` fills first; then its rows
 * of options say where. One operand (a file or folder) is its subject; some take more behind it. */
typedef struct cli_command {
  const char *name, *summary, *usage, *about,
      *notes; /* about, notes: above and below the options in the help */
  const option_group *options;
  const char *noun, *missing; /* of the operand; missing: the message, NULL where it may be left out */
  size_t operand;             /* place of the operand, a const char * in the arguments */
  size_t more;                /* of an option_more for those behind it; 0: one operand alone */
  size_t size;                /* of the arguments */
  void (*defaults)(void *arguments);
  gh_status (*prepare)(gh_context *ctx, void *arguments); /* after the operand, before the options; or NULL */
  gh_status (*check)(gh_context *ctx, void *arguments); /* options that exclude or need each other; or NULL */
  gh_status (*work)(gh_context *ctx, void *arguments);
  void (*release)(void *arguments); /* of what `prepare` and `check` own; or NULL */
  bool ranks;                       /* runs on the ranks of mpirun, of which one speaks */
  int (*run)(int argc,
             char **argv); /* instead of all this: the exit status; argv[0] is the subcommand's name */
} cli_command;
extern const cli_command cli_run, cli_direct, cli_rve, cli_element, cli_study, cli_crosscheck, cli_pack,
    cli_plot, cli_report, cli_compare, cli_lammps;

/* A context whose log and progress go to standard error: a rewritten line on a terminal, plain lines at most
 * every ten seconds elsewhere. NULL (after a message) when there is no memory. */
gh_context *cli_open(void);
/* --quiet, a bool, of all commands that may take long. */
extern const option_row cli_screen_rows[];
/* Only warnings and errors from now on. */
void cli_quiet(gh_context *ctx);
/* From now on the first SIGINT or SIGTERM is a request, which cli_stop reports; the second ends the program
 * at once: files on disk are whole at any time. */
void cli_catch_signals(void);
bool cli_stop(void *data);
/* Of this process among those of mpirun; 0 without. */
int cli_rank(void);
/* Prints "granhom: message" on standard error if s is not GH_OK, on rank 0 alone: what fails, fails on all.
 * Frees ctx; returns the exit status. */
int cli_close(gh_context *ctx, gh_status s);
/* Writes a text on standard output. GH_MEMORY: the text is incomplete; GH_SYSTEM: it cannot be written. */
gh_status cli_print(gh_context *ctx, const gh_text *text);
/* The same on rank 0, and destroys the text. */
gh_status cli_print_last(gh_context *ctx, gh_text **text);
/* Runs a command with its arguments, argv[0] its name; the exit status. */
int cli_command_run(const cli_command *command, int argc, char **argv);
void cli_help(FILE *out, const cli_command *command);
/* Prints "granhom NAME: message" and how to get help; returns 2. */
int cli_usage(const cli_command *command, const char *format, ...) GH_PRINTF(2, 3);
/* For commands that may need MPI (ranks, LAMMPS, HDF5): MPI_Init where mpirun or a batch system has started
 * this process (elsewhere the LAMMPS engine does it, when it is used), MPI_Finalize at exit. GH_INPUT when
 * started on more than one rank and `single` is set, or this build has no MPI. */
gh_status cli_mpi(gh_context *ctx, bool single);
/* Open MPI's own needs where mpirun has not started this process, before MPI starts; and when it has ended. */
gh_status cli_session_start(gh_context *ctx);
void cli_session_end(void);
/* MPI_Comm * of all ranks, for the library; NULL for a process of its own and in a build without MPI. */
const void *cli_world(void);
/* How many they are; 0 in a build without MPI. */
int cli_ranks(void);
/* The value that rank 0 has, on all ranks. */
int cli_share(int value);
/* Ends all ranks. */
void cli_abort(int code);

/* outputs.c: gh_outputs_check, and GH_INPUT where an output is a file in a folder of results of granhom. */
gh_status cli_check_outputs(gh_context *ctx, const gh_output *output, int outputs, const char *const *input,
                            int inputs);
/* The same; the inputs are the results in a folder, and in others. */
gh_status cli_check_outputs_of(gh_context *ctx, const gh_output *output, int outputs, const char *folder,
                               const option_more *others);
/* Wrong input writes nothing. What shows itself only after rows of results are there is no longer that, but a
 * computation that came no further: the rows before it are written, and the exit status is 1. */
gh_status cli_end_of_rows(gh_status status, long rows);
/* What comes last whether the work before it succeeded or not: last(data, status == GH_OK). The message of
 * the first failure stays the one that is reported, and its status is returned. */
gh_status cli_finish(gh_context *ctx, gh_status status, gh_status (*last)(void *data, bool good), void *data);

#endif
