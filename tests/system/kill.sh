#!/bin/sh
# A run that is killed at any moment leaves the complete increments readable; a run that is asked to stop states so and ends with exit status 1.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
granhom=$(cd "${BUILD:-build}" && pwd)/granhom
"$granhom" --version | grep -q '^HDF5 yes' || { echo "skip - results of killed runs (no HDF5)"; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
say() { if [ "$1" = 0 ]; then echo "ok - $2"; else echo "not ok - $2"; failed=1; fi; }

# 2000 short increments, so that the end does not come before the signal
sed -e 's/increments: 30/increments: 2000/' -e "s|sand150.data|$(pwd)/scenes/block/sand150.data|" scenes/block/p02_taylor.yaml >"$work/long.yaml"
cat >"$work/check.py" <<'E'
import csv, json, os, sys
import h5py
import meshio
os.chdir(sys.argv[1])
rows = list(csv.DictReader(open("history.csv")))
assert len(rows) > 0 and all(None not in r.values() and None not in r for r in rows)
with h5py.File("results.h5") as h5:
    steps = [name for name in h5 if name.startswith("step")]
    assert len(rows) <= len(steps) <= len(rows) + 1, (len(rows), len(steps))
    for name in steps:
        assert h5[f"{name}/points/acoustic"][:].shape == (36,) and h5[f"{name}/displacement"][:].shape == (16, 3)
with meshio.xdmf.TimeSeriesReader("results.xdmf") as reader:
    reader.read_points_cells()
    assert len(rows) <= reader.num_steps <= len(steps)
    reader.read_data(reader.num_steps - 1)
with h5py.File("rves.h5") as h5:
    assert len(h5["/rve"]) == 36
assert json.load(open("run.json"))["status"] == sys.argv[2]
E

# waits until the run has written some increments: begun FOLDER LINES
begun() {
  for _ in $(seq 300); do
    [ "$(wc -l 2>/dev/null <"$1/history.csv" || echo 0)" -gt "$2" ] && return 0
    sleep 0.1
  done
  return 1
}

for delay in 0 0.013 0.029; do
  "$granhom" run "$work/long.yaml" -o "$work/kill$delay" --quiet >/dev/null 2>&1 &
  pid=$!
  begun "$work/kill$delay" 5; say $? "the run is under way ($delay)"
  sleep $delay
  kill -9 $pid
  wait $pid 2>/dev/null
  /usr/bin/python3 "$work/check.py" "$work/kill$delay" running; say $? "killed after $delay s: all complete increments are readable"
done

# stop SCENE NAME SIGNAL: within an increment
stop() {
  "$granhom" run "$1" -o "$work/stop$2" --quiet >/dev/null 2>"$work/err" &
  pid=$!
  begun "$work/stop$2" 1; say $? "the run is under way ($2)"
  sleep 0.3
  asked=$(date +%s%N)
  kill "-$3" $pid
  wait $pid
  [ $? = 1 ]; say $? "$2: a run that is asked to stop ($3) ends with exit status 1"
  took=$((($(date +%s%N) - asked) / 1000000))
  [ $took -lt 3000 ]; say $? "$2: it ends within 3 s ($took ms)"
  [ "$(grep -c '^granhom: stopped on request at increment' "$work/err")" = 1 ]; say $? "$2: and states so, with the increment"
  /usr/bin/python3 "$work/check.py" "$work/stop$2" stopped; say $? "$2: and leaves complete results"
}
stop "$work/long.yaml" taylor TERM
stop scenes/block/p02_restricted.yaml restricted TERM
exit $failed
