/* SPDX-License-Identifier: GPL-2.0-or-later */
/* From the arguments of a subcommand to its exit status. */
#include "cli.h"

#include <stdlib.h>

/* The arguments before anything is read; NULL: no memory. */
static void *command_defaults(const cli_command *command) {
  void *arguments = calloc(1, command->size);
  if (arguments && command->defaults) command->defaults(arguments);
  return arguments;
}

void cli_help(FILE *out, const cli_command *command) {
  void *arguments = command_defaults(command);
  fprintf(out, "granhom %s: %s\n\n", command->name, command->summary);
  help_print(out, command->usage);
  fputc('\n', out);
  help_print(out, command->about);
  fputc('\n', out);
  if (arguments) options_print(out, command->options, arguments);
  fprintf(out, "%-26s%s\n%s", "  -h, --help", "this page", *command->notes ? "\n" : "");
  help_print(out, command->notes);
  free(arguments);
}

/* *usage: the command line is wrong, not what its files hold. */
static gh_status command_read(gh_context *ctx, const cli_command *command, int argc, char **argv,
                              void *arguments, bool *usage) {
  option_line line = {.groups = command->options, .argc = argc, .argv = argv, .noun = command->noun};
  if (command->more) line.more = (option_more *)((char *)arguments + command->more);
  *usage = true;
  GH_TRY(options_scan(ctx, &line));
  if (!line.operand && command->missing) return gh_fail(ctx, GH_INPUT, "%s", command->missing);
  *(const char **)((char *)arguments + command->operand) = line.operand;
  *usage = false;
  if (command->prepare) GH_TRY(command->prepare(ctx, arguments));
  *usage = true;
  GH_TRY(options_read(ctx, &line, arguments));
  if (command->check) GH_TRY(command->check(ctx, arguments));
  *usage = false;
  return GH_OK;
}

int cli_command_run(const cli_command *command, int argc, char **argv) {
  bool usage = false;
  if (command->run) return command->run(argc, argv);
  gh_context *ctx = cli_open();
  if (!ctx) return 1;
  void *arguments = command_defaults(command);
  gh_status status = arguments ? GH_OK : gh_fail(ctx, GH_MEMORY, "no memory for the arguments");
  if (status == GH_OK && command->ranks) status = cli_mpi(ctx, false);
  if (status == GH_OK) status = command_read(ctx, command, argc, argv, arguments, &usage);
  if (status == GH_OK) status = command->work(ctx, arguments);
  if (arguments && command->release) command->release(arguments);
  free(arguments);
  if (!usage || status != GH_INPUT) return cli_close(ctx, status);
  cli_usage(command, "%s", gh_message(ctx));
  gh_context_destroy(&ctx);
  return gh_exit_status(status);
}
