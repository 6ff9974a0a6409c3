/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom pack: grows packings from a sieve curve. */
#include "cli.h"
#include "pack_spec.h"

#include "granhom/limits.h"
#include "granhom/report.h"

#include <stdlib.h>
#include <string.h>

/* A pressure against the stiffness of the grains (granhom/limits.h). */
static gh_status check_goal(gh_context *ctx, const pack_spec *spec) {
  const gh_finish_options *f = &spec->soft;
  gh_rve_options o = gh_rve_defaults();
  bool warned = false;
  char what[64];
  if (!spec->finish || f->goal != GH_FINISH_PRESSURE) return GH_OK;
  o.law.normal_stiffness = f->normal_stiffness;
  snprintf(what, sizeof what, "the pressure, %g,", f->target);
  return gh_limits_check_stress(ctx, &o, "--finish", what, f->target, GH_STRESS_NORMAL, &warned);
}

/* Growth takes long: what would fail at its end is tried before. */
static gh_status check_member(gh_context *ctx, const pack_spec *spec, const char *path, const char *picture) {
  const gh_output outputs[] = {{path, GH_FILE_PACKING}, {picture, GH_FILE_PICTURE}};
  return cli_check_outputs(ctx, outputs, 2, (const char *const[]){spec->sieve, spec->file}, 2);
}

static gh_status check_files(gh_context *ctx, const pack_spec *spec) {
  const char *dot = spec->picture ? strrchr(spec->picture, '.') : NULL;
  if (spec->picture && !(dot && (!strcmp(dot, ".svg") || !strcmp(dot, ".png"))))
    return gh_fail(ctx, GH_INPUT, "--picture: '%s' ends neither in .svg nor in .png", spec->picture);
  gh_status status = spec->ensemble ? GH_OK : check_member(ctx, spec, spec->output, spec->picture);
  for (int k = 1; k <= spec->ensemble && status == GH_OK; k++) {
    char *path = gh_ensemble_path(spec->output, k);
    char *picture = spec->picture ? gh_ensemble_path(spec->picture, k) : NULL;
    status = path && (picture || !spec->picture) ? check_member(ctx, spec, path, picture)
                                                 : gh_fail(ctx, GH_MEMORY, "no memory for a path");
    free(path);
    free(picture);
  }
  return status;
}

/* ---- results ---- */

static void print_growth(const pack_spec *spec, const gh_grains *grains, const gh_grow_result *r,
                         unsigned long long seed) {
  printf("grains                 %d %s, seed %llu\n", grains->n, grains->dim == 2 ? "disks" : "spheres",
         seed);
  printf("volume fraction        %.6f: %s\n", r->volume_fraction, gh_grow_stop_text(r->stop));
  printf("growth rate            %g of the grains' speed, %s\n", spec->grow.rate,
         spec->grow.collision == GH_COLLISION_EXCHANGE ? "velocities after (3.9)" : "momentum conserved");
  printf("collisions             %.0f in %.2f s, %.3g per second\n", r->collisions, r->seconds, r->rate);
  printf("other events           %.0f lists, %.0f checks\n", r->transfers, r->checks);
}

static void print_hull(const gh_hull *h, const gh_packing *p) {
  printf("boundary grains        %d of %d, ", h->boundary, p->n);
  if (isinf(h->gap)) printf("not full: the hull has a hole\n");
  else
    printf("%s: widest gap %.4g between grains %d and %d, smallest diameter %.4g\n",
           h->full ? "full" : "not full", h->gap, h->id[0], h->id[1], h->smallest);
}

static gh_status print_soft(gh_context *ctx, const gh_finish_report *report) {
  gh_text *text;
  GH_TRY(gh_text_create(ctx, &text));
  gh_finish_print(report, text);
  return cli_print_last(ctx, &text);
}

/* What growth made in the plane, soft where that is asked for, as a packing. */
static gh_status plane(gh_context *ctx, const pack_spec *spec, const gh_grains *grains, const char *path,
                       const char *picture) {
  gh_packing *p;
  gh_hull hull;
  GH_TRY(gh_grains_packing(ctx, grains, &p));
  gh_status status = GH_OK;
  if (spec->finish) {
    gh_packing *soft = NULL;
    gh_finish_report report;
    GH_TRY_OR(gh_finish(ctx, p, &spec->soft, &soft, &report), done);
    gh_packing_destroy(&p);
    p = soft;
    if (!spec->quiet) GH_TRY_OR(print_soft(ctx, &report), done);
  }
  GH_TRY_OR(gh_hull_find(ctx, p, &hull), done);
  if (!spec->quiet) print_hull(&hull, p);
  GH_TRY_OR(gh_packing_write(ctx, p, path, NULL, NULL), done);
  if (picture) status = gh_picture_packing(ctx, p, picture);
done:
  gh_packing_destroy(&p);
  return status;
}

static gh_status deliver(gh_context *ctx, const pack_spec *spec, const gh_grains *grains, const char *path,
                         const char *picture) {
  if (grains->dim == 2) return plane(ctx, spec, grains, path, picture);
  GH_TRY(gh_grains_write(ctx, grains, path));
  return picture ? gh_picture_grains(ctx, grains, picture) : GH_OK;
}

/* ---- growth ---- */

typedef struct ingredients {
  int n, *type;
  double *diameter;
} ingredients;

static gh_status one(gh_context *ctx, const pack_spec *spec, const ingredients *from, unsigned long long seed,
                     const char *path, const char *picture) {
  gh_grow_options o = spec->grow;
  gh_grow_result r;
  gh_grains *grains;
  o.seed = seed;
  GH_TRY(gh_packing_grow(ctx, spec->dim, from->n, from->diameter, from->type, &o, &grains, &r));
  if (!spec->quiet) print_growth(spec, grains, &r, seed);
  gh_status status = deliver(ctx, spec, grains, path, picture);
  gh_grains_destroy(&grains);
  if (status != GH_OK) return status;
  if (!spec->quiet) {
    printf("written                %s\n", path);
    fflush(stdout);
  }
  if (o.volume_fraction > 0 && r.stop != GH_STOP_FRACTION)
    return gh_fail(ctx, GH_DIVERGED, "the volume fraction %g was not reached: %s at %.6f", o.volume_fraction,
                   gh_grow_stop_text(r.stop), r.volume_fraction);
  return GH_OK;
}

static gh_status member(gh_context *ctx, const pack_spec *spec, const ingredients *from, int k) {
  char *path = gh_ensemble_path(spec->output, k);
  char *picture = spec->picture ? gh_ensemble_path(spec->picture, k) : NULL;
  gh_status status = path && (picture || !spec->picture)
                         ? one(ctx, spec, from, spec->grow.seed + (unsigned)k - 1, path, picture)
                         : gh_fail(ctx, GH_MEMORY, "no memory for a path");
  free(path);
  free(picture);
  return status;
}

static gh_status all(gh_context *ctx, const pack_spec *spec, const ingredients *from) {
  if (!spec->ensemble) return one(ctx, spec, from, spec->grow.seed, spec->output, spec->picture);
  for (int k = 1; k <= spec->ensemble; k++) GH_TRY(cli_end_of_rows(member(ctx, spec, from, k), k - 1));
  return GH_OK;
}

static gh_status prepare(gh_context *ctx, const pack_spec *spec, ingredients *from) {
  gh_sieve *sieve;
  int *count;
  GH_TRY(gh_sieve_read(ctx, spec->sieve, &sieve));
  gh_status status = gh_alloc(ctx, (size_t)sieve->n, sizeof *count, &count);
  if (status == GH_OK) status = gh_sieve_counts(ctx, sieve, spec->dim, spec->count, count);
  if (status == GH_INPUT) gh_prefix(ctx, status, "%s: ", spec->sieve);
  if (status == GH_OK) status = gh_sieve_grains(ctx, sieve, count, &from->n, &from->diameter, &from->type);
  free(count);
  gh_sieve_destroy(&sieve);
  return status;
}

static void arguments_default(void *data) {
  pack_spec_init(data);
}

static void arguments_release(void *data) {
  pack_spec_free(data);
}

static gh_status file_read(gh_context *ctx, void *data) {
  pack_spec *spec = data;
  return spec->file ? pack_spec_read(ctx, spec->file, spec) : GH_OK;
}

static gh_status arguments_check(gh_context *ctx, void *data) {
  return pack_spec_complete(ctx, data);
}

static gh_status pack_work(gh_context *ctx, void *data) {
  pack_spec *spec = data;
  ingredients from = {0};
  if (spec->quiet) cli_quiet(ctx);
  GH_TRY(check_goal(ctx, spec));
  GH_TRY(check_files(ctx, spec));
  if (spec->finish) GH_TRY(cli_mpi(ctx, true));
  gh_status status = prepare(ctx, spec, &from);
  if (status == GH_OK) status = all(ctx, spec, &from);
  free(from.diameter);
  free(from.type);
  return status;
}

const cli_command cli_pack = {
    .name = "pack",
    .summary = "grows a packing of grains from a sieve curve",
    .usage = "usage: granhom pack SPEC.yaml -o PACKING.data [options]\n"
             "       granhom pack --sieve SIEVE.csv [--count N] [--dimension 2|3] [--seed S] -o PACKING.data "
             "[options]\n",
    .about =
        "Grows the grains of a sieve curve in a periodic cell until they jam (event-driven, Lubachevsky and "
        "Stillinger) and writes a LAMMPS data file; types are the fractions, from the finest. SPEC.yaml "
        "holds "
        "options as keys (volume_fraction: 0.8); options on the command line override it.\n",
    .notes = "Exit status: 0 done, 1 growth or equilibrium failed, 2 wrong input.\n",
    .options = (const option_group[]){{pack_spec_rows, 0},
                                      {pack_growth_rows, 0},
                                      {pack_soft_rows, 0},
                                      {cli_screen_rows, offsetof(pack_spec, quiet)},
                                      {0}},
    .noun = "specification",
    .operand = offsetof(pack_spec, file),
    .size = sizeof(pack_spec),
    .defaults = arguments_default,
    .prepare = file_read,
    .check = arguments_check,
    .work = pack_work,
    .release = arguments_release};
