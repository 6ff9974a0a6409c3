/* SPDX-License-Identifier: GPL-2.0-or-later */
/* States of one material point in files. */
#ifndef GRANHOM_RVE_STATE_H
#define GRANHOM_RVE_STATE_H

#include "granhom/micro.h"

/* Writes the converged state of the RVE with what it belongs to: boundary condition and packing. */
gh_status rve_state_save(gh_context *ctx, const char *path, const gh_rve *rve, const gh_rve_options *options,
                         const gh_packing *packing);
/* Puts a state that was saved into the RVE. GH_INPUT: no such file, or the state of other boundary conditions
 * or of another packing. */
gh_status rve_state_load(gh_context *ctx, const char *path, gh_rve *rve, const gh_rve_options *options,
                         const gh_packing *packing);

#endif
