/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Fix granhom/relax driven by a program: a ramp on LAMMPS's neighbour list.
 *
 * LAMMPS's box cannot follow a gradient within one list, the kernel's pairs do. So nothing of it is written
 * back: the program takes what comes out and sets LAMMPS to it. */
#include "engine/lammps/fix_relax.h"

#include "engine/lammps/fix_history.h"
#include "engine/lammps/pair_coulomb.h"

#include "atom.h"
#include "neighbor.h"

#include <algorithm>

using granhom::FixRelax;

/* Pairs that were never closed have nothing to remember. */
void FixRelax::note_committed() {
  committed.clear();
  for (std::size_t c = 0; c < candidates.size(); c++) {
    const gh_pair &p = candidates[c].pair;
    const int *k = candidates[c].k;
    const gh_pair_memory &m = memory[c];
    if (m.gamma == 0 && m.gamma_pl == 0 && m.alpha == 0) continue;
    committed.push_back({p.i, p.j, {k[0], k[1]}, m.gamma, m.gamma_pl, m.alpha});
  }
}

void FixRelax::ramp(const gh_ramp &o, gh_relax_friction *s, gh_relax_result *r, guard_ramped *list) {
  const std::size_t n = atom->nlocal;
  gh_relax_state *g = &s->grains;
  sort_ids();
  find_pairs();
  X0.resize(2 * n);
  for (std::size_t a = 0; a < n; a++) {
    const std::size_t i = order[a];
    std::copy_n(atom->x[i], 2, g->x + 2 * a);
    std::copy_n(pair->build_x.begin() + 3 * (std::ptrdiff_t)i, 2, X0.begin() + 2 * (std::ptrdiff_t)a);
    s->theta[a] = history->theta_now((int)i);
  }
  work.resize(gh_relax_friction_work((int)n, (int)pairs.size()));
  g->npairs = (int)pairs.size();
  g->pairs = pairs.data(), g->x0 = X0.data(), g->work = work.data();
  g->slack = neighbor->skin / 2;
  s->memory = memory.data();
  const long before = r->steps;
  list->end = gh_relax_friction_run(s, o.tolerance, o.floor, o.max_steps - before, &r->residual,
                                    &r->mean_force, &r->steps);
  list->pairs = (r->steps - before) * (long)pairs.size();
  note_committed();
  list->slips = committed.data();
  list->nslips = (int)committed.size();
}
