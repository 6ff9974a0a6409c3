#!/usr/bin/env bash
# Names of sets with blanks, commas, quotes, dots, numbers first, letters beyond ASCII: the curve of the driven set is drawn and
# reported; names whose columns would coincide are refused. SPDX-License-Identifier: GPL-2.0-or-later
set -u
. tests/shell.sh
begin
cp "$root/tests/data/cases/packings/block150.data" p.data || exit 1

mesh() { # TOP BOTTOM LEFT: two quadrilaterals with these physical lines
  cat >mesh.msh <<S
\$MeshFormat
2.2 0 8
\$EndMeshFormat
\$PhysicalNames
4
1 1 "$1"
1 2 "$2"
1 3 "$3"
2 4 "body"
\$EndPhysicalNames
\$Nodes
6
1 0 0 0
2 10 0 0
3 20 0 0
4 0 10 0
5 10 10 0
6 20 10 0
\$EndNodes
\$Elements
7
1 1 2 1 1 4 5
2 1 2 1 1 5 6
3 1 2 2 2 1 2
4 1 2 2 2 2 3
5 1 2 3 3 1 4
6 3 2 4 4 1 2 5 4
7 3 2 4 4 2 3 6 5
\$EndElements
S
}
scene() { # TOP BOTTOM LEFT [MORE]: YAML values
  cat >scene.yaml <<S
title: names
units: {length: mm, force: N}
packing: p.data
contact: {normal_stiffness: 50}
micro: {boundary: taylor-cell, engine: native}
start: {balance: true}
mesh: {gmsh: mesh.msh}
supports: [{edge: $3, fix: x}, {edge: $2, fix: y}]
steps:
  - {name: compress, increments: 3, displace: [{edge: $1, y: -0.1}]${4:-}}
S
}
column() { python3 -c 'import csv,sys; r=list(csv.DictReader(open(sys.argv[1]))); print(r[-1][sys.argv[2]])' "$1" "$2"; }

# what a plain name gives is what all others must give
mesh top bottom left
scene top bottom left
check "plain names" "$granhom" run scene.yaml -o plain --quiet
plain=$(column plain/history.csv top_y)
header=step,increment,name,load_step,time,uy_top,gx,gy,top_x,top_y,bottom_x,bottom_y,left_x,left_y,dilatancy
check "columns of plain names are as they were" sh -c "head -n 1 plain/history.csv | grep -q '^$header,iterations,'"

draws() { # NAME COLUMN [YAML]: of the driven set
  local yaml=${3:-"'$1'"}
  mesh "$1" "b $1" "l $1"
  scene "$yaml" "$(printf '%s' "$yaml" | sed "s/^\(.\)/\1b /")" "$(printf '%s' "$yaml" | sed "s/^\(.\)/\1l /")"
  rm -rf out
  "$granhom" run scene.yaml -o out --quiet >said.out 2>said.err || { not_ok "$1: runs" "$(cat said.err)"; return; }
  if [ "$(column out/history.csv "$2_y")" = "$plain" ] && [ "$(column out/history.csv "uy_$2")" = -0.10000000000000001 ]; then ok "$1: columns of $2"
  else not_ok "$1: columns of $2" "$(head -n 1 out/history.csv)"; fi
  "$granhom" report out >said.out 2>said.err
  if ! has HDF5 "$1: reported"; then :
  elif grep -qF "displacement of $4 in -y (mm)" out/report.html && grep -qF "support force on $4 in y (N)" out/report.html && grep -qF "<th>uy_$5</th>" out/report.html; then ok "$1: reported"
  else not_ok "$1: reported" "$(cat said.err)" "$(grep -o 'over [^<]*' out/report.html | head -n 2)"; fi
  if command -v gnuplot >/dev/null; then check "$1: drawn" "$granhom" plot out; fi
}
draws 'top edge' top_edge "'top edge'" 'top edge' top_edge
draws 'a,b' a_b "'a,b'" 'a,b' a_b
draws "it's" it_s '"it'"'"'s"' "it's" it_s
draws 'top.1-2' top.1-2 "'top.1-2'" top.1-2 top.1-2
draws '7 top' 7_top "'7 top'" '7 top' 7_top
draws 'Oberkante süd ↑' Oberkante_süd_↑ "'Oberkante süd ↑'" 'Oberkante süd ↑' Oberkante_süd_↑
draws 'a/b;c#d%e' 'a/b;c#d%e' "'a/b;c#d%e'" 'a/b;c#d%e' 'a/b;c#d%e'
draws '<top> & {x}' '<top>_&_{x}' "'<top> & {x}'" '&lt;top&gt; &amp; {x}' '&lt;top&gt;_&amp;_{x}'
long=a_name_that_is_longer_than_sixty_four_characters_because_Gmsh_allows_for_one_hundred_and_twenty
draws "$long" "$long" "'$long'" "$long" "$long"

# footings
mesh 'top edge' bottom left
scene "'top edge'" bottom left
sed -i "s/displace: .*/footing: [{edge: top edge, force: [0, -0.1]}]}/; s/^supports:.*/supports: [{edge: bottom, fix: both}]/" scene.yaml
"$granhom" run scene.yaml -o footing --quiet >said.out 2>said.err
if [ $? = 0 ] && { ! has HDF5 || { "$granhom" report footing >/dev/null 2>>said.err && grep -qF 'settlement of the footing' footing/report.html; }; } && head -n 1 footing/history.csv | grep -q ',footing_uy_top_edge,'; then ok "a footing on 'top edge'"
else not_ok "a footing on 'top edge'" "$(cat said.err)" "$(head -n 1 footing/history.csv)"; fi

# ---- what is refused ----

collide() { # NAME TOP BOTTOM WORDS [MORE]
  mesh "$2" "$3" left
  scene "'$2'" "'$3'" left "${5:-}"
  refused_by run "$1" "$4" "$work/scene.yaml" -o out
}
collide "a blank and an underscore" 'a b' a_b "two columns of history.csv would be called 'a_b_x'"
collide "a comma and a blank" 'a,b' 'a b' "two columns of history.csv would be called 'a_b_x'"
collide "a set like a column of another" 'x_y' uy_x "two columns of history.csv would be called 'uy_x_y'"
collide "a slash and an underscore" a/b a_b "two sets of results.h5 would be called 'a_b'"
collide "a name that is too long for a column" "$long$long" bottom "at most 127 are possible"
exit $bad
