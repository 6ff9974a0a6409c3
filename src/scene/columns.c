/* The columns and datasets of the files that a run writes, and what they mean; docs/reference/columns.md is
 * made of these lists. SPDX-License-Identifier: GPL-2.0-or-later */
#include "scene/results.h"

const gh_term scene_history_head[] = {{"step", "number of the increment over the whole run; 0 is the start"},
                                      {"increment", "number within the load step"},
                                      {"name", "name of the load step"},
                                      {"load_step", "number of the load step; 0 is the start"},
                                      {"time", "load steps completed"},
                                      {0}};

const gh_term scene_history_sets[] = {
    [HISTORY_P] = {"p_SET", "pressure on the set, where one acts in some step"},
    [HISTORY_UX] = {"ux_SET",
                    "prescribed displacement, mean over the set; `nan` while the step prescribes none"},
    [HISTORY_UY] = {"uy_SET", ""},
    [HISTORY_FX] = {"fx_SET", "force on each node of the set"},
    [HISTORY_FY] = {"fy_SET", ""},
    [HISTORY_FOOTING_FX] = {"footing_fx_SET", "force on the footing"},
    [HISTORY_FOOTING_FY] = {"footing_fy_SET", ""},
    [HISTORY_GX] = {"gx", "weight per reference area"},
    [HISTORY_GY] = {"gy", ""},
    [HISTORY_X] = {"SET_x",
                   "reaction on the set: force of the supports (or of the footing) on the body. Corner "
                   "nodes count for both edges"},
    [HISTORY_Y] = {"SET_y", ""},
    [HISTORY_FOOTING_UX] = {"footing_ux_SET", "displacement of the middle of the footing"},
    [HISTORY_FOOTING_UY] = {"footing_uy_SET", ""},
    [HISTORY_FOOTING_TURN] = {"footing_turn_SET", "rotation of the footing, radians, counter-clockwise"},
    {0}};

const gh_term scene_history_tail[] = {
    {"dilatancy", "change of the area of the body, percent"},
    {"iterations", "Newton iterations"},
    {"substeps", "substeps in which the increment was solved"},
    {"cuts", "bisections of the increment"},
    {"jumps", "instabilities that were stepped over"},
    {"unjammed", "integration points without stress"},
    {"min_acoustic", "smallest eigenvalue of the acoustic tensors of all points, stress"},
    {"residual", "residual over external forces and reactions"},
    {"micro_evaluations", "evaluations of integration points"},
    {"micro_steps", "their relaxation steps"},
    {"micro_factorisations", "their factorisations"},
    {"inner_work", "work of the stresses since the start"},
    {"outer_work", "work of the external forces and reactions since the start"},
    {"energy", "change of the stored energy since the start"},
    {"dissipation", "dissipated by friction since the start"},
    {"energy_defect", "energy imbalance, relative: work of the stresses less what is stored and dissipated"},
    {0}};

const gh_term scene_history_estimate[] = {
    {"estimate", "estimated error of the Piola stress, root mean square, relative"},
    {"estimate_largest", "the same at the point where it is largest"},
    {"estimate_displacement", "of the displacements, relative"},
    {"estimate_force", "of the force on the set that is driven last (or of all reactions), relative"},
    {"estimate_growth", "growth of the difference of the stresses in this increment, relative"},
    {"branched", "1: the two paths have separated in this increment, which is left out of the estimate"},
    {0}};

const gh_term scene_timing_columns[] = {{"step", "as in `history.csv`"},
                                        {"seconds", "time of the increment"},
                                        {"micro_seconds", "of these in packings"},
                                        {"evaluations", "evaluations of integration points"},
                                        {"computed", "of these computed; the others share a result"},
                                        {"moved", "states moved between ranks"},
                                        {"ranks", "number of ranks"},
                                        {0}};

const gh_term scene_convergence_columns[] = {{"step", "as in `history.csv`"},
                                             {"substep", "substep of the increment"},
                                             {"iteration", "Newton iteration, from 0"},
                                             {"residual", "norm of the unbalanced forces"},
                                             {"relative", "over external forces and reactions"},
                                             {"first", "over the residual at the start of the attempt"},
                                             {"step_length", "of the line search"},
                                             {"seconds", "since the start of the increment"},
                                             {0}};

const gh_term scene_grain_columns[] = {
    {"id", "number in the dump"},
    {"type", "fraction of the sieve curve"},
    {"x", "position; a periodic cell is rotated so that its first vector lies along x"},
    {"y", ""},
    {"z", "0"},
    {"ix", "image flag"},
    {"iy", "image flag"},
    {"iz", "0"},
    {"radius", "radius"},
    {"grain", "id in the packing"},
    {"rattler", "1: rattler"},
    {"held", "1: prescribed"},
    {"replica", "1: periodic replica"},
    {0}};

const gh_term scene_grain_friction[] = {{"theta", "rotation, radians"}, {0}};

const gh_term scene_contact_columns[] = {{"index", "number"},
                                         {"id1", "first grain"},
                                         {"id2", "second grain"},
                                         {"x1", "position of the first grain"},
                                         {"y1", ""},
                                         {"lx", "branch vector to the second grain or its image"},
                                         {"ly", ""},
                                         {"fx", "force on the first grain"},
                                         {"fy", ""},
                                         {"fn", "normal force, compression positive"},
                                         {"ft", "tangential force, along the branch rotated by +90 degrees"},
                                         {"overlap", "overlap, length"},
                                         {0}};

const gh_term scene_contact_friction[] = {{"sliding", "1: on the Coulomb limit"},
                                          {"slip", "tangential slip, length"},
                                          {"slip_plastic", "its plastic part, length"},
                                          {0}};

static const gh_term mesh_datasets[] = {
    {"coordinates", "nodes x 3, reference"},
    {"cells", "elements x 4, node numbers from 0"},
    {"gauss", "integration points x 2, reference"},
    {"points", "numbers of the integration points"},
    {"packing", "number of the packing of each point, in the order of `run.json`"},
    {"sets", "group with the node numbers of each set"},
    {0}};

static const gh_term node_datasets[] = {
    {"time", "load steps completed"},
    {"displacement", "nodes x 3"},
    {"reaction", "nodes x 3, force of supports and footings"},
    {"von_mises", "nodes, $\\sqrt{3/2\\,s:s}$ with the deviator s of the plane; stress "
                  "extrapolated from the integration points"},
    {0}};

static const gh_term point_datasets[] = {
    {"F", "deformation gradient: 11 12 21 22"},
    {"P", "Piola stress: 11 12 21 22, first index the direction of the force"},
    {"cauchy", "Cauchy stress: 11 12 21 22"},
    {"acoustic", "smallest eigenvalue of N.A.N over all N; at or below 0 ellipticity is lost"},
    {"acoustic_angle", "angle of that N to x, radians"},
    {0}};

static const gh_term cell_datasets[] = {{"F", "mean over the points of the element, 3 x 3"},
                                        {"piola", "the same of P"},
                                        {"cauchy", "the same of the Cauchy stress"},
                                        {"von_mises", "of the mean stress"},
                                        {"acoustic", "smallest of the element"},
                                        {"acoustic_normal", "its direction N"},
                                        {0}};

static const gh_term rve_datasets[] = {{"positions", "grains x 2, replicas last"},
                                       {"radii", "radii"},
                                       {"ids", "ids in the packing"},
                                       {"types", "fractions"},
                                       {"flags", "sum of 1 rattler, 2 prescribed, 4 replica"},
                                       {"cell", "lattice vectors as columns, row by row"},
                                       {"low", "corner of the cell"},
                                       {"periodic", "1: periodic cell"},
                                       {"cauchy", "Cauchy stress"},
                                       {"contact_pairs", "contacts x 2, rows of `positions`"},
                                       {"contact_branch_force", "lx ly fx fy of each contact"},
                                       {"rotations", "with friction: rotations, radians"},
                                       {"contact_sliding", "with friction: 1 on the Coulomb limit"},
                                       {0}};

const gh_term_list *gh_scene_columns(void) {
  static const gh_term_list all[] = {
      {"history.csv", scene_history_head},
      {"history.csv: loads and reactions", scene_history_sets},
      {"history.csv: solution", scene_history_tail},
      {"history.csv with --estimate-error", scene_history_estimate},
      {"convergence.csv", scene_convergence_columns},
      {"timing.csv", scene_timing_columns},
      {"results.h5: /mesh", mesh_datasets},
      {"results.h5: /stepNNNN", node_datasets},
      {"results.h5: /stepNNNN/points", point_datasets},
      {"results.h5: /stepNNNN/points, one number each (their means are in cells)", scene_number_terms},
      {"results.h5: /stepNNNN/cells", cell_datasets},
      {"rves.h5: /rve/POINT", rve_datasets},
      {"dumps/point_N.dump", scene_grain_columns},
      {"dumps/point_N.dump with friction", scene_grain_friction},
      {"dumps/point_N.contacts.dump", scene_contact_columns},
      {"dumps/point_N.contacts.dump with friction", scene_contact_friction},
      {0}};
  return all;
}
