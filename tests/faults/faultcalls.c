/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The calls that faultpoint.c lets fail: each asks whether it is the one, and else calls the function behind
 * it. */
#define _GNU_SOURCE
#include "faultpoint.h"

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

extern void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t),
    *__libc_memalign(size_t, size_t);

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
  if (handle && file && strstr(file, "/granhom-lammps.so")) ranges_find();
  fault.on = before;
  return handle;
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
