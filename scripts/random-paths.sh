#!/usr/bin/env bash
# Random paths of F to 5 % strain with friction: 100 paths x 5 packings x 3 coefficients x 3 stiffnesses over pressure, and the table of
# docs/reports/stability.md of those that complete. scripts/random-paths.sh [BUILD [ONE_OF [FOLDER]]]: one of so many (20; 1: all
# 4,500, half an hour on two idle cores), on all cores; results are kept in FOLDER (BUILD/random-paths), and what is there already is not repeated. Changes the
# page where all are run. SPDX-License-Identifier: GPL-2.0-or-later
set -u
cd "$(dirname "$0")/.." || exit 1
export BUILD=${1:-build} every=${2:-20} OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export out=${3:-$BUILD/random-paths}
mkdir -p "$out" || exit 1

# 100 grains, at rest under E_n / kappa
printf 'diameter,count\n0.8,34\n1,33\n1.2,33\n' >"$out/sieve.csv"
for kappa in 100 1000 10000; do
  [ -e "$out/k$kappa-005.data" ] ||
    "$BUILD/granhom" pack --sieve "$out/sieve.csv" --ensemble 5 --finish "pressure=$(awk "BEGIN { print 1 / $kappa }")" \
      --engine native -o "$out/k$kappa.data" >/dev/null 2>"$out/pack.log" || { cat "$out/pack.log"; exit 1; }
done

# One to five legs, 5 % of shear together: each in a random direction, with a rotation, and with an area change of -0.5 to 0.2 of it. In
# increments of 0.1 %.
/usr/bin/python3 - "$out" <<'PYTHON'
import math, random, sys
for number in range(100):
    draw = random.Random(number)
    F, rows = [1.0, 0.0, 0.0, 1.0], 50
    legs = sorted(draw.sample(range(1, rows), draw.randint(0, 4))) + [rows]
    with open(f"{sys.argv[1]}/path{number}.csv", "w") as out:
        out.write("step,F11,F12,F21,F22\n0,1,0,0,1\n")
        for row in range(1, rows + 1):
            if row == 1 or row - 1 in legs:
                angle, area, turn = (draw.uniform(0, 2 * math.pi), draw.uniform(-0.25, 0.1), draw.uniform(-0.3, 0.3))
                a, b = math.cos(angle) / math.sqrt(2), math.sin(angle) / math.sqrt(2)
                rate = [a + area, b - turn, b + turn, -a + area]
            F = [f + 1e-3 * r for f, r in zip(F, rate)]
            out.write(f"{row},{F[0]:.17g},{F[1]:.17g},{F[2]:.17g},{F[3]:.17g}\n")
PYTHON

# one PATH PACKING MU KAPPA: its rows, messages, status and seconds
one() {
  local name=$out/p$1-$2-$3-$4 code=0
  [ -e "$name.end" ] && return
  /usr/bin/time -f %U -o "$name.seconds" "$BUILD/granhom" rve "$out/k$4-00$2.data" --path "$out/path$1.csv" --engine native --normal-stiffness 1 \
    --tangential-stiffness 0.2 --friction-coefficient "$3" -o "$name.csv" >/dev/null 2>"$name.log" || code=$?
  echo $code >"$name.end"
}
export -f one
for path in $(seq 0 99); do
  for packing in 1 2 3 4 5; do
    for mu in 0.1 0.3 0.5; do
      for kappa in 100 1000 10000; do echo "$path $packing $mu $kappa"; done
    done
  done
done | awk -v every="$every" '(NR * 7919) % every == 0' | xargs -P "$(nproc)" -L 1 bash -c 'one "$@"' one

/usr/bin/python3 - "$out" "$every" <<'PYTHON'
import csv, glob, os, re, sys
out, every = sys.argv[1], int(sys.argv[2])
side = {}
for kappa in (100, 1000, 10000):
    lo, hi = re.search(r"(\S+) (\S+) xlo xhi", open(f"{out}/k{kappa}-001.data").read()).groups()
    side[kappa] = float(hi) - float(lo)


# the residual that round-off of the positions leaves (method, "Round-off"), or 1e-8
def allowed(row, kappa):
    pressure = -(float(row["P11"]) + float(row["P22"])) / 2
    force = 2 * pressure * side[kappa] ** 2 / max(int(row["contacts"]), 1) # mean, of contacts of length 1
    return max(1e-8, 16 * 2.3e-16 * 2 * side[kappa] / force if force > 0 else 1)


runs = {}
for end in glob.glob(out + "/p*.end"):
    name = end[:-4]
    path, packing, mu, kappa = re.fullmatch(r"p(\d+)-(\d)-([\d.]+)-(\d+)", os.path.basename(name)).groups()
    status = int(open(end).read())
    log = open(name + ".log").read()
    rows = list(csv.DictReader(open(name + ".csv"))) if os.path.exists(name + ".csv") else []
    worst = max((float(r["residual"]) for r in rows), default=0)
    complete = status == 0 and len(rows) == 51 and "unconverged" not in log and all(float(r["residual"]) <= allowed(r, int(kappa)) for r in rows)
    if not complete:
        print(f"{os.path.basename(name)}: status {status}, {len(rows)} of 51 rows, residual {worst:.1e}: {log.strip().splitlines()[-1] if log.strip() else ''}")
    seconds = float(open(name + ".seconds").read().split()[-1])
    runs.setdefault((mu, int(kappa)), []).append((complete, sum(int(r["ramps"]) for r in rows), log.count("reached in"), seconds, len(rows)))
table = ["| coefficient | $E_n/p$ | complete | ramps an increment | increments in substeps | CPU s per % strain |", "| --- | --- | --- | --- | --- | --- |"]
for (mu, kappa), r in sorted(runs.items()):
    increments = sum(x[4] - 1 for x in r)
    table.append(f"| {mu} | {kappa} | {sum(x[0] for x in r)} of {len(r)} | {sum(x[1] for x in r) / max(increments, 1):.2f} | {sum(x[2] for x in r)} of {increments} | {sum(x[3] for x in r) / max(increments, 1) * 10:.2f} |")
print("\n".join(table))
if every == 1:
    page = open("docs/reports/stability.md").read()
    head, rest = page.split("<!-- random paths: begin, written by scripts/random-paths.sh -->\n")
    tail = rest.split("<!-- random paths: end -->")[1]
    open("docs/reports/stability.md", "w").write(head + "<!-- random paths: begin, written by scripts/random-paths.sh -->\n\n" + "\n".join(table) + "\n\n<!-- random paths: end -->" + tail)
PYTHON
