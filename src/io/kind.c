/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What a file looks like that was given in the place of another one. Asked after a reader has refused it, so
 * that a guess can spoil nothing. */
#include "io/file.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { HEAD = 1 << 14 /* bytes that are inspected */ };

static const struct {
  const char *what, *where;
} kinds[GH_FILE_KINDS] = {
    [GH_FILE_PACKING] =
        {"a packing (LAMMPS data file)",
         "; `granhom rve` and `granhom element` take it, and a scene names it: packing: FILE"},
    [GH_FILE_SCENE] = {"a scene (YAML)", "; `granhom run` takes it"},
    [GH_FILE_STUDY] = {"a study (YAML)", "; `granhom study` takes it"},
    [GH_FILE_CONTROL] = {"the control file of an element test (YAML)",
                         "; `granhom element PACKING --control` takes it"},
    [GH_FILE_GROWTH] = {"the specification of a packing (YAML)", "; `granhom pack` takes it"},
    [GH_FILE_PATH] = {"a path of F (CSV)", "; `granhom rve PACKING --path` takes it"},
    [GH_FILE_CONDITIONS] = {"a table of stresses and strains (CSV)",
                            "; `granhom element PACKING --path` takes it"},
    [GH_FILE_SIEVE] = {"a sieve curve (CSV)", "; `granhom pack --sieve` takes it"},
    [GH_FILE_MESH] = {"a Gmsh mesh", "; a scene names it: mesh: {gmsh: FILE}"},
    [GH_FILE_STATE] = {"a saved state", "; `granhom rve PACKING --load-state` takes it"},
    [GH_FILE_BINARY] = {"a binary file of granhom", ""},
    [GH_FILE_HDF5] = {"an HDF5 file", ""},
    [GH_FILE_DUMP] = {"a LAMMPS dump", "; read_dump, then write_data makes a packing of it"},
    [GH_FILE_SCRIPT] = {"a LAMMPS script", "; `granhom lammps -in` takes it"},
    [GH_FILE_XML] = {"XML", ""},
    [GH_FILE_PICTURE] = {"a picture", ""}};

/* ---- by the first bytes ---- */

static gh_file_kind kind_by_bytes(const char *text, size_t length) {
  static const struct {
    const char *bytes;
    gh_file_kind kind;
  } starts[] = {{"$MeshFormat", GH_FILE_MESH},
                {"$NOD", GH_FILE_MESH},
                {"ITEM:", GH_FILE_DUMP},
                {"<?xml", GH_FILE_XML},
                {"granhom binary file, format 1\nkind state", GH_FILE_STATE},
                {"granhom binary file", GH_FILE_BINARY},
                {"\x89HDF", GH_FILE_HDF5},
                {"\x89PNG", GH_FILE_PICTURE},
                {"%PDF", GH_FILE_PICTURE}};
  for (size_t k = 0; k < sizeof starts / sizeof *starts; k++) {
    const size_t n = strlen(starts[k].bytes);
    if (length >= n && memcmp(text, starts[k].bytes, n) == 0) return starts[k].kind;
  }
  return GH_FILE_UNKNOWN;
}

/* ---- by lines ---- */

static bool is_among(const char *word, size_t length, const char *const *words) {
  for (; *words; words++)
    if (strlen(*words) == length && strncmp(*words, word, length) == 0) return true;
  return false;
}

typedef struct line_marks {
  int atoms, bounds;                 /* of LAMMPS data files */
  int commands;                      /* of LAMMPS scripts */
  int scene, study, growth, control; /* keys of YAML files */
  bool steps, header;                /* the header of a table has been there */
  gh_file_kind table;
} line_marks;

/* The words of a table's header; units stand behind a blank or a bracket. */
static gh_file_kind header_kind(const char *line) {
  static const char *const F[] = {"F11", "F12", "F21", "F22", NULL}, *const more[] = {"P11",      "P12",
                                                                                      "P21",      "P22",
                                                                                      "s11",      "s12",
                                                                                      "s22",      "volume",
                                                                                      "pressure", NULL},
                           *const sieves[] = {"diameter", "sieve", NULL},
                           *const shares[] = {"count", "volume_percent", "passing", "retained", NULL};
  static const char between[] = ",;\t \"[](){}%";
  int gradients = 0, others = 0, diameters = 0, amounts = 0;
  for (const char *at = line + strspn(line, between); *at; at += strspn(at, between)) {
    const size_t n = strcspn(at, between);
    gradients += is_among(at, n, F);
    others += is_among(at, n, more);
    diameters += is_among(at, n, sieves);
    amounts += is_among(at, n, shares);
    at += n;
  }
  if (gradients == 4) return GH_FILE_PATH;
  if (diameters && amounts) return GH_FILE_SIEVE;
  return others && gradients + others >= 3 ? GH_FILE_CONDITIONS : GH_FILE_UNKNOWN;
}

/* A key of YAML at the margin. */
static void key_mark(line_marks *m, const char *key, size_t n) {
  static const char *const scene[] = {"packing",  "contact", "micro",  "start",   "mesh",
                                      "supports", "gravity", "solver", "results", NULL},
                           *const study[] = {"scene",      "rve",   "vary",  "reference",
                                             "quantities", "goals", "quick", NULL},
                           *const growth[] = {"sieve", "count", "volume_fraction", "finish", NULL},
                           *const steps[] = {"steps", NULL};
  m->scene += is_among(key, n, scene);
  m->study += is_among(key, n, study);
  m->growth += is_among(key, n, growth);
  m->steps = m->steps || is_among(key, n, steps);
}

static void line_mark(line_marks *m, const char *line) {
  static const char *const commands[] = {"units",      "atom_style", "pair_style", "read_data", "boundary",
                                         "dimension",  "fix",        "compute",    "timestep",  "run",
                                         "create_box", "variable",   "region",     NULL};
  const char *text = line + strspn(line, " \t");
  const size_t word = strcspn(text, " \t:,;");
  if (!*text || *text == '#') return;
  if (!m->header) m->table = header_kind(text);
  m->header = true;
  if (word && strspn(text, "0123456789") == word) m->atoms += strcmp(text + word, " atoms") == 0;
  m->bounds += strstr(text, "xlo xhi") != NULL || strstr(text, "avec") != NULL;
  m->commands += (text[word] == ' ' || text[word] == '\t') && is_among(text, word, commands);
  m->control += strstr(text, "control:") != NULL;
  if (text == line && text[word] == ':') key_mark(m, text, word);
}

static gh_file_kind kind_by_lines(char *text) {
  line_marks m = {0};
  for (char *line = text; line;) {
    char *end = strchr(line, '\n');
    if (end) *end = 0;
    gh_trim(line + strspn(line, " \t"));
    line_mark(&m, line);
    line = end ? end + 1 : NULL;
  }
  if (m.atoms && m.bounds) return GH_FILE_PACKING;
  if (m.table != GH_FILE_UNKNOWN) return m.table;
  if (m.scene > m.study && m.scene > m.growth) return GH_FILE_SCENE;
  if (m.study > m.growth) return GH_FILE_STUDY;
  if (m.growth) return GH_FILE_GROWTH;
  if (m.steps && m.control) return GH_FILE_CONTROL;
  return m.commands > 1 ? GH_FILE_SCRIPT : GH_FILE_UNKNOWN;
}

/* ---- files ---- */

static gh_file_kind kind_of(const char *path) {
  char text[HEAD + 1];
  struct stat info;
  size_t length = 0;
  const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return GH_FILE_UNKNOWN;
  const bool regular = fstat(fd, &info) == 0 && S_ISREG(info.st_mode);
  for (ssize_t n = 1; regular && n > 0 && length<HEAD; length += n> 0 ? (size_t)n : 0)
    n = read(fd, text + length, HEAD - length);
  close(fd);
  text[length] = 0;
  const char *start = length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0 ? text + 3 : text;
  const gh_file_kind kind = kind_by_bytes(start, length - (size_t)(start - text));
  if (*start == '<') return kind; /* HTML may hold lines of any kind */
  return kind != GH_FILE_UNKNOWN ? kind : kind_by_lines(text + (start - text));
}

gh_status gh_file_expect(gh_context *ctx, gh_status status, const char *path, gh_file_kind wanted) {
  if (status != GH_INPUT) return status;
  const gh_file_kind kind = kind_of(path);
  if (kind == GH_FILE_UNKNOWN || kind == wanted || kind == GH_FILE_HDF5) return status;
  if (kind == GH_FILE_BINARY && wanted == GH_FILE_STATE) return status; /* the seal states more */
  return gh_fail(ctx, GH_INPUT, "%s: looks like %s, and %s is wanted%s", path, kinds[kind].what,
                 kinds[wanted].what, kinds[kind].where);
}

/* Tables are written over tables; a sieve curve is none of the results. */
static bool may_replace(gh_file_kind there, gh_file_kind written) {
  switch (there) {
  case GH_FILE_UNKNOWN:
    return true;
  case GH_FILE_CONDITIONS:
    return written == GH_FILE_PATH;
  case GH_FILE_XML:
    return written == GH_FILE_PICTURE; /* SVG */
  default:
    return there == written;
  }
}

gh_status gh_kind_kept(gh_context *ctx, const char *path, gh_file_kind written) {
  const gh_file_kind there = kind_of(path);
  if (may_replace(there, written)) return GH_OK;
  return gh_fail(ctx, GH_INPUT,
                 "%s: looks like %s, and something else would be written over it; remove it, or choose "
                 "another name",
                 path, kinds[there].what);
}
