/* SPDX-License-Identifier: GPL-2.0-or-later */
/* granhom: meshes of bilinear quadrilaterals: reference element, Gmsh, sets, measures at nodes and cells. */
#ifndef GRANHOM_MESH_H
#define GRANHOM_MESH_H

#include "granhom/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- mesh: bilinear quadrilaterals (Q1), four Gauss points each ---- */

/* A named set on the boundary. Edges run with the body on their left, so that (dy, -dx) points outward. */
typedef struct gh_mesh_set {
  char *name;
  int nnodes, nedges;
  int *nodes;      /* ascending */
  int (*edges)[2]; /* may be empty (a set of points, or of inner lines); each once */
  int nlines;      /* lines that are no edge of the boundary */
} gh_mesh_set;

typedef struct gh_mesh {
  int nnodes, nelements, nsets;
  double *X;      /* nnodes x 2 */
  int (*quad)[4]; /* nelements, counter-clockwise */
  gh_mesh_set *sets;
} gh_mesh;

/* [low, low + size] with elements[0] x elements[1] equal quadrilaterals; sets left right bottom top. Nodes
 * row by row from below. */
GH_API gh_status gh_mesh_rectangle(gh_context *ctx, const double low[2], const double size[2],
                                   const int elements[2], gh_mesh **mesh);
/* Gmsh MSH 2.2 or 4.1 ASCII; 4-node quadrilaterals in the plane z = 0; physical groups of lines and points
 * become sets (their names, else their numbers). Clockwise quadrilaterals are turned. Errors, GH_INPUT with
 * file and line: other versions, binary, triangles or quadratic elements, inverted (non-convex)
 * quadrilaterals, no quadrilateral, nodes missing. Nodes used by no quadrilateral are left out. */
GH_API gh_status gh_mesh_read_gmsh(gh_context *ctx, const char *path, gh_mesh **mesh);
/* Jacobian > 0 at every Gauss point and every corner angle below 180 degrees, else GH_INPUT naming the
 * element. */
GH_API gh_status gh_mesh_check(gh_context *ctx, const gh_mesh *mesh);
/* What does not fit: a node in or on a quadrilateral of which it is no corner (element -1: none), which overlaps
 * there or whose neighbour hangs on its side; nodes at the very same place, which leave a slit between theirs
 * (ntwins 0: none). GH_MEMORY. */
typedef struct gh_mesh_misfits {
  int element, node, ntwins, twin[2];
} gh_mesh_misfits;
GH_API gh_status gh_mesh_find_misfits(gh_context *ctx, const gh_mesh *mesh, gh_mesh_misfits *found);
/* True when the quadrilateral with corners x (counter-clockwise) is convex with an area. */
GH_API bool gh_quad_convex(const double x[4][2]);
/* Index of the set of that name; -1 when there is none. */
GH_API int gh_mesh_find(const gh_mesh *mesh, const char *name);
/* The same, which for `bottom_left`, `bottom_right`, `top_left` and `top_right` is made where the mesh has none
 * of that name: the one node that the sets of both words share. *set -1: there is none. GH_MEMORY. */
GH_API gh_status gh_mesh_find_corner(gh_context *ctx, gh_mesh *mesh, const char *name, int *set);
/* Name of degree of freedom 2 a + i, component i of node a: "node 7 at (1, 2) in x". Returns text. */
enum { GH_DOF_NAME = 96 };
GH_API const char *gh_mesh_dof_name(const gh_mesh *mesh, int dof, char text[GH_DOF_NAME]);
/* Reference coordinates (nelements * 4 x 2) of the Gauss points, point 4 e + g. */
GH_API void gh_mesh_gauss(const gh_mesh *mesh, double *XG);
GH_API void gh_mesh_destroy(gh_mesh **mesh);

/* ---- boundary ---- */

/* A side of an element, body on the left. */
typedef struct gh_mesh_edge {
  int a, b;
} gh_mesh_edge;
/* The sides that belong to one element only, sorted by their nodes. quad: nelements. The caller frees *edges,
 * also after GH_MEMORY. */
GH_API gh_status gh_mesh_boundary_edges(gh_context *ctx, int nelements, const int (*quad)[4],
                                        gh_mesh_edge **edges, int *count);
/* The edge between two nodes, in either direction, among edges sorted as above; NULL when there is none. */
GH_API const gh_mesh_edge *gh_mesh_find_edge(const gh_mesh_edge *edges, int count, int a, int b);
/* Whether two sets have an edge in common. GH_MEMORY. */
GH_API gh_status gh_mesh_share_edges(gh_context *ctx, const gh_mesh_set *a, const gh_mesh_set *b,
                                     bool *share);

/* ---- reference element: 2 x 2 Gauss points, total Lagrangian ---- */

typedef struct gh_shapes {
  double (*grad)[4][2]; /* npoints: dN_a/dX_J */
  double *weight;       /* npoints: reference area of the point */
} gh_shapes;

/* Values of the four shape functions at Gauss point g. */
GH_API void gh_shape_values(int g, double N[4]);
/* Derivatives with respect to X and the area of Gauss point g of a quadrilateral with corners x. */
GH_API void gh_shape_gradients(const double x[4][2], int g, double grad[4][2], double *area);
/* Of all points of a mesh. GH_MEMORY: gh_shapes_destroy frees what was allocated. */
GH_API gh_status gh_shapes_create(gh_context *ctx, const gh_mesh *mesh, gh_shapes *shapes);
GH_API void gh_shapes_destroy(gh_shapes *shapes);
/* F = 1 + grad u at the element's four points (4 x 4). u: nnodes x 2. */
GH_API void gh_element_deformation(const gh_shapes *s, const gh_mesh *mesh, int e, const double *u,
                                   double *F);
/* f[2 a + i] = int P_iJ N_a,J (2.10); P: 4 x 4. */
GH_API void gh_element_force(const gh_shapes *s, int e, const double *P, double f[8]);
/* K[2 a + i][2 b + k] = int N_a,J A_iJkL N_b,L; A: 4 x 16. */
GH_API void gh_element_stiffness(const gh_shapes *s, int e, const double *A, double K[8][8]);

/* ---- measures: from Gauss points to cells and nodes ---- */

/* Von Mises stress of the plane, sqrt(3/2 s_dev : s_dev) (dissertation 6.4.2): zero under equal pressure. */
GH_API double gh_mises2(const double cauchy[4]);
/* Which corner of element e the Gauss point at x (reference coordinates) belongs to. */
GH_API int gh_mesh_gauss_corner(const gh_mesh *mesh, int e, const double x[2]);
/* points: 4 nelements x cols. cells: nelements x cols, means over the four points. */
GH_API void gh_mesh_cell_average(int nelements, int cols, const double *points, double *cells);
/* points: 4 nelements x cols. nodes: nnodes x cols, extrapolated to the corners of the elements and averaged
 * over the elements. GH_MEMORY. */
GH_API gh_status gh_mesh_nodal_average(gh_context *ctx, const gh_mesh *mesh, int cols, const double *points,
                                       double *nodes);
/* cauchy: 4 nelements x 4. nodes: nnodes, von Mises of stresses extrapolated to the corners and averaged over
 * the elements. GH_MEMORY. */
GH_API gh_status gh_mesh_nodal_mises(gh_context *ctx, const gh_mesh *mesh, const double *cauchy,
                                     double *nodes);

#ifdef __cplusplus
}
#endif
#endif
