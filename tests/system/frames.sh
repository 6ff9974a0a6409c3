#!/usr/bin/env bash
# Conditions on a frame through the program: columns, both engines, states, scenes on two ranks and after a stop, wrong input.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, say
begin
packings=$root/tests/data/cases/packings
cp "$packings/p50d.data" "$packings/p20.data" .
printf 'step,F11,F12,F21,F22\n0,1,0,0,1\n1,0.999,0.001,0,0.999\n2,0.998,0.002,0,0.998\n' >path.csv
friction='--friction-coefficient 0.4 --normal-stiffness 100'

# --- one material point ---
for boundary in displacement frame-periodic traction 'mixed --mixed x=traction,y=displacement' 'servo-periodic --servo-acceleration 5'; do
  name=${boundary%% *}
  for engine in native lammps; do
    # shellcheck disable=SC2086
    "$granhom" rve p50d.data --path path.csv --boundary $boundary $friction --engine $engine --dump $name.dump -o $name.$engine.csv 2>err
    say $? "rve --boundary $boundary, $engine"
  done
done
# shellcheck disable=SC2086
"$granhom" rve p50d.data --path path.csv --boundary periodic $friction --engine native -o periodic.csv 2>err
/usr/bin/python3 - <<'E'
import csv
def last(name):
    return {k: float(v) for k, v in list(csv.DictReader(open(name)))[-1].items()}
names = ["displacement", "frame-periodic", "traction", "mixed", "servo-periodic"]
rows = {n: last(n + ".native.csv") for n in names}
periodic = last("periodic.csv")
for n in names:
    other = last(n + ".lammps.csv")
    assert "couple" in rows[n] and ("sweeps" in rows[n]) == (n == "servo-periodic"), n
    for k in ("P11", "P12", "P22"):
        assert abs(rows[n][k] - other[k]) <= 1e-4 * abs(rows[n]["P11"]), (n, k, rows[n][k], other[k])
assert abs(rows["frame-periodic"]["P11"] - periodic["P11"]) <= 1e-6 * abs(periodic["P11"])
assert abs(rows["displacement"]["couple"]) > 0 and rows["traction"]["couple"] == 0
energy = [rows[n]["energy"] for n in ("displacement", "frame-periodic", "traction")]
assert energy[0] > energy[1] > energy[2], energy
assert rows["servo-periodic"]["sweeps"] > 1
head = [l for l in open("traction.dump") if l.startswith("ITEM: ATOMS")][0].split()
assert head[-4:] == ["frame", "ax", "ay", "moment"], head
grains = [l.split() for l in open("traction.dump").read().split("ITEM: ATOMS")[-1].split("\n")[1:] if l]
total = [sum(float(g[k]) for g in grains) for k in (-3, -2)]
assert len(grains) > 50 and max(map(abs, total)) < 1e-9, total
E
say $? 'columns, the other engine, the order of energies, supports in the dump'

if has HDF5 'states'; then
  # shellcheck disable=SC2086
  "$granhom" rve p50d.data --path path.csv --boundary mixed --mixed x=traction,y=periodic $friction --engine native -o whole.csv --save-state s.h5 2>err
  say $? 'a state is saved'
  # shellcheck disable=SC2086
  "$granhom" rve p50d.data --path path.csv --boundary mixed --mixed x=periodic,y=traction $friction --engine native --load-state s.h5 -o no.csv 2>err
  [ $? = 2 ] && grep -q 'saved with --boundary mixed x=traction,y=periodic, and now it is mixed x=periodic,y=traction' err
  say $? 'another mixture is refused'
fi

# --- wrong input ---
refused() { # refused NAME WORDS PACKING OPTIONS...
  local name=$1 words=$2
  shift 2
  refused_by rve "$name" "$words" "../$@" --path ../path.csv -o none.csv
}
refused 'a frame with a gap' 'p20.data: the frame has a gap' p20.data --boundary traction
refused 'mixed without --mixed' '--boundary mixed needs --mixed' p50d.data --boundary mixed
refused '--mixed without mixed' '--mixed needs --boundary mixed' p50d.data --mixed x=traction,y=periodic
refused 'a pair of edges without condition' 'Hill-Mandel' p50d.data --boundary mixed --mixed x=traction
refused 'a gain that cannot converge' '--servo-gain' p50d.data --boundary servo-periodic --servo-gain 1.5

# --- scenes ---
has HDF5 'scenes' || exit $bad
scene() { # scene BOUNDARY
  cat <<Y
packing: p50d.data
contact: {normal_stiffness: 50, friction_angle: 20}
micro: {boundary: $1, engine: native}
start: {confinement: 0.3}
mesh: {rectangle: {size: [10, 10], elements: [2, 2]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
results: {dump: [3]}
steps:
  - {name: hold, increments: 1, pressure: [{edge: right, to: 0.3}, {edge: top, to: 0.3}]}
  - {name: push, increments: 2, displace: [{edge: top, y: -0.02}]}
Y
}
scene traction >traction.yaml
scene 'mixed, mixed: "x=traction,y=displacement"' >mixed.yaml
scene mixed >wrong.yaml
"$granhom" run wrong.yaml -o wrong 2>err
[ $? = 2 ] && grep -q 'wrong.yaml:3: boundary mixed needs the key mixed' err && [ ! -e wrong ]
say $? 'a scene that mixes nothing is refused'
sed 's/p50d/p20/' traction.yaml >gap.yaml
"$granhom" run gap.yaml -o gap 2>err
[ $? = 2 ] && grep -q 'p20.data: the frame has a gap' err && [ ! -e gap ]
say $? 'a scene with a gap in its frame is refused'
"$granhom" run mixed.yaml --explain 2>err | grep -q 'mixed x=traction,y=displacement: each pair'
say $? '--explain states what is mixed'
for name in traction mixed; do
  "$granhom" run $name.yaml -o $name --quiet 2>err
  say $? "$name runs"
  "$granhom" run $name.yaml -o $name.alone --quiet --no-share 2>err
  cmp -s $name/history.csv $name.alone/history.csv
  say $? "$name: --no-share gives the same numbers"
  has MPI 'two ranks' || continue
  mpirun -n 2 "$granhom" run $name.yaml -o $name.two --quiet 2>err
  cmp -s $name/history.csv $name.two/history.csv && cmp -s $name/rves.h5 $name.two/rves.h5 &&
    cmp -s $name/dumps/point_3.dump $name.two/dumps/point_3.dump
  say $? "$name: two ranks give the same numbers"
done
"$granhom" run traction.yaml -o stopped --quiet 2>err &
pid=$!
for _ in $(seq 3000); do # until there are two rows
  [ "$(wc -l 2>/dev/null <stopped/history.csv || echo 0)" -gt 2 ] && break
  kill -0 $pid 2>/dev/null || break
  sleep 0.01
done
kill -TERM $pid 2>/dev/null
wait $pid
"$granhom" run traction.yaml -o stopped --restart --quiet 2>err && cmp -s traction/history.csv stopped/history.csv && cmp -s traction/rves.h5 stopped/rves.h5
say $? 'a run that is stopped and restarted leaves the same numbers'
exit $bad
