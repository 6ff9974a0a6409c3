/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Gmsh meshes as others write them: sections that say nothing about the mesh, other versions, other elements,
 * many groups. */
#include "granhom/macro.h"
#include "test_io.h"

#include <time.h>

/* Two unit squares side by side; the sets "left" and "right" are upright edges. */
static const char head[] = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n",
                  names[] =
                      "$PhysicalNames\n3\n1 1 \"left\"\n1 2 \"right\"\n2 3 \"body\"\n$EndPhysicalNames\n",
                  nodes[] = "$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n$EndNodes\n",
                  elements[] =
                      "$Elements\n4\n1 1 2 1 1 4 1\n2 1 2 2 2 3 6\n3 3 2 3 1 1 2 5 4\n4 3 2 3 1 2 3 6 "
                      "5\n$EndElements\n";

static char text[1 << 16];

static const char *put_mesh(place *p, const char *a, const char *b, const char *c, const char *d,
                            const char *e) {
  snprintf(text, sizeof text, "%s%s%s%s%s", a, b, c, d, e);
  return put_file(p, "a.msh", text);
}

/* The mesh of `path` is the two squares. */
static void assert_squares(place *p, const char *path) {
  static const double X[] = {0, 0, 1, 0, 2, 0, 0, 1, 1, 1, 2, 1};
  gh_mesh *m;
  if (gh_mesh_read_gmsh(p->ctx, path, &m) != GH_OK) fail_msg("%s", gh_message(p->ctx));
  assert_int_equal(m->nnodes, 6);
  assert_int_equal(m->nelements, 2);
  assert_memory_equal(m->X, X, sizeof X);
  assert_int_equal(m->nsets, 2);
  int left = gh_mesh_find(m, "left"), right = gh_mesh_find(m, "right");
  assert_true(left >= 0 && right >= 0);
  assert_int_equal(m->sets[left].nedges, 1);
  assert_int_equal(m->sets[left].edges[0][0], 3); /* downwards: the body is on the left */
  assert_int_equal(m->sets[right].edges[0][0], 2);
  gh_mesh_destroy(&m);
}

static void assert_refused(place *p, const char *path, const char *rest) {
  gh_mesh *m;
  char wanted[160];
  assert_int_equal(gh_mesh_read_gmsh(p->ctx, path, &m), GH_INPUT);
  assert_null(m);
  snprintf(wanted, sizeof wanted, "%s%s", path, rest);
  if (strncmp(gh_message(p->ctx), wanted, strlen(wanted)) != 0)
    fail_msg("\"%s\" does not begin with \"%s\"", gh_message(p->ctx), wanted);
}

/* Sections of which nothing is needed, wherever they stand; words in them may look like numbers or names. */
static void sections_without_meaning_are_passed_over(void **state) {
  static const char *const sections[] = {
      "$Comments\nmade by \"hand, 5 $Nodes\n$EndComments\n",
      "$Periodic\n1\n1 1 2\n1\n1 3\n$EndPeriodic\n",
      "$ElementData\n1\n\"stress\"\n1\n0.0\n3\n0\n1\n2\n3 1.5\n4 nan\n$EndElementData\n",
      "$NodeData\n1\n\"A view\"\n1\n0.0\n3\n0\n1\n1\n1 -0.5\n$EndNodeData\n",
      "$InterpolationScheme\n\"x\"\n0\n$EndInterpolationScheme\n",
      "$SomethingNew\n1 2 3\n$EndSomethingNew\n"};
  place *p = *state;
  for (size_t k = 0; k < sizeof sections / sizeof *sections; k++) {
    assert_squares(p, put_mesh(p, head, sections[k], names, nodes, elements));
    assert_squares(p, put_mesh(p, head, names, nodes, elements, sections[k]));
    assert_squares(p, put_mesh(p, sections[k], head, names, nodes, elements));
  }
}

/* Line ends of Windows and of old spreadsheets, a byte order mark, blank lines, tabs. */
static void line_ends_and_marks_are_no_obstacle(void **state) {
  place *p = *state;
  char other[4096] = "\xEF\xBB\xBF";
  size_t n = 3;
  put_mesh(p, head, names, nodes, elements, "");
  for (const char *c = text; *c; c++) {
    if (*c == '\n') memcpy(other + n, "\r\n\r\n", 4), n += 4;
    else other[n++] = (char)(*c == ' ' && c[1] != '"' ? '\t' : *c);
  }
  other[n] = 0;
  assert_squares(p, put_file(p, "b.msh", other));
  for (char *c = text; (c = strchr(c, '\n'));) *c = '\r';
  assert_squares(p, put_file(p, "c.msh", text));
}

/* $ParametricNodes of MSH 2.2: nodes of corners have no parameter, of curves one, of surfaces two. */
static void parametric_nodes_are_nodes(void **state) {
  place *p = *state;
  assert_squares(
      p, put_mesh(p, head, names,
                  "$ParametricNodes\n6\n1 0 0 0 0 1\n2 1 0 0 1 1 0.5\n3 2 0 0 0 2\n4 0 1 0 0 4\n5 1 1 "
                  "0 2 1 0.25 0.75\n6 2 1 0 0 3\n$EndParametricNodes\n",
                  elements, ""));
  assert_refused(p,
                 put_mesh(p, head, names,
                          "$ParametricNodes\n2\n1 0 0 0 1 1\n2 1 0 0 0 1\n$EndParametricNodes\n", elements,
                          ""),
                 ":14: ");
}

/* Versions and forms that are not read are named, with how to save the mesh. */
static void versions_are_named(void **state) {
  place *p = *state;
  assert_refused(
      p, put_file(p, "a.msh", "$NOD\n1\n1 0 0 0\n$ENDNOD\n$ELM\n0\n$ENDELM\n"),
      ":1: MSH version 1, which begins with $NOD; 2.2 and 4.1 ASCII are read; save it as one of them "
      "(gmsh FILE -save -format msh41");
  static const char *const versions[] = {"1", "2", "3", "4", "4.0", "4.2", "5.0"};
  for (size_t k = 0; k < sizeof versions / sizeof *versions; k++) {
    char start[64], message[128];
    snprintf(start, sizeof start, "$MeshFormat\n%s 0 8\n$EndMeshFormat\n", versions[k]);
    snprintf(message, sizeof message, ":2: MSH version %s; 2.2 and 4.1 ASCII are read; save", versions[k]);
    assert_refused(p, put_mesh(p, start, names, nodes, elements, ""), message);
  }
  static const char *const binary[] = {"2.2", "4.1", "4"};
  for (size_t k = 0; k < sizeof binary / sizeof *binary; k++) {
    char start[64], message[128];
    size_t n = (size_t)snprintf(start, sizeof start, "$MeshFormat\n%s 1 8\n", binary[k]);
    memcpy(start + n, "\1\0\0\0\n$EndMeshFormat\n", 20);
    snprintf(message, sizeof message, ":2: a binary Gmsh mesh (MSH %s), and only ASCII is read; save it with",
             binary[k]);
    assert_refused(p, put_bytes(p, "a.msh", start, n + 20), message);
  }
  assert_refused(p, put_file(p, "a.geo", "// a plate\nPoint(1) = {0, 0, 0};\n"),
                 ":1: a Gmsh geometry and no mesh; gmsh -2");
  assert_refused(p, put_file(p, "a.msh", "$Comments\n$EndComments\n"),
                 ":3: no Gmsh file: it holds no $MeshFormat");
  assert_refused(p, put_bytes(p, "a.msh", "\xFF\xFE$\0M\0", 6), ":1: text in UTF-16");
}

/* Elements that are no bilinear quadrilaterals are named with their line and what to change in Gmsh. */
static void elements_are_named(void **state) {
  static const struct {
    int type;
    const char *message;
  } others[] = {
      {2, ":22: a triangle (type 2); only 4-node quadrilaterals are read, with 2-node lines and points as "
          "sets (in Gmsh: Recombine Surface"},
      {4, ":22: a tetrahedron (type 4); "},
      {5, ":22: a hexahedron (type 5); "},
      {8, ":22: a quadratic line (type 8); "},
      {9, ":22: a quadratic triangle (type 9); "},
      {10, ":22: a quadratic quadrilateral (type 10); only 4-node quadrilaterals are read, with 2-node "
           "lines and points as sets (in Gmsh: Mesh.ElementOrder = 1)"},
      {16, ":22: a quadratic quadrilateral (type 16); "},
      {21, ":22: a cubic triangle (type 21); "},
      {36, ":22: a cubic quadrilateral (type 36); "},
      {99, ":22: an unsupported element (type 99); "}};
  place *p = *state;
  for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
    char wrong[256];
    snprintf(wrong, sizeof wrong, "$Elements\n2\n1 1 2 1 1 4 1\n2 %d 2 3 1 1 2 5 4 1 2 3 4\n$EndElements\n",
             others[k].type);
    assert_refused(p, put_mesh(p, head, names, nodes, wrong, ""), others[k].message);
  }
}

/* Without a physical group of surfaces Gmsh leaves the surfaces out, and the message states so. */
static void a_mesh_without_surfaces_says_why(void **state) {
  place *p = *state;
  assert_refused(
      p, put_mesh(p, head, names, nodes, "$Elements\n2\n1 1 2 1 1 4 1\n2 1 2 2 2 3 6\n$EndElements\n", ""),
      ": the mesh has no quadrilateral, only points and lines of physical groups: once there are such "
      "groups, Gmsh saves nothing but them; give the surface one, too (Physical Surface), or save all "
      "(Mesh.SaveAll = 1)");
  assert_refused(p, put_mesh(p, head, nodes, "$Elements\n0\n$EndElements\n", "", ""),
                 ": the mesh has no quadrilateral (in Gmsh: mesh in two dimensions, gmsh -2");
}

/* Number of nodes (2 n + 2) in two rows. */
static void print_strip(FILE *f, int n) {
  for (int k = 0; k <= n; k++) fprintf(f, "%d %d 0 0\n%d %d 1 0\n", 2 * k + 1, k, 2 * k + 2, k);
}

/* A strip of n quadrilaterals whose lower edges are n groups with names; MSH 4.1 has an entity for each. */
static const char *put_strip(place *p, bool v4, int n) {
  const char *path = in_folder(p, "strip.msh");
  FILE *f = fopen(path, "w");
  assert_non_null(f);
  fprintf(f, "$MeshFormat\n%s 0 8\n$EndMeshFormat\n$PhysicalNames\n%d\n", v4 ? "4.1" : "2.2", n);
  for (int k = n; k > 0; k--) fprintf(f, "1 %d \"edge %d\"\n", k, k);
  fprintf(f, "$EndPhysicalNames\n");
  if (v4) {
    fprintf(f, "$Entities\n0 %d 1 0\n", n);
    for (int k = n; k > 0; k--) fprintf(f, "%d 0 0 0 1 1 0 1 %d 0\n", k, k);
    fprintf(f, "1 0 0 0 1 1 0 0 0\n$EndEntities\n$Nodes\n1 %d 1 %d\n2 1 0 %d\n", 2 * n + 2, 2 * n + 2,
            2 * n + 2);
    for (int k = 0; k <= n; k++) fprintf(f, "%d\n%d\n", 2 * k + 1, 2 * k + 2);
    for (int k = 0; k <= n; k++) fprintf(f, "%d 0 0\n%d 1 0\n", k, k);
    fprintf(f, "$EndNodes\n$Elements\n%d %d 1 %d\n2 1 3 %d\n", n + 1, 2 * n, 2 * n, n);
    for (int k = 0; k < n; k++)
      fprintf(f, "%d %d %d %d %d\n", k + 1, 2 * k + 1, 2 * k + 3, 2 * k + 4, 2 * k + 2);
    for (int k = 0; k < n; k++) fprintf(f, "1 %d 1 1\n%d %d %d\n", k + 1, n + k + 1, 2 * k + 1, 2 * k + 3);
  } else {
    fprintf(f, "$Nodes\n%d\n", 2 * n + 2);
    print_strip(f, n);
    fprintf(f, "$EndNodes\n$Elements\n%d\n", 2 * n);
    for (int k = 0; k < n; k++)
      fprintf(f, "%d 3 2 0 1 %d %d %d %d\n", k + 1, 2 * k + 1, 2 * k + 3, 2 * k + 4, 2 * k + 2);
    for (int k = 0; k < n; k++) fprintf(f, "%d 1 2 %d 1 %d %d\n", n + k + 1, k + 1, 2 * k + 1, 2 * k + 3);
  }
  fprintf(f, "$EndElements\n");
  assert_int_equal(fclose(f), 0);
  return path;
}

/* Time grows hardly more than the number of groups: 100,000 of them would take minutes in quadratic time. */
static void many_groups_take_little_time(void **state) {
  enum { N = 100000 };
  place *p = *state;
  for (int v4 = 0; v4 < 2; v4++) {
    const char *path = put_strip(p, v4, N);
    gh_mesh *m;
    clock_t begin = clock();
    if (gh_mesh_read_gmsh(p->ctx, path, &m) != GH_OK) fail_msg("%s", gh_message(p->ctx));
    double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
    print_message("%d groups of MSH %s: %.2f s\n", N, v4 ? "4.1" : "2.2", seconds);
    if (!getenv("SANITIZED")) assert_true(seconds < 5);
    assert_int_equal(m->nelements, N);
    assert_int_equal(m->nsets, N);
    for (int k = 0; k < N; k += N / 7) {
      char name[32];
      snprintf(name, sizeof name, "edge %d", k + 1);
      assert_string_equal(m->sets[k].name, name);
      assert_int_equal(m->sets[k].nedges, 1);
      assert_true(m->X[2 * m->sets[k].edges[0][0]] == k && m->X[2 * m->sets[k].edges[0][1]] == k + 1);
    }
    gh_mesh_destroy(&m);
  }
}

/* A line that is listed twice, also from its other end, is one edge: a pressure acts once. Lines that are no edge
 * of the boundary are counted. */
static void lines_count_once(void **state) {
  place *p = *state;
  gh_mesh *m;
  snprintf(
      text, sizeof text, "%s%s%s%s", head, names, nodes,
      "$Elements\n8\n1 1 2 1 1 4 1\n2 1 2 1 1 1 4\n3 1 2 1 1 4 1\n4 1 2 2 2 3 6\n5 1 2 2 2 2 5\n6 1 2 2 2 1 "
      "6\n7 3 2 3 1 1 2 5 4\n8 3 2 3 1 2 3 6 5\n$EndElements\n");
  assert_int_equal(gh_mesh_read_gmsh(p->ctx, put_file(p, "a.msh", text), &m), GH_OK);
  const gh_mesh_set *left = m->sets + gh_mesh_find(m, "left"), *right = m->sets + gh_mesh_find(m, "right");
  assert_int_equal(left->nedges, 1);
  assert_int_equal(left->nlines, 0);
  assert_int_equal(right->nedges, 1);
  assert_int_equal(right->nlines, 2); /* between the squares, and across */
  gh_mesh_destroy(&m);
}

/* Squares that share an area, a node that hangs on a side: refused by the line of the element. Nodes that lie at
 * one place are counted. In both directions: the nodes are looked through along one axis. */
static void quadrilaterals_meet_at_corners(void **state) {
  static const char *const across[] = {
      "$Elements\n2\n1 3 2 3 1 1 3 6 4\n2 3 2 3 1 1 2 5 4\n$EndElements\n", /* one square covers the other */
      "$Elements\n3\n1 3 2 3 1 1 3 6 4\n2 3 2 3 1 4 5 8 7\n3 3 2 3 1 5 6 9 8\n$EndElements\n"}; /* node 5 hangs */
  static const char
      more[] = "$Nodes\n9\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n7 0 2 0\n8 1 2 0\n9 "
               "2 2 0\n$EndNodes\n",
      turned[] = "$Nodes\n9\n1 0 0 0\n2 0 1 0\n3 0 2 0\n4 1 0 0\n5 1 1 0\n6 1 2 0\n7 2 0 0\n8 2 1 0\n"
                 "9 2 2 0\n$EndNodes\n",
      twin[] = "$Nodes\n7\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n7 1 0 0\n$EndNodes\n",
      slit[] = "$Elements\n2\n1 3 2 3 1 1 2 5 4\n2 3 2 3 1 7 3 6 5\n$EndElements\n";
  place *p = *state;
  gh_mesh *m;
  gh_mesh_misfits found;
  for (int k = 0; k < 2; k++)
    for (int turn = 0; turn < 2; turn++)
      assert_refused(p, put_mesh(p, head, names, turn ? turned : more, across[k], ""),
                     ":24: quadrilateral 1 has a node of others in it or on its side");
  assert_int_equal(gh_mesh_read_gmsh(p->ctx, put_mesh(p, head, names, twin, slit, ""), &m), GH_OK);
  assert_int_equal(gh_mesh_find_misfits(p->ctx, m, &found), GH_OK);
  assert_int_equal(found.element, -1);
  assert_int_equal(found.ntwins, 1);
  assert_true(m->X[2 * found.twin[0]] == 1 && m->X[2 * found.twin[1]] == 1);
  gh_mesh_destroy(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {TEST(sections_without_meaning_are_passed_over),
                                     TEST(line_ends_and_marks_are_no_obstacle),
                                     TEST(parametric_nodes_are_nodes),
                                     TEST(versions_are_named),
                                     TEST(elements_are_named),
                                     TEST(a_mesh_without_surfaces_says_why),
                                     TEST(lines_count_once),
                                     TEST(quadrilaterals_meet_at_corners),
                                     TEST(many_groups_take_little_time)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
