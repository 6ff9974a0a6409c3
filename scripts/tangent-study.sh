#!/bin/sh
# Which matrix of Newton's iteration is the cheapest, and which the most robust: runs scenes with each of them, with and without line
# search, and with automatic increments, and prints a table (Markdown). Finished runs are not repeated.
#   tangent-study.sh BUILD OUTDIR [SCENE.yaml ...]     default: the block with periodic conditions, the biaxial test, the block with friction
# Times count on a machine that does nothing else. SPDX-License-Identifier: GPL-2.0-or-later
set -eu
cd "$(dirname "$0")/.."
root=$(pwd)
[ $# -ge 2 ] || { echo "usage: tangent-study.sh BUILD OUTDIR [SCENE.yaml ...]" >&2; exit 2; }
granhom=$(cd "$1" && pwd)/granhom
mkdir -p "$2"
out=$(cd "$2" && pwd)
shift 2
[ $# -gt 0 ] || set -- scenes/block/p02_periodic.yaml scenes/biaxial/periodic.yaml scenes/block/friction20_periodic.yaml
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1

# variant SCENE NAME KEYS
variant() {
  name=$(basename "$(dirname "$1")")-$(basename "$1" .yaml)-$2
  folder=$(cd "$(dirname "$1")" && pwd)
  sed -e "s|^packing: *\([^/[{]\)|packing: $folder/\1|" -e "s|gmsh: *\([^/]\)|gmsh: $folder/\1|" \
    -e "s|^solver: {method: newton, |solver: {method: newton, $3, |" "$1" >"$out/$name.yaml"
  grep -q "$3" "$out/$name.yaml" || { echo "$1: has no line that begins with solver: {method: newton," >&2; exit 2; }
  grep -q '"status":[[:space:]]*"done"' "$out/$name/run.json" 2>/dev/null ||
    "$granhom" run "$out/$name.yaml" -o "$out/$name" --quiet >"$out/$name.log" 2>&1 || true # a failure is a result
  echo "$name"
}

for scene; do
  for tangent in algorithmic symmetrised frozen elastic; do
    variant "$scene" $tangent "tangent: $tangent"
    variant "$scene" "$tangent-automatic" "tangent: $tangent, increments: automatic"
  done
  variant "$scene" no-search "line_search: false"
done >"$out/names"

/usr/bin/python3 - "$out" <<'E2'
import csv, json, os, sys
out = sys.argv[1]
print("| run | outcome | increments | iterations | cuts | jumps | relaxation steps | factorisations | seconds |")
print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
for name in open(f"{out}/names").read().split():
    path = f"{out}/{name}/run.json"
    if not os.path.exists(path):
        print(f"| {name} | no results |" + " |" * 7)
        continue
    run = json.load(open(path))
    s = run.get("summary", {})
    where = ""
    if run["status"] != "done" and os.path.exists(f"{out}/{name}/history.csv"):
        rows = list(csv.DictReader(open(f"{out}/{name}/history.csv")))
        where = f" after {rows[-1]['name']} {rows[-1]['increment']}" if rows else ""
    cells = [s.get(k, "") for k in ("increments", "iterations", "cuts", "jumps", "relaxation_steps", "factorisations")]
    print(f"| {name} | {run['status']}{where} | " + " | ".join(str(c) for c in cells) + f" | {s.get('seconds', {}).get('total', float('nan')):.1f} |")
E2
