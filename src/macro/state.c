/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The state of the macro problem between two increments, as numbers. */
#include "macro/internal.h"

#include <stdlib.h>
#include <string.h>

/* ndof, npoints, following edges, started, solved, footings; the tally; numbers of an edge and of a footing
 */
enum { HEAD = 6, TALLY = sizeof(gh_tally) / sizeof(double), EDGE = 3, FOOTING = 7 };

/* The arrays that an increment starts with: the last equilibrium and what holds it. All else is recomputed.
 */
typedef struct piece {
  double *data;
  size_t n;
} piece;

enum { PIECES = 9 };
static int state_pieces(const gh_macro *m, piece list[PIECES]) {
  size_t d = (size_t)m->ndof, n = (size_t)m->npoints;
  const piece all[PIECES] = {{m->eq.u, d},      {m->eq.F, 4 * n}, {m->eq.P, 4 * n},
                             {m->eq.A, 16 * n}, {m->eq.fint, d},  {m->reaction, d},
                             {m->f0, d},        {m->force, d},    {m->elastic, 16 * n}};
  memcpy(list, all, sizeof all);
  return m->elastic ? PIECES : PIECES - 1;
}

static size_t state_count(const gh_macro *m, size_t edges, size_t footings) {
  piece list[PIECES];
  size_t size = HEAD + TALLY + EDGE * edges + FOOTING * footings;
  for (int k = 0, n = state_pieces(m, list); k < n; k++) size += list[k].n;
  return size;
}

size_t gh_macro_state_size(const gh_macro *m) {
  return state_count(m, (size_t)m->follow.n, (size_t)m->nfootings);
}

void gh_macro_save(const gh_macro *m, double *state) {
  piece list[PIECES];
  const double head[HEAD] = {m->ndof, m->npoints, m->follow.n, m->started, m->solved, m->nfootings};
  memcpy(state, head, sizeof head);
  state += HEAD;
  memcpy(state, &m->tally, sizeof m->tally);
  state += TALLY;
  for (int k = 0, n = state_pieces(m, list); k < n; k++) {
    memcpy(state, list[k].data, list[k].n * sizeof *state);
    state += list[k].n;
  }
  for (int k = 0; k < m->follow.n; k++, state += EDGE) {
    const gh_edge_load *e = m->follow.edge + k;
    state[0] = e->a, state[1] = e->b, state[2] = e->pressure;
  }
  for (int k = 0; k < m->nfootings; k++, state += FOOTING) {
    const gh_footing_load *f = &m->footing[k].from;
    state[0] = f->set;
    memcpy(state + 1, f->force, sizeof f->force);
    memcpy(state + 3, f->arm, sizeof f->arm);
  }
}

/* Sets and loads of the footings; gh_footings_begin finds all else. */
static gh_status state_load_footings(gh_macro *m, const double *state, int count) {
  gh_footing *list;
  GH_TRY(gh_alloc(m->ctx, (size_t)count + 1, sizeof *list, &list));
  free(m->footing);
  m->footing = list;
  m->nfootings = count;
  for (int k = 0; k < count; k++, state += FOOTING) {
    if (!(state[0] >= 0 && state[0] < m->mesh->nsets)) {
      m->nfootings = 0;
      return gh_fail(m->ctx, GH_INPUT, "the state has a footing on set %g", state[0]);
    }
    list[k].set = m->mesh->sets + (int)state[0];
    list[k].from.set = (int)state[0];
    memcpy(list[k].from.force, state + 1, sizeof list[k].from.force);
    memcpy(list[k].from.arm, state + 3, sizeof list[k].from.arm);
  }
  return GH_OK;
}

gh_status gh_macro_load(gh_macro *m, const double *state, size_t size) {
  piece list[PIECES];
  double edges = size >= HEAD ? state[2] : -1, footings = size >= HEAD ? state[5] : -1;
  if (!(edges >= 0 && edges < 1e9 && footings >= 0 && footings < 1e9) || state[0] != m->ndof ||
      state[1] != m->npoints || size != state_count(m, (size_t)edges, (size_t)footings))
    return gh_fail(m->ctx, GH_INPUT, "the state of %zu numbers does not belong to this mesh", size);
  m->started = state[3] != 0;
  m->solved = state[4] != 0;
  state += HEAD;
  memcpy(&m->tally, state, sizeof m->tally);
  state += TALLY;
  for (int k = 0, n = state_pieces(m, list); k < n; k++) {
    memcpy(list[k].data, state, list[k].n * sizeof *state);
    state += list[k].n;
  }
  m->follow.n = 0;
  for (int k = 0; k < (int)edges; k++, state += EDGE) {
    if (!(state[0] >= 0 && state[0] < m->mesh->nnodes && state[1] >= 0 && state[1] < m->mesh->nnodes))
      return gh_fail(m->ctx, GH_INPUT, "the state has an edge from node %g to %g", state[0], state[1]);
    GH_TRY(gh_edge_loads_add(m->ctx, &m->follow, (int)state[0], (int)state[1], state[2]));
  }
  return state_load_footings(m, state, (int)footings);
}
