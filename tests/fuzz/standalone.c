/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The loop around a fuzz target where there is no libFuzzer: all files of a corpus, and then changes of them,
 * for some seconds. Usage: TARGET SEED SECONDS FINDING CORPUS.
 *
 * An input is written to the file FINDING before it is tried, which is left behind where the program ends in
 * it. */
#include "fuzz.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_FILES = 1000, MOST_BYTES = 1 << 16 };

typedef struct corpus {
  int n;
  size_t size[MOST_FILES];
  uint8_t *data[MOST_FILES];
} corpus;

static unsigned long long state;
static unsigned long random_below(unsigned long n) { /* xorshift64* */
  state ^= state >> 12, state ^= state << 25, state ^= state >> 27;
  return (unsigned long)((state * 2685821657736338717ull) >> 33) % n;
}

static void corpus_read(const char *folder, corpus *c) {
  struct dirent **list;
  int n = scandir(folder, &list, NULL, alphasort);
  for (int k = 0; k < n; k++) {
    char path[1000];
    struct stat info;
    snprintf(path, sizeof path, "%s/%s", folder, list[k]->d_name);
    free(list[k]);
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) continue;
    if (fstat(fd, &info) == 0 && S_ISREG(info.st_mode) && info.st_size <= MOST_BYTES && c->n < MOST_FILES) {
      c->data[c->n] = malloc((size_t)info.st_size + 1);
      fuzz_require(c->data[c->n] && read(fd, c->data[c->n], (size_t)info.st_size) == info.st_size,
                   "a corpus cannot be read");
      c->size[c->n++] = (size_t)info.st_size;
    }
    close(fd);
  }
  if (n >= 0) free(list);
}

/* One change at a random place: a bit, a number, a part removed, repeated or taken from another input. */
static size_t input_change(const corpus *c, uint8_t *data, size_t size) {
  static const char *const numbers[] = {
      "0", "-1", "1e308", "1e-308", "nan", "inf", "2147483648", "1000000000", "99999999999999999999",
      "",  " ",  "\n",    ",",      "\"",  ":"};
  size_t at = size ? random_below(size) : 0, n = 1 + random_below(16), left = size - at;
  const char *number = numbers[random_below(sizeof numbers / sizeof *numbers)];
  const uint8_t *from = (const uint8_t *)number;
  size_t length = strlen(number), drop = 0;
  switch (random_below(6)) {
  case 0:
    if (size) data[at] ^= (uint8_t)(1u << random_below(8));
    return size;
  case 1: /* removed */
    length = 0, drop = n;
    break;
  case 2: { /* of another input */
    int k = (int)random_below((unsigned long)c->n);
    size_t begin = c->size[k] ? random_below(c->size[k]) : 0;
    from = c->data[k] + begin;
    length = c->size[k] - begin < 8 * n ? c->size[k] - begin : 8 * n;
    break;
  }
  case 3: /* a word replaced by a number */
    while (drop < left && data[at + drop] > ' ' && data[at + drop] != ',' && data[at + drop] != ']') drop++;
    break;
  case 4: /* cut off */
    return random_below(8) ? size : at;
  default: /* a number put in */
    break;
  }
  if (drop > left) drop = left;
  if (size - drop + length > MOST_BYTES) return size;
  memmove(data + at + length, data + at + drop, left - drop);
  memcpy(data + at, from, length);
  return size - drop + length;
}

static void input_try(const char *finding, const uint8_t *data, size_t size) {
  int fd = open(finding, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  fuzz_require(fd >= 0 && write(fd, data, size) == (ssize_t)size, "the input cannot be kept");
  close(fd);
  alarm(60);
  LLVMFuzzerTestOneInput(data, size);
  alarm(0);
}

int main(int argc, char **argv) {
  static corpus c;
  static uint8_t data[MOST_BYTES];
  if (argc != 5) return 2;
  state = strtoull(argv[1], NULL, 10) * 2654435761u + 88172645463325252ull;
  double end = gh_seconds() + strtod(argv[2], NULL);
  corpus_read(argv[4], &c);
  fuzz_require(c.n > 0, "an empty corpus");
  long runs = 0;
  for (int k = 0; k < c.n; k++, runs++) input_try(argv[3], c.data[k], c.size[k]);
  for (; gh_seconds() < end; runs++) {
    int k = (int)random_below((unsigned long)c.n);
    size_t size = c.size[k];
    memcpy(data, c.data[k], size);
    for (unsigned long turns = 1 + random_below(4); turns > 0; turns--) size = input_change(&c, data, size);
    input_try(argv[3], data, size);
  }
  unlink(argv[3]);
  for (int k = 0; k < c.n; k++) free(c.data[k]);
  printf("runs %ld\n", runs);
  return 0;
}
