/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Scenes and runs in words. */
#include "scene/internal.h"

static void explain_contact(const gh_contact_law *law, gh_text *out) {
  gh_text_print(out, "contact           normal, one-sided harmonic, stiffness %g; ", law->normal_stiffness);
  if (!law->friction) {
    gh_text_print(out, "frictionless\n");
    return;
  }
  gh_text_print(
      out,
      "Coulomb friction %g (%.4g degrees), tangential stiffness %g, hardening %g%s;\n"
      "                  slip %s, rotations %s\n",
      law->friction_coefficient, atan(law->friction_coefficient) * 180 / acos(-1), law->tangential_stiffness,
      law->hardening, law->hardening_law == GH_HARDENING_PROPORTIONAL ? " times the normal force" : "",
      law->slip == GH_SLIP_OBJECTIVE ? "objective" : "projected", law->fixed_rotations ? "fixed" : "free");
}

static void explain_left_out(const gh_scene *s, bool relaxes, bool turns, gh_text *out) {
  const gh_contact_law *law = &s->micro.law;
  const char *friction =
                 law->friction
                     ? ""
                     : "grain rotations, tangential forces and the history of contacts (frictionless)",
             *turn = law->friction && !turns ? "grain rotations" : "",
             *moves = relaxes ? ""
                      : turns ? "motion of the grains but their rotations"
                              : "relaxation, factorisation of the grains' stiffness";
  const char *hardening =
      law->friction && law->hardening == 0 ? "hardening of contacts that have opened" : "";
  const bool stays = s->solver.tangent == GH_TANGENT_FROZEN || s->solver.tangent == GH_TANGENT_ELASTIC;
  const char *tangents = stays ? "tangents of the packings but at the end of an increment" : "";
  const char *parts[] = {friction, turn, moves, hardening, tangents};
  const char *join = "";
  gh_text_print(out, "left out          ");
  for (int k = 0; k < 5; k++) {
    if (!*parts[k]) continue;
    gh_text_print(out, "%s%s", join, parts[k]);
    join = "; ";
  }
  gh_text_print(out, "%s\n", *join ? "" : "nothing");
}

static void explain_packings(const gh_scene *s, gh_text *out) {
  enum { SHOWN = 12 };
  int points = 4 * s->mesh->nelements;
  if (s->npackings == 1) {
    gh_text_print(out, "material points   %d, each a packing of %d grains (%s)\n", points, s->packings[0]->n,
                  s->packing_paths[0]);
  } else {
    gh_text_print(out, "material points   %d, of %d packings ", points, s->npackings);
    if (s->packing_drawn) gh_text_print(out, "drawn by the seed %ld\n", s->packing_seed);
    else gh_text_print(out, "in turn\n");
    for (int k = 0; k < s->npackings && k < SHOWN; k++)
      gh_text_print(out, "                  %d of %d grains (%s)\n", scene_packing_points(s, k),
                    s->packings[k]->n, s->packing_paths[k]);
    if (s->npackings > SHOWN) gh_text_print(out, "                  ... and %d more\n", s->npackings - SHOWN);
  }
}

/* Which points are one RVE in the beginning: those with the same packing. */
static void explain_sharing(const gh_scene *s, gh_text *out) {
  int points = 4 * s->mesh->nelements, groups = 0;
  for (int k = 0; k < s->npackings; k++) groups += scene_packing_points(s, k) > 0;
  if (!s->no_share)
    gh_text_print(out,
                  "sharing           the %d points begin as %d different RVE%s; points stay together while "
                  "their F agree to the bit\n",
                  points, groups, GH_S(groups));
  else gh_text_print(out, "sharing           none: each of the %d points is computed\n", points);
  if (s->resident > 0)
    gh_text_print(out, "memory            at most %d RVEs kept ready on a rank, other states swapped\n",
                  s->resident);
  else
    gh_text_print(out, "memory            RVEs kept ready on a rank up to %.0f MB, other states swapped\n",
                  GH_FARM_BYTES / 1e6);
}

static void explain_micro(const gh_scene *s, gh_text *out) {
  static const char *const meaning[] = {
      [GH_TAYLOR] = "every grain follows F: no relaxation, the tangent is a sum over contacts",
      [GH_TAYLOR_CELL] =
          "every grain of the periodic cell follows F: no relaxation, the tangent is a sum over contacts",
      [GH_RESTRICTED] = "grains at the boundary follow F, inner grains are relaxed; tangent by condensation "
                        "of the inner grains",
      [GH_PERIODIC] = "the cell follows F, all its grains are relaxed; tangent by condensation of all grains "
                      "onto the cell",
      [GH_DISPLACEMENT] = "grains on the frame follow F, all others are relaxed; tangent by condensation",
      [GH_FRAME_PERIODIC] =
          "opposite edges of the frame move alike: all grains of the periodic cell are relaxed",
      [GH_TRACTION] =
          "uniform traction on the frame, which F holds in the mean; all grains are relaxed; tangent by "
          "condensation, with the constraint as a border of the matrix",
      [GH_SERVO_DISPLACEMENT] = "as displacement",
      [GH_SERVO_PERIODIC] = "as frame-periodic, by sweeps that move the grains of the frame",
      [GH_SERVO_TRACTION] = "as traction, by sweeps that move the grains of the frame",
      [GH_MIXED] = "each pair of edges of the frame by itself; tangent by condensation"};
  static const char *const ways[] = {[GH_RELAX_POLISHED] = "central differences, then Newton",
                                     [GH_RELAX_DAMPED] = "damped: central differences alone, without Newton",
                                     [GH_RELAX_FIRE] = "fire: FIRE alone, without Newton"};
  bool relaxes = s->micro.boundary != GH_TAYLOR && s->micro.boundary != GH_TAYLOR_CELL;
  char boundary[GH_MIXED_TEXT];
  gh_boundary_text(&s->micro, boundary);
  explain_packings(s, out);
  gh_text_print(out, "boundary          %s: %s\n", boundary, meaning[s->micro.boundary]);
  bool turns = s->micro.law.friction && !s->micro.law.fixed_rotations;
  gh_text_print(out, "engine            %s%s\n", s->micro.engine == GH_ENGINE_NATIVE ? "native" : "lammps",
                relaxes ? ""
                : turns ? ", for contacts and rotations"
                        : ", for the contacts only");
  explain_contact(&s->micro.law, out);
  if (relaxes || turns)
    gh_text_print(out, "relaxation        %s, to a residual of %g\n", ways[s->micro.relaxation],
                  s->micro.tolerance);
  if (gh_rve_has_branches(&s->micro))
    gh_text_print(out, "slip              integrated %s\n",
                  s->micro.integration == GH_INTEGRATION_RAMP ? "along ramps of F" : "over whole increments");
  if ((relaxes || turns) && s->micro.accept > 0)
    gh_text_print(
        out, "                  after %ld steps accepted unconverged, if no unbalanced force is above %g\n",
        gh_rve_step_limit(&s->micro), s->micro.accept);
  explain_left_out(s, relaxes, turns, out);
}

static bool pressure_follows(const gh_scene *s) {
  bool follows = s->start == SCENE_START_CONFINEMENT && s->confinement_follow > 0;
  for (int k = 0; k < s->nsteps; k++)
    for (int j = 0; j < s->steps[k].npressures; j++) follows = follows || s->steps[k].pressures[j].follow;
  return follows;
}

static bool has_footing(const gh_scene *s) {
  for (int k = 0; k < s->nsteps; k++)
    if (s->steps[k].nfootings > 0) return true;
  return false;
}

static void explain_systems(const gh_scene *s, gh_text *out) {
  const char *why = pressure_follows(s) && s->micro.law.friction ? "friction, pressure that follows the edge"
                    : pressure_follows(s)                        ? "pressure that follows the edge"
                    : s->micro.law.friction                      ? "friction"
                                                                 : NULL;
  const bool halves = s->solver.tangent == GH_TANGENT_SYMMETRISED;
  gh_text_print(out, "linear systems    %d unknowns at most, ", 2 * s->mesh->nnodes);
  if (why && !halves) gh_text_print(out, "unsymmetric (%s): UMFPACK\n", why);
  else
    gh_text_print(out, "%s: CHOLMOD, and UMFPACK where they are not positive definite\n",
                  why ? "made symmetric" : "symmetric (no friction, dead loads)");
  if (has_footing(s))
    gh_text_print(out,
                  "                  nodes of footings are eliminated: three unknowns for each footing\n");
}

static void explain_relaxation(const gh_scene *s, gh_text *out) {
  gh_text_print(
      out,
      "                  explicit relaxation: damping %g of critical, time step %g of the critical one; "
      "from stresses\n                  alone, no tangents, nothing is factorised\n",
      s->solver.damping_ratio, s->solver.safety);
}

static void explain_relaxing(const gh_scene *s, gh_text *out) {
  gh_text_print(out, "solver            damped central differences\n");
  explain_relaxation(s, out);
  gh_text_print(
      out,
      "                  at rest when residual and kinetic energy over internal work are at most %g; at "
      "most %d steps\n"
      "                  an increment that does not come to rest is halved up to %d times\n",
      s->solver.tolerance, s->solver.max_iterations, s->solver.cut_steps);
}

static void explain_newton(const gh_scene *s, gh_text *out) {
  static const char *const matrix[] = {
      [GH_TANGENT_ALGORITHMIC] = "the consistent tangent",
      [GH_TANGENT_SYMMETRISED] = "the symmetric part of the consistent tangent",
      [GH_TANGENT_FROZEN] = "the tangent of the last equilibrium, factorised once for an increment",
      [GH_TANGENT_ELASTIC] = "the tangent of the packings as read, factorised once for an increment"};
  gh_text_print(out, "solver            Newton with %s,\n", matrix[s->solver.tangent]);
  gh_text_print(out, "                  %s line search", s->solver.line_search ? "with" : "without");
  if (s->solver.line_search && s->solver.memory > 1)
    gh_text_print(out, " below the largest of %d residuals", s->solver.memory);
  gh_text_print(out, ", tolerance %g, at most %d iterations\n", s->solver.tolerance,
                s->solver.max_iterations);
  gh_text_print(out,
                "                  an increment that fails is halved up to %d times; instabilities are %s\n",
                s->solver.cut_steps, s->solver.pass_jumps ? "stepped over and counted" : "not stepped over");
  if (s->solver.method == GH_METHOD_AUTOMATIC) {
    gh_text_print(out, "                  where that stops, to the same tolerance:\n");
    explain_relaxation(s, out);
  }
}

static void explain_solver(const gh_scene *s, gh_text *out) {
  const bool stress = s->solver.method == GH_METHOD_RELAXATION;
  if (stress) explain_relaxing(s, out);
  else explain_newton(s, out);
  if (s->at_once > 1)
    gh_text_print(
        out,
        "increments        automatic: up to %d planned ones at once after easy ones, fewer after hard "
        "ones\n",
        s->at_once);
  if (!stress) explain_systems(s, out);
}

static void explain_error(const gh_scene *s, gh_text *out) {
  gh_text_print(
      out, "error             residuals and energy imbalance of each increment, at no cost worth naming\n");
  if (!s->estimate) return;
  gh_text_print(
      out,
      "                  estimate by step doubling: each increment once more in two halves from the same "
      "state, from\n"
      "                  which the run continues: about three times the time, twice the memory for states; "
      "%s\n",
      s->micro.law.friction ? "differences of first order add up (friction)"
                            : "differences are round-off or branches (frictionless)");
}

static void explain_share(const char *what, int count, int points, gh_text *out) {
  if (count == 0) return;
  if (count < 0 || count >= points) gh_text_print(out, "; %s of all points", what);
  else gh_text_print(out, "; %s of %d point%s", what, count, count == 1 ? "" : "s");
}

/* Which files, and who works. */
static void explain_run(const gh_scene *s, gh_text *out) {
  const int points = 4 * s->mesh->nelements;
  const bool few = s->nrves == GH_FEW_POINTS && points <= GH_FEW;
  gh_text_print(out, "results           loads, reactions, residuals as text");
  if (gh_h5_available()) {
    gh_text_print(out, "; fields for ParaView (HDF5)");
    if (s->nrves == GH_FEW_POINTS && !few)
      gh_text_print(out, "; grains and contacts of the first, the most loaded and the least stable point");
    else explain_share("grains and contacts", few ? -1 : s->nrves, points, out);
    gh_text_print(out, "; checkpoints");
  } else {
    gh_text_print(out, "; no fields, grains and checkpoints: built without HDF5");
  }
  explain_share("LAMMPS dumps", s->ndumps, points, out);
  gh_text_print(out, "\n");
  if (s->ranks == 0) gh_text_print(out, "ranks             one: built without MPI\n");
  else if (s->ranks == 1) gh_text_print(out, "ranks             one: nothing is sent\n");
  else
    gh_text_print(out,
                  "ranks             %d: rank 0 assembles and solves, all of them compute RVEs, which %s\n",
                  s->ranks, s->no_balance ? "stay where they began" : "move to where the load is low");
}

static void explain_start(const gh_scene *s, gh_text *out) {
  if (s->start == SCENE_START_CONFINEMENT)
    gh_text_print(out, "start             equilibrium under a confinement of %g\n", s->confinement);
  else if (s->start == SCENE_START_BALANCE)
    gh_text_print(out, "start             the stress of the packing is held by fixed forces\n");
  else gh_text_print(out, "start             equilibrium without confinement\n");
}

void gh_scene_explain(const gh_scene *s, gh_text *out) {
  if (*s->title) gh_text_print(out, "scene             %s\n", s->title);
  gh_text_print(out,
                "mesh              %d bilinear quadrilaterals with 2 x 2 Gauss points, %d nodes, %d sets\n",
                s->mesh->nelements, s->mesh->nnodes, s->nsets);
  explain_micro(s, out);
  explain_sharing(s, out);
  explain_solver(s, out);
  explain_error(s, out);
  explain_run(s, out);
  explain_start(s, out);
  for (int k = 0; k < s->nsteps; k++) {
    const scene_step *step = s->steps + k;
    gh_text_print(out, "step %-12d %s: %d increment%s", k + 1, step->name, step->increments,
                  GH_S(step->increments));
    for (int j = 0; j < step->nfootings; j++)
      gh_text_print(out, "; rigid footing on '%s'", s->mesh->sets[step->footings[j].set].name);
    gh_text_print(out, "\n");
  }
}

static void print_estimate(const gh_run_estimate *q, gh_text *out) {
  if (q->increments == 0) {
    gh_text_print(out, "no estimate of the error of the path: --estimate-error makes one, for about three "
                       "times the time\n");
    return;
  }
  gh_text_print(
      out,
      "estimated error of the path%s: stress %.2g (largest of a point %.2g), displacement %.2g, force "
      "%.2g, relative; %.1f s for it\n",
      q->branched > 0 ? ", its branches apart" : "", gh_estimated_error(q, GH_ERROR_STRESS),
      gh_estimated_error(q, GH_ERROR_STRESS_LARGEST), gh_estimated_error(q, GH_ERROR_DISPLACEMENT),
      gh_estimated_error(q, GH_ERROR_FORCE), q->seconds);
  if (q->branched > 0)
    gh_text_print(
        out,
        "the path branches in %d of %d increment%s (stress differs by up to %.2g): there and behind it "
        "is one of several, which no estimate compares\n",
        q->branched, q->increments, GH_S(q->increments), q->branch);
}

static void print_error(const gh_run_summary *m, gh_text *out) {
  const gh_energy *e = &m->energy;
  gh_text_print(
      out,
      "residuals at most %.1e (macro) and %.1e (packings); energy imbalance %.1e, work imbalance %.1e of "
      "the largest work",
      e->residual, e->micro_residual, gh_energy_defect(e), gh_work_defect(e));
  if (e->freed != 0) gh_text_print(out, "; %.2g of it were released at instabilities", e->freed / e->largest);
  gh_text_print(out, "\n");
  print_estimate(&m->estimate, out);
}

/* "2 steps, 30 increments, ..."; of a run that ended before its end, which steps are complete and how much of
 * the next one. */
static void print_progress(const gh_run_summary *m, gh_text *out) {
  if (m->planned > m->steps)
    gh_text_print(out, "%d of %d step%s complete", m->steps, m->planned, GH_S(m->planned));
  else gh_text_print(out, "%d step%s", m->steps, GH_S(m->steps));
  if (m->step > 0)
    gh_text_print(out, ", and %d of %d increment%s of step %d; in all", m->done, m->of, GH_S(m->of), m->step);
  gh_text_print(out,
                "%s %d increment%s, %d iteration%s in %d substep%s; %d bisection%s, %d %s stepped over\n",
                m->step > 0 ? "" : ",", m->increments, GH_S(m->increments), m->iterations,
                GH_S(m->iterations), m->substeps, GH_S(m->substeps), m->cuts, GH_S(m->cuts), m->jumps,
                m->jumps == 1 ? "instability" : "instabilities");
}

static void print_relaxation(const gh_run_summary *m, gh_text *out) {
  if (m->relaxed == 0) return;
  gh_text_print(out, "%d of the iterations, in %d increment%s, were steps of explicit relaxation\n",
                m->relaxed, m->relaxed_increments, GH_S(m->relaxed_increments));
}

void gh_summary_print(const gh_run_summary *m, const char *folder, gh_text *out) {
  double rest = m->cost.total - m->cost.relax - m->cost.contacts - m->cost.factorise;
  print_progress(m, out);
  print_relaxation(m, out);
  if (isfinite(m->min_acoustic))
    gh_text_print(out, "%d of %d integration points unjammed; smallest acoustic eigenvalue %.4g%s\n",
                  m->unjammed, m->points, m->min_acoustic, m->min_acoustic > 0 ? "" : " (ellipticity lost)");
  print_error(m, out);
  gh_text_print(out,
                "%.1f s, of these %.1f s micro (relaxation %.1f, contacts %.1f, factorisation %.1f, rest "
                "%.1f), %.1f s results\n",
                m->seconds, m->micro_seconds, m->cost.relax, m->cost.contacts, m->cost.factorise,
                fmax(rest, 0), m->results_seconds);
  if (m->farm.evaluations > 0)
    gh_text_print(
        out,
        "%d rank%s; of %ld evaluations of points %ld were computed (%.0f %% shared), %ld state%s moved "
        "between ranks; at the end %d different RVE%s at %d points\n",
        m->farm.ranks, GH_S(m->farm.ranks), m->farm.evaluations, m->farm.computed,
        100 * (1 - (double)m->farm.computed / (double)m->farm.evaluations), m->farm.moved,
        GH_S(m->farm.moved), m->farm.states, GH_S(m->farm.states), m->points);
  if (m->farm.ramps > 0)
    gh_text_print(out,
                  "%ld ramp%s, %ld of them to rest where the last part of an increment had no equilibrium\n",
                  m->farm.ramps, GH_S(m->farm.ramps), m->farm.settled);
  if (m->farm.accepted > 0)
    gh_text_print(out, "in %ld evaluation%s a packing was accepted unconverged (micro.accept)\n",
                  m->farm.accepted, GH_S(m->farm.accepted));
  if (m->farm.ranks > 1 && m->farm.longest > 0)
    gh_text_print(out,
                  "ranks were busy for %.0f %% of the time that the busiest one took in each evaluation\n",
                  100 * m->farm.busy / (m->farm.ranks * m->farm.longest));
  gh_text_print(out, "results in %s\n", folder);
}
