#!/bin/sh
# Scenes from file to results, compared with an independent program; files read back by meshio and h5py. SPDX-License-Identifier: GPL-2.0-or-later
set -u
granhom=${BUILD:-build}/granhom
"$granhom" --version | grep -q '^HDF5 yes' || { echo "skip - results read by h5py and meshio (no HDF5)"; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cases=$(pwd)/tests/data/cases
failed=0
say() { if [ "$1" = 0 ]; then echo "ok - $2"; else echo "not ok - $2"; failed=1; fi; }

cat >"$work/distorted.yaml" <<E
title: Distorted block under follower pressure
packing: $cases/packings/p150.data
contact: {normal_stiffness: 50}
micro: {boundary: taylor}
start: {confinement: 0.22}
mesh:
  rectangle: {size: [100, 100], elements: [3, 3]}
  move:
    - {node: [33.3333333333333, 33.3333333333333], by: [6, -4]}
    - {node: [66.6666666666667, 33.3333333333333], by: [-5, 7]}
    - {node: [33.3333333333333, 66.6666666666667], by: [4, 5]}
    - {node: [66.6666666666667, 66.6666666666667], by: [-7, -6]}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps:
  - {name: confine, increments: 10, supports: [{edge: top, fix: y}], pressure: [{edge: right, to: 0.2, follow: true}]}
  - {name: compress, increments: 30, displace: [{edge: top, y: -3}]}
solver: {tolerance: 1e-11}
E
cat >"$work/gravity.yaml" <<E
packing: $cases/packings/p150.data
contact: {normal_stiffness: 50}
micro: {boundary: taylor, engine: native}
start: {confinement: 0.05}
mesh: {rectangle: {size: [10, 10], elements: [4, 4]}}
supports: [{edge: left, fix: x}, {edge: right, fix: x}, {edge: bottom, fix: y}]
steps:
  - {name: weight, increments: 5, gravity: {to: [0, -0.015]}}
solver: {tolerance: 1e-11}
output: {rves: [0, 63]}
E
for scene in distorted gravity; do
  "$granhom" run "$work/$scene.yaml" -o "$work/$scene" >"$work/log" 2>&1
  say $? "$scene runs to its end"
done

cat >"$work/compare.py" <<'E'
"""compare.py RESULTS CASE: history.csv, nodes and Gauss points against the reference, 1e-8 of the largest value of a column."""
import csv, sys
import h5py
import numpy as np
results, case, bad = sys.argv[1], sys.argv[2], 0
def table(path):
    with open(path) as f:
        return list(csv.DictReader(f))
def check(what, ours, theirs):
    global bad
    ours, theirs = np.array(ours, float), np.array(theirs, float)
    scale = max(np.abs(theirs).max(), 1e-6)
    error = np.abs(ours - theirs).max() / scale
    if not error <= 1e-8:
        bad = 1
        print(f"#   {what}: off by {error:.2e}")
ours, theirs = table(f"{results}/history.csv"), table(f"{case}_steps.csv")
assert len(ours) == len(theirs), (len(ours), len(theirs))
largest = max(abs(float(r[c])) for r in theirs for c in ("bottom_y", "left_x", "right_x", "top_y"))
for column in ("bottom_x", "bottom_y", "right_x", "right_y", "top_x", "top_y", "left_x", "left_y"):
    a, b = [float(r[column]) for r in ours], [float(r[column]) for r in theirs]
    if np.abs(np.array(a) - b).max() > 1e-8 * largest:
        bad = 1
        print(f"#   {column}: off by {np.abs(np.array(a) - b).max():.2e}")
check("dilatancy", [r["dilatancy"] for r in ours], [r["dilatancy"] for r in theirs])
with h5py.File(f"{results}/results.h5") as h5:
    X, XG = h5["/mesh/coordinates"][:, :2], h5["/mesh/gauss"][:]
    for kind, where, columns, dataset in (("nodes", X, ("ux", "uy"), "displacement"), ("gauss", XG, ("F11", "F12", "F21", "F22"), "points/F"),
                                          ("gauss", XG, ("P11", "P12", "P21", "P22"), "points/P")):
        rows = table(f"{case}_{kind}.csv")
        for step in sorted({int(r["step"]) for r in rows}):
            part = [r for r in rows if int(r["step"]) == step]
            place = np.array([[float(r["X"]), float(r["Y"])] for r in part])
            index = [int(np.argmin(np.hypot(*(where - p).T))) for p in place]
            data = h5[f"/step{step:04d}/{dataset}"][:]
            theirs = np.array([[float(r[c]) for c in columns] for r in part])
            if dataset == "points/F":
                theirs, data = theirs - [1, 0, 0, 1], data - [1, 0, 0, 1]
            check(f"{dataset} of step {step}", data[index][:, :len(columns)], theirs)
sys.exit(bad)
E
/usr/bin/python3 "$work/compare.py" "$work/distorted" "$cases/macro/block_taylor_p02_distorted"
say $? 'distorted mesh, follower pressure: reactions, dilatancy, displacements, F and P of the reference to 1e-8'
/usr/bin/python3 "$work/compare.py" "$work/gravity" "$cases/macro/gravity_taylor"
say $? 'gravity in a step: reactions, dilatancy, displacements, F and P of the reference to 1e-8'

(cd "$work/distorted" && /usr/bin/python3 - <<'E'
import json
import h5py
import meshio
import numpy as np
with meshio.xdmf.TimeSeriesReader("results.xdmf") as reader, h5py.File("results.h5") as h5:
    points, cells = reader.read_points_cells()
    assert points.shape == (16, 3) and cells[0].type == "quad" and len(cells[0].data) == 9
    assert reader.num_steps == 41
    time, nodes, elements = reader.read_data(40)
    assert time == 2
    assert np.allclose(nodes["displacement"][12:, 1], -3) and nodes["displacement"][:, 2].max() == 0
    average = h5["/step0040/points/cauchy"][:].reshape(9, 4, 4).mean(axis=1)
    assert np.allclose(elements["cauchy"][0][:, [0, 1, 3, 4]], average)
    assert elements["von_mises_cell"][0].min() > 0 and nodes["von_mises"].min() > 0
run = json.load(open("run.json"))
assert run["status"] == "done" and run["summary"]["increments"] == 40, run
rows = np.genfromtxt("history.csv", delimiter=",", names=True, dtype=None, encoding="utf8")
assert rows["p_right"][10] == 0.2 and abs(rows["p_right"][5] - 0.21) < 1e-15 and rows["uy_top"][40] == -3
with h5py.File("results.h5") as h5:
    for name in "coordination", "anisotropy":
        assert all(abs(rows[name][k] - h5[f"/step{k:04d}/points/{name}"][:].mean()) < 1e-13 for k in range(41)), name
residuals = np.genfromtxt("convergence.csv", delimiter=",", names=True)
assert set(residuals["step"]) == set(range(41))
E
)
say $? 'results.xdmf opens in meshio and agrees with results.h5; run.json, history.csv and convergence.csv are complete'
/usr/bin/python3 -c "
import h5py
with h5py.File('$work/gravity/rves.h5') as h5: assert sorted(h5['/rve']) == ['0000', '0063'] and h5['/rve/0063/radii'].shape[0] >= 150"
say $? 'the chosen material points are recorded, and no others'
"$granhom" plot "$work/distorted" -o "$work/pictures" >"$work/log" 2>&1 && [ "$(ls "$work"/pictures/*.png | wc -l)" = 4 ]
say $? 'granhom plot draws four pictures'
cp -r "$work/distorted" "$work/before"
"$granhom" run "$work/distorted.yaml" -o "$work/distorted" --quiet >"$work/log" 2>&1 && [ ! -s "$work/log" ]
say $? 'a second run into the same folder states nothing when quiet'
/usr/bin/python3 - "$work/before/results.h5" "$work/distorted/results.h5" <<'E'
import sys
import h5py
import numpy as np
with h5py.File(sys.argv[1]) as a, h5py.File(sys.argv[2]) as b:
    def same(name, item):
        if isinstance(item, h5py.Dataset) and not name.endswith("/seconds"):
            assert np.array_equal(item[()], b[name][()]), name
    a.visititems(same)
E
say $? 'and gives the same numbers to the last bit'
exit $failed
