/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The columns and datasets of a scene's own results, and what they mean; docs/reference/columns.md is made of
 * these lists and of gh_results_columns. */
#include "scene/output.h"

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
    {"iterations", "iterations of Newton, and steps of relaxation"},
    {"substeps", "substeps in which the increment was solved"},
    {"cuts", "bisections of the increment"},
    {"jumps", "instabilities that were stepped over"},
    {"unjammed", "integration points without stress"},
    {"min_acoustic", "smallest eigenvalue of the acoustic tensors of all points, stress; `nan` "
                     "with `method: relaxation`"},
    {"residual", "residual over external forces and reactions"},
    {"micro_evaluations", "evaluations of integration points"},
    {"micro_steps", "their relaxation steps"},
    {"micro_factorisations", "their factorisations"},
    {"inner_work", "work of the stresses since the start"},
    {"outer_work", "work of the external forces and reactions since the start"},
    {"energy", "change of the stored energy since the start"},
    {"dissipation", "dissipated by friction since the start"},
    {"energy_defect", "energy imbalance, relative: work of the stresses less what is stored and dissipated"},
    {"coordination", "contacts of a grain that is no rattler, mean over the integration points"},
    {"anisotropy", "of the fabric, mean over the integration points"},
    {0}};

const gh_term scene_history_relaxation[] = {{"relaxed", "steps of relaxation among the iterations"}, {0}};

const gh_term scene_history_estimate[] = {
    {"estimate", "estimated error of the Piola stress, root mean square, relative"},
    {"estimate_largest", "the same at the point where it is largest"},
    {"estimate_displacement", "of the displacements, relative"},
    {"estimate_force", "of the force on the set that is driven last (or of all reactions), relative"},
    {"estimate_growth", "growth of the difference of the stresses in this increment, relative"},
    {"branched", "1: the two paths have separated in this increment, which is left out of the estimate"},
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

const gh_term_list *gh_scene_columns(void) {
  static const gh_term_list all[] = {
      {"history.csv: loads and reactions", scene_history_sets},
      {"history.csv: solution", scene_history_tail},
      {"history.csv with solver.method relaxation or automatic", scene_history_relaxation},
      {"history.csv with --estimate-error", scene_history_estimate},
      {"results.h5: /stepNNNN", node_datasets},
      {"results.h5: /stepNNNN/points", point_datasets},
      {"results.h5: /stepNNNN/points, one number each (their means are in cells)", scene_number_terms},
      {"results.h5: /stepNNNN/cells", cell_datasets},
      {0}};
  return all;
}
