#!/usr/bin/env bash
# What a run states of its error: run.json, history.csv, the last lines, the report, granhom rve. SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, not_ok, check
begin
packing=$root/tests/data/cases/packings/p50.data

scene() { # scene FRICTION BOUNDARY
  cat <<Y
packing: $packing
contact: {normal_stiffness: 50$1}
micro: {boundary: $2, engine: native}
start: {confinement: 0.3}
mesh: {rectangle: {size: [10, 10], elements: [2, 2]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps:
  - {name: press, increments: 2, pressure: [{edge: right, to: 0.32}, {edge: top, to: 0.32}]}
  - {name: shear, increments: 4, displace: [{edge: top, x: 0.05}]}
Y
}
scene '' taylor >smooth.yaml
scene ', friction_angle: 20' taylor >rough.yaml
for name in smooth rough; do
  check "$name runs" "$granhom" run $name.yaml -o $name.plain
  "$granhom" run $name.yaml -o $name --estimate-error >$name.said 2>$name.log
  check "$name with an estimate runs" test $? = 0
done
"$granhom" run smooth.yaml -o smooth.plain >plain.said 2>/dev/null
check "without an estimate the last lines report residuals, imbalance, and how to get one" awk '
  /^residuals at most .* \(macro\) and .* \(packings\); energy imbalance .*, work imbalance .* of the largest work$/ { n++ }
  /^no estimate of the error of the path: --estimate-error makes one/ { n++ } END { exit n != 2 }' plain.said
check "with one they report it" grep -q '^estimated error of the path: stress .* displacement .* force .* s for it$' rough.said
check "the screen shows the halves alone" test "$(grep -c 'shear 4/4  part [12]  iteration  0' rough.log)" = 2
cat >numbers.py <<'E2'
"""Numbers of run.json and history.csv against each other and against what they have to be."""
import csv, json
def read(d):
    return json.load(open(f"{d}/run.json"))["error"], list(csv.DictReader(open(f"{d}/history.csv")))
known = ["inner_work", "outer_work", "energy", "dissipation", "energy_defect"]
more = ["estimate", "estimate_largest", "estimate_displacement", "estimate_force", "estimate_growth", "branched"]
for name in ("smooth", "rough"):
    for d in (name + ".plain", name):
        error, rows = read(d)
        tail = known + ["coordination", "anisotropy"] + ([] if d.endswith("plain") else more)
        assert list(rows[0])[-len(tail):] == tail, list(rows[0])
        assert all(float(rows[0][k]) == 0 for k in known)  # the start is the zero
        last = {k: float(v) for k, v in rows[-1].items() if k != "name"}
        assert all(abs(last[k] - error[k]) <= 1e-14 * abs(last[k]) for k in known)
        largest = max(max(abs(float(r["inner_work"])), abs(float(r["energy"]) + float(r["dissipation"]))) for r in rows)
        defect = (last["inner_work"] - last["energy"] - last["dissipation"]) / largest
        assert abs(defect - error["energy_defect"]) < 1e-12 and abs(defect) < 2e-2, (d, defect, error)
        assert abs(error["work_defect"]) < 1e-7 and error["freed_in_jumps"] == 0
        assert max(float(r["residual"]) for r in rows) <= error["residual"] <= 1e-8 and error["micro_residual"] <= 1e-8
        assert (last["dissipation"] > 0) == (name == "rough")
        assert ("estimate" in error) == (d == name)
    e = error["estimate"]
    assert e["increments"] == 7 and e["branched_increments"] == 0 and e["extra_seconds"] > 0
    keys = ["stress_l2", "stress_largest", "displacement", "force"]
    if name == "smooth":
        assert all(0 <= e[k] < 1e-6 for k in keys), e  # path independent
    else:
        assert all(1e-6 < e[k] < 1e-2 for k in keys), e
        fine, coarse = (float(read(d)[1][-1]["top_x"]) for d in ("rough", "rough.plain"))
        assert fine != coarse and abs(fine / coarse - 1) < 10 * e["force"]
E2
check "the numbers fit each other" /usr/bin/python3 numbers.py
check "--explain states the price" sh -c "'$granhom' run rough.yaml --explain --estimate-error | grep -q 'about three times the time'"
check "and nothing of it unasked" sh -c "! '$granhom' run rough.yaml --explain | grep -q doubling"
check "help names the option" sh -c "'$granhom' help run | grep -q -- --estimate-error && '$granhom' help rve | grep -q -- --estimate-error"

# --- automatic increments, a body that is cut ---
{ scene ', friction_angle: 20' taylor; echo 'solver: {increments: automatic, at_once: 4}'; } >auto.yaml
check "automatic increments" "$granhom" run auto.yaml -o auto --estimate-error --quiet
check "are taken at once in the second path" test "$(wc -l <auto/history.csv)" -lt 8

# --- several ranks ---
if has MPI "two ranks" && command -v mpirun >/dev/null && mpirun -n 2 true 2>/dev/null; then
  check "two ranks" mpirun -n 2 "$granhom" run rough.yaml -o two --estimate-error --quiet
  check "give the same numbers" cmp rough/history.csv two/history.csv
fi

# --- the report ---
if "$granhom" report rough -o page.html >said 2>&1; then
  check "the report has the section" grep -q '<h2 id="error">Error against run time' page.html
  check "with the estimate" grep -q 'Estimate by step doubling, largest of all increments' page.html
  check "and its curves" test "$(grep -c 'Estimated error of the stress\|Estimated error at each increment\|<figcaption>Energy imbalance' page.html)" -ge 3
  "$granhom" report smooth.plain -o page.html >said
  check "without an estimate it states how to get one" grep -q -- '--estimate-error</code> makes one' page.html
elif ! grep -q 'built without HDF5' said; then
  not_ok "the report is made" "$(cat said)"
fi

# --- one packing ---
cat >path.csv <<'P'
step,F11,F12,F21,F22
0,1,0,0,1
1,0.998,0.001,0,0.999
2,0.996,0.002,0,0.998
3,0.994,0.003,0,0.997
4,0.992,0.004,0,0.996
P
rve() { "$granhom" rve "$packing" --engine native --normal-stiffness 1000 --path "$@"; }
rve path.csv -o one.csv 2>said
check "rve reports residual and energy imbalance at the end" sh -c "tail -n 1 said | grep -q '^largest residual .*; energy imbalance '"
awk -F, 'NR == 1 { print; next } NR > 2 { for (k = 1; k < 4; k++) { printf "%d", 4 * (NR - 3) + k; for (c = 2; c <= 5; c++) printf ",%.17g", f[c] + k * ($c - f[c]) / 4; print "" } }
  { printf "%d", 4 * (NR - 2); for (c = 2; c <= 5; c++) { f[c] = $c; printf ",%s", $c } print "" }' path.csv >fine.csv
check "a path of quarters has a sixteenth of it, where grains follow F" sh -c "
  a=\$('$granhom' rve '$packing' --engine native --boundary taylor-cell --path path.csv -o a.csv 2>&1 | sed -n 's/.*energy imbalance \([^:]*\):.*/\1/p')
  b=\$('$granhom' rve '$packing' --engine native --boundary taylor-cell --path fine.csv -o b.csv 2>&1 | sed -n 's/.*energy imbalance \([^:]*\):.*/\1/p')
  awk -v a=\$a -v b=\$b 'BEGIN { r = a / b; exit !(r > 8 && r < 32) }'"
rve path.csv -o whole.csv --friction-angle 20 --boundary taylor 2>/dev/null
rve path.csv -o halves.csv --friction-angle 20 --boundary taylor --estimate-error 2>said
check "an estimate for each row" test "$(grep -c '^step [0-4]: estimated error of the stress' said)" = 5
check "and one for the path" grep -q '^estimated error of the stress path .* it branches in 0 of 5 rows' said
check "which is the difference of the two paths" awk -F, -v told="$(sed -n 's/^estimated error of the stress path \([^ ]*\) .*/\1/p' said)" '
  FNR == 1 { for (c = 1; c <= NF; c++) at[$c] = c; next }
  NR == FNR { for (k = 0; k < 4; k++) p[FNR, k] = $(at["P11"] + k); next }
  { d = s = 0; for (k = 0; k < 4; k++) { v = $(at["P11"] + k); d += (v - p[FNR, k]) ^ 2; s += v ^ 2 }
    if (sqrt(d) > off) off = sqrt(d); if (sqrt(s) > most) most = sqrt(s) }
  END { r = off / most / told; exit !(r > 0.95 && r < 1.05) }' whole.csv halves.csv
rve path.csv -o smooth.csv --estimate-error 2>said
check "without friction there is nothing but the tolerance" awk '/^estimated error of the stress path/ { n++; exit !($7 < 1e-6) } END { if (!n) exit 1 }' said
exit $bad
