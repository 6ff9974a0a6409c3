#!/usr/bin/env bash
# Scenes on several ranks: the same numbers to the last bit, errors told once with the right exit status, nobody hangs.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, say
begin
{ has MPI "runs on ranks" && has HDF5 "runs on ranks"; } || exit 0
packings=$root/tests/data/cases/packings
same() { cmp -s "$1/history.csv" "$2/history.csv" && cmp -s "$1/rves.h5" "$2/rves.h5"; say $? "$3"; }

scene() { # scene BOUNDARY PACKING MICRO
  cat <<Y
packing: $2
contact: {normal_stiffness: 50}
micro: {boundary: $1, engine: native$3}
start: {confinement: 0.3}
mesh: {rectangle: {size: [10, 10], elements: [3, 2]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps:
  - {name: hold, increments: 1, pressure: [{edge: right, to: 0.3}, {edge: top, to: 0.3}]}
  - {name: shear, increments: 4, displace: [{edge: top, x: 0.05}]}
Y
}
scene periodic "$packings/p50.data" '' >periodic.yaml
scene periodic "$packings/p50.data" ', resident: 2, relaxation: fire' >fire.yaml
scene periodic "$packings/p50.data" ', resident: 2' >pool.yaml
scene taylor "[$packings/p20.data, $packings/p50.data, $packings/p50d.data]" '' >list.yaml
scene taylor "{ensemble: [$packings/p20.data, $packings/p50.data, $packings/p50d.data], seed: 5}" '' >drawn.yaml

# --- one process ---
for name in periodic pool list drawn fire; do
  "$granhom" run $name.yaml -o $name --quiet 2>err; say $? "$name runs"
done
same periodic pool 'a pool of two RVEs gives the numbers of twenty-four'
"$granhom" run periodic.yaml -o no_share --quiet --no-share 2>err
same periodic no_share '--no-share gives the same numbers'
/usr/bin/python3 - <<'E'
import json
import h5py
def farm(name):
    return json.load(open(f"{name}/run.json"))["summary"]["farm"]
assert farm("no_share")["computed"] == farm("no_share")["evaluations"] == farm("periodic")["evaluations"]
assert farm("periodic")["computed"] < farm("periodic")["evaluations"] and farm("pool")["rves_kept_ready"] == 2
with h5py.File("list/results.h5") as h5:
    assert list(h5["/mesh/packing"][:]) == [0, 1, 2] * 8
run = json.load(open("drawn/run.json"))["packings"]
with h5py.File("drawn/results.h5") as h5:
    assert list(h5["/mesh/packing"][:]) == run["of_point"] and set(run["of_point"]) == {0, 1, 2} and run["seed"] == 5
ways = [json.load(open(f"{name}/run.json"))["options"]["micro"]["relaxation"] for name in ("periodic", "fire")]
assert ways == ["polished", "fire"], ways
assert [f["points"] for f in run["files"]] == [run["of_point"].count(k) for k in range(3)]
assert [f["grains"] for f in run["files"]] == [20, 50, 50]
E
say $? 'run.json and results.h5 say what was shared, kept, and which packing is where'
"$granhom" run list.yaml --explain >said 2>err
grep -q '24, of 3 packings in turn' said && grep -q '24 points begin as 3 different RVEs' said; say $? '--explain states packings and groups'
"$granhom" run drawn.yaml --explain --no-share >said 2>err
grep -q 'drawn by the seed 5' said && grep -q 'each of the 24 points is computed' said; say $? '--explain states the seed and that nothing is shared'

# wrong PACKING WORDS: refused with the line
wrong() {
  scene taylor "$1" '' >wrong.yaml
  "$granhom" run wrong.yaml -o wrong 2>err
  [ $? = 2 ] && grep -q "^granhom: wrong.yaml:1: .*$2" err && [ ! -e wrong ]; say $? "$2: exit 2 with the line"
}
wrong '[]' 'packing is an empty list'
wrong "[$packings/p20.data, none.data]" 'packing: ./none.data: cannot be opened'
wrong "{ensemble: [$packings/p20.data]}" "packing needs the key 'seed'"
wrong "{ensemble: $packings/p20.data, seed: 1}" 'ensemble must be a list'
wrong "{ensemble: [$packings/p20.data], seed: x}" 'seed'

# --- several ranks ---
if ! command -v mpirun >/dev/null || ! mpirun -n 2 true 2>err; then
  echo 'skip - mpirun does not start here'
  exit $bad
fi
for n in 1 2 3 8; do
  mpirun -n $n "$granhom" run periodic.yaml -o on$n --quiet 2>err; say $? "$n ranks: exit 0"
  same periodic on$n "$n ranks give the numbers of one process"
done
/usr/bin/python3 - <<'E'
import json
def counts(name):
    s = json.load(open(f"{name}/run.json"))["summary"]
    return s["pair_evaluations"], s["farm"]["pair_evaluations"]
done, points = counts("periodic")
assert 0 < done < points, (done, points)  # points that share are computed once
assert all(counts(f"on{n}") == (done, points) for n in (1, 2, 3, 8)), [counts(f"on{n}") for n in (1, 2, 3, 8)]
assert counts("no_share")[1] == points and counts("pool")[1] == points
E
say $? 'run.json has the same number of pair evaluations on any number of ranks'
mpirun -n 3 "$granhom" run pool.yaml -o pool3 --quiet --no-balance --no-share 2>err
same periodic pool3 '3 ranks without balance and sharing, two RVEs each: the same numbers'
mpirun -n 3 "$granhom" run drawn.yaml -o drawn3 --quiet 2>err
same drawn drawn3 '3 ranks with three packings: the same numbers'

# each ARGUMENTS: on three ranks; ended CODE WORDS NAME: all ended with CODE, and WORDS are in granhom's only message
cat >each.sh <<'E'
"$@"
echo $? >code.$OMPI_COMM_WORLD_RANK
E
each() { rm -f code.*; timeout 60 mpirun -n 3 sh each.sh "$granhom" run "$@" --quiet >said 2>err; }
ended() {
  [ "$(cat code.0 code.1 code.2 | tr '\n' ' ')" = "$1 $1 $1 " ] && [ "$(grep -c '^granhom' err)" = 1 ] && grep -q "^granhom.*$2" err
  say $? "$3"
}
each none.yaml -o no; ended 2 'none.yaml: cannot be opened' 'a missing scene on three ranks: exit 2 on all, told once'
each periodic.yaml; ended 2 '-o DIR is needed' 'a missing option likewise'
[ ! -e no ]; say $? 'and nothing is written'
sed -e 's/, engine: native/&, max_steps: 3/' -e 's/^steps/solver: {cut_steps: 1}\n&/' periodic.yaml >few.yaml
each few.yaml -o few
ended 1 'integration point 0: no equilibrium within' 'an RVE that fails is named by its point: exit 1 on all'
sed -e 's/increments: 4/increments: 4000/' periodic.yaml >long.yaml
mpirun -n 3 sh -c 'echo $$ >pid.$OMPI_COMM_WORLD_RANK; exec "$@"' sh "$granhom" run long.yaml -o long --quiet >said 2>err &
job=$!
for _ in $(seq 200); do [ "$(wc -l 2>/dev/null <long/history.csv || echo 0)" -gt 3 ] && break; sleep 0.1; done
kill -TERM "$(cat pid.2)" # one rank alone: the others hear of it
timeout 20 tail --pid=$job -f /dev/null; wait $job; code=$?
[ $code = 1 ] && [ "$(grep -c '^granhom: stopped on request at increment' err)" = 1 ]; say $? 'SIGTERM to one rank ends all, with one message and exit 1'
[ "$(/usr/bin/python3 -c 'import json; print(json.load(open("long/run.json"))["status"])')" = stopped ]; say $? 'and run.json states so'
exit $bad
