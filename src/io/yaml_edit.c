/* YAML: changing a document in memory, and printing it again. SPDX-License-Identifier: GPL-2.0-or-later */
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

gh_status gh_yaml_set(gh_yaml *doc, const char *key, const char *value) {
  char name[GH_QUOTE], shown[GH_QUOTE];
  gh_yaml *new = NULL;
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

/* Plain texts of a block may hold what ends a value in flow style. */
static bool plain_in_flow(const yaml_node_t *n) {
  const char *text = (const char *)n->data.scalar.value;
  return n->data.scalar.style == YAML_PLAIN_SCALAR_STYLE && !strpbrk(text, ",[]{}\"'\n") &&
         !strstr(text, ": ") && !strstr(text, " #");
}

static void print_scalar(const yaml_node_t *n, gh_text *out) {
  if (plain_in_flow(n)) {
    gh_text_print(out, "%s", (const char *)n->data.scalar.value);
    return;
  }
  gh_text_print(out, "\"");
  for (const unsigned char *c = n->data.scalar.value; *c; c++)
    if (*c == '"' || *c == '\\') gh_text_print(out, "\\%c", *c);
    else if (*c < ' ' || *c == 0x7F) gh_text_print(out, "\\x%02X", *c);
    else gh_text_print(out, "%c", *c);
  gh_text_print(out, "\"");
}

void gh_yaml_print(gh_yaml_node node, gh_text *out) {
  if (!gh_yaml_has(node)) return;
  const yaml_node_t *n = gh_yaml_look(node);
  int length = gh_yaml_length(node);
  if (gh_yaml_is_scalar(node)) {
    print_scalar(n, out);
  } else if (gh_yaml_is_list(node)) {
    for (int k = 0; k < length; k++) {
      gh_text_print(out, k ? ", " : "[");
      gh_yaml_print(gh_yaml_item(node, k), out);
    }
    gh_text_print(out, length ? "]" : "[]");
  } else {
    for (int k = 0; k < length; k++) {
      gh_yaml_node value;
      gh_yaml_key(node, k, &value);
      gh_text_print(out, k ? ", " : "{");
      gh_yaml_print((gh_yaml_node){.doc = node.doc, .node = n->data.mapping.pairs.start[k].key}, out);
      gh_text_print(out, ": ");
      gh_yaml_print(value, out);
    }
    gh_text_print(out, length ? "}" : "{}");
  }
}
