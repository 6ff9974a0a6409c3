/* The state of the macro problem between two increments, as numbers. SPDX-License-Identifier:
 * GPL-2.0-or-later */
#include "macro/internal.h"

#include <string.h>

/* ndof, npoints, following edges, started, solved */
enum { HEAD = 5 };

/* The arrays that an increment begins with: the last equilibrium and what holds it. All else is made anew. */
typedef struct piece {
  double *data;
  size_t n;
} piece;

static int pieces(const gh_macro *m, piece list[8]) {
  size_t d = (size_t)m->ndof, n = (size_t)m->npoints;
  const piece all[8] = {{m->eq.u, d},    {m->eq.F, 4 * n}, {m->eq.P, 4 * n}, {m->eq.A, 16 * n},
                        {m->eq.fint, d}, {m->reaction, d}, {m->f0, d},       {m->force, d}};
  memcpy(list, all, sizeof all);
  return 8;
}

static size_t size_for(const gh_macro *m, size_t edges) {
  piece list[8];
  size_t size = HEAD + 3 * edges;
  for (int k = 0, n = pieces(m, list); k < n; k++) size += list[k].n;
  return size;
}

size_t gh_macro_state_size(const gh_macro *m) {
  return size_for(m, (size_t)m->follow.n);
}

void gh_macro_save(const gh_macro *m, double *state) {
  piece list[8];
  const double head[HEAD] = {m->ndof, m->npoints, m->follow.n, m->started, m->solved};
  memcpy(state, head, sizeof head);
  state += HEAD;
  for (int k = 0, n = pieces(m, list); k < n; k++) {
    memcpy(state, list[k].data, list[k].n * sizeof *state);
    state += list[k].n;
  }
  for (int k = 0; k < m->follow.n; k++, state += 3) {
    const gh_edge_load *e = m->follow.edge + k;
    state[0] = e->a, state[1] = e->b, state[2] = e->pressure;
  }
}

gh_status gh_macro_load(gh_macro *m, const double *state, size_t size) {
  piece list[8];
  double edges = size >= HEAD ? state[2] : -1;
  if (!(edges >= 0 && edges < 1e9) || state[0] != m->ndof || state[1] != m->npoints ||
      size != size_for(m, (size_t)edges))
    return gh_fail(m->ctx, GH_INPUT, "the state of %zu numbers does not belong to this mesh", size);
  m->started = state[3] != 0;
  m->solved = state[4] != 0;
  state += HEAD;
  for (int k = 0, n = pieces(m, list); k < n; k++) {
    memcpy(list[k].data, state, list[k].n * sizeof *state);
    state += list[k].n;
  }
  m->follow.n = 0;
  for (int k = 0; k < (int)edges; k++, state += 3) {
    if (!(state[0] >= 0 && state[0] < m->mesh->nnodes && state[1] >= 0 && state[1] < m->mesh->nnodes))
      return gh_fail(m->ctx, GH_INPUT, "the state has an edge from node %g to %g", state[0], state[1]);
    GH_TRY(gh_edge_loads_add(m->ctx, &m->follow, (int)state[0], (int)state[1], state[2]));
  }
  return GH_OK;
}
