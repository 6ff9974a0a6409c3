/* Calls that fail on request: a library for LD_PRELOAD. SPDX-License-Identifier: GPL-2.0-or-later
 *
 * Every allocation, and every call that reads or writes a file, made by granhom or by a library in whose name
 * it works (LAMMPS, HDF5, SuiteSparse, libyaml, cJSON, cairo, the C++ runtime) is a point; points are counted
 * in the order of the calls, and the one with the wanted number fails. What Open MPI, fontconfig and the
 * linear algebra below SuiteSparse do by themselves is no point: they end the program or ignore the failure,
 * and no caller can change that.
 *
 * The library is a server: its constructor runs before main(), reads one order per line from descriptor
 * FAULT_FD and forks a child for each, which goes on into main(). So the dynamic linker works once for
 * thousands of runs. Order: FOLDER KIND FLAVOUR POINT SECONDS; the child works in FOLDER, its output goes to
 * FOLDER.out and FOLDER.err. Answer, on the same descriptor: status (128 + signal; 124 for the time limit),
 * points, whether the point was met, and what it was. POINT 0 counts the points, -1 writes FOLDER.paths too.
 * Without FAULT_FD (ranks of mpirun) the order is in FAULT_ORDER, for the rank FAULT_RANK alone, and the
 * answer is the record in the file FAULT_ANSWER. */
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <limits.h>
#include <link.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
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

extern void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t),
    *__libc_memalign(size_t, size_t);

/* own: allocations of granhom's code; lib: those of the libraries; io: calls on files. */
typedef enum kind { NONE, OWN, LIB, IO } kind;
/* hard: the error that the call has most often; soft: EINTR, or a short count, where the call may give it;
 * full: the device stays full from the point on. */
typedef enum flavour { HARD, SOFT, SHORT, FULL } flavour;
typedef enum caller { OTHER, PROGRAM, LIBRARY } caller;

enum { MOST_PATHS = 1 << 17, DEPTH = 64, INNER = 3 };

/* In memory that a child shares with the server. path: of each point, a sum over the calls that led to it,
 * for the first MOST_PATHS when all are counted; of an allocation in a library, over the INNER last calls of
 * libraries and of granhom, because their recursion leads to the same few places in endless variety. */
typedef struct record {
  long points;
  int met;
  char what[200];
  char library[64], crash[64]; /* of the caller of the point; whose code a signal has ended */
  unsigned path[MOST_PATHS];
} record;

typedef struct range {
  uintptr_t low, high;
  caller who;
} range;

enum { MOST_RANGES = 64, MOST_FILES = 1024 };
static struct {
  kind kind;
  flavour flavour;
  long at;
  bool on;
  record *record, own;
  range range[MOST_RANGES];
  int ranges;
  char marked[MOST_FILES];
  char folder[PATH_MAX];
  size_t length;
} fault = {.record = &fault.own};

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

static caller caller_of(const void *address) {
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

static bool fail_memory(const char *call, const void *from) {
  if (!fault.on || fault.kind == IO) return false;
  caller who = caller_of(from);
  if (who != (fault.kind == OWN ? PROGRAM : LIBRARY) || !point_count(call, NULL, from)) return false;
  errno = ENOMEM;
  return true;
}

static bool path_counts(const char *path, const void *from) {
  if (!fault.on || fault.kind != IO || !path) return false;
  caller who = caller_of(from);
  if (who == PROGRAM) return true;
  return who == LIBRARY && (*path != '/' || strncmp(path, fault.folder, fault.length) == 0);
}

static bool file_counts(int fd, const void *from) {
  if (!fault.on || fault.kind != IO || fd == STDERR_FILENO || fd < 0 || fd >= MOST_FILES) return false;
  return (fault.marked[fd] || fd <= STDOUT_FILENO) && caller_of(from) != OTHER;
}

static void file_mark(int fd, bool counts) {
  if (fd >= 0 && fd < MOST_FILES) fault.marked[fd] = counts;
}

/* A call that takes room on the device (`writes`), or not. */
static bool fail_path(const char *call, const char *path, int reason, bool writes, const void *from) {
  if (!path_counts(path, from)) return false;
  if (fault.flavour == FULL && !writes) return false;
  if (fault.flavour == SOFT || fault.flavour == SHORT || !point_count(call, path, from)) return false;
  errno = fault.flavour == FULL ? ENOSPC : reason;
  return true;
}

/* ... on an open file. `soft`: the call may be interrupted. */
static bool fail_file(const char *call, int fd, int reason, bool writes, bool soft, const void *from) {
  if (!file_counts(fd, from)) return false;
  if (fault.flavour == FULL && !writes) return false;
  if ((fault.flavour == SOFT && !soft) || fault.flavour == SHORT) return false;
  char name[16];
  snprintf(name, sizeof name, "%d", fd);
  if (!point_count(call, name, from)) return false;
  errno = fault.flavour == FULL ? ENOSPC : fault.flavour == SOFT ? EINTR : reason;
  return true;
}

/* Number of bytes of a count that is cut short, or 0 when it is not. */
static size_t fail_short(const char *call, int fd, size_t n, const void *from) {
  if (fault.flavour != SHORT || n < 2 || !file_counts(fd, from) || !point_count(call, "half", from)) return 0;
  return n / 2;
}

#define FROM __builtin_return_address(0)
/* The function behind ours. dlsym may allocate: that is no point. */
#define REAL(name)                                                                                           \
  static __typeof__(&name) real;                                                                             \
  if (!real) {                                                                                               \
    bool before_ = fault.on;                                                                                 \
    fault.on = false;                                                                                        \
    *(void **)&real = dlsym(RTLD_NEXT, #name);                                                               \
    fault.on = before_;                                                                                      \
  }

/* ---- memory ---- */

void *malloc(size_t n) {
  return fail_memory("malloc", FROM) ? NULL : __libc_malloc(n);
}
void *calloc(size_t n, size_t size) {
  return fail_memory("calloc", FROM) ? NULL : __libc_calloc(n, size);
}
void *realloc(void *p, size_t n) {
  return n && fail_memory("realloc", FROM) ? NULL : __libc_realloc(p, n);
}
void *aligned_alloc(size_t alignment, size_t n) {
  return fail_memory("aligned_alloc", FROM) ? NULL : __libc_memalign(alignment, n);
}
void *memalign(size_t alignment, size_t n) {
  return fail_memory("memalign", FROM) ? NULL : __libc_memalign(alignment, n);
}
int posix_memalign(void **p, size_t alignment, size_t n) {
  if (fail_memory("posix_memalign", FROM)) return ENOMEM;
  void *memory = __libc_memalign(alignment, n);
  if (memory) *p = memory;
  return memory ? 0 : ENOMEM;
}
char *strndup(const char *text, size_t most) {
  size_t n = strnlen(text, most);
  char *copy = fail_memory("strndup", FROM) ? NULL : __libc_malloc(n + 1);
  if (!copy) return NULL;
  memcpy(copy, text, n);
  copy[n] = 0;
  return copy;
}
char *strdup(const char *text) {
  size_t n = strlen(text) + 1;
  char *copy = fail_memory("strdup", FROM) ? NULL : __libc_malloc(n);
  return copy ? memcpy(copy, text, n) : NULL;
}
FILE *open_memstream(char **text, size_t *size) {
  REAL(open_memstream);
  return fail_memory("open_memstream", FROM) ? NULL : real(text, size);
}

/* ---- files by name ---- */

#define OPEN(name)                                                                                           \
  int name(const char *path, int flags, ...) {                                                               \
    REAL(name);                                                                                              \
    va_list args;                                                                                            \
    va_start(args, flags);                                                                                   \
    int mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(args, int) : 0;                                        \
    va_end(args);                                                                                            \
    if (fail_path("open", path, EMFILE, flags & O_CREAT, FROM)) return -1;                                   \
    int fd = real(path, flags, mode);                                                                        \
    file_mark(fd, path_counts(path, FROM));                                                                  \
    return fd;                                                                                               \
  }
OPEN(open)
OPEN(open64)

int openat(int folder, const char *path, int flags, ...) {
  REAL(openat);
  va_list args;
  va_start(args, flags);
  int mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(args, int) : 0;
  va_end(args);
  if (fail_path("openat", path, EMFILE, flags & O_CREAT, FROM)) return -1;
  int fd = real(folder, path, flags, mode);
  file_mark(fd, path_counts(path, FROM));
  return fd;
}

#define FOPEN(name)                                                                                          \
  FILE *name(const char *path, const char *mode) {                                                           \
    REAL(name);                                                                                              \
    if (fail_path("fopen", path, EMFILE, strpbrk(mode, "wa+"), FROM)) return NULL;                           \
    FILE *file = real(path, mode);                                                                           \
    if (file) file_mark(fileno(file), path_counts(path, FROM));                                              \
    return file;                                                                                             \
  }
FOPEN(fopen)
FOPEN(fopen64)

/* NAME(PARAMETERS) calls real(ARGUMENTS); it fails with REASON for the path P, taking room or not. */
#define BY_PATH(result, name, parameters, arguments, p, reason, writes, failure)                             \
  result name parameters {                                                                                   \
    REAL(name);                                                                                              \
    return fail_path(#name, p, reason, writes, FROM) ? failure : real arguments;                             \
  }
BY_PATH(int, mkdir, (const char *path, mode_t mode), (path, mode), path, EIO, true, -1)
BY_PATH(int, mkdirat, (int at, const char *path, mode_t mode), (at, path, mode), path, EIO, true, -1)
BY_PATH(int, unlink, (const char *path), (path), path, EIO, false, -1)
BY_PATH(int, unlinkat, (int at, const char *path, int flags), (at, path, flags), path, EIO, false, -1)
BY_PATH(int, remove, (const char *path), (path), path, EIO, false, -1)
BY_PATH(int, rmdir, (const char *path), (path), path, EIO, false, -1)
BY_PATH(int, rename, (const char *from, const char *to), (from, to), to, EIO, true, -1)
BY_PATH(int, renameat, (int a, const char *from, int b, const char *to), (a, from, b, to), to, EIO, true, -1)
BY_PATH(int, link, (const char *from, const char *to), (from, to), to, EIO, true, -1)
BY_PATH(int, stat, (const char *path, struct stat *info), (path, info), path, EIO, false, -1)
BY_PATH(int, lstat, (const char *path, struct stat *info), (path, info), path, EIO, false, -1)
BY_PATH(int, fstatat, (int at, const char *path, struct stat *info, int f), (at, path, info, f), path, EIO,
        false, -1)
BY_PATH(int, access, (const char *path, int mode), (path, mode), path, EIO, false, -1)
BY_PATH(int, faccessat, (int at, const char *path, int mode, int f), (at, path, mode, f), path, EIO, false,
        -1)
BY_PATH(ssize_t, readlink, (const char *path, char *name, size_t n), (path, name, n), path, EIO, false, -1)
BY_PATH(int, linkat, (int a, const char *from, int b, const char *to, int f), (a, from, b, to, f), to, EIO,
        true, -1)
BY_PATH(int, chmod, (const char *path, mode_t mode), (path, mode), path, EIO, false, -1)
BY_PATH(char *, realpath, (const char *path, char *resolved), (path, resolved), path, EIO, false, NULL)
BY_PATH(char *, getcwd, (char *text, size_t size), (text, size), ".", EIO, false, NULL)
BY_PATH(char *, mkdtemp, (char *path), (path), path, ENOSPC, true, NULL)
BY_PATH(DIR *, opendir, (const char *path), (path), path, EMFILE, false, NULL)
BY_PATH(FILE *, popen, (const char *command, const char *mode), (command, mode), command, EMFILE, false, NULL)
BY_PATH(pid_t, fork, (void), (), "process", EAGAIN, false, -1)
BY_PATH(int, pipe, (int fd[2]), (fd), "pipe", EMFILE, false, -1)
BY_PATH(int, pipe2, (int fd[2], int flags), (fd, flags), "pipe", EMFILE, false, -1)
BY_PATH(int, socketpair, (int d, int type, int p, int fd[2]), (d, type, p, fd), "pair", EMFILE, false, -1)

int mkstemp(char *path) {
  REAL(mkstemp);
  if (fail_path("mkstemp", path, EMFILE, true, FROM)) return -1;
  int fd = real(path);
  file_mark(fd, path_counts(path, FROM));
  return fd;
}

/* ---- open files ---- */

#define READ(name, parameters, arguments, half, writes, reason)                                              \
  ssize_t name parameters {                                                                                  \
    REAL(name);                                                                                              \
    if (fail_file(#name, fd, reason, writes, true, FROM)) return -1;                                         \
    size_t part = fail_short(#name, fd, n, FROM);                                                            \
    return part ? real half : real arguments;                                                                \
  }
READ(read, (int fd, void *p, size_t n), (fd, p, n), (fd, p, part), false, EIO)
READ(write, (int fd, const void *p, size_t n), (fd, p, n), (fd, p, part), true, ENOSPC)
READ(pread, (int fd, void *p, size_t n, off_t at), (fd, p, n, at), (fd, p, part, at), false, EIO)
READ(pread64, (int fd, void *p, size_t n, off64_t at), (fd, p, n, at), (fd, p, part, at), false, EIO)
READ(pwrite, (int fd, const void *p, size_t n, off_t at), (fd, p, n, at), (fd, p, part, at), true, ENOSPC)
READ(pwrite64, (int fd, const void *p, size_t n, off64_t at), (fd, p, n, at), (fd, p, part, at), true, ENOSPC)

#define BY_FILE(name, parameters, arguments, reason, writes, soft)                                           \
  int name parameters {                                                                                      \
    REAL(name);                                                                                              \
    return fail_file(#name, fd, reason, writes, soft, FROM) ? -1 : real arguments;                           \
  }
BY_FILE(fsync, (int fd), (fd), EIO, true, true)
BY_FILE(fdatasync, (int fd), (fd), EIO, true, true)
BY_FILE(ftruncate, (int fd, off_t n), (fd, n), EIO, true, true)
BY_FILE(ftruncate64, (int fd, off64_t n), (fd, n), EIO, true, true)
BY_FILE(fstat, (int fd, struct stat *info), (fd, info), EIO, false, false)
BY_FILE(fchmod, (int fd, mode_t mode), (fd, mode), EIO, false, false)
BY_FILE(flock, (int fd, int what), (fd, what), ENOLCK, false, true)

/* The file is closed also when closing fails. */
int close(int fd) {
  REAL(close);
  bool fails = fail_file("close", fd, EIO, true, true, FROM);
  int reason = errno;
  file_mark(fd, false);
  int status = real(fd);
  if (fails) errno = reason;
  return fails ? -1 : status;
}

/* ---- streams ---- */

enum { STREAM_ERROR = 0x20 }; /* glibc's mark behind ferror() */

static bool fail_stream(const char *call, FILE *file, int reason, bool writes, const void *from) {
  if (!fail_file(call, fileno(file), reason, writes, false, from)) return false;
  file->_flags |= STREAM_ERROR;
  return true;
}

size_t fwrite(const void *p, size_t size, size_t n, FILE *file) {
  REAL(fwrite);
  return fail_stream("fwrite", file, ENOSPC, true, FROM) ? 0 : real(p, size, n, file);
}
size_t fread(void *p, size_t size, size_t n, FILE *file) {
  REAL(fread);
  return fail_stream("fread", file, EIO, false, FROM) ? 0 : real(p, size, n, file);
}
char *fgets(char *text, int n, FILE *file) {
  REAL(fgets);
  return fail_stream("fgets", file, EIO, false, FROM) ? NULL : real(text, n, file);
}
ssize_t getline(char **text, size_t *n, FILE *file) {
  REAL(getline);
  return fail_stream("getline", file, EIO, false, FROM) ? -1 : real(text, n, file);
}
int fputs(const char *text, FILE *file) {
  REAL(fputs);
  return fail_stream("fputs", file, ENOSPC, true, FROM) ? EOF : real(text, file);
}
int fputc(int c, FILE *file) {
  REAL(fputc);
  return fail_stream("fputc", file, ENOSPC, true, FROM) ? EOF : real(c, file);
}
int puts(const char *text) {
  REAL(puts);
  return fail_stream("puts", stdout, ENOSPC, true, FROM) ? EOF : real(text);
}
int putchar(int c) {
  REAL(putchar);
  return fail_stream("putchar", stdout, ENOSPC, true, FROM) ? EOF : real(c);
}
int vfprintf(FILE *file, const char *format, va_list args) {
  REAL(vfprintf);
  return fail_stream("vfprintf", file, ENOSPC, true, FROM) ? -1 : real(file, format, args);
}
int fprintf(FILE *file, const char *format, ...) {
  if (fail_stream("fprintf", file, ENOSPC, true, FROM)) return -1;
  va_list args;
  va_start(args, format);
  int n = vfprintf(file, format, args);
  va_end(args);
  return n;
}
int printf(const char *format, ...) {
  if (fail_stream("printf", stdout, ENOSPC, true, FROM)) return -1;
  va_list args;
  va_start(args, format);
  int n = vfprintf(stdout, format, args);
  va_end(args);
  return n;
}
int fflush(FILE *file) {
  REAL(fflush);
  return file && fail_stream("fflush", file, ENOSPC, true, FROM) ? EOF : real(file);
}
int fclose(FILE *file) {
  REAL(fclose);
  int fd = fileno(file); /* -1: in memory */
  bool fails = fail_file("fclose", fd, EIO, true, false, FROM);
  int reason = errno;
  file_mark(fd, false);
  int status = real(file);
  if (fails) errno = reason;
  return fails ? EOF : status;
}
int pclose(FILE *file) {
  REAL(pclose);
  bool fails = fail_path("pclose", "process", ECHILD, false, FROM);
  int status = real(file);
  if (fails) errno = ECHILD;
  return fails ? -1 : status;
}

/* The LAMMPS engine is loaded when it is needed, and LAMMPS with it. */
void *dlopen(const char *file, int mode) {
  REAL(dlopen);
  bool before = fault.on;
  fault.on = false;
  void *handle = real(file, mode);
  if (handle && file && strstr(file, "/granhom-lammps.so")) {
    fault.ranges = 0;
    dl_iterate_phdr(range_add, NULL);
  }
  fault.on = before;
  return handle;
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

/* HDF5 ends the program where it cannot register an object. LAMMPS does so too, but there it is caught. */
void exit(int status) {
  REAL(exit);
  Dl_info info;
  if (caller_of(FROM) == LIBRARY && dladdr(FROM, &info) && info.dli_fname &&
      !strstr(info.dli_fname, "/liblammps")) {
    const char *name = strrchr(info.dli_fname, '/');
    snprintf(fault.record->crash, sizeof fault.record->crash, "%.60s", name ? name + 1 : "?");
  }
  real(status);
  abort();
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
  dl_iterate_phdr(range_add, NULL);
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
