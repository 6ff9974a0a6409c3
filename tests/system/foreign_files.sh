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

{ printf '\xEF\xBB\xBF'; sed 's/mesh.msh/plain.msh/' scene.yaml; } >marked.yaml
cp "$data/foreign/plain_v22.msh" plain.msh
"$granhom" run marked.yaml -o marked --quiet >said 2>said.err
say $? 'a scene with a byte order mark runs'
check '  to the same results' cmp plain/history.csv marked/history.csv
# a line across a square in a set that is pressed
sed 's/^31$/32/; s/^1 15 2 7 3 3$/&\n99 1 2 3 5 1 15/' plain.msh >odd.msh
scene odd.msh
sed 's/displace: .*}], /pressure: [{edge: top, to: 0.01}], /' scene.yaml >pressed.yaml
refused_by run 'a pressure on a line that is no edge' "pressed.yaml:6: a pressure needs edges of the boundary, and 1 of the lines of set 'top' is none" \
  ../pressed.yaml -o out --quiet

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
# a sanitizer needs more address space than a limit leaves
([ -n "${SANITIZED:-}" ] || ulimit -v 6000000; refused_by run 'a mesh without end' '/dev/zero:1: not a text file' ../scene.yaml --explain)
mkfifo pipe
scene pipe
refused_by run 'a mesh in a pipe that nothing is written into' 'pipe: a pipe that nothing is written into' ../scene.yaml -o out --quiet

# ---- packings ----

printf 'step,F11,F12,F21,F22\n0,1,0,0,1\n1,0.99,0.005,0,0.985\n' >path.csv
# rve OUT PACKING [PATH] [OPTIONS...]: one packing along the path
rve() {
  local out=$1 packing=$2 path=${3:-path.csv}
  shift $(($# < 3 ? $# : 3))
  "$granhom" rve "$packing" --path "$path" -o "$out" "$@" >said 2>said.err
}
# untimed FILE: without the column of seconds
untimed() { awk -F, -v OFS=, 'NR == 1 { for (k = 1; k <= NF; k++) if ($k ~ /seconds/) c = k } { if (c) $c = ""; print }' "$1"; }
# same_rve NAME PACKING [PATH]: it gives what p150.data gives
same_rve() {
  rm -f other.csv
  rve other.csv "$2" "${3:-path.csv}"
  say $? "$1 is read"
  check '  as the same packing and path' cmp <(untimed plain.csv) <(untimed other.csv)
}
rve plain.csv p150.data
say $? 'a packing along a path'
check '  which compresses it' awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) if ($k == "P22") c = k } END { exit !($c < 0) }' plain.csv
# atoms PROGRAM: p150.data with its lines of atoms changed by awk
atoms() { awk "/^Atoms/ { inside = 1; print; next } inside && NF >= 7 { $1 } { print }" p150.data; }
atoms '$2 = "quartz"' | sed 's/^Atoms.*/Atom Type Labels\n\n1 quartz\n\n&/' >labels.data
same_rve 'a packing with labels of types' labels.data
sed 's/^Atoms.*/Atom Type Labels\n\n1 quartz\n\nMasses\n\nquartz 1\n\nPair Coeffs # granular\n\nquartz hertz 1\n\n&/' p150.data >masses.data
same_rve 'a packing with masses and coefficients by labels' masses.data
atoms '$0 = $1 " " $2 " " $5 " " $6 " " $7 " " $3 " " $4 " 0 0 0"' | sed 's/^Atoms.*/Atoms # hybrid sphere/' >hybrid.data
same_rve 'a packing of style hybrid sphere' hybrid.data
sed 's/^Atoms.*/Atoms # granular/; s/$/\r/; 1s/^/\xEF\xBB\xBF/' p150.data | tr ' ' '\t' | sed 's/^Atoms\t#\t/Atoms # /; s/\txlo\txhi/ xlo xhi/' >windows.data
same_rve 'a packing of style granular with tabs, CR LF and a byte order mark' windows.data

# the same packing rotated by 30 degrees, its cell general triclinic: P turns with it
awk -v CONVFMT=%.17g 'BEGIN { c = cos(atan2(0, -1) / 6); s = sin(atan2(0, -1) / 6) }
  /xlo xhi/ { x0 = $1; a = $2 - $1; next } /ylo yhi/ { y0 = $1; b = $2 - $1; next }
  /zlo zhi/ { print c * a " " s * a " 0 avec\n" (-s * b) " " c * b " 0 bvec\n0 0 1 cvec\n" (c * x0 - s * y0) " " (s * x0 + c * y0) " -0.5 abc origin"; next }
  /^Atoms/ { inside = 1; print; next }
  inside && NF >= 7 { x = $5; y = $6; $5 = c * x - s * y; $6 = s * x + c * y } { print }' p150.data >turned.data
# turned ROW OF FOUR: R A R^T
awk -F, -v OFS=, -v CONVFMT=%.17g -v OFMT=%.17g 'BEGIN { c = cos(atan2(0, -1) / 6); s = sin(atan2(0, -1) / 6) } NR == 1 { print; next }
  { a = c * $2 - s * $4; b = c * $3 - s * $5; d = s * $2 + c * $4; e = s * $3 + c * $5
    print $1, a * c - b * s, a * s + b * c, d * c - e * s, d * s + e * c }' path.csv >turned_path.csv
for engine in lammps native; do
  rve turned.csv turned.data turned_path.csv --boundary periodic --engine $engine && rve straight.csv p150.data path.csv --boundary periodic --engine $engine
  say $? "a general triclinic cell is read ($engine)"
  P() { for k in P11 P12 P21 P22; do column "$1" $k; done | tr '\n' ' '; }
  check '  and the stress turns with the packing' awk -v t="$(P turned.csv)" -v p="$(P straight.csv)" 'BEGIN { c = cos(atan2(0, -1) / 6); s = sin(atan2(0, -1) / 6)
    split(t, T, " "); split(p, A, " "); a = c * A[1] - s * A[3]; b = c * A[2] - s * A[4]; d = s * A[1] + c * A[3]; e = s * A[2] + c * A[4]
    R[1] = a * c - b * s; R[2] = a * s + b * c; R[3] = d * c - e * s; R[4] = d * s + e * c
    for (k = 1; k <= 4; k++) if (T[k] == "" || (T[k] - R[k])^2 > (1e-7 * A[4])^2) { print k, T[k], R[k]; exit 1 } }'
done

# refused_packing NAME WORDS FILE
refused_packing() { refused_by rve "$1" "$2" "../$3" --path ../path.csv; }
{ cat p150.data; printf '\nBonds\n\n1 1 1 2\n'; } >bonds.data
refused_packing 'a packing with bonds' "bonds.data:$(grep -n Bonds bonds.data | cut -d: -f1): a section Bonds, which would be lost" bonds.data
sed '3s/^/5 ellipsoids\n/' p150.data >ellipsoids.data
refused_packing 'a packing with ellipsoids' 'ellipsoids.data:3: 5 ellipsoids' ellipsoids.data
sed 's/^Atoms.*/Atoms # hybrid/' p150.data >unknown.data
refused_packing 'a hybrid style that is not named' "style 'hybrid'" unknown.data
iconv -f UTF-8 -t UTF-16 p150.data >utf16.data 2>/dev/null && refused_packing 'a packing in UTF-16' 'utf16.data:1: text in UTF-16' utf16.data
refused_packing 'a packing without end' '/dev/zero:1: not a text file' ../../../../../../../../../dev/zero
{ echo '#format x_y_z_r'; awk '/^Atoms/ { inside = 1 } inside && NF >= 7 { printf "%s %s %s %.17g\n", $5, $6, $7, $3 / 2 }' p150.data; } >spheres.txt
refused_packing 'a list of spheres' 'spheres.txt:2: a list of spheres (x y z r) has no cell' spheres.txt
# what the documentation shows to do with it, with the cell of the packing
sed -n '/^awk -v CONVFMT/,/^```/p' "$root/docs/how-to/packing.md" | grep -v '^```' >recipe.sh
read -r x0 x1 < <(awk '/xlo xhi/ { print $1, $2 }' p150.data)
sed -i "s/-v low=[-0-9.,]* -v high=[-0-9.,]*/-v low=$x0,$x0 -v high=$x1,$x1/" recipe.sh
bash recipe.sh
same_rve 'a list of spheres made into a packing as the documentation shows' packing.data

# ---- tables ----

sed 's/,/;/g; s/\./,/g' path.csv >german.csv
same_rve 'a path with semicolons and decimal commas' p150.data german.csv
sed 's/,/","/g; s/^/"/; s/$/"/' path.csv >quoted.csv
same_rve 'a path with quotes' p150.data quoted.csv
{ printf '\xEF\xBB\xBF'; sed 's/$/,/; 1s/F\([12]*\)/F\1 [-]/g; 1s/step/step/' path.csv; echo ,,,,,; } >excel.csv
same_rve 'a path with units, trailing commas and a byte order mark' p150.data excel.csv
{ echo '# step F11 F12 F21 F22'; sed '1d; s/,/ /g' path.csv; } >numpy.csv
same_rve 'a path with blanks and its header in a comment' p150.data numpy.csv
sed '1s/F11/F11 [%]/' path.csv >percent.csv
refused_by rve 'a path in percent' 'percent.csv:1: no column F11' ../p150.data --path ../percent.csv

printf 'diameter,passing\n0.25,10\n0.5,40\n1.0,80\n2.0,100\n' >ref.csv
# pack SIEVE OUT
pack() { "$granhom" pack --sieve "$1" --count 200 --volume-fraction 0.6 --seed 3 -o "$2" >said 2>said.err; }
pack ref.csv ref.data
say $? 'a packing from a sieve curve'
check '  has the grains of the curve' test "$(awk '/^Atoms/ { inside = 1 } inside && NF >= 7 { n[$3]++ } END { print n["0.25"], n["0.5"], n["1"], n["2"] }' ref.data)" = '98 74 25 3'
# same_sieve NAME: standard input is the same curve
same_sieve() {
  cat >sieve.csv
  rm -f sieve.data
  pack sieve.csv sieve.data
  say $? "a sieve table with $1 is read"
  check '  as the same curve' cmp ref.data sieve.data
}
printf 'diameter;passing\n0,25;10,0\n0,5;40,0\n1,0;80,0\n2,0;100,0\n' | same_sieve 'semicolons and decimal commas'
printf '"diameter","passing"\n"0.25","10"\n"0.5","40"\n"1.0","80"\n"2.0","100"\n' | same_sieve quotes
printf 'd (mm)\tpassing\r\nmm\t%%\r\n0,25\t10%%\r\n0,5\t40%%\r\n1,0\t80%%\r\n2,0\t100%%\r\n' | same_sieve 'tabs, units and percent signs'
printf 'diameter [mm],passing [%%],\n0,0,\n0.25,10,\n0.5,40,\n1.0,80,\n2.0,100,\n,,\n' | same_sieve 'a pan and trailing commas'
printf 'sieve;retained\n2;0\n1;20\n0,5;40\n0,25;30\npan;10\n' | same_sieve 'what each sieve retains'
printf 'sieve,cumulative retained\n2,0\n1,20\n0.5,60\n0.25,90\n' | same_sieve 'what is retained in all'
printf 'diameter,retained\n2,0\n1,10\n0.5,20\n' >doubt.csv
refused_by pack 'a sieve table of two meanings' 'retained_individual or retained_cumulative' --sieve ../doubt.csv --count 100 -o doubt.data
printf 'diameter,passing\n1,50\n2,100\n' >percent.csv
refused_by pack 'a curve in percent without a number of grains' 'needs a number of grains: --count N, at least 5' --sieve ../percent.csv -o out.data
refused_by pack 'a number of grains too small' '1 grains are too few for one of each fraction of the sieve curve: --count must be at least 5' --sieve ../percent.csv --count 1 -o out.data

# ---- files in the place of others ----

scene plain.msh && sed '/^mesh/d; /^packing/d' scene.yaml >rest.yaml && cp scene.yaml a.scene
cp p150.data a.packing
cp path.csv a.path
printf 's11,s22,s12\n-0.1,-0.1,0\n' >a.conditions
cp ref.csv a.sieve
printf 'title: of a study\nrve: {packing: a.packing}\nvary: {micro.tolerance: [1e-3]}\n' >a.study
printf 'steps:\n  - {increments: 1, control: {s11: -0.1, s22: -0.1, s12: 0}}\n' >a.control
printf 'sieve: ref.csv\ncount: 200\n' >a.growth
cp "$data/foreign/plain_v22.msh" a.mesh
"$granhom" rve p150.data --path path.csv --engine native --dump a.dump -o out.csv >said 2>said.err
cp "$root/lammps-inputs/in.compress" a.script
printf '\x89PNG\r\n\x1a\n\0' >a.picture
printf '<?xml version="1.0" ?>\n<Xdmf/>\n' >a.xml
kinds='packing path conditions sieve study control growth mesh dump script picture xml scene'
if has HDF5 'a state in the place of others'; then
  "$granhom" rve p150.data --path path.csv --engine native --save-state a.state -o out.csv >said 2>said.err
  kinds="$kinds state"
fi
# What each looks like, and who takes it
declare -A what=([packing]='a packing (LAMMPS data file)' [path]='a path of F (CSV)' [conditions]='a table of stresses and strains (CSV)'
  [sieve]='a sieve curve (CSV)' [study]='a study (YAML)' [control]='the control file of an element test (YAML)'
  [growth]='the specification of a packing (YAML)' [mesh]='a Gmsh mesh' [dump]='a LAMMPS dump' [script]='a LAMMPS script'
  [picture]='a picture' [xml]='XML' [scene]='a scene (YAML)' [state]='a saved state')
declare -A taken=([packing]='`granhom rve` and `granhom element` take it, and a scene names it: packing: FILE' [path]='`granhom rve PACKING --path` takes it'
  [conditions]='`granhom element PACKING --path` takes it' [sieve]='`granhom pack --sieve` takes it' [study]='`granhom study` takes it'
  [control]='`granhom element PACKING --control` takes it' [growth]='`granhom pack` takes it' [mesh]='a scene names it: mesh: {gmsh: FILE}'
  [script]='`granhom lammps -in` takes it' [scene]='`granhom run` takes it' [state]='`granhom rve PACKING --load-state` takes it')
# misplaced WANTED COMMAND ARGUMENTS...: each other kind in the place of FILE among the arguments, or named by scene.yaml
misplaced() {
  local wanted=$1 command=$2 kind
  shift 2
  for kind in $kinds; do
    [ "$kind" = "$wanted" ] && continue
    [ "$wanted" = conditions ] && [ "$kind" = path ] && continue # a path of F is one of conditions, too
    { printf 'packing: %s\n' "$([ "$wanted" = packing ] && echo "a.$kind" || echo a.packing)"
      printf 'mesh: {gmsh: %s}\n' "$([ "$wanted" = mesh ] && echo "a.$kind" || echo a.mesh)"
      cat rest.yaml; } >scene.yaml
    refused_by "$command" "${what[$kind]} for ${what[$wanted]}" "a.$kind: looks like ${what[$kind]}, and ${what[$wanted]} is wanted${taken[$kind]:+; ${taken[$kind]}}" "${@//FILE/../a.$kind}"
  done
}
misplaced scene run FILE -o out
misplaced study study FILE -o out
misplaced packing rve FILE --path ../path.csv -o out.csv
misplaced packing crosscheck FILE --path ../path.csv -o out
misplaced packing run ../scene.yaml -o out
misplaced mesh run ../scene.yaml -o out
misplaced path rve ../a.packing --path FILE -o out.csv
misplaced control element ../a.packing --control FILE -o out.csv
misplaced conditions element ../a.packing --path FILE -o out.csv
misplaced growth pack FILE -o out.data
misplaced sieve pack --sieve FILE --count 10 -o out.data
has HDF5 && misplaced state rve ../a.packing --path ../path.csv --load-state FILE -o out.csv
refused_by run 'a scene that lacks keys is still one' "needs the key 'mesh'" ../rest.yaml -o out
sed 's/.*/line/' rest.yaml >lines
refused_by rve 'what looks like nothing known' 'neither a header line nor a section' ../lines --path ../path.csv -o out.csv

exit $bad
