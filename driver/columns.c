/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Columns of the results of granhom rve and granhom element. */
#include "reference.h"

const gh_term columns_point[] = {
    {"step", "number of the row"},
    {"F11", "deformation gradient"},
    {"F12", ""},
    {"F21", ""},
    {"F22", ""},
    {"P11", "Piola stress: force per reference length, first index the direction of the "
            "force"},
    {"P12", ""},
    {"P21", ""},
    {"P22", ""},
    {"s11", "Cauchy stress: force per deformed length, compression negative"},
    {"s12", ""},
    {"s21", ""},
    {"s22", ""},
    {"energy", "stored energy per reference area"},
    {"contacts", "number of contacts"},
    {"rattlers", "number of floating grains"},
    {"residual", "largest unbalanced force over the mean normal contact force, in any substep"},
    {"seconds", "time of the evaluation"},
    {0}};

const gh_term columns_friction[] = {
    {"energy_t", "part of `energy` in tangential springs and hardening"},
    {"dissipation", "dissipated by friction since the start, per reference area"},
    {"sliding", "contacts on the Coulomb limit"},
    {0}};

const gh_term columns_frame[] = {
    {"couple",
     "moments of the supports of the frame per reference area; 0 but for `displacement` with friction"},
    {0}};

const gh_term columns_servo[] = {{"sweeps", "of servo-control"}, {0}};

const gh_term columns_ramp[] = {
    {"ramps", "ramps of the increment along which slip was integrated; 0: it counts from the last state"},
    {0}};

const gh_term columns_path[] = {
    {"events", "parts in which Newton's iteration followed the increment, where not at once, or could not"},
    {"newton", "equilibria that Newton's iteration found from the start, without relaxation: 1, or 0; more "
               "where the increment was cut"},
    {0}};

const gh_term columns_control[] = {
    {"load_step", "number of the step, repetitions counted; 0 the start"},
    {"volume", "det F"},
    {"pressure", "-(s11 + s22)/2"},
    {"iterations", "evaluations of the packing"},
    {"parts", "substeps of the increment"},
    {"cuts", "bisections of the increment"},
    {"jumps", "instabilities passed by servo control"},
    {"mismatch", "largest deviation from a prescribed stress over the largest stress"},
    {0}};

const gh_term columns_tangent[] = {{"step", "as in the results"},
                                   {"A1111 ... A2222",
                                    "$A_{iJkL} = \\partial P_{iJ}/\\partial F_{kL}$, 16 columns, last index "
                                    "fastest"},
                                   {0}};
