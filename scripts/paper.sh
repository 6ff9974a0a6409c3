#!/bin/sh
# Section 4 of the paper: scenes/paper/reference.yaml with other meshes, conditions, friction, rotations, anisotropy and stiffness, its
# table and curves for docs/reports/paper.md. Half an hour of one core; what has results is not run again.
#   paper.sh BUILD [OUT]       OUT (BUILD/paper): the runs; ONLY="mesh_1x2 mu_0.2": these alone; TABLES=1: nothing is run
# SPDX-License-Identifier: GPL-2.0-or-later
set -eu
cd "$(dirname "$0")/.."
scenes=$(pwd)/scenes/paper gp=$(pwd)/scripts/paper.gp
build=$(cd "${1:-build}" && pwd)
mkdir -p "${2:-$build/paper}"
cd "${2:-$build/paper}"
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
[ -e granhom ] || cp "$build/granhom" granhom # it may be rebuilt while this is running
[ -e sand-008.data ] || cp "$scenes"/*.data .

# pack NAME STIFFNESS PRESSURE ANISOTROPY: eight packings with the sizes of sand-00N.data
pack() {
  [ -e "$1-008.data" ] || ./granhom pack --sieve "$scenes/sieve.csv" --count 100 --rate 0.01 --finish pressure="$3" --normal-stiffness "$2" \
    --anisotropy "$4" --ensemble 8 -o "$1.data" --quiet >"$1.log"
}
# run NAME SED...: reference.yaml changed
run() {
  name=$1
  shift
  [ -n "${ONLY:-}" ] && ! printf ' %s ' "$ONLY" | grep -q " $name " && return
  sed "$@" "$scenes/reference.yaml" >"$name.yaml"
  [ "${TABLES:-0}" = 1 ] || grep -qs '"status":[[:space:]]*"done"' "$name/run.json" && return
  echo "$name"
  ./granhom run "$name.yaml" -o "$name" --quiet 2>"$name.log" || tail -n 1 "$name.log"
}
[ "${TABLES:-0}" = 1 ] || {
  pack anisotropy5 10 0.015 0.05
  pack anisotropy8 10 0.015 0.08
  pack stiff 150 0.015 0.02
}
for mesh in 1x2 2x4 4x8 8x16; do run mesh_$mesh -e "s/elements: .*]}}/elements: [${mesh%x*}, ${mesh#*x}]}}/"; done
run periodic -e 's/frame-periodic/periodic/'
run displacement -e 's/frame-periodic/displacement/'
for mu in 0.2 0.6 0.8; do run mu_$mu -e "s/friction_coefficient: 0.4/friction_coefficient: $mu/"; done
run mu_0 -e 's/, tangential_stiffness: 2, friction_coefficient: 0.4//'
run fixed -e 's/engine: native/engine: native, rotations: fixed/'
for a in 5 8; do run anisotropy_$a -e "s/sand-/anisotropy$a-/g"; done
run kappa_1000 -e 's/sand-/stiff-/g' -e 's/normal_stiffness: 10, tangential_stiffness: 2/normal_stiffness: 150, tangential_stiffness: 30/'

# A line of the table: axial stress (dead loads, reference width) over sigma_0 = 0.15, its peak, mobilised angle there, and the rest.
for name in mesh_1x2 mesh_2x4 mesh_4x8 mesh_8x16 periodic displacement mu_0 mu_0.2 mu_0.6 mu_0.8 fixed anisotropy_5 anisotropy_8 kappa_1000; do
  [ -e "$name/history.csv" ] || continue
  python3 - "$name" <<'E'
import csv, json, math, sys
name = sys.argv[1]
rows = [r for r in csv.DictReader(open(name + "/history.csv")) if float(r["load_step"]) >= 1]
run = json.load(open(name + "/run.json"))
s = run.get("summary") or sys.exit()  # it is under way
start = [r for r in rows if r["load_step"] == "1"][-1]
rows = [start] + [r for r in rows if r["load_step"] == "2"]
u = [float(r["uy_top"]) for r in rows[1:]]
u.insert(0, 2 * u[0] - u[1])  # where the plate takes over: equal increments
out = []
for k, r in enumerate(rows):
    out.append(((u[0] - u[k]) / (20 + u[0]), float(r["bottom_y"]) / 10 / 0.15, float(r["dilatancy"]), float(r["coordination"]), float(r["anisotropy"])))
with open(name + ".txt", "w") as file:
    for row in out: print(*row, file=file)
peak = max(out, key=lambda row: row[1])
angle = math.degrees(math.asin((peak[1] - 1) / (peak[1] + 1)))
total = lambda c: sum(float(r[c]) for r in rows)
print("| %s | %.1f %% | %.2f | %.1f | %.1f %% | %.2f | %.2f | %.3f | %d | %d | %d | %.0f |" % (
    name, 100 * out[-1][0], peak[1], angle, 100 * peak[0], out[-1][1], out[-1][3], max(r[4] for r in out),
    total("iterations"), total("cuts"), total("jumps"), s["seconds"]["total"]))
E
done >table.md
cat table.md
command -v gnuplot >/dev/null && gnuplot -e "png='mesh.png'; names='mesh_1x2 mesh_2x4 mesh_4x8 mesh_8x16 periodic displacement'" "$gp" &&
  gnuplot -e "png='micro.png'; names='mesh_2x4 mu_0 mu_0.2 mu_0.6 mu_0.8 fixed'" "$gp" &&
  gnuplot -e "png='anisotropy.png'; names='mesh_2x4 anisotropy_5 anisotropy_8 kappa_1000'" "$gp"
