/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Compiles the sources of growth for three dimensions: included before them. */
#define DIM 3
#define gh_packing_grow2 gh_packing_grow3
#define growth_box_fit2 growth_box_fit3
#define growth_create2 growth_create3
#define growth_destroy2 growth_destroy3
#define growth_list2 growth_list3
#define growth_list_all2 growth_list_all3
#define growth_order2 growth_order3
#define growth_run2 growth_run3
#define growth_scale2 growth_scale3
#define growth_sync2 growth_sync3
