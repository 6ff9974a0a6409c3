/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Which build of granhom this is. */
#include "granhom/base.h"

#include "sources.h" /* made by the Makefile */

#ifndef GH_BUILD_FLAGS
#define GH_BUILD_FLAGS "unknown"
#endif

const char *gh_build(void) {
  return GH_SOURCES " " GH_BUILD_FLAGS;
}
