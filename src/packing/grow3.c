/* SPDX-License-Identifier: GPL-2.0-or-later */
/* grow.c in three dimensions. */
#include "packing/to3.h"
/* the source below defines the functions with the names of to3.h */
#include "packing/grow.c"
