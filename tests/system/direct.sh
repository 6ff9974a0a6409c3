#!/usr/bin/env bash
# granhom direct: columns of `run`, balance, restart to the last bit, engines, specimens, refusals.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, check, say, refused_by
begin memory
packings=$root/tests/data/cases/packings
cp "$packings/p150.data" .
cat >scene.yaml <<'E2'
packing: p150.data
contact: {normal_stiffness: 50, friction_angle: 20}
micro: {boundary: taylor, engine: native, tolerance: 1e-9}
start: {confinement: 0.3}
mesh: {rectangle: {size: [20, 30], elements: [2, 3]}}
supports: [{edge: bottom, fix: both}, {edge: top, fix: x}]
results: {dump: [3]}
steps:
  - {name: press, increments: 2, pressure: [{edge: left, to: 0.4, follow: true}, {edge: right, to: 0.4, follow: true}, {edge: top, to: 0.4}]}
  - {name: drive, increments: 3, supports: [{edge: top, fix: y}], displace: [{edge: top, y: -0.3}]}
  - {name: free, increments: 2, release: [{edge: top, free: y}], gravity: {to: [0, -0.001]}}
E2
sed 's/{edge: bottom, fix: both}/{edge: bottom, fix: y}, {set: left, fix: x}/; s/, {edge: top, fix: x}\]/]/; s/, friction_angle: 20//' scene.yaml >smooth.yaml

"$granhom" direct scene.yaml -o a --grains 200 --tile >said 2>err
say $? "a scene with pressures, a driven edge, a release and gravity runs to its end"
check "the summary states what was done" grep -qE '^3 of 3 steps, 7 increments of [0-9]+ grains' said
"$granhom" run scene.yaml -o fem --quiet
cat >columns.py <<'E2'
import csv, json, sys
rows = list(csv.DictReader(open("a/history.csv")))
fem = list(csv.DictReader(open("fem/history.csv")))
assert len(rows) == 8 and set(rows[0]) <= set(fem[0]), set(rows[0]) - set(fem[0])
assert {"top_y", "p_left", "uy_top", "dilatancy", "residual", "coordination", "anisotropy", "outer_work"} <= set(rows[0])
for r, f in zip(rows, fem):
    for name in r:
        if name[:2] in ("p_", "gx", "gy"):
            assert abs(float(r[name]) - float(f[name])) < 1e-12, (name, r[name], f[name])
    assert float(r["residual"]) <= 1.0000001e-9
at = {r["name"] + r["increment"]: {k: float(v) for k, v in r.items() if k != "name"} for r in rows}
press, free = at["press2"], at["free2"]
assert abs(press["bottom_y"] - 0.4 * 20) < 0.02 * 8, press["bottom_y"]  # followers lean
assert abs(free["bottom_y"] - 0.4 * 20 - 0.001 * 600) < 0.05 * 8, free["bottom_y"]
assert abs(at["drive3"]["bottom_y"] + at["drive3"]["top_y"] - 0.4 * 20) < 0.05 * 8
assert at["drive3"]["bottom_y"] > press["bottom_y"] and 2 < press["coordination"] < 5
assert abs(at["drive3"]["uy_top"] + 0.3) < 1e-15
run = json.load(open("a/run.json"))
assert run["status"] == "done" and run["options"]["direct"]["tile"] is True and run["driven"]["set"] == "top"
E2
/usr/bin/python3 columns.py 2>err
say $? "history.csv has names of run's, the prescribed values, and reactions that balance the loads"
check "the dump has all grains at all increments" test "$(grep -c '^ITEM: TIMESTEP' a/dumps/point_0.dump)" = 8

"$granhom" direct scene.yaml -o b --grains 200 --tile --quiet --engine lammps
say $? "the same with LAMMPS"
/usr/bin/python3 - 2>err <<'E2'
import csv
import os
assert os.path.exists("b/history.csv")
a, b = (list(csv.DictReader(open(f"{d}/history.csv"))) for d in "ab")
for r, s in zip(a[:2], b[:2]):
    for name in ("bottom_y", "top_x", "dilatancy", "coordination"):
        assert abs(float(r[name]) - float(s[name])) <= 1e-4 * max(1, abs(float(r[name]))), (name, r[name], s[name])
E2
say $? "both engines agree"

if has HDF5 "restarts of a direct simulation"; then
  "$granhom" direct scene.yaml -o c --grains 200 --tile --quiet 2>/dev/null &
  pid=$!
  for _ in $(seq 600); do
    [ -s c/history.csv ] && [ "$(wc -l <c/history.csv)" -ge 4 ] && break
    sleep 0.05
  done
  kill -INT $pid 2>/dev/null
  wait $pid
  "$granhom" direct scene.yaml -o c --grains 200 --tile --restart --quiet 2>err
  say $? "a stopped simulation is continued"
  for f in history.csv dumps/point_0.dump dumps/point_0.contacts.dump; do
    check "  $f is that of an undisturbed one to the last bit" cmp a/$f c/$f
  done
  "$granhom" direct scene.yaml -o c --grains 210 --tile --restart --quiet 2>err
  [ $? = 2 ] && grep -q 'other grains' err
  say $? "a checkpoint of other grains is refused"
  check "results.h5 has stresses that carry the load" /usr/bin/python3 -c "
import h5py
with h5py.File('a/results.h5') as h:
    s = h['/step0002/cells/cauchy'][:]
    assert abs(s[:, 4].mean() + 0.4) < 0.08 and abs(s[:, 0].mean() + 0.4) < 0.08, s.mean(axis=0)
    assert abs(h['/step0005/displacement'][-1][1] + 0.3) < 1e-12"
fi

"$granhom" direct smooth.yaml -o grown --grains 150 --quiet 2>err
say $? "a packing is grown for the outline"
"$granhom" direct smooth.yaml -o other --grains 150 --seed 2 --quiet 2>err
cmp -s grown/history.csv other/history.csv
[ $? = 1 ]
say $? "another seed is another specimen"

sed 's/tolerance: 1e-9/tolerance: 1e-9, max_steps: 400/' scene.yaml >few.yaml
"$granhom" direct few.yaml -o few --grains 200 --tile --quiet 2>err
[ $? = 1 ] && grep -q 'no equilibrium within' err
say $? "too few relaxation steps: exit 1 with the residual and the grain"

cat >footing.yaml <<'E2'
packing: p150.data
contact: {normal_stiffness: 50}
start: {balance: true}
mesh: {rectangle: {size: [20, 30], elements: [2, 3]}}
supports: [{edge: bottom, fix: both}]
steps: [{name: load, increments: 1, footing: [{edge: top, force: [0, -1]}]}]
E2
sed 's/size: \[20, 30\], elements: \[2, 3\]/size: [1000, 1], elements: [2, 1]/' scene.yaml >thin.yaml
sed '/^start/d; /name: press/d; /name: free/d' scene.yaml >loose.yaml
refused_by direct "a footing" "a direct simulation has no footings" ../footing.yaml -o x
refused_by direct "more grains than memory" "GB of memory" ../scene.yaml -o x --grains 100000000
refused_by direct "an outline that is too thin" "the outline takes 0 grains" ../thin.yaml -o x --tile --grains 10
refused_by direct "a packing under stress without a load" "grains only push" ../loose.yaml -o x --tile
if has MPI "more than one rank"; then
  mpirun -n 2 "$granhom" direct scene.yaml -o x --tile 2>err
  [ $? = 2 ] && [ ! -e x ]
  say $? "more than one rank is refused"
fi
exit $bad
