/* SPDX-License-Identifier: GPL-2.0-or-later */
/* The outline of a mesh, its sides, and the grains that lie on them. */
#ifndef GRANHOM_DIRECT_OUTLINE_H
#define GRANHOM_DIRECT_OUTLINE_H

#include "granhom/mesh.h"
#include "granhom/packing.h"

/* An edge of the mesh on the outline, body on the left. */
typedef struct outline_edge {
  int a, b;      /* nodes */
  double length; /* reference */
  double along[2], outward[2];
  double start; /* arc length from the beginning of its side */
} outline_edge;

/* Consecutive edges without a corner between them. */
typedef struct outline_side {
  int first, count;
  double length;
} outline_side;

typedef struct outline {
  const gh_mesh *mesh;
  int nedges, nsides;
  outline_edge *edge; /* side by side, in order along them */
  outline_side *side;
  double area, low[2], high[2];
} outline;

gh_status outline_create(gh_context *ctx, const gh_mesh *mesh, outline *o);
void outline_destroy(outline *o);
/* The same edges and sides where the nodes of its mesh are now. */
void outline_move(outline *o);
/* Mean gradient of displacements (2 nnodes), of those of the outline alone: int u (x) N dS over the area. */
void outline_gradient(const outline *o, const double *u, double G[4]);
/* Distance from the outline, positive inside. */
double outline_depth(const outline *o, const double X[2]);
/* Where X is along a side: arc length, within 0 and its length, and how far it is beyond the end of the edge
 * there; the edge, and the depth below it. */
typedef struct outline_place {
  int edge;
  double s, beyond, depth;
} outline_place;
outline_place outline_project(const outline *o, const outline_side *side, const double X[2]);

/* A grain on a side. At a corner it may be on two. */
typedef struct chain_member {
  int grain, side, edge;
  double s, share;  /* arc length; share of edge `edge`: 0 at node a, 1 at b */
  double offset[2]; /* from the point of the outline to the grain, reference */
} chain_member;

/* The part of an edge that a member bears. */
typedef struct chain_piece {
  int member, edge;
  double length;
} chain_piece;

/* Members in order along the sides. */
typedef struct chain {
  int nmembers, npieces;
  size_t member_capacity, piece_capacity;
  chain_member *member;
  chain_piece *piece;
  double depth; /* mean over the outline of the depth of its grains */
} chain;

/* The grains that a probe of half a mean radius touches from outside. GH_INPUT: a side without any. */
gh_status chain_create(gh_context *ctx, const outline *o, const gh_packing *body, chain *c);
void chain_destroy(chain *c);

#endif
