#!/bin/sh
# Two ranks against one on the first part of the periodic biaxial test, with balance on and off, and what a run spends on anything but grains:
# farm.sh [BUILD]. Wants two quiet cores. SPDX-License-Identifier: GPL-2.0-or-later
set -eu
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
granhom=$(cd "${1:-build}" && pwd)/granhom
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# the first three increments of the pressure
sed -e "s|sand88.data|$(pwd)/scenes/biaxial/sand88.data|" -e 's/increments: 10/increments: 3/' -e 's/to: 0.2}/to: 0.067}/g' -e '/name: compress/,/displace/d' scenes/biaxial/periodic.yaml >"$work/scene.yaml"
run() { # run NAME RANKS OPTIONS
  name=$1 ranks=$2
  shift 2
  if [ "$ranks" = 1 ]; then "$granhom" run "$work/scene.yaml" -o "$work/$name" --quiet "$@" >/dev/null 2>&1
  else mpirun -n "$ranks" "$granhom" run "$work/scene.yaml" -o "$work/$name" --quiet "$@" >/dev/null 2>&1; fi
}
run one 1
run still 2 --no-balance
run two 2
cmp "$work/one/history.csv" "$work/two/history.csv"
cmp "$work/one/history.csv" "$work/still/history.csv"
/usr/bin/python3 - "$work" <<'E'
import json, sys
runs = {name: json.load(open(f"{sys.argv[1]}/{name}/run.json"))["summary"] for name in ("one", "still", "two")}
one = runs["one"]["seconds"]
print(f"{'farm: biaxial, periodic, 3 increments':40} {'seconds':>8} {'micro':>8} {'efficiency':>10} {'of micro':>8} {'balance':>8} {'moved':>6}")
for name, words, ranks in (("one", "one rank", 1), ("still", "two ranks, --no-balance", 2), ("two", "two ranks", 2)):
    s, f = runs[name]["seconds"], runs[name]["farm"]
    print(f"{words:40} {s['total']:8.2f} {s['micro']:8.2f} {one['total'] / (ranks * s['total']):10.1%} {one['micro'] / (ranks * s['micro']):8.1%} {f['busy_seconds'] / (ranks * f['longest_seconds']):8.1%} {runs[name]['farm']['moved']:6}")
inside = sum(one[k] for k in ("micro_set", "micro_relax", "micro_contacts", "micro_factorise"))
print("one rank, share of the run:")
for words, seconds in (("cell, relaxation, contacts, factorisation", inside), ("other arithmetic of an RVE (sums, states)", one["micro_sum"] - inside),
                       ("farm: books, sharing, loading and saving", one["micro"] - one["micro_sum"]),
                       ("results and checkpoints", one["results"]), ("macro: assembly, solution, rest", one["total"] - one["micro"] - one["results"])):
    print(f"  {words:44} {seconds:8.3f} s {seconds / one['total']:7.2%}")
print(f"neither LAMMPS nor SuiteSparse nor contacts  {one['total'] - inside:10.3f} s {1 - inside / one['total']:7.2%} (macro solution included)")
E
