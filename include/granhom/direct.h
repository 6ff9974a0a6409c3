/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: direct simulation: the outline of a mesh filled with grains, under the loads of the mesh
 * (docs/explanation/method.md, "Direct simulation"). */
#ifndef GRANHOM_DIRECT_H
#define GRANHOM_DIRECT_H

#include "granhom/mesh.h"
#include "granhom/micro.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- grains for an outline ---- */

/* Copies of a periodic packing, scaled so that `grains` of them have the area of the mesh, cut by its outline:
 * grains whose centres lie inside, and so far beyond that those on the boundary are on the outline in the mean.
 * *body: ids 1 ... n; the cell is a box around it. GH_INPUT: the outline is too small for the grains. */
GH_API gh_status gh_direct_fill(gh_context *ctx, const gh_mesh *mesh, const gh_packing *packing,
                                double grains, gh_packing **body);
/* One periodic packing as large as the box around the mesh, with the diameters of `like`, grown with the seed
 * and brought to the pressure of like[0] with normal stiffness and tolerance of the options: for
 * gh_direct_fill. */
GH_API gh_status gh_direct_grow(gh_context *ctx, const gh_mesh *mesh, int npackings,
                                const gh_packing *const *like, const gh_rve_options *options, double grains,
                                unsigned long long seed, gh_packing **packing);
/* Bytes that a body of so many grains needs at most. */
GH_API double gh_direct_bytes(double grains);

/* ---- the body ---- */

typedef struct gh_direct gh_direct;

typedef struct gh_direct_options {
  gh_engine_kind engine;
  gh_contact_law law;
  double tolerance; /* of the residual: largest unbalanced force on a grain over the mean normal force */
  long max_steps;   /* relaxation steps of a substep */
  gh_relaxation relaxation;
  gh_integration integration;
  int cut_steps;            /* bisections of an increment */
  bool (*stop)(void *data); /* asked between relaxations; NULL: never */
  void *stop_data;
} gh_direct_options;

/* What acts at the end of an increment, by nodes and sets of the mesh. */
typedef struct gh_direct_loads {
  const bool *fixed;    /* 2 nnodes: prescribed components */
  const double *value;  /* 2 nnodes: displacement there */
  const double *dead;   /* nsets: pressure on the reference edges */
  const double *follow; /* nsets: on the current ones */
  const double *force;  /* nsets x 2: on the set as a whole */
  double gravity[2];    /* weight per reference area */
} gh_direct_loads;

typedef struct gh_direct_report {
  int substeps, cuts;
  long steps;      /* of relaxation */
  double residual; /* at the end */
  double seconds;
} gh_direct_report;

/* At the last equilibrium. */
typedef struct gh_direct_measures {
  double volume, current; /* area within the outline, reference and current */
  double residual, mean_force, coordination, fabric[3], anisotropy;
  int contacts, rattlers, sliding;
  double outer_work, energy, dissipation; /* since gh_direct_zero */
} gh_direct_measures;

/* The mesh must outlive the body; its first `nsets` sets are looked at. GH_INPUT: an edge of the outline has no
 * grains. */
GH_API gh_status gh_direct_create(gh_context *ctx, const gh_mesh *mesh, int nsets, const gh_packing *body,
                                  const gh_direct_options *options, gh_direct **direct);
GH_API void gh_direct_destroy(gh_direct **direct);
/* Holds the initial stress: what holds the boundary grains where they are acts on them from now on. Before the
 * first solve. */
GH_API gh_status gh_direct_balance(gh_direct *direct);
/* The equilibrium under `loads`, from the last one. GH_DIVERGED: bisections are spent; the state is that of the
 * last substep. GH_STOPPED. */
GH_API gh_status gh_direct_solve(gh_direct *direct, const gh_direct_loads *loads, gh_direct_report *report);
/* Work and energy count from here. */
GH_API void gh_direct_zero(gh_direct *direct);

GH_API const gh_direct_measures *gh_direct_measure(const gh_direct *direct);
/* nnodes x 2: prescribed, or fitted to the grains around the node. */
GH_API const double *gh_direct_u(const gh_direct *direct);
/* nelements x 4: Cauchy stress, by the shares of the contacts in the elements. */
GH_API const double *gh_direct_cauchy(const gh_direct *direct);
/* nelements: contacts of a grain, of the grains in it. */
GH_API const double *gh_direct_coordination(const gh_direct *direct);
/* Force of the supports on the grains of a set. Grains at a corner count for both edges. */
GH_API void gh_direct_reaction(const gh_direct *direct, int set, double sum[2]);
/* Grains, contacts and forces from outside, valid until the next solve. `flags` have bit 3 for boundary
 * grains. */
GH_API void gh_direct_look(const gh_direct *direct, gh_rve_view *view);

/* All that the next solve starts from, as numbers. GH_INPUT: not of this body. */
GH_API size_t gh_direct_state_size(const gh_direct *direct);
GH_API void gh_direct_save(const gh_direct *direct, double *state);
GH_API gh_status gh_direct_load(gh_direct *direct, const double *state, size_t size);

#ifdef __cplusplus
}
#endif
#endif
