/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The keys of a study file, and what they mean; docs/reference/keys.md is made of these lists. */
#include "study/parts.h"

const gh_term study_keys[] = {
    {"title", "for tables and pictures; default: the name of the file"},
    {"units", "labels, as in a scene; a scene has its own"},
    {"scene", "scene file, relative to the study: one of `scene` and `rve` is required"},
    {"rve", "one packing along a path, below"},
    {"base", "map of keys with a value for all runs"},
    {"vary", "required. Map of parameters: keys with lists of values; all combinations are run"},
    {"reference", "required. What results are compared with, below"},
    {"quantities",
     "list of what is compared: `stress`, `energy` of a path; `stress`, `force` or `displacement`, "
     "`dilatancy` of a scene. The first one ranks. Default: all"},
    {"goals", "relative errors for which the cheapest run is named; default [1e-2, 1e-3, 1e-6]"},
    {"order", "parameter with numbers above 0 whose order of convergence is computed"},
    {"series", "parameter whose values are the points of a curve; default: the first"},
    {"plots", "list of columns to draw over t"},
    {"quick", "smaller study for `--quick`, below"},
    {0}};

const gh_term study_units_keys[] = {{"length", "as in a scene"}, {"force", "as in a scene"}, {0}};

const gh_term study_rve_keys[] = {{"packing", "required. File, or a pattern of file names: an ensemble"},
                                  {"contact", "required. As in a scene"},
                                  {"micro", "as in a scene; `engine` may also be `gran` or `liggghts`"},
                                  {"path", "required. Path of deformation gradients, below"},
                                  {0}};

const gh_term study_path_keys[] = {{"legs", "list of straight segments, from F = I"},
                                   {"file", "CSV file with the columns F11 F12 F21 F22"},
                                   {0}};

const gh_term study_leg_keys[] = {{"to", "required. `[F11, F12, F21, F22]` at the end"},
                                  {"increments", "required. Number of increments"},
                                  {0}};

const gh_term study_reference_keys[] = {
    {"set", "map of keys: the same run with these values"},
    {"file", "CSV file with `t` and the columns of the quantities"},
    {"closed_form", "`triangular-lattice`: equal frictionless disks on a lattice that follows F"},
    {0}};

const gh_term study_quick_keys[] = {
    {"vary", "replaces `vary`"}, {"base", "is added to `base`"}, {"reference", "replaces `reference`"}, {0}};

const gh_term_list *gh_study_keys(void) {
  static const gh_term_list all[] = {{"study file", study_keys},
                                     {"rve", study_rve_keys},
                                     {"rve.path", study_path_keys},
                                     {"rve.path.legs", study_leg_keys},
                                     {"reference", study_reference_keys},
                                     {"quick", study_quick_keys},
                                     {0}};
  return all;
}
