/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Calls that fail on request: a library for LD_PRELOAD.
 *
 * Every allocation, and every call that reads or writes a file, made by granhom or by a library in whose name
 * it works (LAMMPS, HDF5, SuiteSparse, libyaml, cJSON, cairo, the C++ runtime) is a point; points are counted
 * in the order of the calls, and the one with the wanted number fails. What Open MPI, fontconfig and the
 * linear algebra below SuiteSparse do by themselves is no point: they end the program or ignore the failure,
 * and no caller can change that. The calls are in faultcalls.c.
 *
 * The library is a server: its constructor runs before main(), reads one order per line from descriptor
 * FAULT_FD and forks a child for each, which continues into main(). So the dynamic linker works once for
 * thousands of runs. Order: FOLDER KIND FLAVOUR POINT SECONDS; the child works in FOLDER, its output goes to
 * FOLDER.out and FOLDER.err. Answer, on the same descriptor: status (128 + signal; 124 for the time limit),
 * points, whether the point was met, and what it was. POINT 0 counts the points, -1 writes FOLDER.paths too.
 * Without FAULT_FD (ranks of mpirun) the order is in FAULT_ORDER, for the rank FAULT_RANK alone, and the
 * answer is the record in the file FAULT_ANSWER. */
#define _GNU_SOURCE
#include "faultpoint.h"

#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <ucontext.h>
#include <unistd.h>

fault_state fault = {.record = &fault.own};

/* ---- who calls ---- */

static caller caller_of_object(const char *name) {
  static const char *const libraries[] = {
      "/liblammps.",  "/libhdf5", "/libyaml", "/libcjson",       "/libcairo.",  "/libstdc++", "/libcholmod.",
      "/libumfpack.", "/libklu.", "/libamd.", "/libsuitesparse", "/libcolamd.", "/libbtf.",   "/libpng"};
  if (!*name || strstr(name, "/granhom-lammps.so")) return PROGRAM;
  for (size_t k = 0; k < sizeof libraries / sizeof *libraries; k++)
    if (strstr(name, libraries[k])) return LIBRARY;
  return OTHER;
}

static int range_add(struct dl_phdr_info *info, size_t size, void *data) {
  (void)size, (void)data;
  caller who = caller_of_object(info->dlpi_name);
  for (int k = 0; who != OTHER && k < info->dlpi_phnum; k++) {
    const ElfW(Phdr) *part = &info->dlpi_phdr[k];
    if (part->p_type != PT_LOAD || !(part->p_flags & PF_X) || fault.ranges == MOST_RANGES) continue;
    uintptr_t low = info->dlpi_addr + part->p_vaddr;
    fault.range[fault.ranges++] = (range){low, low + part->p_memsz, who};
  }
  return 0;
}

void ranges_find(void) {
  fault.ranges = 0;
  dl_iterate_phdr(range_add, NULL);
}

caller caller_of(const void *address) {
  uintptr_t a = (uintptr_t)address;
  for (int k = 0; k < fault.ranges; k++)
    if (a >= fault.range[k].low && a < fault.range[k].high) return fault.range[k].who;
  return OTHER;
}

/* ---- points ---- */

static void point_describe(const char *call, const char *subject, const void *from) {
  Dl_info info = {0};
  record *r = fault.record;
  const char *object = dladdr(from, &info) && info.dli_fname ? strrchr(info.dli_fname, '/') : NULL;
  snprintf(r->library, sizeof r->library, "%.60s", object ? object + 1 : "?");
  snprintf(r->what, sizeof r->what, "%s(%.80s) in %.80s", call, subject ? subject : "",
           info.dli_sname ? info.dli_sname : "?");
}

static unsigned path_sum(void) {
  void *call[DEPTH];
  fault.on = false;
  int n = backtrace(call, DEPTH);
  fault.on = true;
  uint64_t sum = 14695981039346656037u;
  for (int k = 0, met[3] = {0}; k < n; k++) {
    const caller who = caller_of(call[k]);
    if (fault.kind != LIB || (who != OTHER && ++met[who] <= INNER))
      sum = (sum ^ (uintptr_t)call[k]) * 1099511628211u;
  }
  return (unsigned)(sum >> 16);
}

/* Counts a point; true when it is the one to fail. */
static bool point_count(const char *call, const char *object, const void *from) {
  record *r = fault.record;
  long n = ++r->points;
  if (fault.at < 0 && n <= MOST_PATHS) r->path[n - 1] = path_sum();
  if (fault.at <= 0 || n < fault.at) return false;
  if (n > fault.at) return fault.flavour == FULL;
  fault.on = false;
  r->met = 1;
  point_describe(call, object, from);
  fault.on = true;
  return true;
}

bool fail_memory(const char *call, const void *from) {
  if (!fault.on || fault.kind == IO) return false;
  caller who = caller_of(from);
  if (who != (fault.kind == OWN ? PROGRAM : LIBRARY) || !point_count(call, NULL, from)) return false;
  errno = ENOMEM;
  return true;
}

bool path_counts(const char *path, const void *from) {
  if (!fault.on || fault.kind != IO || !path) return false;
  caller who = caller_of(from);
  if (who == PROGRAM) return true;
  return who == LIBRARY && (*path != '/' || strncmp(path, fault.folder, fault.length) == 0);
}

static bool file_counts(int fd, const void *from) {
  if (!fault.on || fault.kind != IO || fd == STDERR_FILENO || fd < 0 || fd >= MOST_FILES) return false;
  return (fault.marked[fd] || fd <= STDOUT_FILENO) && caller_of(from) != OTHER;
}

void file_mark(int fd, bool counts) {
  if (fd >= 0 && fd < MOST_FILES) fault.marked[fd] = counts;
}

bool fail_path(const char *call, const char *path, int reason, bool writes, const void *from) {
  if (!path_counts(path, from)) return false;
  if (fault.flavour == FULL && !writes) return false;
  if (fault.flavour == SOFT || fault.flavour == SHORT || !point_count(call, path, from)) return false;
  errno = fault.flavour == FULL ? ENOSPC : reason;
  return true;
}

bool fail_file(const char *call, int fd, int reason, bool writes, bool soft, const void *from) {
  if (!file_counts(fd, from)) return false;
  if (fault.flavour == FULL && !writes) return false;
  if ((fault.flavour == SOFT && !soft) || fault.flavour == SHORT) return false;
  char name[16];
  snprintf(name, sizeof name, "%d", fd);
  if (!point_count(call, name, from)) return false;
  errno = fault.flavour == FULL ? ENOSPC : fault.flavour == SOFT ? EINTR : reason;
  return true;
}

size_t fail_short(const char *call, int fd, size_t n, const void *from) {
  if (fault.flavour != SHORT || n < 2 || !file_counts(fd, from) || !point_count(call, "half", from)) return 0;
  return n / 2;
}

/* ---- crashes ---- */

/* The object whose function has called into the C library, or has failed itself. A long jump to a place that
 * libpng or FreeType had not set leaves no stack to look at. No code of granhom's jumps: that is the library.
 */
static void crash_note(int number, siginfo_t *signal_info, void *context) {
  record *r = fault.record;
  void *call[24];
  Dl_info info;
  fault.on = false;
  (void)signal_info;
  const void *at = (const void *)((ucontext_t *)context)->uc_mcontext.gregs[REG_RIP];
  if (dladdr(at, &info) && info.dli_fname && strstr(info.dli_fname, "/libc.so"))
    memcpy(r->crash, r->library, sizeof r->crash);
  int n = backtrace(call, 24);
  for (int k = 2; k < n; k++) { /* behind this function and the signal's frame */
    const char *name = dladdr(call[k], &info) && info.dli_fname ? strrchr(info.dli_fname, '/') : NULL;
    if (!name || strncmp(name, "/libc.so", 8) == 0 || strncmp(name, "/libstdc++", 10) == 0) continue;
    if (strncmp(name, "/libgcc_s", 9) == 0 || strstr(name, "faultpoint")) continue;
    snprintf(r->crash, sizeof r->crash, "%.60s", name + 1);
    break;
  }
  signal(number, SIG_DFL);
  raise(number);
}

/* Open MPI leaves the signals alone (OMPI_MCA_opal_signal, drive.py). */
static void crash_watch(void) {
  static const int numbers[] = {SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGILL};
  static char room[1 << 16]; /* for a stack that has run over */
  sigaltstack(&(stack_t){.ss_sp = room, .ss_size = sizeof room}, NULL);
  struct sigaction action = {.sa_sigaction = crash_note,
                             .sa_flags = (int)SA_RESETHAND | SA_NODEFER | SA_ONSTACK | SA_SIGINFO};
  for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) sigaction(numbers[k], &action, NULL);
}

/* ---- orders ---- */

/* FOLDER KIND FLAVOUR POINT SECONDS */
static bool order_take(const char *order, int *seconds) {
  static const char *const kinds[] = {"none", "own", "lib", "io"}, *const flavours[] = {"hard", "soft",
                                                                                        "short", "full"};
  char what[16], how[16];
  if (sscanf(order, "%4095s %15s %15s %ld %d", fault.folder, what, how, &fault.at, seconds) != 5)
    return false;
  fault.length = strlen(fault.folder);
  for (kind k = NONE; k <= IO; k++)
    if (strcmp(kinds[k], what) == 0) fault.kind = k;
  for (flavour f = HARD; f <= FULL; f++)
    if (strcmp(flavours[f], how) == 0) fault.flavour = f;
  return true;
}

static void child_begin(void) {
  char path[PATH_MAX + 8];
  setpgid(0, 0);
  int in = open("/dev/null", O_RDONLY);
  snprintf(path, sizeof path, "%s.out", fault.folder);
  int out = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  snprintf(path, sizeof path, "%s.err", fault.folder);
  int err = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND, 0666);
  if (chdir(fault.folder) != 0 || in < 0 || out < 0 || err < 0) _exit(99);
  dup2(in, 0), dup2(out, 1), dup2(err, 2);
  close(in), close(out), close(err);
  memset(fault.marked, 0, sizeof fault.marked);
  fault.on = fault.kind != NONE;
}

/* The exit status of a shell: 128 + signal; 124 when the limit was met. */
static int child_wait(pid_t child, int seconds) {
  int status = 0, steps = 0, ended;
  struct timespec pause = {0, 1000000};
  while ((ended = waitpid(child, &status, WNOHANG)) == 0 && steps < seconds * 1000) {
    nanosleep(&pause, NULL);
    steps++;
  }
  kill(-child, SIGKILL);
  if (ended == child) return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  waitpid(child, &status, 0);
  return 124;
}

/* FOLDER.paths: the sums, four bytes each. */
static void paths_write(void) {
  char path[PATH_MAX + 8];
  snprintf(path, sizeof path, "%s.paths", fault.folder);
  int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  size_t n = (size_t)(fault.record->points < MOST_PATHS ? fault.record->points : MOST_PATHS);
  if (file < 0 || write(file, fault.record->path, n * sizeof *fault.record->path) < 0) _exit(96);
  close(file);
}

static void serve(int fd) {
  FILE *orders = fdopen(fd, "r+");
  char order[PATH_MAX + 64];
  fault.record = mmap(NULL, sizeof *fault.record, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (!orders || fault.record == MAP_FAILED) _exit(99);
  setvbuf(orders, NULL, _IOLBF, BUFSIZ);
  while (fgets(order, sizeof order, orders)) {
    int seconds;
    memset(fault.record, 0, offsetof(record, path));
    if (!order_take(order, &seconds)) _exit(98);
    pid_t child = fork();
    if (child == 0) {
      close(fd);
      child_begin();
      return;
    }
    int status = child_wait(child, seconds);
    if (fault.at < 0) paths_write();
    const record *r = fault.record;
    dprintf(fd, "%d %ld %d %s %s %s\n", status, r->points, r->met, *r->library ? r->library : "-",
            *r->crash ? r->crash : "-", r->what);
  }
  _exit(0);
}

/* The answer of a rank stays in its file however it ends. */
static void answer_open(void) {
  const char *path = getenv("FAULT_ANSWER");
  int fd = path ? open(path, O_RDWR | O_CREAT | O_TRUNC, 0666) : -1;
  if (fd < 0 || ftruncate(fd, sizeof *fault.record) != 0) _exit(97);
  fault.record = mmap(NULL, sizeof *fault.record, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (fault.record == MAP_FAILED) _exit(97);
  close(fd);
}

__attribute__((constructor)) static void begin(void) {
  const char *fd = getenv("FAULT_FD"), *order = getenv("FAULT_ORDER"), *rank = getenv("FAULT_RANK");
  const char *mine = getenv("OMPI_COMM_WORLD_RANK");
  int seconds;
  ranges_find();
  crash_watch();
  void *call[1];
  backtrace(call, 1); /* the first call loads a library */
  struct rlimit none = {0, 0};
  setrlimit(RLIMIT_CORE, &none);
  unsetenv("LD_PRELOAD"); /* not for gnuplot */
  if (fd) {
    serve(atoi(fd));
  } else if (order && rank && mine && strcmp(rank, mine) == 0 && order_take(order, &seconds)) {
    answer_open();
    fault.on = fault.kind != NONE;
  }
}
