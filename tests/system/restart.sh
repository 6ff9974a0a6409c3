#!/usr/bin/env bash
# Checkpoints: a run that is stopped and restarted leaves what an undisturbed run leaves; damaged and foreign checkpoints are refused.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, say
begin memory
has HDF5 "restarts" || exit 0
packings=$root/tests/data/cases/packings

# Every kind of load, supports that begin and end, friction, unsymmetric systems, packings in turn
cp "$packings/p20.data" "$packings/p50.data" .
cat >all.yaml <<'E'
packing: [p20.data, p50.data]
contact: {normal_stiffness: 50, friction_angle: 20}
micro: {boundary: restricted, engine: native}
start: {confinement: 0.3, follow: true}
mesh: {rectangle: {size: [10, 10], elements: [2, 2]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
gravity: [0, -0.0001]
results: {dump: [3]}
steps:
  - {name: press, increments: 3, supports: [{edge: bottom, fix: x}], pressure: [{edge: right, to: 0.32, follow: true}, {edge: top, to: 0.31}]}
  - {name: weight, increments: 2, gravity: {to: [0, -0.001]}, forces: [{set: top, to: [0.001, 0]}]}
  - {name: drive, increments: 4, displace: [{edge: top, y: -0.03}]}
  - {name: free, increments: 3, release: [{edge: top, free: y}], pressure: [{edge: top, to: 0.35}]}
E
# A footing whose load moves
cat >footing.yaml <<'E'
packing: p20.data
contact: {normal_stiffness: 50}
micro: {boundary: periodic, engine: native}
start: {balance: true}
mesh: {rectangle: {size: [10, 10], elements: [2, 2]}}
supports: [{edge: bottom, fix: both}]
steps:
  - {name: settle, increments: 3, footing: [{edge: top, force: [0, -0.1]}]}
  - {name: tilt, increments: 3, footing: [{edge: top, eccentricity: 1, force: [0.01, -0.2]}]}
E
cat >same.py <<'E'
"""same.py A B: the files of two runs, apart from seconds."""
import csv, json, os, sys
import h5py
import numpy as np
a, b = sys.argv[1:3]
for name in ("history.csv", "results.xdmf", "points.xdmf", "rves.h5", "dumps/point_3.dump", "dumps/point_3.contacts.dump"):
    if name[0] == "d" and not os.path.exists(f"{a}/{name}"):
        continue
    assert open(f"{a}/{name}", "rb").read() == open(f"{b}/{name}", "rb").read(), name
rows = [[{k: v for k, v in r.items() if k != "seconds"} for r in csv.DictReader(open(f"{d}/convergence.csv"))] for d in (a, b)]
assert rows[0] == rows[1], "convergence.csv"
times = [[(r["step"], r["evaluations"]) for r in csv.DictReader(open(f"{d}/timing.csv"))] for d in (a, b)]
assert times[0] == times[1], "timing.csv"
for file in ("results.h5", "traces.h5"):
    with h5py.File(f"{a}/{file}") as x, h5py.File(f"{b}/{file}") as y:
        names = []
        y.visit(names.append)
        def check(name, item):
            names.remove(name)
            if isinstance(item, h5py.Dataset) and not name.endswith("/seconds"):
                assert np.array_equal(item[()], y[name][()]), name
        x.visititems(check)
        assert not names, names
sums = [json.load(open(f"{d}/run.json")) for d in (a, b)]
points = [[s["summary"]["farm"][key] for key in ("evaluations", "pair_evaluations")] for s in sums]
work = [[s["summary"].pop(key) for key in ("evaluations", "relaxation_steps", "factorisations", "pair_evaluations")] for s in sums]
for list in (points, work):
    assert all(0 < x <= y for x, y in zip(*list)), list  # what was begun twice counts twice
for s in sums:
    s["summary"].pop("seconds"), s["summary"].pop("farm")
    s["error"].get("estimate", {}).pop("extra_seconds", 0)
assert sums[0]["summary"] == sums[1]["summary"] and sums[1]["status"] == "done", [s["summary"] for s in sums]
assert sums[0]["error"] == sums[1]["error"], [s["error"] for s in sums]
E
same() { /usr/bin/python3 same.py "$1" "$2" 2>err; say $? "$3"; }

"$granhom" run all.yaml -o whole --quiet 2>err; code=$?; say $code 'the undisturbed run'; [ $code = 0 ] || exit 1

# go DIR SIGNAL OPTIONS: stopped and restarted again and again until it is done; stops: how often it was stopped
go() {
  local dir=$1 signal=$2 code=1
  shift 2
  stops=0
  while [ $stops -lt 40 ]; do
    local lines
    lines=$(wc -l 2>/dev/null <"$dir/history.csv" || echo 0)
    "$granhom" run "${scene:-all.yaml}" -o "$dir" --quiet --restart "$@" 2>err &
    local pid=$!
    for _ in $(seq 300); do # until there is another row
      [ "$(wc -l 2>/dev/null <"$dir/history.csv" || echo 0)" -gt "$lines" ] && break
      kill -0 $pid 2>/dev/null || break
      sleep 0.01
    done
    kill -$signal $pid 2>/dev/null
    wait $pid; code=$?
    [ $code = 0 ] && break
    [ $code = 1 ] && grep -q '^granhom: stopped on request .*--restart continues' err || break
    stops=$((stops + 1))
  done
  return $code
}
go term TERM; say $? "stopped by SIGTERM and restarted $stops times"
[ $stops -gt 3 ]; say $? 'which were more than three'
same whole term 'all files are those of the undisturbed run'
go int INT --checkpoint-every 4 --no-share; say $? "stopped by SIGINT and restarted $stops times, with a checkpoint each 4 increments, no sharing"
[ $stops -gt 3 ]; say $? 'which were more than three: stopping writes one too'
same whole int 'all files are those of the undisturbed run'

"$granhom" run footing.yaml -o footed --quiet 2>err; say $? 'the undisturbed run with a footing'
scene=footing.yaml go foot TERM; say $? "stopped by SIGTERM and restarted $stops times"
same footed foot 'all files are those of the undisturbed run'

# two paths are compared: both have to survive
"$granhom" run all.yaml -o estimated --estimate-error --quiet 2>err; say $? 'the undisturbed run with an estimate of its error'
unset scene
go twice TERM --estimate-error; say $? "stopped by SIGTERM and restarted $stops times"
[ $stops -gt 3 ]; say $? 'which were more than three'
same estimated twice 'all files are those of the undisturbed run'
go each INT --estimate-error --no-share --checkpoint-every 3; say $? "stopped by SIGINT and restarted $stops times, with a checkpoint each 3 increments, no sharing"
same estimated each 'all files are those of the undisturbed run'
"$granhom" run all.yaml -o estimated --restart --quiet 2>err
[ $? = 2 ] && grep -q 'was made with another choice of --estimate-error' err; say $? 'continuing without the estimate is refused'

# --- the file itself ---
"$granhom" run all.yaml -o term --quiet --restart 2>err; say $? 'restarting a complete run does nothing'
same whole term 'and changes nothing'
# refused WORDS NAME: exit 2, WORDS in the message, nothing written
refused() {
  local before=$(find r -type f | sort | xargs cksum)
  "$granhom" run "${scene:-all.yaml}" -o r --quiet --restart ${engine:+--engine $engine} 2>err
  [ $? = 2 ] && [ "$(grep -c '^granhom' err)" = 1 ] && grep -q "$1" err && [ "$before" = "$(find r -type f | sort | xargs cksum)" ]; say $? "$2"
}
fresh() { rm -rf r; cp -r whole r; }
fresh
sed 's/to: 0.35/to: 0.36/' all.yaml >other.yaml
scene=other.yaml refused 'r/checkpoint.h5: cannot continue from this checkpoint: it belongs to another scene file' 'another scene is refused'
engine=lammps refused 'another engine' 'another engine is refused'
cp p20.data keep.data
sed '/^Atoms/,$ s/^\([0-9]* [0-9]* [^ ]* [^ ]* [^ ]*\)\([0-9]\) /\11 /' keep.data >p20.data
cmp -s p20.data keep.data && sed -i '$ s/\([0-9]\) *$/\14/' p20.data
refused 'belongs to other packings' 'another packing is refused'
cp keep.data p20.data
head -c 20000 whole/checkpoint.h5 >r/checkpoint.h5; refused 'r/checkpoint.h5: is damaged: it has 20000 bytes instead of' 'a truncated file is refused'
: >r/checkpoint.h5; refused 'the file is empty' 'an empty file is refused'
cp p50.data r/checkpoint.h5; refused 'is damaged, or no binary file of granhom' 'a file of another kind is refused'
cp whole/results.h5 r/checkpoint.h5; refused 'holds a results 1 of granhom, wanted is a checkpoint 6' 'another HDF5 file is refused'
fresh; rm r/results.h5; refused 'r/results.h5: No such file' 'missing results are reported'
cat >flip.py <<'E'
"""flip.py FILE SEED: turns one random bit of the numbers."""
import random, sys
import h5py
path, seed = sys.argv[1], int(sys.argv[2])
random.seed(seed)
places = []
with h5py.File(path) as h5:
    def note(name, d):
        if isinstance(d, h5py.Dataset): # the 0 behind a text counts for nothing
            places.append((d.id.get_offset(), d.id.get_storage_size() - (d.dtype.kind in "SO")))
    h5.visititems(note)
offset, size = random.choice(places)
at = offset + random.randrange(size)
data = bytearray(open(path, "rb").read())
data[at] ^= 1 << random.randrange(8)
open(path, "wb").write(data)
E
seed=$(date +%s)
echo "# seed $seed"
missed=0
for k in 1 2 3 4 5 6 7 8 9 10; do
  fresh
  /usr/bin/python3 flip.py r/checkpoint.h5 $((seed + k))
  "$granhom" run all.yaml -o r --quiet --restart 2>err
  [ $? = 2 ] || { missed=1; echo "# not refused: seed $((seed + k))"; }
done
say $missed 'a checkpoint with a wrong bit is refused, ten times'
fresh; rm r/checkpoint.h5
"$granhom" run all.yaml -o r --quiet --restart 2>err; say $? 'without a checkpoint the run begins at the start'
grep -q '^warning: there is no checkpoint' err; say $? 'and states so'
same whole r 'with the same result'
for option in 0 x -1; do
  "$granhom" run all.yaml -o r --checkpoint-every $option 2>err
  [ $? = 2 ] && grep -qF -- "--checkpoint-every must be an integer from 1 to 1000000000, not \"$option\"" err; say $? "--checkpoint-every $option: exit 2"
done
exit $bad
