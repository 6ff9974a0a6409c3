/* SPDX-License-Identifier: GPL-2.0-or-later */
/* YAML: reading on top of libyaml's documents, typed values with file and line.
 * A document is checked as a whole when it is read: every key is a text and occurs once in
 * its map, no aliases, no tags, one document per file. What asks for values later need not think of these. */
#include "io/yaml.h"

#include <float.h>
#include <limits.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const yaml_node_t *get(const gh_yaml *doc, int node) {
  return node > 0 ? doc->document.nodes.start + (node - 1) : NULL;
}

static const char *text_of(const yaml_node_t *scalar) {
  return (const char *)scalar->data.scalar.value;
}

static int count_of(const gh_yaml *doc) {
  return (int)(doc->document.nodes.top - doc->document.nodes.start);
}

/* ---- reading ---- */

static gh_status fail_parse(const gh_yaml *doc, const yaml_parser_t *parser, const char *text) {
  size_t line = parser->problem_mark.line + 1;
  const char *context = parser->context ? parser->context : "";
  /* where it finds no memory for an anchor's name it fails without an error */
  if (parser->error == YAML_MEMORY_ERROR || parser->error == YAML_NO_ERROR)
    return gh_fail(doc->ctx, GH_MEMORY, "%s: no memory to read it", doc->path);
  if (parser->error == YAML_READER_ERROR) { /* these carry an offset in place of a mark */
    line = 1;
    for (size_t k = 0; k < parser->problem_offset && text[k]; k++) line += text[k] == '\n';
  }
  return gh_fail(doc->ctx, GH_INPUT, "%s:%zu: not valid YAML: %s%s%s%s", doc->path, line,
                 parser->problem ? parser->problem : "unknown problem", *context ? " (" : "", context,
                 *context ? ")" : "");
}

/* libyaml's time grows with the square of the depth, minutes for a file of 100 kB. Brackets in texts and
 * comments count too: no scene has so many that stay open. */
static gh_status check_depth(const gh_yaml *doc, const gh_reader *r) {
  enum { DEEPEST = 200 };
  int depth = 0, line = 1;
  for (size_t k = 0; k < r->length; k++) {
    char c = r->text[k];
    line += c == '\n';
    depth += (c == '[' || c == '{') - (c == ']' || c == '}');
    if (depth < 0) depth = 0;
    if (depth > DEEPEST)
      return gh_fail(doc->ctx, GH_INPUT, "%s:%d: more than %d brackets are open", doc->path, line, DEEPEST);
  }
  return GH_OK;
}

/* Loads the one document of the text. */
static gh_status load(gh_yaml *doc, const gh_reader *r) {
  yaml_parser_t parser;
  yaml_document_t second;
  gh_status s = GH_OK;
  GH_TRY(check_depth(doc, r));
  if (!yaml_parser_initialize(&parser))
    return gh_fail(doc->ctx, GH_MEMORY, "%s: no memory to read it", doc->path);
  yaml_parser_set_encoding(&parser, YAML_UTF8_ENCODING);
  const size_t mark = strncmp(r->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0; /* a byte order mark */
  yaml_parser_set_input_string(&parser, (const unsigned char *)r->text + mark, r->length - mark);
  if (!yaml_parser_load(&parser, &doc->document)) {
    s = fail_parse(doc, &parser, r->text);
  } else if (count_of(doc) == 0) {
    s = gh_fail(doc->ctx, GH_INPUT, "%s: the file holds no values, only blank lines and comments", doc->path);
  } else if (!yaml_parser_load(&parser, &second)) {
    s = fail_parse(doc, &parser, r->text);
  } else {
    const yaml_node_t *root = yaml_document_get_root_node(&second);
    if (root) {
      s = gh_fail(doc->ctx, GH_INPUT, "%s:%zu: a second document begins, one per file is read", doc->path,
                  root->start_mark.line + 1);
    }
    yaml_document_delete(&second);
  }
  yaml_parser_delete(&parser);
  return s;
}

typedef struct {
  const char *key;
  int node;
} key_place;

static int compare_keys(const void *a, const void *b) {
  const key_place *p = a, *q = b;
  int order = strcmp(p->key, q->key);
  return order ? order : (p->node > q->node) - (p->node < q->node);
}

/* {y: -0,2} is a map of y: -0 and of a key 2 without a value. */
static gh_status check_comma(const gh_yaml *doc, const yaml_node_pair_t *before,
                             const yaml_node_pair_t *pair) {
  const gh_yaml_node key = {.doc = doc, .node = pair->key};
  const yaml_node_t *whole = get(doc, before->value), *part = get(doc, pair->key),
                    *value = get(doc, pair->value);
  char quoted[2][GH_QUOTE];
  long ignored;
  double number;
  if (whole->type != YAML_SCALAR_NODE || part->type != YAML_SCALAR_NODE || value->type != YAML_SCALAR_NODE ||
      value->data.scalar.length > 0)
    return GH_OK;
  if (!gh_parse_integer(text_of(whole), LONG_MIN, LONG_MAX, &ignored) ||
      !gh_parse_number(text_of(part), &number))
    return GH_OK;
  return gh_yaml_fail(key, "%s,%s has a comma: a decimal point is wanted, and no sign between thousands",
                      gh_quote(text_of(whole), quoted[0]), gh_quote(text_of(part), quoted[1]));
}

static gh_status check_keys(const gh_yaml *doc, const yaml_node_t *map) {
  const yaml_node_pair_t *pair = map->data.mapping.pairs.start;
  size_t n = (size_t)(map->data.mapping.pairs.top - pair);
  for (size_t k = 1; k < n; k++) GH_TRY(check_comma(doc, pair + k - 1, pair + k));
  key_place *keys;
  gh_status s = gh_alloc(doc->ctx, n, sizeof *keys, &keys);
  for (size_t k = 0; k < n && s == GH_OK; k++) {
    gh_yaml_node node = {.doc = doc, .node = pair[k].key};
    if (!gh_yaml_is_scalar(node)) s = gh_yaml_fail(node, "a key must be a text");
    else keys[k] = (key_place){.key = text_of(get(doc, node.node)), .node = node.node};
  }
  if (s == GH_OK) qsort(keys, n, sizeof *keys, compare_keys);
  for (size_t k = 1; k < n && s == GH_OK; k++) {
    char quoted[GH_QUOTE];
    if (strcmp(keys[k].key, keys[k - 1].key) != 0) continue;
    gh_yaml_node first = {.doc = doc, .node = keys[k - 1].node}, again = {.doc = doc, .node = keys[k].node};
    s = gh_yaml_fail(again, "key '%s' occurs twice, first in line %d", gh_quote(keys[k].key, quoted),
                     gh_yaml_line(first));
  }
  free(keys);
  return s;
}

static gh_status check_node(const gh_yaml *doc, int node) {
  gh_yaml_node place = {.doc = doc, .node = node};
  const yaml_node_t *n = get(doc, node);
  const char *tag = n->tag ? (const char *)n->tag : "";
  switch (n->type) {
  case YAML_SCALAR_NODE:
    if (strcmp(tag, YAML_DEFAULT_SCALAR_TAG) != 0)
      return gh_yaml_fail(place, "the tag '%s' is not understood", tag);
    if (strlen(text_of(n)) != n->data.scalar.length)
      return gh_yaml_fail(place, "a text holds a zero character");
    return GH_OK;
  case YAML_SEQUENCE_NODE:
    if (strcmp(tag, YAML_DEFAULT_SEQUENCE_TAG) != 0)
      return gh_yaml_fail(place, "the tag '%s' is not understood", tag);
    return GH_OK;
  case YAML_MAPPING_NODE:
    if (strcmp(tag, YAML_DEFAULT_MAPPING_TAG) != 0)
      return gh_yaml_fail(place, "the tag '%s' is not understood", tag);
    return check_keys(doc, n);
  default:
    return gh_yaml_fail(place, "a value of unknown kind");
  }
}

/* libyaml puts the same node in two places for an alias. With aliases a document could contain itself. */
static gh_status check_reference(const gh_yaml *doc, int *references, int node) {
  gh_yaml_node place = {.doc = doc, .node = node};
  if (references[node - 1]++ == 0) return GH_OK;
  return gh_yaml_fail(place, "this value is used again by an alias (*); write it out instead");
}

static gh_status check_references(const gh_yaml *doc, int *references) {
  references[0] = 1; /* the root */
  for (int k = 1; k <= count_of(doc); k++) {
    const yaml_node_t *n = get(doc, k);
    if (n->type == YAML_SEQUENCE_NODE) {
      for (const yaml_node_item_t *i = n->data.sequence.items.start; i < n->data.sequence.items.top; i++)
        GH_TRY(check_reference(doc, references, *i));
    } else if (n->type == YAML_MAPPING_NODE) {
      for (const yaml_node_pair_t *p = n->data.mapping.pairs.start; p < n->data.mapping.pairs.top; p++) {
        GH_TRY(check_reference(doc, references, p->key));
        GH_TRY(check_reference(doc, references, p->value));
      }
    }
  }
  return GH_OK;
}

static gh_status check(const gh_yaml *doc) {
  int *references;
  GH_TRY(gh_alloc(doc->ctx, (size_t)count_of(doc), sizeof *references, &references));
  gh_status s = check_references(doc, references);
  free(references);
  for (int k = 1; k <= count_of(doc) && s == GH_OK; k++) s = check_node(doc, k);
  return s;
}

static gh_status parse(gh_context *ctx, const gh_reader *r, gh_yaml **out) {
  gh_yaml *doc;
  GH_TRY(gh_alloc(ctx, 1, sizeof *doc, &doc));
  doc->ctx = ctx;
  doc->path = strdup(r->path);
  gh_status s = doc->path ? load(doc, r) : gh_fail(ctx, GH_MEMORY, "%s: no memory to read it", r->path);
  if (s == GH_OK) s = check(doc);
  if (s == GH_OK) *out = doc;
  else gh_yaml_destroy(&doc);
  return s;
}

gh_status gh_yaml_read(gh_context *ctx, const char *path, gh_yaml **out) {
  *out = NULL;
  gh_reader r;
  enum { MOST_MEGABYTES = 16 }; /* libyaml takes a hundred bytes for each byte of lists */
  GH_TRY(gh_reader_open_most(ctx, path, MOST_MEGABYTES, &r));
  gh_status s = parse(ctx, &r, out);
  gh_reader_close(&r);
  return s;
}

gh_status gh_yaml_parse(gh_context *ctx, const char *name, const char *text, gh_yaml **out) {
  *out = NULL;
  char *copy = strdup(text);
  if (!copy) return gh_fail(ctx, GH_MEMORY, "%s: no memory to read it", name);
  gh_reader r = {.path = name, .text = copy, .length = strlen(copy)};
  gh_status s = parse(ctx, &r, out);
  free(copy);
  return s;
}

void gh_yaml_destroy(gh_yaml **doc) {
  if (!doc || !*doc) return;
  if ((*doc)->document.nodes.start) yaml_document_delete(&(*doc)->document);
  free((*doc)->path);
  free(*doc);
  *doc = NULL;
}

/* ---- places ---- */

gh_yaml_node gh_yaml_root(const gh_yaml *doc) {
  return (gh_yaml_node){.doc = doc, .node = 1};
}

int gh_yaml_line(gh_yaml_node node) {
  const yaml_node_t *n = get(node.doc, node.node ? node.node : node.parent);
  return n ? (int)n->start_mark.line + 1 : 0;
}

const char *gh_yaml_path(gh_yaml_node node) {
  return node.doc->path;
}

static bool is(gh_yaml_node node, yaml_node_type_t type) {
  return node.node > 0 && get(node.doc, node.node)->type == type;
}
bool gh_yaml_is_map(gh_yaml_node node) {
  return is(node, YAML_MAPPING_NODE);
}
bool gh_yaml_is_list(gh_yaml_node node) {
  return is(node, YAML_SEQUENCE_NODE);
}
bool gh_yaml_is_scalar(gh_yaml_node node) {
  return is(node, YAML_SCALAR_NODE);
}
bool gh_yaml_has(gh_yaml_node node) {
  return node.node > 0;
}

gh_status gh_yaml_fail(gh_yaml_node node, const char *format, ...) {
  gh_context *ctx = node.doc->ctx;
  int line = gh_yaml_line(node);
  char text[1024];
  va_list args;
  va_start(args, format);
  gh_c_locale l = gh_c_locale_begin();
  vsnprintf(text, sizeof text, format, args);
  gh_c_locale_end(l);
  va_end(args);
  if (line == 0) return gh_fail(ctx, GH_INPUT, "%s: %s", node.doc->path, text);
  return gh_fail(ctx, GH_INPUT, "%s:%d: %s", node.doc->path, line, text);
}

const yaml_node_t *gh_yaml_look(gh_yaml_node node) {
  return get(node.doc, node.node);
}

const char *gh_yaml_kind(gh_yaml_node node) {
  if (gh_yaml_is_map(node)) return "a map";
  if (gh_yaml_is_list(node)) return "a list";
  if (!gh_yaml_has(node)) return "missing";
  const yaml_node_t *n = get(node.doc, node.node);
  if (n->data.scalar.style != YAML_PLAIN_SCALAR_STYLE) return "a text in quotes";
  return n->data.scalar.length ? "a single value" : "empty";
}

static gh_status fail_key(gh_yaml_node place, const char *key, const char *const *known) {
  char quoted[GH_QUOTE], list[512] = "";
  const char *nearest = gh_nearest(key, known);
  size_t used = 0;
  for (const char *const *k = known; *k; k++) {
    int n = snprintf(list + used, sizeof list - used, "%s%s", k == known ? "" : ", ", *k);
    used = used + (size_t)n < sizeof list ? used + (size_t)n : sizeof list - 1;
  }
  gh_quote(key, quoted);
  if (nearest) return gh_yaml_fail(place, "unknown key '%s', is '%s' meant?", quoted, nearest);
  return gh_yaml_fail(place, "unknown key '%s'; known here: %s", quoted, list);
}

gh_status gh_yaml_keys(gh_yaml_node map, const char *const *known) {
  if (!gh_yaml_is_map(map))
    return gh_yaml_fail(map, "a map (key: value) is wanted here, this is %s", gh_yaml_kind(map));
  const yaml_node_t *n = get(map.doc, map.node);
  for (const yaml_node_pair_t *p = n->data.mapping.pairs.start; p < n->data.mapping.pairs.top; p++) {
    const char *key = text_of(get(map.doc, p->key)), *const *k = known;
    while (*k && strcmp(*k, key) != 0) k++;
    if (!*k) return fail_key((gh_yaml_node){.doc = map.doc, .node = p->key}, key, known);
  }
  return GH_OK;
}

int gh_yaml_length(gh_yaml_node node) {
  const yaml_node_t *n = get(node.doc, node.node);
  if (gh_yaml_is_map(node)) return (int)(n->data.mapping.pairs.top - n->data.mapping.pairs.start);
  if (gh_yaml_is_list(node)) return (int)(n->data.sequence.items.top - n->data.sequence.items.start);
  return 0;
}

gh_yaml_node gh_yaml_item(gh_yaml_node list, int k) {
  gh_yaml_node item = {.doc = list.doc, .parent = list.node};
  if (gh_yaml_is_list(list) && k >= 0 && k < gh_yaml_length(list))
    item.node = get(list.doc, list.node)->data.sequence.items.start[k];
  return item;
}

const char *gh_yaml_key(gh_yaml_node map, int k, gh_yaml_node *value) {
  gh_yaml_node found = {.doc = map.doc, .parent = map.node};
  const char *key = NULL;
  if (gh_yaml_is_map(map) && k >= 0 && k < gh_yaml_length(map)) {
    yaml_node_pair_t pair = get(map.doc, map.node)->data.mapping.pairs.start[k];
    found.node = pair.value;
    key = text_of(get(map.doc, pair.key));
  }
  if (value) *value = found;
  return key;
}

gh_yaml_node gh_yaml_get(gh_yaml_node map, const char *key) {
  gh_yaml_node value = {.doc = map.doc, .parent = map.node ? map.node : map.parent};
  for (int k = 0; gh_yaml_is_map(map) && k < gh_yaml_length(map); k++)
    if (strcmp(gh_yaml_key(map, k, &value), key) == 0) return value;
  value.node = 0;
  return value;
}

/* ---- typed values ---- */

/* The text of a plain scalar (no quotes, not empty). `wanted`: "a number". */
static gh_status plain(gh_yaml_node node, const char *what, const char *wanted, const char **text) {
  char quoted[GH_QUOTE];
  *text = NULL;
  if (!gh_yaml_has(node)) return gh_yaml_fail(node, "%s is missing, %s is wanted", what, wanted);
  if (!gh_yaml_is_scalar(node))
    return gh_yaml_fail(node, "%s is %s, %s is wanted", what, gh_yaml_kind(node), wanted);
  const yaml_node_t *n = get(node.doc, node.node);
  if (n->data.scalar.style != YAML_PLAIN_SCALAR_STYLE)
    return gh_yaml_fail(node, "%s is a text in quotes ('%s'), %s is wanted", what,
                        gh_quote(text_of(n), quoted), wanted);
  if (n->data.scalar.length == 0) return gh_yaml_fail(node, "%s is empty, %s is wanted", what, wanted);
  *text = text_of(n);
  return GH_OK;
}

gh_status gh_yaml_number(gh_yaml_node node, const char *what, double low, double high, double *value) {
  const char *text;
  char quoted[GH_QUOTE];
  double v;
  GH_TRY(plain(node, what, "a number", &text));
  if (!gh_parse_number(text, &v))
    return gh_yaml_fail(node, "%s: '%s' is not a finite number%s", what, gh_quote(text, quoted),
                        gh_number_hint(text));
  if (v >= low && v <= high) {
    *value = v;
    return GH_OK;
  }
  gh_quote(text, quoted);
  if (v < low && low == DBL_MIN) return gh_yaml_fail(node, "%s is %s, it must be positive", what, quoted);
  if (v < low) return gh_yaml_fail(node, "%s is %s, it must be at least %g", what, quoted, low);
  return gh_yaml_fail(node, "%s is %s, it must be at most %g", what, quoted, high);
}

gh_status gh_yaml_integer(gh_yaml_node node, const char *what, long low, long high, long *value) {
  const char *text;
  char quoted[GH_QUOTE];
  long v;
  GH_TRY(plain(node, what, "an integer", &text));
  gh_quote(text, quoted);
  if (gh_parse_integer(text, low, high, value)) return GH_OK;
  if (!gh_parse_integer(text, LONG_MIN, LONG_MAX, &v))
    return gh_yaml_fail(node, "%s: '%s' is not an integer%s", what, quoted, gh_number_hint(text));
  if (v < low) return gh_yaml_fail(node, "%s is %s, it must be at least %ld", what, quoted, low);
  return gh_yaml_fail(node, "%s is %s, it must be at most %ld", what, quoted, high);
}

gh_status gh_yaml_bool(gh_yaml_node node, const char *what, bool *value) {
  static const char *const words[] = {"false", "no", "off", "true", "yes", "on"};
  const char *text;
  char quoted[GH_QUOTE];
  GH_TRY(plain(node, what, "true or false", &text));
  for (int k = 0; k < 6; k++) {
    if (!text || strcasecmp(text, words[k]) != 0) continue;
    *value = k >= 3;
    return GH_OK;
  }
  return gh_yaml_fail(node, "%s: '%s' is neither true nor false", what, gh_quote(text, quoted));
}

gh_status gh_yaml_text(gh_yaml_node node, const char *what, const char **value) {
  char control[GH_QUOTE];
  *value = NULL;
  if (!gh_yaml_has(node)) return gh_yaml_fail(node, "%s is missing, a text is wanted", what);
  if (!gh_yaml_is_scalar(node))
    return gh_yaml_fail(node, "%s is %s, a text is wanted", what, gh_yaml_kind(node));
  const yaml_node_t *n = get(node.doc, node.node);
  if (n->data.scalar.length == 0) return gh_yaml_fail(node, "%s is empty, a text is wanted", what);
  if (gh_unprintable(text_of(n), control))
    return gh_yaml_fail(node, "%s holds %s, a text in one line is wanted", what, control);
  *value = text_of(n);
  return GH_OK;
}

/* Of a list of integers that is too long: [0,5, 1]. */
static const char *comma_hint(gh_yaml_node list, int n) {
  long ignored;
  const int length = gh_yaml_length(list);
  for (int k = 0; k < length; k++) {
    const gh_yaml_node item = gh_yaml_item(list, k);
    if (!gh_yaml_is_scalar(item) ||
        !gh_parse_integer(text_of(get(item.doc, item.node)), LONG_MIN, LONG_MAX, &ignored))
      return "";
  }
  return length > n ? " (with decimal commas? a decimal point is wanted)" : "";
}

gh_status gh_yaml_numbers(gh_yaml_node node, const char *what, int n, double *values) {
  if (!gh_yaml_has(node)) return gh_yaml_fail(node, "%s is missing, a list of %d numbers is wanted", what, n);
  if (!gh_yaml_is_list(node))
    return gh_yaml_fail(node, "%s is %s, a list of %d numbers is wanted", what, gh_yaml_kind(node), n);
  int length = gh_yaml_length(node);
  if (length != n)
    return gh_yaml_fail(node, "%s has %d items, %d numbers are wanted%s", what, length, n,
                        comma_hint(node, n));
  for (int k = 0; k < n; k++) {
    char item[GH_QUOTE + 32], quoted[GH_QUOTE];
    snprintf(item, sizeof item, "%s, item %d", gh_quote(what, quoted), k + 1);
    GH_TRY(gh_yaml_number(gh_yaml_item(node, k), item, -INFINITY, INFINITY, &values[k]));
  }
  return GH_OK;
}
