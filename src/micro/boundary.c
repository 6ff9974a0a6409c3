/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Boundary conditions of an RVE (method 2): one row of a table each.
 *
 * Everything that depends on the condition uses its row; a new condition is a new row, and what it fixes
 * that no other row does. */
#include "micro/internal.h"

#include <string.h>

static const gh_condition conditions[] = {
    [GH_TAYLOR] = {.name = "taylor", .body = GH_BODY_CLUSTER, .fixes = GH_FIXES_ALL},
    [GH_TAYLOR_CELL] = {.name = "taylor-cell", .body = GH_BODY_CELL, .fixes = GH_FIXES_ALL},
    [GH_RESTRICTED] = {.name = "restricted", .body = GH_BODY_CLUSTER, .fixes = GH_FIXES_BOUNDARY},
    [GH_PERIODIC] = {.name = "periodic", .body = GH_BODY_CELL, .fixes = GH_FIXES_NONE},
};
enum { CONDITIONS = sizeof conditions / sizeof *conditions };

const gh_condition *gh_condition_of(gh_boundary b) {
  return &conditions[b];
}

bool gh_boundary_from_name(const char *name, gh_boundary *b) {
  for (int k = 0; k < CONDITIONS; k++) {
    if (strcmp(name, conditions[k].name) != 0) continue;
    *b = (gh_boundary)k;
    return true;
  }
  return false;
}

const char *gh_boundary_name(gh_boundary b) {
  return conditions[b].name;
}

bool gh_rve_has_branches(const gh_rve_options *o) {
  return gh_condition_relaxes(gh_condition_of(o->boundary)) && o->law.friction;
}

gh_status gh_condition_fix(gh_rve *r) {
  const gh_condition *c = gh_condition_of(r->options.boundary);
  if (c->fixes == GH_FIXES_BOUNDARY) r->held = r->cluster->boundary;
  if (c->fixes != GH_FIXES_ALL || !r->turns) return GH_OK;
  GH_TRY(gh_alloc(r->ctx, (size_t)r->n, 1, &r->all_held)); /* rotations are unknown, no position is */
  memset(r->all_held, 1, (size_t)r->n);
  r->held = r->all_held;
  return GH_OK;
}
