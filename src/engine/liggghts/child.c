/* A program as a child process with a time limit. SPDX-License-Identifier: GPL-2.0-or-later */
#define _GNU_SOURCE 1 /* environ */
#include "engine/liggghts/child.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static bool runnable(const char *path) {
  struct stat s;
  return stat(path, &s) == 0 && S_ISREG(s.st_mode) && access(path, X_OK) == 0;
}

char *child_find(const char *program) {
  if (strchr(program, '/')) return runnable(program) ? strdup(program) : NULL;
  const char *at = getenv("PATH");
  while (at && *at && *program) {
    size_t folder = strcspn(at, ":"), size = folder + strlen(program) + 3;
    char *path = malloc(size);
    if (!path) return NULL;
    snprintf(path, size, "%.*s/%s", folder ? (int)folder : 1, folder ? at : ".", program);
    if (runnable(path)) return path;
    free(path);
    at += folder + (at[folder] == ':');
  }
  return NULL;
}

/* A child that is an MPI program of its own must not take itself for a part of this one. */
static bool of_mpi(const char *variable) {
  static const char *const prefixes[] = {"PMIX_", "PMI_", "OMPI_"};
  if (strncmp(variable, "OMPI_ALLOW_RUN_AS_ROOT", 22) == 0) return false;
  for (size_t k = 0; k < sizeof prefixes / sizeof *prefixes; k++)
    if (strncmp(variable, prefixes[k], strlen(prefixes[k])) == 0) return true;
  return false;
}

static gh_status environment(gh_context *ctx, char ***copy) {
  static char alone[] = "OMPI_MCA_ess_singleton_isolated=1";
  size_t n = 0, kept = 0;
  while (environ[n]) n++;
  GH_TRY(gh_alloc(ctx, n + 2, sizeof **copy, copy));
  for (size_t k = 0; k < n; k++)
    if (!of_mpi(environ[k])) (*copy)[kept++] = environ[k];
  (*copy)[kept] = alone;
  return GH_OK;
}

static int spawn(char *const argv[], char *const env[], const char *output, pid_t *pid) {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, output, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  int error = posix_spawn(pid, argv[0], &files, &attributes, argv, env);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  return error;
}

/* Looks every 2 ms whether the child has ended. */
static void wait_for(pid_t pid, double seconds, child_end *end, int *code) {
  double limit = gh_seconds() + seconds;
  int status = 0;
  *end = CHILD_EXIT;
  for (pid_t ended = 0; ended == 0;) {
    ended = waitpid(pid, &status, WNOHANG);
    if (ended == 0 && gh_seconds() > limit) {
      kill(-pid, SIGKILL);
      *end = CHILD_STOPPED;
      ended = waitpid(pid, &status, 0);
    }
    if (ended == 0 || (ended < 0 && errno == EINTR)) {
      nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
      ended = 0;
    }
  }
  if (*end == CHILD_EXIT && WIFSIGNALED(status)) *end = CHILD_SIGNAL;
  *code = WIFEXITED(status) ? WEXITSTATUS(status) : WIFSIGNALED(status) ? WTERMSIG(status) : -1;
}

gh_status child_run(gh_context *ctx, char *const argv[], const char *output, double seconds, child_end *end,
                    int *code) {
  char **env;
  pid_t pid;
  GH_TRY(environment(ctx, &env));
  int error = spawn(argv, env, output, &pid);
  free(env);
  if (error) return gh_fail(ctx, GH_SYSTEM, "%s cannot be started: %s", argv[0], strerror(error));
  wait_for(pid, seconds, end, code);
  return GH_OK;
}
