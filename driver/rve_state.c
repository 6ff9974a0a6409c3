/* SPDX-License-Identifier: GPL-2.0-or-later */
/* States of one material point in HDF5 files.
 *
 * boundary          word
 * law               7: normal stiffness, friction or not, tangential stiffness, friction coefficient,
 *                   hardening, measure of slip and twice the law of hardening, rotations fixed or not
 * state             what gh_rve_save gives
 * packing/cell      2 x 2;   packing/radius   grains;   packing/x   grains x 2;   blas   word
 *
 * A state is numbers without a meaning of their own: loaded into another packing it would be a wrong answer
 * that looks right. Therefore the packing goes along, and is compared to the last bit. */
#include "rve_state.h"

#include "granhom/io.h"

#include <stdlib.h>
#include <string.h>

#define KIND "state 2"

enum { SLIP = 5, HARDENING_LAW = 7, LAW = 8, STORED = 7 };

/* Without friction the other parameters mean nothing. */
static void law_numbers(const gh_contact_law *law, double out[LAW]) {
  memset(out, 0, LAW * sizeof *out);
  out[0] = law->normal_stiffness;
  if (!law->friction) return;
  out[1] = 1;
  out[2] = law->tangential_stiffness;
  out[3] = law->friction_coefficient;
  out[4] = law->hardening;
  out[SLIP] = law->slip;
  out[6] = law->fixed_rotations != 0;
  out[HARDENING_LAW] = law->hardening_law;
}

static gh_status put(gh_context *ctx, gh_h5 *file, const gh_rve *rve, const gh_rve_options *o,
                     const gh_packing *p, double *state) {
  double law[LAW];
  gh_rve_save(rve, state);
  law_numbers(&o->law, law);
  law[SLIP] += 2 * law[HARDENING_LAW];
  char blas[GH_BLAS_SIZE];
  GH_TRY(gh_blas(ctx, blas, sizeof blas));
  char boundary[GH_MIXED_TEXT];
  gh_boundary_text(o, boundary);
  GH_TRY(gh_h5_put_text(file, "boundary", boundary));
  GH_TRY(gh_h5_put_text(file, "blas", blas));
  GH_TRY(gh_h5_put_doubles(file, "law", STORED, 1, law));
  GH_TRY(gh_h5_put_doubles(file, "packing/cell", 2, 2, p->cell));
  GH_TRY(gh_h5_put_doubles(file, "packing/radius", (size_t)p->n, 1, p->radius));
  GH_TRY(gh_h5_put_doubles(file, "packing/x", (size_t)p->n, 2, p->x));
  return gh_h5_put_doubles(file, "state", gh_rve_state_size(rve), 1, state);
}

gh_status rve_state_save(gh_context *ctx, const char *path, const gh_rve *rve, const gh_rve_options *options,
                         const gh_packing *packing) {
  gh_h5 *file;
  double *state;
  GH_TRY(gh_alloc(ctx, gh_rve_state_size(rve), sizeof *state, &state));
  gh_status status = gh_h5_open(ctx, path, KIND, false, &file);
  if (status == GH_OK) {
    status = put(ctx, file, rve, options, packing, state);
    if (status == GH_OK) status = gh_h5_commit(&file);
    else gh_h5_close(&file);
  }
  free(state);
  return status;
}

static gh_status check_boundary(gh_context *ctx, const char *path, gh_h5 *file, const gh_rve_options *o) {
  char word[GH_MIXED_TEXT], now[GH_MIXED_TEXT];
  gh_boundary_text(o, now);
  GH_TRY(gh_h5_get_text(file, "boundary", sizeof word, word));
  if (!strcmp(word, now)) return GH_OK;
  return gh_fail(ctx, GH_INPUT, "%s: the state was saved with --boundary %s, and now it is %s", path, word,
                 now);
}

/* States of an earlier version of granhom do not name it. */
static gh_status check_blas(gh_context *ctx, const char *path, gh_h5 *file) {
  char there[GH_BLAS_SIZE] = "", here[GH_BLAS_SIZE];
  GH_TRY(gh_blas(ctx, here, sizeof here));
  if (gh_h5_get_text(file, "blas", sizeof there, there) != GH_OK || strcmp(there, here) == 0) return GH_OK;
  gh_log(ctx, GH_LEVEL_WARNING,
         "%s: the state was saved with the BLAS %s, and now it is %s: results agree to round-off, not to the "
         "bit",
         path, there, here);
  return GH_OK;
}

static gh_status check_law(gh_context *ctx, const char *path, gh_h5 *file, const gh_contact_law *law) {
  static const char *const names[LAW] = {"normal stiffness",
                                         "friction (1) or none (0)",
                                         "tangential stiffness",
                                         "friction coefficient",
                                         "hardening",
                                         "measure of slip (0 projected, 1 objective)",
                                         "rotations fixed (1) or free (0)",
                                         "law of hardening (0 printed, 1 proportional)"};
  double there[LAW], here[LAW];
  law_numbers(law, here);
  GH_TRY(gh_h5_get_doubles(file, "law", STORED, 1, there));
  there[HARDENING_LAW] = floor(there[SLIP] / 2);
  there[SLIP] -= 2 * there[HARDENING_LAW];
  for (int k = 0; k < LAW; k++)
    if (there[k] != here[k])
      return gh_fail(ctx, GH_INPUT,
                     "%s: the state was saved with another contact law: %s was %.10g, now it is %.10g", path,
                     names[k], there[k], here[k]);
  return GH_OK;
}

static gh_status check_packing(gh_context *ctx, const char *path, gh_h5 *file, const gh_packing *p,
                               double *memory) {
  size_t n = (size_t)p->n, rows, cols;
  double *cell = memory, *radius = memory + 4, *x = radius + n;
  GH_TRY(gh_h5_size(file, "packing/radius", &rows, &cols));
  if (rows != n)
    return gh_fail(ctx, GH_INPUT, "%s: the state belongs to a packing of %zu grains, and this one has %d",
                   path, rows, p->n);
  GH_TRY(gh_h5_get_doubles(file, "packing/cell", 2, 2, cell));
  GH_TRY(gh_h5_get_doubles(file, "packing/radius", n, 1, radius));
  GH_TRY(gh_h5_get_doubles(file, "packing/x", n, 2, x));
  if (memcmp(cell, p->cell, sizeof p->cell) != 0)
    return gh_fail(ctx, GH_INPUT, "%s: the state belongs to another packing, with the cell [%g %g; %g %g]",
                   path, cell[0], cell[1], cell[2], cell[3]);
  for (size_t i = 0; i < n; i++)
    if (radius[i] != p->radius[i] || x[2 * i] != p->x[2 * i] || x[2 * i + 1] != p->x[2 * i + 1])
      return gh_fail(
          ctx, GH_INPUT,
          "%s: the state belongs to another packing: there grain %d has the radius %.10g and is at (%.10g, "
          "%.10g), here it has %.10g and is at (%.10g, %.10g)",
          path, p->id[i], radius[i], x[2 * i], x[2 * i + 1], p->radius[i], p->x[2 * i], p->x[2 * i + 1]);
  return GH_OK;
}

static gh_status read_state(gh_context *ctx, gh_h5 *file, gh_rve *rve) {
  size_t rows, cols;
  double *state;
  GH_TRY(gh_h5_size(file, "state", &rows, &cols));
  GH_TRY(gh_alloc(ctx, rows * cols + 1, sizeof *state, &state));
  gh_status status = gh_h5_get_doubles(file, "state", rows, cols, state);
  if (status == GH_OK) status = gh_rve_load(rve, state, rows * cols);
  free(state);
  return status;
}

gh_status rve_state_load(gh_context *ctx, const char *path, gh_rve *rve, const gh_rve_options *options,
                         const gh_packing *packing) {
  gh_h5 *file;
  double *memory = NULL;
  gh_status status;
  GH_TRY(gh_file_expect(ctx, gh_h5_read(ctx, path, KIND, NULL, &file), path, GH_FILE_STATE));
  GH_TRY_OR(gh_alloc(ctx, 4 + 3 * (size_t)packing->n, sizeof *memory, &memory), done);
  GH_TRY_OR(check_boundary(ctx, path, file, options), done);
  GH_TRY_OR(check_packing(ctx, path, file, packing, memory), done);
  GH_TRY_OR(check_law(ctx, path, file, &options->law), done);
  GH_TRY_OR(check_blas(ctx, path, file), done);
  GH_TRY_OR(read_state(ctx, file, rve), done);
done:
  if (status != GH_OK && strncmp(gh_message(ctx), path, strlen(path)) != 0)
    gh_prefix(ctx, status, "%s: ", path);
  free(memory);
  gh_h5_close(&file);
  return status;
}
