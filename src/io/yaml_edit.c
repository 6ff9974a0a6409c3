/* SPDX-License-Identifier: GPL-2.0-or-later */
/* YAML: changing a document in memory, and printing it again. */
#include "io/yaml.h"

#include <stdlib.h>
#include <string.h>

/* ---- setting ---- */

static yaml_node_t *node_of(gh_yaml *doc, int node) {
  return doc->document.nodes.start + (node - 1);
}

/* Copies a node with all below it; its number, 0 without memory. All of it gets the mark. */
static int copy(gh_yaml *to, gh_yaml_node from, yaml_mark_t mark) {
  yaml_document_t *d = &to->document;
  const yaml_node_t *n = gh_yaml_look(from);
  int made = 0;
  if (gh_yaml_is_scalar(from)) {
    made = yaml_document_add_scalar(d, NULL, n->data.scalar.value, (int)n->data.scalar.length,
                                    n->data.scalar.style);
  } else if (gh_yaml_is_list(from)) {
    made = yaml_document_add_sequence(d, NULL, YAML_FLOW_SEQUENCE_STYLE);
    for (int k = 0; made && k < gh_yaml_length(from); k++) {
      int item = copy(to, gh_yaml_item(from, k), mark);
      if (!item || !yaml_document_append_sequence_item(d, made, item)) return 0;
    }
  } else {
    made = yaml_document_add_mapping(d, NULL, YAML_FLOW_MAPPING_STYLE);
    for (int k = 0; made && k < gh_yaml_length(from); k++) {
      gh_yaml_node key = {.doc = from.doc, .node = n->data.mapping.pairs.start[k].key}, value;
      gh_yaml_key(from, k, &value);
      int a = copy(to, key, mark), b = a ? copy(to, value, mark) : 0;
      if (!b || !yaml_document_append_mapping_pair(d, made, a, b)) return 0;
    }
  }
  if (made) node_of(to, made)->start_mark = mark;
  return made;
}

/* A place in the document: entry `k` of `parent`, or a pair that its map is to get (k -1). */
typedef struct place {
  int parent, k;
} place;

/* Where the part of a way leads from `at`. GH_INPUT: nowhere. */
static gh_status step(gh_yaml *doc, const char *key, const char *part, gh_yaml_node at, place *p) {
  char name[GH_QUOTE], all[GH_QUOTE];
  long index;
  *p = (place){.parent = at.node, .k = -1};
  gh_quote(key, all), gh_quote(part, name);
  if (!*part) return gh_fail(doc->ctx, GH_INPUT, "%s: '%s' is no key: a part of it is empty", doc->path, all);
  if (gh_yaml_is_map(at)) {
    for (int k = 0; k < gh_yaml_length(at); k++)
      if (strcmp(gh_yaml_key(at, k, NULL), part) == 0) p->k = k;
    return GH_OK;
  }
  if (!gh_yaml_is_list(at))
    return gh_yaml_fail(at, "'%s': this is %s, it has no '%s'", all, gh_yaml_kind(at), name);
  int length = gh_yaml_length(at);
  if (!gh_parse_integer(part, 0, 1000000000, &index))
    return gh_yaml_fail(at, "'%s': this is a list, '%s' is no number of an entry (0, 1, ...)", all, name);
  if (index >= length)
    return gh_yaml_fail(at, "'%s': there is no entry %ld, the list has %d (from 0)", all, index, length);
  p->k = (int)index;
  return GH_OK;
}

static int *slot(gh_yaml *doc, place p) {
  yaml_node_t *n = node_of(doc, p.parent);
  if (n->type == YAML_SEQUENCE_NODE) return n->data.sequence.items.start + p.k;
  return &n->data.mapping.pairs.start[p.k].value;
}

/* Nothing is written there: "start:". A map may take its place. */
static bool is_blank(gh_yaml_node node) {
  const yaml_node_t *n = gh_yaml_look(node);
  return gh_yaml_is_scalar(node) && n->data.scalar.length == 0 &&
         n->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
}

/* Puts node `made` into the place. */
static bool put(gh_yaml *doc, place p, const char *part, int made) {
  if (p.k >= 0) {
    *slot(doc, p) = made;
    return true;
  }
  const yaml_mark_t mark = node_of(doc, p.parent)->start_mark;
  int key = yaml_document_add_scalar(&doc->document, NULL, (const yaml_char_t *)part, (int)strlen(part),
                                     YAML_PLAIN_SCALAR_STYLE);
  if (!key) return false;
  node_of(doc, key)->start_mark = mark;
  return yaml_document_append_mapping_pair(&doc->document, p.parent, key, made) != 0;
}

/* What stands behind the last place that exists is made before it is hung up there, so that a failure leaves
 * the document as it was. `rest`: the parts behind that place, to be made as maps; cut in place. */
static gh_status hang_up(gh_yaml *doc, place p, const char *part, char *rest, gh_yaml_node value) {
  const yaml_mark_t mark = node_of(doc, p.k >= 0 ? *slot(doc, p) : p.parent)->start_mark;
  int made = copy(doc, value, mark);
  while (made && rest) { /* from the last part to the first */
    char *dot = strrchr(rest, '.'), *name = dot ? dot + 1 : rest;
    int map = yaml_document_add_mapping(&doc->document, NULL, YAML_FLOW_MAPPING_STYLE);
    if (map) node_of(doc, map)->start_mark = mark;
    made = map && put(doc, (place){.parent = map, .k = -1}, name, made) ? map : 0;
    if (dot) *dot = 0;
    else rest = NULL;
  }
  if (made && put(doc, p, part, made)) return GH_OK;
  return gh_fail(doc->ctx, GH_MEMORY, "%s: no memory to change it", doc->path);
}

static bool has_empty_part(const char *rest) {
  return !*rest || *rest == '.' || strstr(rest, "..") || rest[strlen(rest) - 1] == '.';
}

/* Follows the way as far as there is one. */
static gh_status set_value(gh_yaml *doc, const char *key, char *way, gh_yaml_node value) {
  gh_yaml_node at = gh_yaml_root(doc);
  for (char *part = way;;) {
    char *dot = strchr(part, '.'), *rest = dot ? dot + 1 : NULL;
    place p;
    if (dot) *dot = 0;
    GH_TRY(step(doc, key, part, at, &p));
    gh_yaml_node next = {.doc = doc, .node = p.k >= 0 ? *slot(doc, p) : 0};
    if (!rest || !next.node || is_blank(next)) {
      if (rest && has_empty_part(rest)) return step(doc, key, "", at, &p);
      return hang_up(doc, p, part, rest, value);
    }
    at = next, part = rest;
  }
}

/* Bytes of the character at c in UTF-8; 0: none, or a control character. */
static int character_length(const unsigned char *c) {
  int n = *c < 0x80                 ? 1
          : *c >= 0xC2 && *c < 0xE0 ? 2
          : *c >= 0xE0 && *c < 0xF0 ? 3
          : *c >= 0xF0 && *c < 0xF5 ? 4
                                    : 0;
  for (int k = 1; k < n; k++)
    if ((c[k] & 0xC0) != 0x80) return 0;
  bool overlong = (*c == 0xE0 && c[1] < 0xA0) || (*c == 0xF0 && c[1] < 0x90);
  bool beyond = (*c == 0xED && c[1] >= 0xA0) || (*c == 0xF4 && c[1] >= 0x90); /* surrogates, above 0x10FFFF */
  return *c < ' ' || *c == 0x7F || overlong || beyond ? 0 : n;
}

static bool is_text(const char *text) {
  const unsigned char *c = (const unsigned char *)text;
  for (int n; *c; c += n)
    if ((n = character_length(c)) == 0) return false;
  return true;
}

gh_status gh_yaml_set(gh_yaml *doc, const char *key, const char *value) {
  char name[GH_QUOTE], shown[GH_QUOTE];
  gh_yaml *new = NULL;
  if (!is_text(key))
    return gh_fail(doc->ctx, GH_INPUT, "%s: '%s' is no key: it holds what is no character of a text",
                   doc->path, gh_quote(key, name));
  if (!*value)
    return gh_fail(doc->ctx, GH_INPUT, "%s: '%s': the value is empty", doc->path, gh_quote(key, name));
  gh_status status = gh_yaml_parse(doc->ctx, "value", value, &new);
  if (status != GH_OK)
    return gh_prefix(doc->ctx, status, "%s: '%s': '%s' is no YAML value: ", doc->path, gh_quote(key, name),
                     gh_quote(value, shown));
  char *way = strdup(key);
  status = way ? set_value(doc, key, way, gh_yaml_root(new))
               : gh_fail(doc->ctx, GH_MEMORY, "%s: no memory to change it", doc->path);
  free(way);
  gh_yaml_destroy(&new);
  return status;
}

/* ---- printing ---- */

static bool is_blank_or_end(char c) {
  return c == ' ' || c == '\t' || c == 0;
}

/* Characters beyond ASCII that no YAML text holds as they are: line breaks, controls, the byte order mark and
 * what is no character. Returns how many bytes are one of them, 0 for none, and how it is written. */
static int wide_escape(const char *text, char out[8]) {
  const unsigned char *c = (const unsigned char *)text;
  if (c[0] == 0xC2 && c[1] >= 0x80 && c[1] < 0xA0) {
    if (c[1] == 0x85) snprintf(out, 8, "\\N");
    else snprintf(out, 8, "\\x%02X", c[1]);
    return 2;
  }
  static const struct {
    const char *bytes, *escape;
  } three[] = {{"\xE2\x80\xA8", "\\L"},
               {"\xE2\x80\xA9", "\\P"},
               {"\xEF\xBB\xBF", "\\uFEFF"},
               {"\xEF\xBF\xBE", "\\uFFFE"},
               {"\xEF\xBF\xBF", "\\uFFFF"}};
  for (size_t k = 0; k < sizeof three / sizeof *three; k++)
    if (strncmp(text, three[k].bytes, 3) == 0) {
      snprintf(out, 8, "%s", three[k].escape);
      return 3;
    }
  return 0;
}

/* Plain texts of a block, and keys that were set, may hold what ends a value in flow style or begins
 * something else there. */
static bool plain_in_flow(const yaml_node_t *n) {
  const char *text = (const char *)n->data.scalar.value;
  size_t length = strlen(text);
  char escape[8];
  if (n->data.scalar.style != YAML_PLAIN_SCALAR_STYLE || length != n->data.scalar.length) return false;
  if (length == 0) return true;
  if (is_blank_or_end(text[0]) || is_blank_or_end(text[length - 1]) || strchr("#&*!|>%@`?:", text[0]))
    return false;
  if (text[0] == '-' && is_blank_or_end(text[1])) return false;
  for (const char *c = text; *c; c++) {
    if (strchr(",[]{}\"'", *c) || (unsigned char)*c < ' ' || *c == 0x7F || wide_escape(c, escape))
      return false;
    if (*c == ':' && (is_blank_or_end(c[1]) || c[1] == '?')) return false;
    if (*c == ' ' && c[1] == '#') return false;
  }
  return true;
}

static void print_scalar(const yaml_node_t *n, gh_text *out) {
  if (plain_in_flow(n)) {
    gh_text_print(out, "%s", (const char *)n->data.scalar.value);
    return;
  }
  gh_text_print(out, "\"");
  for (const unsigned char *c = n->data.scalar.value; *c; c++) {
    char escape[8];
    const int wide = wide_escape((const char *)c, escape);
    if (wide) {
      gh_text_print(out, "%s", escape);
      c += wide - 1;
    } else if (*c == '"' || *c == '\\') gh_text_print(out, "\\%c", *c);
    else if (*c < ' ' || *c == 0x7F) gh_text_print(out, "\\x%02X", *c);
    else gh_text_print(out, "%c", *c);
  }
  gh_text_print(out, "\"");
}

void gh_yaml_print(gh_yaml_node node, gh_text *out) {
  if (!gh_yaml_has(node)) return;
  const yaml_node_t *n = gh_yaml_look(node);
  int length = gh_yaml_length(node);
  if (gh_yaml_is_scalar(node) && n->data.scalar.length == 0 && node.node == gh_yaml_root(node.doc).node) {
    gh_text_print(out, "\"\""); /* nothing would be no document */
  } else if (gh_yaml_is_scalar(node)) {
    print_scalar(n, out);
  } else if (gh_yaml_is_list(node)) {
    for (int k = 0; k < length; k++) {
      gh_text_print(out, k ? ", " : "[");
      if (is_blank(gh_yaml_item(node, k))) gh_text_print(out, "~"); /* nothing would be no entry */
      else gh_yaml_print(gh_yaml_item(node, k), out);
    }
    gh_text_print(out, length ? "]" : "[]");
  } else {
    for (int k = 0; k < length; k++) {
      gh_yaml_node value;
      gh_yaml_key(node, k, &value);
      gh_yaml_node key = {.doc = node.doc, .node = n->data.mapping.pairs.start[k].key};
      gh_text_print(out, k ? ", " : "{");
      if (is_blank(key)) gh_text_print(out, "\"\"");
      else gh_yaml_print(key, out);
      gh_text_print(out, ": ");
      gh_yaml_print(value, out);
    }
    gh_text_print(out, length ? "}" : "{}");
  }
}
