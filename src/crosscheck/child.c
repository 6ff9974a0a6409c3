/* SPDX-License-Identifier: GPL-2.0-or-later */
/* A program as a child process with a time limit. */
#define _GNU_SOURCE 1 /* environ */
#include "crosscheck/child.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static bool runnable(const char *path) {
  struct stat s;
  return stat(path, &s) == 0 && S_ISREG(s.st_mode) && access(path, X_OK) == 0;
}

char *child_find(const char *program) {
  if (strchr(program, '/')) return runnable(program) ? realpath(program, NULL) : NULL;
  const char *at = getenv("PATH");
  while (at && *at && *program) {
    size_t folder = strcspn(at, ":"), size = folder + strlen(program) + 3;
    char *path = malloc(size);
    if (!path) return NULL;
    snprintf(path, size, "%.*s/%s", folder ? (int)folder : 1, folder ? at : ".", program);
    char *whole = runnable(path) ? realpath(path, NULL) : NULL;
    free(path);
    if (whole) return whole;
    at += folder + (at[folder] == ':');
  }
  return NULL;
}

/* A child that is an MPI program of its own must not take itself for a part of this one. Its TMPDIR is ours
 * to say: programs of Open MPI that begin and end at one time get in each other's way in a common folder. */
static bool dropped(const char *variable) {
  static const char *const prefixes[] = {"PMIX_", "PMI_", "OMPI_", "TMPDIR="};
  if (strncmp(variable, "OMPI_ALLOW_RUN_AS_ROOT", 22) == 0) return false;
  for (size_t k = 0; k < sizeof prefixes / sizeof *prefixes; k++)
    if (strncmp(variable, prefixes[k], strlen(prefixes[k])) == 0) return true;
  return false;
}

static gh_status environment(gh_context *ctx, char *tmpdir, char ***copy) {
  static char alone[] = "OMPI_MCA_ess_singleton_isolated=1";
  size_t n = 0, kept = 0;
  while (environ[n]) n++;
  GH_TRY(gh_alloc(ctx, n + 3, sizeof **copy, copy));
  for (size_t k = 0; k < n; k++)
    if (!dropped(environ[k])) (*copy)[kept++] = environ[k];
  (*copy)[kept++] = alone;
  (*copy)[kept] = tmpdir;
  return GH_OK;
}

/* In the child: nothing but calls that are safe after fork. A group of its own, so that all of it can be
 * killed; and it does not outlive this program. */
static void become(char *const argv[], char *const env[], const char *output, const char *folder,
                   pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);
  int in = open("/dev/null", O_RDONLY), out = open(output, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (in < 0 || out < 0 || chdir(folder) != 0 || dup2(in, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0 ||
      dup2(out, STDERR_FILENO) < 0)
    _exit(127);
  execve(argv[0], argv, env);
  static const char message[] = "it cannot be executed\n";
  if (write(STDERR_FILENO, message, sizeof message - 1) < 0) _exit(126);
  _exit(127);
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

gh_status child_run(gh_context *ctx, char *const argv[], const char *output, const char *folder,
                    double seconds, child_end *end, int *code) {
  char **env, tmpdir[4096];
  snprintf(tmpdir, sizeof tmpdir, "TMPDIR=%s", folder);
  GH_TRY(environment(ctx, tmpdir, &env));
  pid_t parent = getpid(), pid = fork();
  if (pid == 0) become(argv, env, output, folder, parent);
  free(env);
  if (pid < 0) return gh_fail(ctx, GH_SYSTEM, "%s cannot be started: %s", argv[0], strerror(errno));
  setpgid(pid, pid); /* before it may have to be killed; the child does the same, whoever comes first */
  wait_for(pid, seconds, end, code);
  return GH_OK;
}
