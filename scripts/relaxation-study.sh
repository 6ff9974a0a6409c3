#!/bin/sh
# What the ways to equilibrium cost in counts that do not depend on the machine: one packing (scenes/block/sand150.data, periodic, native
# engine), compressed by 1 % in 20 increments with the sides held, without and with friction; a table (Markdown).
#   relaxation-study.sh BUILD OUTDIR
# SPDX-License-Identifier: GPL-2.0-or-later
set -eu
cd "$(dirname "$0")/.."
[ $# -eq 2 ] || { echo "usage: relaxation-study.sh BUILD OUTDIR" >&2; exit 2; }
granhom=$(cd "$1" && pwd)/granhom
packing=$(pwd)/scenes/block/sand150.data
mkdir -p "$2"
cd "$2"
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1

# one element whose four points share one RVE: all nodes are prescribed
run() { # run NAME FRICTION RELAXATION TOLERANCE
  cat >"$1.yaml" <<Y
packing: $packing
contact: {normal_stiffness: 50$2}
micro: {boundary: periodic, engine: native, relaxation: $3, tolerance: $4}
start: {balance: true}
mesh: {rectangle: {size: [1, 1], elements: [1, 1]}}
supports: [{edge: left, fix: x}, {edge: right, fix: x}, {edge: bottom, fix: y}]
steps: [{name: compress, increments: 20, displace: [{edge: top, y: -0.01}]}]
Y
  "$granhom" run "$1.yaml" -o "$1" --quiet >"$1.log" 2>&1 || true # a failure is a result
}

for friction in none 20; do
  law=
  [ $friction = none ] || law=", friction_angle: $friction"
  for tolerance in 1e-4 1e-8 1e-10; do
    for way in damped fire polished; do run "$friction-$way-$tolerance" "$law" $way $tolerance; done
  done
done

/usr/bin/python3 - <<'P'
import csv, json
print("| friction | tolerance | method | outcome | steps | pair evaluations | factorisations | stress from polished, 1e-10 |")
print("| --- | --- | --- | --- | --- | --- | --- | --- |")
def row(name):
    rows = list(csv.DictReader(open(f"{name}/history.csv")))
    return [float(r["top_y"]) for r in rows]
for friction in ("none", "20"):
    reference = row(f"{friction}-polished-1e-10")
    for tolerance in ("1e-4", "1e-8", "1e-10"):
        for way in ("damped", "fire", "polished"):
            name = f"{friction}-{way}-{tolerance}"
            run = json.load(open(f"{name}/run.json"))
            s, path = run["summary"], row(name)
            away = max(abs(a - b) for a, b in zip(path, reference)) / max(map(abs, reference))
            print(f"| {friction} | {tolerance} | {way} | {run['status']} | {s['relaxation_steps']} | {s['pair_evaluations'] / 1e6:.2f} million | "
                  f"{s['factorisations']} | {away:.1e} |")
P
