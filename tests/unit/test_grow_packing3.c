/* SPDX-License-Identifier: GPL-2.0-or-later */
/* test_grow_packing.c in three dimensions. */
#include "packing/to3.h"
/* the source below takes DIM and the names from to3.h */
#include "test_grow_packing.c"
