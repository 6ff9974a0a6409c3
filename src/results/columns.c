/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The columns and datasets that are the same for each solver, and what they mean; docs/reference/columns.md
 * is made of these lists and of those of the solvers. */
#include "results/results.h"

const gh_term results_timing_columns[] = {{"step", "as in `history.csv`"},
                                          {"seconds", "time of the increment"},
                                          {"micro_seconds", "of these in packings"},
                                          {"evaluations", "evaluations of integration points"},
                                          {"computed", "of these computed; the others share a result"},
                                          {"moved", "states moved between ranks"},
                                          {"ranks", "number of ranks"},
                                          {0}};

const gh_term results_convergence_columns[] = {
    {"step", "as in `history.csv`"},
    {"substep", "substep of the increment"},
    {"iteration", "iteration of Newton, or step of relaxation, from 0"},
    {"residual", "norm of the unbalanced forces"},
    {"relative", "over external forces and reactions"},
    {"first", "over the residual at the start of the attempt"},
    {"step_length", "of the line search; of relaxation: time step "
                    "over the critical one"},
    {"kinetic", "of relaxation: kinetic energy over internal work; "
                "0 with Newton"},
    {"seconds", "since the start of the increment"},
    {0}};

const gh_term results_grain_columns[] = {
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

const gh_term results_grain_friction[] = {{"theta", "rotation, radians"}, {0}};

const gh_term results_grain_frame[] = {
    {"frame", "1: on the frame"},
    {"ax", "force of the support on it; copies that are no grains here included"},
    {"ay", ""},
    {"moment", "moment of the support on it"},
    {0}};

const gh_term results_contact_columns[] = {
    {"index", "number"},
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

const gh_term results_contact_friction[] = {{"sliding", "1: on the Coulomb limit"},
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

const gh_term results_history_columns[] = {
    {"step", "number of the increment over the whole run; 0 is the start"},
    {"increment", "number within the load step"},
    {"name", "name of the load step"},
    {"load_step", "number of the load step; 0 is the start"},
    {"time", "load steps completed"},
    {0}};

const gh_term_list *gh_results_columns(void) {
  static const gh_term_list all[] = {{"history.csv", results_history_columns},
                                     {"convergence.csv", results_convergence_columns},
                                     {"timing.csv", results_timing_columns},
                                     {"results.h5: /mesh", mesh_datasets},
                                     {"rves.h5: /rve/POINT", rve_datasets},
                                     {"dumps/point_N.dump", results_grain_columns},
                                     {"dumps/point_N.dump with friction", results_grain_friction},
                                     {"dumps/point_N.dump on a frame", results_grain_frame},
                                     {"dumps/point_N.contacts.dump", results_contact_columns},
                                     {"dumps/point_N.contacts.dump with friction", results_contact_friction},
                                     {0}};
  return all;
}
