/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The keys of a scene file, and what they mean.
 *
 * The readers refuse every key that is not listed here, and docs/reference/keys.md is made of these lists. */
#include "scene/read.h"

const gh_term scene_root_keys[] = {
    {"title", "one line of text for pictures and pages"},
    {"units", "labels of pictures, below; no number depends on them"},
    {"packing",
     "required. The packing at each integration point: a LAMMPS data file; a list of files, which the "
     "points 4 e + 0 ... 3 take in turn; or a map, below"},
    {"contact", "required. Contact law, below"},
    {"micro", "boundary condition and equilibrium of the packings, below"},
    {"start", "state that the steps start from, below"},
    {"mesh", "required. Mesh, below"},
    {"supports", "list of supports that act in all steps, below"},
    {"gravity", "`[gx, gy]`: weight per reference area from the start on; default [0, 0]"},
    {"steps", "required. List of load steps, below"},
    {"solver", "solver of the finite element problem, below"},
    {"results", "which packings are recorded, below"},
    {"output", "older name of `results`"},
    {0}};

const gh_term scene_units_keys[] = {
    {"length", "unit of length, such as mm"}, {"force", "unit of force, such as N"}, {0}};

const gh_term scene_ensemble_keys[] = {
    {"ensemble", "list of files, one of which each integration point draws"},
    {"seed", "seed of the drawing, 0 or more"},
    {0}};

const gh_term scene_contact_keys[] = {
    {"normal_stiffness", "required. $E_n > 0$, force per overlap"},
    {"tangential_stiffness", "$E_t > 0$, force per slip; default $E_n$. Needs friction"},
    {"friction_angle", "angle of friction between grains in degrees, 0 or more and below 90. Without it and "
                       "`friction_coefficient` the grains are frictionless"},
    {"friction_coefficient", "tangent of the angle of friction, 0 or more; instead of `friction_angle`"},
    {"hardening",
     "$h \\ge 0$, force per length: growth of the friction limit with the plastic slip; default 0"},
    {"hardening_law",
     "`printed` (default): the limit grows by $h \\alpha$; `proportional`: by $f_n h \\alpha$, with "
     "$h$ per length"},
    {"rotations", "`free` (default) or `fixed`: whether grains rotate"},
    {"slip", "`projected` (default): projected increment of slip; `objective`: measured by the angle, for "
             "increments that rotate the body by more than about a degree"},
    {"allow_overlap",
     "`true`: no [limit of the overlap](limits.md); a number: the largest mean overlap over the "
     "mean radius. Default `false`: 0.2"},
    {0}};

const gh_term scene_micro_keys[] = {
    {"boundary", "`taylor`, `taylor-cell`, `restricted`, `periodic` (default); on a frame of boundary grains "
                 "`displacement`, `frame-periodic`, `traction`, `mixed`, and by servo-control "
                 "`servo-displacement`, `servo-periodic`, `servo-traction`"},
    {"mixed",
     "with `boundary: mixed`: `x=traction,y=displacement`, for the edges that the first (x) and second (y) "
     "lattice vector lead to; of `displacement`, `periodic`, `traction`"},
    {"servo_gain",
     "of servo-control: displacement of a grain of the frame over its unbalanced force, over $1/E_n$; "
     "above 0, below 1, default 0.1"},
    {"servo_tolerance",
     "norm of what it may leave unbalanced on the frame over the mean normal contact force; above "
     "0, below 1, default 1e-4"},
    {"servo_acceleration", "sweeps that Anderson's acceleration combines, 0 (default: none) to 8"},
    {"tolerance",
     "largest unbalanced force on a free grain (or moment over radius) over the mean normal contact "
     "force; above 0, below 1, default 1e-8"},
    {"accept",
     "force: a packing that has used `max_steps` is accepted unconverged below this unbalanced force. "
     "Default: none is"},
    {"engine", "`lammps` (default) or `native`"},
    {"max_steps",
     "relaxation steps after which an evaluation has not converged; default 400000, with friction "
     "50000"},
    {"resident",
     "RVEs that a rank keeps in memory; default: as many as fit into 1 GB. No result depends on it"},
    {"integration",
     "of slip, with friction and free grains: `ramp` (default): along a ramp of F and over a short last "
     "part; "
     "`whole`: over the increment at once (Table 7.1), which has no equilibrium in some increments"},
    {"relaxation", "`polished` (default): damped central differences with Newton finish; `damped`: without; "
                   "`fire`: FIRE alone"},
    {0}};

const gh_term scene_start_keys[] = {
    {"confinement",
     "$p > 0$: equilibrium under this pressure on the edges that the first step with pressures "
     "loads; if there is none, on all edges without a support in normal direction"},
    {"follow", "whether that pressure is a follower load; default: as the pressure that replaces it"},
    {"balance", "`true`: the stress of the packing at zero displacement is balanced by fixed forces (in-situ "
                "state)"},
    {0}};

const gh_term scene_mesh_keys[] = {
    {"rectangle", "equal quadrilaterals, below; sets `left right bottom top`, and where a scene names them "
                  "`bottom_left` and the other corners"},
    {"gmsh", "file name: MSH 2.2 or 4.1, ASCII; physical groups of lines and points "
             "are the sets"},
    {"move", "list of nodes to move, below"},
    {0}};

const gh_term scene_rectangle_keys[] = {{"size", "required. `[width, height]`"},
                                        {"elements", "required. `[m, n]`"},
                                        {"low", "lower left corner; default [0, 0]"},
                                        {0}};

const gh_term scene_move_keys[] = {
    {"node", "required. `[x, y]` of the node"}, {"by", "required. `[dx, dy]`"}, {0}};

const gh_term scene_support_keys[] = {
    {"edge", "required. Edge or set"},
    {"set", ""},
    {"fix", "required. `x`, `y` or `both`: fixed where the nodes are when the step "
            "starts"},
    {0}};

const gh_term scene_step_keys[] = {
    {"name", "for messages and tables; default `step N`"},
    {"increments", "required. Number of equal increments, 1 or more"},
    {"supports", "list of supports of this step alone"},
    {"release", "list of prescribed displacements that end; their reactions fade over the step"},
    {"pressure", "list of pressures on edges"},
    {"displace", "list of prescribed displacements"},
    {"forces", "list of nodal forces"},
    {"footing", "list of rigid footings"},
    {"gravity", "`[gx, gy]` at the end of the step, or a map"},
    {0}};

const gh_term scene_pressure_keys[] = {
    {"edge", "required. Edge or set with edges"},
    {"set", ""},
    {"from", "pressure at the start of the step; default: the present one"},
    {"to", "required. Pressure at the end of the step, positive into the body"},
    {"follow",
     "`true`: follower load on the deformed edge. Default `false`: dead load on the reference edge"},
    {0}};

const gh_term scene_displace_keys[] = {
    {"edge", "required. Edge or set"},
    {"set", ""},
    {"x", "displacement in x at the end of the step, from the reference"},
    {"y", "displacement in y"},
    {"from",
     "at the start of the step: a number, or `[x, y]` where both are prescribed; default: that of each node"},
    {0}};

const gh_term scene_force_keys[] = {
    {"edge", "required. Edge or set"},
    {"set", ""},
    {"from", "`[fx, fy]` at the start of the step; default: the present force"},
    {"to", "required. `[fx, fy]` on each node at the end of the step"},
    {0}};

const gh_term scene_footing_keys[] = {
    {"edge", "required. Straight edge, whose nodes then move as a rigid body"},
    {"set", ""},
    {"force", "required. `[fx, fy]` at the end of the step"},
    {"from", "`[fx, fy]` at the start of the step; default: the present force"},
    {"at", "`[x, y]`: point of load application in the reference; default: middle of the edge"},
    {"eccentricity", "instead of `at`: distance from the middle along the edge, towards growing x (or y)"},
    {0}};

const gh_term scene_gravity_keys[] = {
    {"from", "`[gx, gy]` at the start of the step; default: the present one"},
    {"to", "required. `[gx, gy]` at the end"},
    {0}};

const gh_term scene_release_keys[] = {
    {"edge", "required. Edge or set"}, {"set", ""}, {"free", "required. `x`, `y` or `both`"}, {0}};

const gh_term scene_solver_keys[] = {
    {"method", "`newton` (default), `relaxation` (explicit, from stresses alone) or `automatic` (Newton, and "
               "relaxation where it stops)"},
    {"tolerance",
     "residual over the sum of external forces and reactions, with `relaxation` also kinetic energy over "
     "internal work; above 0, below 1, default 1e-8, with `relaxation` 1e-3"},
    {"damping_ratio", "of relaxation, over critical damping; above 0, default 1"},
    {"safety", "of relaxation: time step over the critical one; above 0, below 1, default 0.5"},
    {"line_search", "default `true`"},
    {"search_memory",
     "1 to 10: a step must reduce the residual below the largest of the last so many. Default 1; "
     "with friction and free grains 5"},
    {"max_iterations", "per attempt; default 20, with a `frozen` or `elastic` tangent 200, with "
                       "`relaxation` 2000"},
    {"cut_steps", "how often a failing increment is bisected, 0 to 30; default 6"},
    {"pass_jumps", "`true` (default): after the last bisection at an instability, step over it and count it; "
                   "`false`: stop"},
    {"tangent", "matrix of the iteration: `algorithmic` (default), `symmetrised`, `frozen` (of the last "
                "equilibrium) or `elastic` (of the packings as read). The solution is the same"},
    {"increments",
     "`planned` (default), or `automatic`: after easy increments several planned ones at once, after "
     "hard ones fewer"},
    {"at_once", "planned increments at once with `automatic`, at most; default 16"},
    {0}};

const gh_term scene_results_keys[] = {
    {"rves",
     "integration points ($4e + g$, from 0) whose grains are recorded: a list, `all` or `none`. Default: all "
     "up to 64 points; else the first, the most loaded and the least stable"},
    {"dump", "integration points that are written as LAMMPS dumps: a list, `all` or `none` (default)"},
    {"dump_every", "every so many increments; default 1"},
    {0}};

const gh_term_list *gh_scene_keys(void) {
  static const gh_term_list all[] = {{"scene file", scene_root_keys},
                                     {"units", scene_units_keys},
                                     {"packing", scene_ensemble_keys},
                                     {"contact", scene_contact_keys},
                                     {"micro", scene_micro_keys},
                                     {"start", scene_start_keys},
                                     {"mesh", scene_mesh_keys},
                                     {"mesh.rectangle", scene_rectangle_keys},
                                     {"mesh.move", scene_move_keys},
                                     {"supports", scene_support_keys},
                                     {"steps", scene_step_keys},
                                     {"steps.pressure", scene_pressure_keys},
                                     {"steps.displace", scene_displace_keys},
                                     {"steps.forces", scene_force_keys},
                                     {"steps.footing", scene_footing_keys},
                                     {"steps.gravity", scene_gravity_keys},
                                     {"steps.release", scene_release_keys},
                                     {"solver", scene_solver_keys},
                                     {"results", scene_results_keys},
                                     {0}};
  return all;
}
