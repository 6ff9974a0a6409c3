"""The mesh of the slope, Gmsh MSH 2.2 to standard output: make_mesh.py [FINER] > slope.msh

FINER (default 1) times 38 x 10 bilinear quadrilaterals between a level base and a surface that has a crest, a slope of 1 : 2 and a toe. Columns are 3.875 m
wide: the footing of 23.25 m covers six of them, and its force acts one column off its middle, on the side of the slope.
Python's own library only. SPDX-License-Identifier: GPL-2.0-or-later"""
import sys

FINER = int(sys.argv[1]) if len(sys.argv) > 1 else 1
STEP = 3.875 / FINER       # width of a column, m
CREST, SLOPE, TOE = 16 * FINER, 10 * FINER, 12 * FINER  # columns
ROWS = 10 * FINER
HEIGHT = ROWS * STEP       # of the crest
DROP = SLOPE * STEP / 2
FOOTING = range(9 * FINER, 15 * FINER)  # columns under the footing: one column of free crest to the slope
COLUMNS = CREST + SLOPE + TOE
SETS = ("bottom", "right", "toe", "slope", "crest", "footing", "left")


def node(i, j):
    return 1 + i + j * (COLUMNS + 1)


def point(i, j):
    surface = HEIGHT - DROP * min(max(i - CREST, 0), SLOPE) / SLOPE
    return STEP * i, surface * j / ROWS


def surface_set(i):
    if i in FOOTING:
        return "footing"
    return "crest" if i < CREST else "slope" if i < CREST + SLOPE else "toe"


def lines():
    """(set, from, to) with the body on the left."""
    for i in range(COLUMNS):
        yield "bottom", node(i, 0), node(i + 1, 0)
        yield surface_set(i), node(i + 1, ROWS), node(i, ROWS)
    for j in range(ROWS):
        yield "right", node(COLUMNS, j), node(COLUMNS, j + 1)
        yield "left", node(0, j + 1), node(0, j)


def main():
    print("$MeshFormat\n2.2 0 8\n$EndMeshFormat")
    print("$PhysicalNames\n%d" % (len(SETS) + 1))
    for k, name in enumerate(SETS):
        print('1 %d "%s"' % (k + 1, name))
    print('2 %d "ground"\n$EndPhysicalNames' % (len(SETS) + 1))
    print("$Nodes\n%d" % ((COLUMNS + 1) * (ROWS + 1)))
    for j in range(ROWS + 1):
        for i in range(COLUMNS + 1):
            print("%d %.10g %.10g 0" % (node(i, j), *point(i, j)))
    edges = [(1, SETS.index(name) + 1, (a, b)) for name, a, b in lines()]
    quads = [(3, len(SETS) + 1, (node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)))
             for j in range(ROWS) for i in range(COLUMNS)]
    print("$EndNodes\n$Elements\n%d" % (len(edges) + len(quads)))
    for k, (kind, group, nodes) in enumerate(edges + quads):
        print(k + 1, kind, 2, group, group, *nodes)
    print("$EndElements")


main()
