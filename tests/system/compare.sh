#!/usr/bin/env bash
# granhom compare: a run beside others, by folders whose means, gaps and scatter are known. SPDX-License-Identifier: GPL-2.0-or-later
set -u
. tests/shell.sh
begin

# folder NAME DRIVEN ROWS: ROWS are "time uy top_y dilatancy coordination"
folder() {
  mkdir -p "$1"
  printf '{"title": "Block <b> & \\"sand\\"", "status": "done", "units": {"length": "mm", "force": "N"}%s}\n' \
    "${2:+, \"driven\": {\"set\": \"$2\", \"direction\": \"y\"\}}" >"$1/run.json"
  { echo "step,name,time,uy_top,top_x,top_y,dilatancy,coordination"
    printf '%s\n' "$3" | awk '{print NR - 1 ",press," $1 "," $2 ",0," $3 "," $4 "," $5}'; } >"$1/history.csv"
}
# f = -100 t at the load steps 0, 1/2, 1; others: -80 t and -120 t, so that the mean is -100 t and the scatter 20 sqrt(2) t; the
# second has the load steps 0, 1/4, 1 alone. The largest reaction is 110: the run's gap is 10 t / 100 of it.
folder run top '0 0 0 0 4
0.5 -1 -55 0.5 4
1 -2 -110 1 5
1.5 -3 -130 2 6'
folder a top '0 0 0 0 4
0.5 -1 -40 0.25 3
1 -2 -80 1 3
1.25 -2.5 -90 2 3'
folder b top '0 0 0 0 4
0.25 -0.5 -30 0.25 4
1 -2 -120 1 3'

"$granhom" compare run a b -o c.csv --picture c.png >said.out 2>said.err
say $? "a run beside two others"
cat >wanted.py <<'E'
import csv, math, sys
rows = list(csv.DictReader(open(sys.argv[1])))
assert [r["time"] for r in rows] == ["0", "0.5", "1"], rows
def near(name, values):
    for row, value in zip(rows, values):
        assert abs(float(row[name]) - value) < 1e-12, (name, row[name], value)
near("uy_top", [0, -1, -2])
near("top_y", [0, -55, -110])
near("top_y_others", [0, -50, -100])          # (-40 - 60)/2, (-80 - 120)/2
near("top_y_scatter", [0, 10 * math.sqrt(2), 20 * math.sqrt(2)])
near("top_y_gap", [0, -5, -10])               # per cent of 100
near("dilatancy_others", [0, (0.25 + 0.5) / 2, 1])  # b: 0.25 + (1 - 0.25)/3
near("dilatancy_gap", [0, 0.125, 0])
near("coordination_others", [4, (3 + 4 - 1 / 3) / 2, 3])
near("coordination_gap", [0, 4 - (7 - 1 / 3) / 2, 2])
import csv, math, sys
rows = list(csv.DictReader(open(sys.argv[1])))
assert [r["time"] for r in rows] == ["0", "0.5", "1"], rows
def near(name, values):
    for row, value in zip(rows, values):
        assert abs(float(row[name]) - value) < 1e-12, (name, row[name], value)
near("uy_top", [0, -1, -2])
near("top_y", [0, -55, -110])
near("top_y_others", [0, -50, -100])          # (-40 - 60)/2, (-80 - 120)/2
near("top_y_scatter", [0, 10 * math.sqrt(2), 20 * math.sqrt(2)])
near("top_y_gap", [0, -5, -10])               # per cent of 100
near("dilatancy_others", [0, (0.25 + 0.5) / 2, 1])  # b: 0.25 + (1 - 0.25)/3
near("dilatancy_gap", [0, 0.125, 0])
near("coordination_others", [4, (3 + 4 - 1 / 3) / 2, 3])
near("coordination_gap", [0, 4 - (7 - 1 / 3) / 2, 2])
E
check "mean, scatter and gap, interpolated over the load steps" python3 wanted.py c.csv
check "the summary has the largest gap and its load step" grep -Eq '^top_y +-110 +-100 .* 5%  +-10% +1$' said.out
check "and states that the others end earlier" grep -q 'to load step 1, where the first of the others ends' said.out
check "a row of the table goes to standard output" sh -c '"$1" compare run a b -o - | sed -n 3p | grep -q "^0.5,-1,0,0,"' sh "$granhom"
if command -v gnuplot >/dev/null; then check "the picture" sh -c 'head -c 4 c.png | grep -q PNG'; else echo "skip - no gnuplot"; fi
"$granhom" compare run a >one.out 2>said.err
say $? "a run beside one"
check "which has no scatter" sh -c '! grep -q scatter one.out'

folder still '' '0 nan 5 0 4
1 nan 6 1 4'
check "without a driven set over the load steps" sh -c '"$1" compare still still -o - | grep -q "^1,0,0,0,6,6,0,1,1,0"' sh "$granhom"

# ---- what cannot be compared ----
folder faster top '0 0 0 0 4
1 -4 -1 0 4'
folder zero top '0 0 0 0 4
1 -2 0 0 4'
folder back top '0 0 0 0 4
0 -2 -1 0 4'
folder early top '0 0 0 0 4'
folder other bottom '0 0 0 0 4
1 -2 -1 0 4'
folder hole top '0 0 0 0 4
1 -2 nan 0 4'
folder bare top '0 0 0 0 4
1 -2 -1 0 4'
sed -i 's/top_x,top_y/one,two/' bare/history.csv
mkdir empty
refused_by compare "no other folder" "a second folder is needed, to compare '../run' to" ../run
refused_by compare "no folder" "two folders of results are needed"
refused_by compare "another displacement" "../faster/history.csv: uy_top is -4 at load step 1, ../run has -2: not the same loading" ../run ../faster
refused_by compare "no reaction but zero" "no reaction but zero" ../run ../zero
refused_by compare "load steps that stand" "../back/history.csv:3: the load steps in the column \`time\` do not increase" ../run ../back
refused_by compare "no increment in common" "no increment in common" ../run ../early
refused_by compare "another driven set" "../other: drives 'bottom' in y, ../run 'top' in y" ../run ../other
refused_by compare "a reaction that is no number" "top_y is not a finite number" ../run ../hole
refused_by compare "no reaction in common" "no reaction in common" ../run ../bare
refused_by compare "a folder without results" "../empty/run.json: cannot be opened" ../run ../empty
"$granhom" compare empty a -o nowhere/c.csv >said.out 2>said.err
check "a table that cannot be written, before anything is read" sh -c '[ "$1" = 1 ] && grep -q "nowhere/c.csv: its folder nowhere" said.err' sh $?
# shellcheck disable=SC2046
refused_by compare "too many folders" "at most 32 more folders" ../run $(printf '../a %.0s' $(seq 33))
exit $bad
