/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Forces of a relaxation under supports, external loads and the constraints of a frame. */
#include "engine/relax/relax_frame.h"

#include "contact/frame.h"

#include <stdlib.h>
#include <string.h>

static gh_status array_copy(gh_context *ctx, const void *from, size_t count, size_t size, void *to) {
  void **copy = to;
  if (!from) return GH_OK;
  GH_TRY(gh_alloc(ctx, count, size, copy));
  memcpy(*copy, from, count * size);
  return GH_OK;
}

gh_status gh_relax_frame_make(gh_context *ctx, const gh_engine_setup *setup, gh_relax_frame *frame) {
  const size_t n = (size_t)setup->n;
  GH_TRY(array_copy(ctx, setup->fixed, n, 1, &frame->fixed));
  GH_TRY(array_copy(ctx, setup->edges, n, 1, &frame->edges));
  GH_TRY(array_copy(ctx, setup->area, 2 * n, sizeof(double), &frame->area));
  double axes[4];
  if (frame->area) gh_frame_invert(setup->n, frame->area, frame->inverse, axes);
  return GH_OK;
}

void gh_relax_frame_free(gh_relax_frame *frame) {
  void *const arrays[] = {frame->fixed, frame->edges, frame->area, frame->force, frame->moment};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  *frame = (gh_relax_frame){0};
}

static gh_status load_copy(gh_context *ctx, const double *from, size_t count, double **to) {
  if (from && *to) memcpy(*to, from, count * sizeof **to);
  if (from) return *to ? GH_OK : array_copy(ctx, from, count, sizeof **to, to);
  free(*to);
  *to = NULL;
  return GH_OK;
}

gh_status gh_relax_frame_load(gh_context *ctx, int n, const double *force, const double *moment,
                              gh_relax_frame *frame) {
  GH_TRY(load_copy(ctx, force, 2 * (size_t)n, &frame->force));
  return load_copy(ctx, moment, (size_t)n, &frame->moment);
}

const gh_relax_frame *gh_relax_frame_used(const gh_relax_frame *f) {
  return f->fixed || f->edges || f->area || f->force || f->moment ? f : NULL;
}

void gh_frame_weigh(const gh_relax_frame *frame, size_t npairs, const int *i, const int *j, int count,
                    double *const *values) {
  if (!frame->edges) return;
  for (size_t p = 0; p < npairs; p++) {
    if (!(frame->edges[i[p]] & frame->edges[j[p]])) continue;
    const double share = gh_frame_share(frame->edges[i[p]], frame->edges[j[p]]);
    for (int k = 0; k < count; k++) values[k][p] *= share;
  }
}

void gh_frame_act(const gh_relax_frame *frame, int n, const double *radius, double *force, double *couple) {
  for (int i = 0; i < 2 * n && frame->force; i++) force[i] += frame->force[i];
  for (int i = 0; i < n && frame->moment && couple; i++) couple[i] -= frame->moment[i] / radius[i];
  if (frame->area) gh_frame_project(frame->area, frame->inverse, n, force);
  for (int i = 0; i < n && frame->fixed; i++) {
    if (frame->fixed[i] & GH_FIXED_X) force[2 * i] = 0;
    if (frame->fixed[i] & GH_FIXED_Y) force[2 * i + 1] = 0;
    if ((frame->fixed[i] & GH_FIXED_TURN) && couple) couple[i] = 0;
  }
}
