#!/usr/bin/env bash
# Explicit relaxation of scenes: Newton's solution from stresses alone, the same on ranks and after a restart; what does not come to rest, and wrong keys.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, say
begin
packings=$root/tests/data/cases/packings

scene() { # scene BOUNDARY SOLVER MICRO
  cat <<Y
packing: [$packings/p20.data, $packings/p50.data]
contact: {normal_stiffness: 50}
micro: {boundary: $1, engine: native$3}
start: {confinement: 0.3, follow: true}
mesh: {rectangle: {size: [10, 10], elements: [2, 2]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps:
  - {name: press, increments: 2, pressure: [{edge: right, to: 0.32, follow: true}, {edge: top, to: 0.31}]}
  - {name: drive, increments: 4, displace: [{edge: top, y: -0.03}]}
solver: {$2}
Y
}
scene taylor 'tolerance: 1e-11' '' >newton.yaml
scene taylor 'method: relaxation' '' >default.yaml
scene taylor 'method: relaxation, damping_ratio: 1, safety: 0.5, tolerance: 1e-6' '' >fine.yaml
scene taylor 'method: relaxation, max_iterations: 4, cut_steps: 2' '' >short.yaml
scene periodic 'method: relaxation' ', relaxation: damped' >periodic.yaml
scene taylor 'method: automatic' '' >automatic.yaml

for name in newton default fine periodic automatic; do
  "$granhom" run $name.yaml -o $name >$name.out 2>&1; say $? "$name runs to its end"
done
/usr/bin/python3 - 2>err <<'E'
import csv, json
def rows(name):
    return [{k: float(v) for k, v in r.items() if k != "name"} for r in csv.DictReader(open(f"{name}/history.csv"))]
newton = rows("newton")
largest = max(abs(r["bottom_y"]) for r in newton)
for name, tolerance in (("default", 1e-3), ("fine", 1e-6), ("automatic", 1e-8)):
    ours = rows(name)
    assert len(ours) == len(newton) == 7
    off = max(abs(a[c] - b[c]) for a, b in zip(ours, newton) for c in ("top_y", "bottom_y", "left_x")) / largest
    assert off <= 10 * tolerance, (name, off)
    assert all(r["residual"] <= tolerance for r in ours), name
    steps = [r["relaxed"] == r["iterations"] > 0 for r in ours]
    assert all(steps) if name != "automatic" else not any(steps), name
    assert all((r["min_acoustic"] != r["min_acoustic"]) == (name != "automatic") for r in ours)
assert "relaxed" not in newton[0]
# Packings that relax without factorising: there is no tangent, then, either
assert all(r["micro_factorisations"] == 0 < r["micro_evaluations"] for r in rows("periodic"))
lines = list(csv.DictReader(open("fine/convergence.csv")))
last = {r["step"]: r for r in lines}
assert all(float(r["kinetic"]) <= 1e-6 and float(r["relative"]) <= 1e-6 and r["step_length"] == "0.5" for r in last.values())
assert all(float(r["kinetic"]) == 0 for r in csv.DictReader(open("newton/convergence.csv")))
run = json.load(open("fine/run.json"))
solver, summary = run["options"]["solver"], run["summary"]
assert (solver["method"], solver["damping_ratio"], solver["safety"], solver["tolerance"]) == ("relaxation", 1, 0.5, 1e-6), solver
assert summary["relaxation_iterations"] == summary["iterations"] == sum(r["relaxed"] for r in rows("fine"))
assert summary["relaxation_increments"] == 7, summary
assert json.load(open("default/run.json"))["options"]["solver"]["tolerance"] == 1e-3
assert json.load(open("automatic/run.json"))["summary"]["relaxation_iterations"] == 0
E
say $? 'Newton and relaxation agree to ten times its tolerance; residuals, energies and counts; no factorisation, no tangent'
grep -q 'of the iterations, in 7 increments, were steps of explicit relaxation' fine.out; say $? 'the summary states how much was relaxation'
grep -q 'kinetic energy over work' fine.out; say $? 'a line of progress with both measures'
"$granhom" run fine.yaml --explain | grep -q 'damped central differences'; say $? '--explain states that the solver is relaxation'
"$granhom" run newton.yaml --explain | grep -q 'Newton with'; say $? '--explain states that the solver is Newton'
"$granhom" report fine -o report >said.err 2>&1; say $? 'a report without acoustic tensors'
! grep -q 'Elliptic\|acoustic eigenvalue' report; say $? 'which makes no statement on ellipticity'

"$granhom" run short.yaml -o short --quiet >/dev/null 2>err
[ $? = 1 ] && grep -q 'no equilibrium after 2 bisections.*does not come to rest in 4 steps: relative residual' err
say $? 'what does not come to rest is cut, ends with status 1 and states so'

wrong() { # wrong SOLVER MESSAGE
  scene taylor "$1" '' >wrong.yaml
  "$granhom" run wrong.yaml -o wrong --quiet >/dev/null 2>err
  [ $? = 2 ] && grep -q "wrong.yaml:10: .*$2" err && [ ! -e wrong ]
  say $? "refused: $1"
}
wrong 'method: explicit' 'none of newton, relaxation, automatic'
wrong 'method: relaxation, damping_ratio: 0' 'damping_ratio'
wrong 'method: relaxation, damping_ratio: -1' 'damping_ratio'
wrong 'method: automatic, damping_ratio: .nan' 'damping_ratio'
wrong 'method: relaxation, safety: 0' 'safety'
wrong 'method: relaxation, safety: 1' 'safety'
wrong 'method: relaxation, safety: fast' 'safety'
wrong 'method: relaxation, tolerance: 1' 'tolerance'
wrong 'method: relaxation, tangent: frozen' 'belongs to Newton'
wrong 'safety: 0.5' 'needs .method: relaxation'

if has HDF5 'restarts of relaxation'; then
  stops=0
  while [ $stops -lt 20 ]; do # stopped as soon as there is another increment, and continued
    lines=$(wc -l 2>/dev/null <again/history.csv || echo 0)
    "$granhom" run fine.yaml -o again --quiet --restart 2>err &
    pid=$!
    while kill -0 $pid 2>/dev/null && [ "$(wc -l 2>/dev/null <again/history.csv || echo 0)" -le "$lines" ]; do sleep 0.01; done
    kill -TERM $pid 2>/dev/null
    wait $pid && break
    stops=$((stops + 1))
  done
  [ $stops -gt 1 ] && cmp -s fine/history.csv again/history.csv && cmp -s fine/rves.h5 again/rves.h5
  say $? "stopped $stops times and restarted: the same to the last bit"
fi
if has MPI 'relaxation on ranks'; then
  for name in fine periodic; do
    mpirun -n 2 "$granhom" run $name.yaml -o ranks_$name --quiet 2>err; say $? "$name runs on two ranks"
    cmp -s $name/history.csv ranks_$name/history.csv; say $? "$name: the same to the last bit on two ranks"
  done
fi
exit $bad
