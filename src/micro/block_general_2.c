/* SPDX-License-Identifier: GPL-2.0-or-later */
#define BLOCK 2
#define STRIDE 2
#define SYMMETRIC 0
#include "micro/block_kernel.h"

const gh_block_kernel gh_block_general_2 = {.size = BLOCK,
                                            .stride = STRIDE,
                                            .symmetric = SYMMETRIC,
                                            .factor = block_factor,
                                            .solve = block_solve,
                                            .subtract = block_subtract};
