/* results.xdmf and points.xdmf: XDMF 3 that tells ParaView and meshio what is in results.h5, on the mesh and
 * at the integration points. SPDX-License-Identifier: GPL-2.0-or-later */
#include "scene/results.h"

void scene_xdmf_begin(gh_text *out) {
  gh_text_print(out, "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"3.0\">\n <Domain>\n"
                     "  <Grid Name=\"granhom\" GridType=\"Collection\" CollectionType=\"Temporal\">\n");
}

void scene_xdmf_end(gh_text *out) {
  gh_text_print(out, "  </Grid>\n </Domain>\n</Xdmf>\n");
}

static void item(gh_text *out, const char *type, int rows, int cols, const char *where) {
  gh_text_print(out, "<DataItem Format=\"HDF\" NumberType=\"%s\" Precision=\"%d\" Dimensions=\"%d", type,
                *type == 'I' ? 4 : 8, rows);
  if (cols > 1) gh_text_print(out, " %d", cols);
  gh_text_print(out, "\">results.h5:%s</DataItem>\n", where);
}

static void attribute(gh_text *out, const scene_frame *f, const char *name, const char *center,
                      const char *type, int rows, int cols, const char *dataset) {
  char where[96];
  snprintf(where, sizeof where, "/step%04d/%s", f->counter, dataset);
  gh_text_print(out, "    <Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"%s\">", name, type, center);
  item(out, "Float", rows, cols, where);
  gh_text_print(out, "    </Attribute>\n");
}

void scene_xdmf_step(gh_text *out, const gh_mesh *mesh, const scene_frame *f) {
  int nn = mesh->nnodes, ne = mesh->nelements;
  gh_text_print(out, "   <Grid Name=\"step%04d\" GridType=\"Uniform\">\n    <Time Value=\"%.17g\"/>\n",
                f->counter, f->time);
  gh_text_print(out, "    <Topology TopologyType=\"Quadrilateral\" NumberOfElements=\"%d\">", ne);
  item(out, "Int", ne, 4, "/mesh/cells");
  gh_text_print(out, "    </Topology>\n    <Geometry GeometryType=\"XYZ\">");
  item(out, "Float", nn, 3, "/mesh/coordinates");
  gh_text_print(out, "    </Geometry>\n");
  attribute(out, f, "displacement", "Node", "Vector", nn, 3, "displacement");
  attribute(out, f, "reaction", "Node", "Vector", nn, 3, "reaction");
  attribute(out, f, "von_mises", "Node", "Scalar", nn, 1, "von_mises");
  attribute(out, f, "F", "Cell", "Tensor", ne, 9, "cells/F");
  attribute(out, f, "piola", "Cell", "Tensor", ne, 9, "cells/piola");
  attribute(out, f, "cauchy", "Cell", "Tensor", ne, 9, "cells/cauchy");
  attribute(out, f, "von_mises_cell", "Cell", "Scalar", ne, 1, "cells/von_mises");
  attribute(out, f, "acoustic", "Cell", "Scalar", ne, 1, "cells/acoustic");
  attribute(out, f, "acoustic_normal", "Cell", "Vector", ne, 3, "cells/acoustic_normal");
  for (size_t k = 0; k < scene_number_count; k++) {
    char dataset[64];
    if (!scene_numbers[k].mean) continue;
    snprintf(dataset, sizeof dataset, "cells/%s", scene_numbers[k].name);
    attribute(out, f, scene_numbers[k].name, "Cell", "Scalar", ne, 1, dataset);
  }
  gh_text_print(out, "   </Grid>\n");
}

void scene_xdmf_points(gh_text *out, const gh_mesh *mesh, const scene_frame *f) {
  int np = 4 * mesh->nelements;
  gh_text_print(out, "   <Grid Name=\"step%04d\" GridType=\"Uniform\">\n    <Time Value=\"%.17g\"/>\n",
                f->counter, f->time);
  gh_text_print(
      out, "    <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"%d\" NodesPerElement=\"1\">", np);
  item(out, "Int", np, 1, "/mesh/points");
  gh_text_print(out, "    </Topology>\n    <Geometry GeometryType=\"XY\">");
  item(out, "Float", np, 2, "/mesh/gauss");
  gh_text_print(out, "    </Geometry>\n");
  attribute(out, f, "F", "Node", "Matrix", np, 4, "points/F");
  attribute(out, f, "piola", "Node", "Matrix", np, 4, "points/P");
  attribute(out, f, "cauchy", "Node", "Matrix", np, 4, "points/cauchy");
  attribute(out, f, "acoustic", "Node", "Scalar", np, 1, "points/acoustic");
  attribute(out, f, "acoustic_angle", "Node", "Scalar", np, 1, "points/acoustic_angle");
  for (size_t k = 0; k < scene_number_count; k++) {
    char dataset[64];
    snprintf(dataset, sizeof dataset, "points/%s", scene_numbers[k].name);
    attribute(out, f, scene_numbers[k].name, "Node", "Scalar", np, 1, dataset);
  }
  gh_text_print(out, "   </Grid>\n");
}
