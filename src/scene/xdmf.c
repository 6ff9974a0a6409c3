/* results.xdmf: XDMF 3 that tells ParaView and meshio what is in results.h5.
 * SPDX-License-Identifier: GPL-2.0-or-later */
#include "scene/internal.h"

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
  static const char *const cells[] = {"energy",          "coordination", "contacts",  "rattlers",
                                      "residual",        "mean_force",   "unjammed",  "acoustic",
                                      "volume_fraction", "fabric_xx",    "fabric_xy", "fabric_yy"};
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
  attribute(out, f, "piola", "Cell", "Tensor", ne, 9, "cells/piola");
  attribute(out, f, "cauchy", "Cell", "Tensor", ne, 9, "cells/cauchy");
  attribute(out, f, "von_mises_cell", "Cell", "Scalar", ne, 1, "cells/von_mises");
  for (size_t k = 0; k < sizeof cells / sizeof *cells; k++) {
    char dataset[64];
    snprintf(dataset, sizeof dataset, "cells/%s", cells[k]);
    attribute(out, f, cells[k], "Cell", "Scalar", ne, 1, dataset);
  }
  gh_text_print(out, "   </Grid>\n");
}
