#!/bin/sh
# A footing from scene to results: balance and rigidity read from the files by h5py. SPDX-License-Identifier: GPL-2.0-or-later
set -u
granhom=${BUILD:-build}/granhom
"$granhom" --version | grep -q '^HDF5 yes' || { echo "skip - a footing in the results (no HDF5)"; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
say() { if [ "$1" = 0 ]; then echo "ok - $2"; else echo "not ok - $2"; failed=1; fi; }

for boundary in taylor restricted; do
  cat >"$work/$boundary.yaml" <<E
packing: $(pwd)/tests/data/cases/packings/p50.data
contact: {normal_stiffness: 50}
micro: {boundary: $boundary, engine: native}
start: {balance: true}
mesh: {rectangle: {size: [10, 5], elements: [6, 3]}}
supports: [{edge: bottom, fix: both}]
steps:
  - {name: weight, increments: 1, gravity: [0, -0.01], footing: [{edge: top, force: [0, 0]}]}
  - {name: load, increments: 4, footing: [{edge: top, force: [0.1, -2], eccentricity: -1.5}]}
solver: {tolerance: 1e-10}
output: {rves: none}
E
  "$granhom" run "$work/$boundary.yaml" -o "$work/$boundary" >"$work/log" 2>&1
  say $? "$boundary: a block under a footing runs"
  /usr/bin/python3 - "$work/$boundary" <<'E'
import csv
import sys
import h5py
import numpy as np

folder = sys.argv[1]
rows = list(csv.DictReader(open(folder + "/history.csv")))
last = {k: float(v) for k, v in rows[-1].items() if k != "name"}
with h5py.File(folder + "/results.h5") as f:
    X = f["/mesh/coordinates"][:, :2]
    u = f["/step0005/displacement"][:, :2]
    r = f["/step0005/reaction"][:, :2]
x = X + u
top = X[:, 1] == 5
ends = [np.flatnonzero(top & (X[:, 0] == e))[0] for e in (0, 10)]
chord = (x[ends[1]] - x[ends[0]]) / 10
middle = x[ends].mean(axis=0)
point = middle - 1.5 * chord
arm = x[top] - point
force = r[top].sum(axis=0)
moment = (arm[:, 0] * r[top, 1] - arm[:, 1] * r[top, 0]).sum()
turned = np.outer(X[top, 0] - 5, chord) + middle
assert abs(x[top] - turned).max() < 1e-12, "the footing is not rigid"
assert abs(np.hypot(*chord) - 1) < 1e-13, "the footing has stretched"
assert abs(force - [0.1, -2]).max() < 1e-9, force
assert abs(moment) < 1e-8, moment
assert last["footing_turn_top"] > 1e-3 and abs(np.arctan2(chord[1], chord[0]) - last["footing_turn_top"]) < 1e-12
assert abs(middle - [5, 5] - [last["footing_ux_top"], last["footing_uy_top"]]).max() < 1e-12
assert (last["footing_fx_top"], last["footing_fy_top"]) == (0.1, -2)
assert abs(np.array([last["top_x"], last["top_y"]]) - force).max() < 1e-12
first = {k: float(v) for k, v in rows[1].items() if k != "name"}
assert first["footing_fy_top"] == 0 and first["footing_uy_top"] < 0 and abs(first["top_y"]) < 1e-9
E
  say $? "$boundary: the footing is rigid, forces and moments balance, and history.csv states the same"
done
"$granhom" run "$work/taylor.yaml" --explain 2>&1 | grep -q "rigid footing on 'top'"
say $? '--explain names the footing'
"$granhom" plot "$work/taylor" >/dev/null 2>&1 && [ -s "$work/taylor/curves.png" ]
say $? 'curves over the settlement are drawn'
sed 's/edge: bottom, fix: both}/edge: bottom, fix: both}, {edge: left, fix: x}/' "$work/taylor.yaml" >"$work/held.yaml"
"$granhom" run "$work/held.yaml" -o "$work/held" >/dev/null 2>"$work/err"
[ $? = 2 ] && [ ! -e "$work/held" ] && grep -q "held.yaml:8: the footing on 'top' cannot move its node at (0, 5)" "$work/err"
say $? 'a footing on a supported node is refused with file and line'
exit $failed
