/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Boundary conditions of an RVE (method 2): one row of a table each.
 *
 * Everything that depends on the condition uses its row; a new condition is a new row, and what it fixes
 * that no other row does. */
#include "micro/internal.h"

#include <string.h>

#define ON_A_FRAME(x, y)                                                                                     \
  .body = GH_BODY_FRAME, .fixes = GH_FIXES_BOUNDARY, .edges = {GH_EDGES_##x, GH_EDGES_##y}

static const gh_condition conditions[GH_BOUNDARIES] = {
    [GH_TAYLOR] = {.name = "taylor", .body = GH_BODY_CLUSTER, .fixes = GH_FIXES_ALL},
    [GH_TAYLOR_CELL] = {.name = "taylor-cell", .body = GH_BODY_CELL, .fixes = GH_FIXES_ALL},
    [GH_RESTRICTED] = {.name = "restricted", .body = GH_BODY_CLUSTER, .fixes = GH_FIXES_BOUNDARY},
    [GH_PERIODIC] = {.name = "periodic", .body = GH_BODY_CELL, .fixes = GH_FIXES_NONE},
    [GH_DISPLACEMENT] = {.name = "displacement", ON_A_FRAME(DISPLACEMENT, DISPLACEMENT)},
    [GH_FRAME_PERIODIC] = {.name = "frame-periodic", ON_A_FRAME(PERIODIC, PERIODIC)},
    [GH_TRACTION] = {.name = "traction", ON_A_FRAME(TRACTION, TRACTION)},
    [GH_SERVO_DISPLACEMENT] = {.name = "servo-displacement",
                               .servo = true,
                               ON_A_FRAME(DISPLACEMENT, DISPLACEMENT)},
    [GH_SERVO_PERIODIC] = {.name = "servo-periodic", .servo = true, ON_A_FRAME(PERIODIC, PERIODIC)},
    [GH_SERVO_TRACTION] = {.name = "servo-traction", .servo = true, ON_A_FRAME(TRACTION, TRACTION)},
    [GH_MIXED] = {.name = "mixed", ON_A_FRAME(OPEN, OPEN)}};

gh_condition gh_condition_of(const gh_rve_options *o) {
  gh_condition c = conditions[o->boundary];
  if (o->boundary == GH_MIXED) memcpy(c.edges, o->mixed, sizeof c.edges);
  return c;
}

bool gh_boundary_from_name(const char *name, gh_boundary *b) {
  for (int k = 0; k < GH_BOUNDARIES; k++) {
    if (strcmp(name, conditions[k].name) != 0) continue;
    *b = (gh_boundary)k;
    return true;
  }
  return false;
}

const char *gh_boundary_name(gh_boundary b) {
  return conditions[b].name;
}

const char *gh_boundary_words(void) {
  return "taylor, taylor-cell, restricted, periodic, displacement, frame-periodic, traction, mixed, "
         "servo-displacement, servo-periodic, servo-traction";
}

bool gh_rve_has_branches(const gh_rve_options *o) {
  const gh_condition c = gh_condition_of(o);
  return gh_condition_relaxes(&c) && o->law.friction;
}

bool gh_rve_has_frame(const gh_rve_options *o) {
  return conditions[o->boundary].body == GH_BODY_FRAME;
}

bool gh_rve_has_servo(const gh_rve_options *o) {
  return conditions[o->boundary].servo;
}

/* ---- mixed conditions ---- */

static const char *const edge_words[] = {[GH_EDGES_OPEN] = "",
                                         [GH_EDGES_DISPLACEMENT] = "displacement",
                                         [GH_EDGES_PERIODIC] = "periodic",
                                         [GH_EDGES_TRACTION] = "traction"};

/* "x=traction" at the start of the text; what follows it. NULL: it is none. */
static const char *edges_read(const char *text, gh_edges mixed[2]) {
  if ((text[0] != 'x' && text[0] != 'y') || text[1] != '=') return NULL;
  const size_t length = strcspn(text + 2, ",");
  for (int k = GH_EDGES_DISPLACEMENT; k <= GH_EDGES_TRACTION; k++)
    if (strlen(edge_words[k]) == length && strncmp(text + 2, edge_words[k], length) == 0) {
      if (mixed[text[0] - 'x'] != GH_EDGES_OPEN) return NULL;
      mixed[text[0] - 'x'] = (gh_edges)k;
      return text + 2 + length;
    }
  return NULL;
}

static gh_status mixed_check(gh_context *ctx, const gh_edges mixed[2]) {
  for (int k = 0; k < 2; k++)
    if (mixed[k] == GH_EDGES_OPEN)
      return gh_fail(
          ctx, GH_INPUT,
          "mixed conditions: the pair of edges %c has no condition, so that its term sum a . dx of the work "
          "is not that of the stress (Hill-Mandel): %c=displacement, periodic or traction",
          'x' + k, 'x' + k);
  return GH_OK;
}

gh_status gh_mixed_read(gh_context *ctx, const char *text, gh_edges mixed[2]) {
  const char *at = text;
  mixed[0] = mixed[1] = GH_EDGES_OPEN;
  while (at && *at) {
    at = edges_read(at, mixed);
    if (at && *at == ',' && at[1]) at++;
    else if (at && *at) at = NULL;
  }
  if (!at)
    return gh_fail(
        ctx, GH_INPUT,
        "mixed conditions '%s' must be like x=traction,y=displacement, of displacement, periodic and "
        "traction",
        text);
  return mixed_check(ctx, mixed);
}

void gh_boundary_text(const gh_rve_options *o, char text[GH_MIXED_TEXT]) {
  if (o->boundary == GH_MIXED)
    snprintf(text, GH_MIXED_TEXT, "mixed x=%s,y=%s", edge_words[o->mixed[0]], edge_words[o->mixed[1]]);
  else snprintf(text, GH_MIXED_TEXT, "%s", gh_boundary_name(o->boundary));
}

/* ---- packings ---- */

/* What a frame is made of; grains that reach across the cell are refused where it is made. */
gh_status gh_rve_check_packing(gh_context *ctx, const gh_packing *packing, const gh_rve_options *o) {
  gh_hull hull;
  gh_rve_frame *frame;
  const gh_condition c = gh_condition_of(o);
  if (c.body != GH_BODY_FRAME) return GH_OK;
  if (o->boundary == GH_MIXED) GH_TRY(mixed_check(ctx, o->mixed));
  GH_TRY(gh_frame_create(ctx, packing, &c, &frame));
  gh_frame_destroy(&frame);
  GH_TRY(gh_hull_find(ctx, packing, &hull));
  if (hull.full) return GH_OK;
  const char *const hint =
      "`granhom pack` prints the gap of a packing; another origin of the cell, or another packing, "
      "has another frame";
  if (isinf(hull.gap))
    return gh_fail(ctx, GH_INPUT,
                   "the frame has a hole: no chain of grains closes the %c edges of the cell. %s",
                   'x' + 1 - hull.face, hint);
  return gh_fail(
      ctx, GH_INPUT,
      "the frame has a gap of %.4g between grains %d and %d on the %c edges, and the smallest grain, of "
      "diameter %.4g, can pass. %s",
      hull.gap, hull.id[0], hull.id[1], 'x' + 1 - hull.face, hull.smallest, hint);
}

gh_status gh_condition_fix(gh_rve *r) {
  const gh_condition c = gh_condition_of(&r->options);
  if (r->frame) r->held = r->frame->fixed ? r->frame->held : NULL;
  else if (c.fixes == GH_FIXES_BOUNDARY) r->held = r->cluster->boundary;
  r->pinned = r->periodic && !r->held && !gh_frame_is_open(r->frame);
  if (c.fixes != GH_FIXES_ALL || !r->turns) return GH_OK;
  GH_TRY(gh_alloc(r->ctx, (size_t)r->n, 1, &r->all_held)); /* rotations are unknown, no position is */
  memset(r->all_held, 1, (size_t)r->n);
  r->held = r->all_held;
  r->pinned = r->periodic;
  return GH_OK;
}
