/* SPDX-License-Identifier: GPL-2.0-or-later */
/* What granhom knows of its own files: keys, columns, conditions. */
#ifndef GRANHOM_REFERENCE_H
#define GRANHOM_REFERENCE_H

#include "granhom/io.h"

/* columns.c: of granhom rve and element; with friction; of element alone; of --tangent. */
extern const gh_term columns_point[], columns_friction[], columns_frame[], columns_servo[], columns_ramp[],
    columns_path[], columns_control[], columns_tangent[];
/* element_spec.c: keys of a control file. */
extern const gh_term element_keys[], element_step_keys[], element_way_keys[], element_repeat_keys[];

/* granhom help keys|columns [FILE]: tables in Markdown, of which docs/reference is made. The exit status, or
 * -1 where `topic` is none of these. */
int reference_help(const char *topic, const char *file);

#endif
