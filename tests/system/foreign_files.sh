#!/usr/bin/env bash
# Files that other programs write: meshes, packings, tables. Read right, or refused by naming the cause. SPDX-License-Identifier:
# GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # ok, not_ok, check, say, begin, refused_by
begin
data=$root/tests/data
cp "$data/cases/packings/p150.data" p150.data
# column FILE NAME: the last value of a column
column() { awk -F, -v name="$2" 'NR == 1 { for (k = 1; k <= NF; k++) if ($k == name) c = k } END { print $c }' "$1"; }
# near A B WITHIN
near() { awk -v a="$1" -v b="$2" -v within="$3" 'BEGIN { d = a - b; exit !(a != "" && d <= within && -d <= within) }'; }

# ---- Gmsh meshes ----

# scene MESH: a scene with it
scene() {
  cat >scene.yaml <<END
packing: p150.data
contact: {normal_stiffness: 50}
micro: {boundary: taylor}
mesh: {gmsh: $1}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps: [{increments: 1, displace: [{edge: top, y: -0.01}], supports: [{edge: right, fix: x}]}]
END
}
for mesh in plain parametric; do
  cp "$data/foreign/${mesh}_v22.msh" mesh.msh
  scene mesh.msh
  "$granhom" run scene.yaml -o $mesh --quiet >said 2>said.err
  say $? "a scene with the $mesh mesh runs"
  check "  its reaction is the right one" near "$(column $mesh/history.csv top_y)" -1.471364 1e-6
done
check 'parameters of nodes change nothing' cmp plain/history.csv parametric/history.csv

# refused_mesh NAME WORDS: mesh.msh is refused; the message has the mesh's name before its line
refused_mesh() { scene mesh.msh && refused_by run "$1" "$2" ../scene.yaml -o out --quiet; }
printf '$NOD\n1\n1 0 0 0\n$ENDNOD\n' >mesh.msh
refused_mesh 'MSH 1' 'mesh.msh:1: MSH version 1'
printf '$MeshFormat\n4.1 1 8\n\1\0\0\0\n$EndMeshFormat\n' >mesh.msh
refused_mesh 'a binary mesh' 'mesh.msh:2: a binary Gmsh mesh (MSH 4.1)'
sed '/"soil/d; /^[0-9]* 3 2 /d; s/^9$/7/; s/^31$/'"$(grep -c '^[0-9]* \(1\|15\) 2 ' "$data/foreign/plain_v22.msh")/" "$data/foreign/plain_v22.msh" >mesh.msh
refused_mesh 'a mesh without a physical group of surfaces' 'Mesh.SaveAll = 1'
printf '\xFF\xFE$\0M\0' >mesh.msh
refused_mesh 'a mesh in UTF-16' 'mesh.msh:1: text in UTF-16'
scene /dev/zero
(ulimit -v 6000000; refused_by run 'a mesh without end' '/dev/zero:1: not a text file' ../scene.yaml --explain)
mkfifo pipe
scene pipe
refused_by run 'a mesh in a pipe that nothing is written into' 'pipe: a pipe that nothing is written into' ../scene.yaml -o out --quiet

exit $bad
