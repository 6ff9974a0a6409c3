/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: pictures and reports of folders of results, pictures of packings. */
#ifndef GRANHOM_REPORT_H
#define GRANHOM_REPORT_H

#include "granhom/io.h"
#include "granhom/packing.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- pictures of a folder of results, PNG ---- */

/* GH_INPUT with the file and the reason: no results, a file that is cut off, damaged or of another program,
 * files that do not belong together (fewer increments than run.json has counted). A run that is under way is
 * whole up to its last complete increment. */
GH_API gh_status gh_results_check(gh_context *ctx, const char *folder);
/* Pictures. png NULL: all that a picture needs is read and laid out, and nothing is written, so that what
 * cannot be drawn is refused before the first picture is. */

/* Deformed mesh at the last increment over the outline of the undeformed one, coloured by the von Mises
 * stress. */
GH_API gh_status gh_picture_mesh(gh_context *ctx, const char *folder, const char *png);
/* Grains of one material point, the cell's frame and the network of forces. point -1: the one with the
 * largest von Mises stress among those recorded. */
GH_API gh_status gh_picture_rve(gh_context *ctx, const char *folder, int point, const char *png);
/* Force and dilatancy over the driven displacement (or over the load steps when nothing is driven). Needs
 * gnuplot. */
GH_API gh_status gh_picture_curves(gh_context *ctx, const char *folder, const char *png);
/* Residuals over the iterations of the last increments. Needs gnuplot. */
GH_API gh_status gh_picture_convergence(gh_context *ctx, const char *folder, const char *png);
/* A drawing of the caller's own: commands of gnuplot, after a preamble that sets the terminal and the looks
 * of the others. Needs gnuplot. Texts that are not the program's own (titles, names, units) are printed into
 * the commands by gh_picture_string; commands with '!', '`', '@' or `system` in them are refused. */
GH_API gh_status gh_picture_script(gh_context *ctx, const char *commands, int width, int height,
                                   const char *png);
/* Any text as a string of gnuplot: escaped byte by byte, so that nothing in it is a command. Control
 * characters become '?'. Use it with `noenhanced`. */
GH_API void gh_picture_string(gh_text *out, const char *text);

/* ---- a run beside others of the same scene ---- */

/* What history.csv of `folder` holds, beside the mean of that of `others`: direct simulations, or runs with
 * other meshes, packings or conditions. The rows are the increments of `folder` up to the load step that all
 * have reached; the others are interpolated linearly over the load steps. A reaction's gap is the difference to
 * the mean of the others in per cent of the largest reaction (of the mean, over all sets and increments); that
 * of the dilatancy, of the coordination number, of the anisotropy and of a footing's displacement is the
 * difference itself. The scatter is the standard deviation of the others (with n - 1), from two on. */
typedef struct gh_comparison gh_comparison;
enum { GH_COMPARED_MOST = 32 };
/* GH_INPUT: no folder of results, no or too many others, another driven set or another displacement of it at
 * the end of a load step, no column or no increment in common, no reaction that is not zero. */
GH_API gh_status gh_comparison_create(gh_context *ctx, const char *folder, const char *const *others,
                                      int nothers, gh_comparison **comparison);
GH_API void gh_comparison_destroy(gh_comparison **comparison);
/* As a table for people: mean and largest gap of each quantity, and where that is. */
GH_API void gh_comparison_print(const gh_comparison *comparison, gh_text *out);
/* As CSV: a row per increment. */
GH_API void gh_comparison_table(const gh_comparison *comparison, gh_text *out);
/* Its columns. */
GH_API const gh_term_list *gh_comparison_columns(void);
/* Curves as PNG, by gnuplot; png NULL: nothing is written. */
GH_API gh_status gh_comparison_picture(const gh_comparison *comparison, const char *png);

/* ---- a report ---- */

/* One self-contained HTML page about a folder of results: outcome, curves, fields on the mesh, packings of
 * npoints integration points (at most 12; npoints 0: the largest von Mises stress, the smallest acoustic
 * eigenvalue and the first, of the points whose grains are recorded), residuals, times; with `comparison`
 * (NULL: without) the run beside others. GH_INPUT: no results, damaged files, a point that does not exist;
 * nothing is written then. */
GH_API gh_status gh_report_write(gh_context *ctx, const char *folder, const int *points, int npoints,
                                 const gh_comparison *comparison, const char *html);

/* ---- pictures of packings ---- */

/* Primary, boundary and replica grains of a packing in three tones (Figures 3.3 and 3.12), the cell as a
 * frame. The name's ending chooses: .svg or .png; GH_INPUT: another one. */
GH_API gh_status gh_picture_packing(gh_context *ctx, const gh_packing *packing, const char *path);
/* The same for what growth makes. Spheres are seen from the front, right and above, without replicas. */
GH_API gh_status gh_picture_grains(gh_context *ctx, const gh_grains *grains, const char *path);

#ifdef __cplusplus
}
#endif
#endif
