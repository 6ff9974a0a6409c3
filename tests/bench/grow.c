/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Events per second while packings grow: equal grains, quartz sand, concrete, 2D and 3D.
 *
 *   grow [LARGEST [PART]]     number of grains up to LARGEST (default 100000); PART of the volume fraction
 *
 * Each packing grows from points to a volume fraction short of jamming; all of that is in the time, which is
 * the processor's. Leaves and checks are the other events of the queue, new lists and predictions that are
 * rebuilt, per collision: collisions compare the same work only where these agree. The last columns are the
 * time per collision and per event over log2 of the number of grains: the latter must not rise with that
 * number. */
#include "granhom/packing.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

static const struct sand {
  const char *name;
  int n;
  double diameter[6], count[6], fraction[2];
} sands[] = {{"equal", 1, {1}, {1000}, {0.80, 0.60}},
             {"quartz", 6, {.25, .16, .125, .1, .063, .05}, {6, 242, 441, 149, 145, 17}, {0.80, 0.61}},
             {"concrete", 5, {16, 8, 4, 2, 1}, {8, 21, 53, 127, 791}, {0.88, 0.63}}};

static gh_status grow(gh_context *ctx, const struct sand *sand, int dim, int n, double part,
                      gh_grow_result *r) {
  gh_sieve *sieve;
  double *diameter = NULL;
  int count[6], *type = NULL;
  gh_grains *grains = NULL;
  GH_TRY(gh_sieve_create(ctx, GH_SIEVE_COUNT, sand->n, sand->diameter, sand->count, &sieve));
  gh_status status = gh_sieve_counts(ctx, sieve, dim, n, count);
  if (status == GH_OK) status = gh_sieve_grains(ctx, sieve, count, &n, &diameter, &type);
  gh_grow_options o = gh_grow_defaults(dim);
  o.rate = 0.02;
  o.volume_fraction = part * sand->fraction[dim - 2];
  if (status == GH_OK) status = gh_packing_grow(ctx, dim, n, diameter, type, &o, &grains, r);
  gh_grains_destroy(&grains);
  gh_sieve_destroy(&sieve);
  free(diameter);
  free(type);
  return status;
}

int main(int argc, char **argv) {
  gh_context *ctx;
  double largest = argc > 1 ? atof(argv[1]) : 1e5, part = argc > 2 ? atof(argv[2]) : 1;
  if (gh_context_create(&ctx) != GH_OK) return 1;
  printf("%-9s %3s %7s %9s %11s %7s %7s %8s %10s %18s\n", "grains", "dim", "number", "fraction", "collisions",
         "leaves", "checks", "seconds", "per second", "ns over log2 n, of");
  printf("%77s %10s %10s\n", "", "collision", "event");
  for (size_t s = 0; s < sizeof sands / sizeof *sands; s++)
    for (int dim = 2; dim <= 3; dim++)
      for (int n = 1000; n <= largest; n *= 10) {
        gh_grow_result r;
        clock_t begin = clock();
        if (grow(ctx, &sands[s], dim, n, part, &r) != GH_OK) {
          fprintf(stderr, "%s\n", gh_message(ctx));
          return 1;
        }
        double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC, rate = r.collisions / seconds;
        double events = r.collisions + r.transfers + r.checks;
        printf("%-9s %3d %7d %9.4f %11.0f %7.2f %7.2f %8.2f %10.3g %10.1f %10.1f\n", sands[s].name, dim, n,
               r.volume_fraction, r.collisions, r.transfers / r.collisions, r.checks / r.collisions, seconds,
               rate, 1e9 / rate / log2(n), 1e9 * seconds / events / log2(n));
        fflush(stdout);
      }
  gh_context_destroy(&ctx);
  return 0;
}
