/* SPDX-License-Identifier: GPL-2.0-or-later */
/* results.xdmf and points.xdmf: XDMF 3 that describes to ParaView and meshio what is in results.h5, on the
 * mesh and at the integration points. */
#include "results/results.h"

void results_xdmf_begin(gh_text *out) {
  gh_text_print(out, "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"3.0\">\n <Domain>\n"
                     "  <Grid Name=\"granhom\" GridType=\"Collection\" CollectionType=\"Temporal\">\n");
}

void results_xdmf_end(gh_text *out) {
  gh_text_print(out, "  </Grid>\n </Domain>\n</Xdmf>\n");
}

static void item_print(gh_text *out, const char *type, int rows, int cols, const char *where) {
  gh_text_print(out, "<DataItem Format=\"HDF\" NumberType=\"%s\" Precision=\"%d\" Dimensions=\"%d", type,
                *type == 'I' ? 4 : 8, rows);
  if (cols > 1) gh_text_print(out, " %d", cols);
  gh_text_print(out, "\">results.h5:%s</DataItem>\n", where);
}

/* Of a tensor of the plane ParaView wants the four numbers as a matrix. */
static const char *attribute_type(int components) {
  return components == 1 ? "Scalar" : components == 3 ? "Vector" : components == 4 ? "Matrix" : "Tensor";
}

static void attribute_print(gh_text *out, const gh_frame *f, const gh_field *field, const char *center,
                            int rows) {
  char where[96];
  snprintf(where, sizeof where, "/step%04d/%s", f->counter, field->name);
  gh_text_print(out, "    <Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"%s\">", field->attribute,
                attribute_type(field->components), center);
  item_print(out, "Float", rows, field->components, where);
  gh_text_print(out, "    </Attribute>\n");
}

static void grid_begin(gh_text *out, const gh_frame *f) {
  gh_text_print(out, "   <Grid Name=\"step%04d\" GridType=\"Uniform\">\n    <Time Value=\"%.17g\"/>\n",
                f->counter, f->time);
}

void results_xdmf_step(gh_text *out, const gh_solver_results *s, const gh_frame *f) {
  const int nn = s->mesh->nnodes, ne = s->mesh->nelements;
  grid_begin(out, f);
  gh_text_print(out, "    <Topology TopologyType=\"Quadrilateral\" NumberOfElements=\"%d\">", ne);
  item_print(out, "Int", ne, 4, "/mesh/cells");
  gh_text_print(out, "    </Topology>\n    <Geometry GeometryType=\"XYZ\">");
  item_print(out, "Float", nn, 3, "/mesh/coordinates");
  gh_text_print(out, "    </Geometry>\n");
  for (int k = 0; k < s->nfields; k++) {
    const gh_field *field = s->fields + k;
    if (!field->attribute || field->place == GH_AT_POINTS) continue;
    const bool nodes = field->place == GH_AT_NODES;
    attribute_print(out, f, field, nodes ? "Node" : "Cell", nodes ? nn : ne);
  }
  gh_text_print(out, "   </Grid>\n");
}

void results_xdmf_points(gh_text *out, const gh_solver_results *s, const gh_frame *f) {
  const int np = 4 * s->mesh->nelements;
  grid_begin(out, f);
  gh_text_print(
      out, "    <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"%d\" NodesPerElement=\"1\">", np);
  item_print(out, "Int", np, 1, "/mesh/points");
  gh_text_print(out, "    </Topology>\n    <Geometry GeometryType=\"XY\">");
  item_print(out, "Float", np, 2, "/mesh/gauss");
  gh_text_print(out, "    </Geometry>\n");
  for (int k = 0; k < s->nfields; k++) {
    const gh_field *field = s->fields + k;
    if (field->attribute && field->place == GH_AT_POINTS) attribute_print(out, f, field, "Node", np);
  }
  gh_text_print(out, "   </Grid>\n");
}
