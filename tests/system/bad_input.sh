#!/bin/sh
# Wrong scenes: one clear message with file and line, exit status 2, nothing written. SPDX-License-Identifier: GPL-2.0-or-later
set -u
granhom=$(cd "${BUILD:-build}" && pwd)/granhom
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
cp tests/data/cases/packings/block150.data "$work/ok.data"
cd "$work" || exit 1

# scene KEY: a whole scene to standard output, with the text of one key replaced by standard input when KEY is not empty
scene() {
  for key in packing contact micro start mesh supports steps extra; do
    if [ "$key" = "${1:-}" ]; then cat; continue; fi
    case $key in
      packing) echo 'packing: ok.data' ;;
      contact) echo 'contact: {normal_stiffness: 50}' ;;
      micro) echo 'micro: {boundary: taylor, engine: native}' ;;
      start) echo 'start: {confinement: 0.01}' ;;
      mesh) echo 'mesh: {rectangle: {size: [10, 10], elements: [2, 2]}}' ;;
      supports) printf 'supports:\n  - {edge: left, fix: x}\n  - {edge: bottom, fix: y}\n' ;;
      steps) printf 'steps:\n  - {name: push, increments: 1, displace: [{edge: top, y: -0.01}]}\n' ;;
    esac
  done
}

# bad WHAT PATTERN: runs scene.yaml and expects the pattern (grep -E) in a single message
bad() {
  "$granhom" run "${scene_file:-scene.yaml}" -o "${out:-out}" >log 2>err
  code=$?
  why=
  [ $code = 2 ] || why="exit status $code instead of 2"
  grep -Eq "$2" err || why="$why; the message does not match '$2'"
  [ "$(grep -c '^granhom: ' err)" = 1 ] || why="$why; not one message"
  [ -d out ] && why="$why; a folder was written"
  rm -rf out
  if [ -z "$why" ]; then echo "ok - $1"; return; fi
  echo "not ok - $1: ${why#; }"
  sed 's/^/#   /' err
  failed=1
}
with() { scene "$1" >scene.yaml; }

with extra <<'E'
tilte: Typing error
E
bad 'unknown key' 'scene.yaml:[0-9]+: .*tilte.*title'
with micro <<'E'
micro: {boundry: taylor}
E
bad 'unknown key inside a map' 'scene.yaml:3: .*boundry.*boundary'
with contact <<'E'
contact: {normal_stiffness: fifty}
E
bad 'wrong type: a word for a number' 'scene.yaml:2: .*normal_stiffness'
with steps <<'E'
steps: {name: push}
E
bad 'wrong type: a map for a list' 'scene.yaml:[0-9]+: .*steps.*list'
with contact <<'E'
contact: {normal_stiffness: -50}
E
bad 'negative stiffness' 'scene.yaml:2: .*normal_stiffness.*-50'
with contact <<'E'
contact: {normal_stiffness: .nan}
E
bad 'stiffness that is no number' 'scene.yaml:2: .*normal_stiffness'
with packing <<'E'
packing: nowhere.data
E
bad 'missing packing' 'scene.yaml:1: .*nowhere.data'
with packing </dev/null
bad 'no packing named' 'scene.yaml:1: .*packing'
with micro <<'E'
micro: {boundary: tailor}
E
bad 'bad boundary word' 'scene.yaml:3: .*tailor.*taylor.*periodic'
with micro <<'E'
micro: {engine: abacus}
E
bad 'bad engine word' 'scene.yaml:3: .*abacus'
with micro <<'E'
micro: {tolerance: 0}
E
bad 'tolerance of zero' 'scene.yaml:3: .*tolerance'
with mesh <<'E'
mesh: {rectangle: {size: [10, -10], elements: [2, 2]}}
E
bad 'negative size' 'scene.yaml:5: .*size'
with mesh <<'E'
mesh:
  rectangle: {size: [10, 10], elements: [2, 2]}
  move: [{node: [5, 5], by: [9, 0]}]
E
bad 'inverted element' 'scene.yaml:[56]: .*element'
with mesh <<'E'
mesh:
  rectangle: {size: [10, 10], elements: [2, 2]}
  move: [{node: [4, 5], by: [0, 0]}]
E
bad 'a node to move that is not there' 'scene.yaml:7: .*no node at \(4, 5\)'
with mesh <<'E'
mesh: {gmsh: nowhere.msh}
E
bad 'missing mesh file' 'scene.yaml:5: .*nowhere.msh'
with supports <<'E'
supports: [{edge: lefft, fix: x}]
E
bad 'an edge that does not exist' 'scene.yaml:6: .*lefft.*left, right, bottom, top'
with supports <<'E'
supports: [{edge: left, fix: z}]
E
bad 'a direction that does not exist' 'scene.yaml:6: .*z.*x, y or both'
with supports </dev/null
bad 'no supports' 'scene.yaml:[0-9]+: nothing holds the body in x'
with supports <<'E'
supports: [{edge: left, fix: x}, {edge: right, fix: x}, {edge: bottom, fix: y}]
E
bad 'a confinement without an edge to act on' 'scene.yaml:4: the confinement finds no edge'
{ scene steps </dev/null | grep -v -e '^ *- {edge' -e '^supports'; cat <<'E'; } >scene.yaml
supports: [{edge: left, fix: y}, {edge: bottom, fix: x}]
steps:
  - {increments: 1, pressure: [{edge: right, to: 0.02}]}
E
bad 'supports that leave a rotation free' 'scene.yaml: .*node|scene.yaml: .*rotat'
with steps <<'E'
steps:
  - {name: push, displace: [{edge: top, y: -0.01}]}
E
bad 'a step without increments' 'scene.yaml:10: .*increments'
with steps <<'E'
steps: []
E
bad 'no steps' 'scene.yaml:9: .*steps'
with steps <<'E'
steps:
  - {increments: 1, pressure: [{edge: right, to: 1}, {edge: right, to: 2}]}
E
bad 'pressure given twice for an edge' 'scene.yaml:10: .*right.*twice'
with steps <<'E'
steps:
  - {increments: 1, displace: [{edge: top}]}
E
bad 'a displacement without target' 'scene.yaml:10: .*target'
with steps <<'E'
steps:
  - {increments: 1, release: [{edge: top, free: y}]}
E
bad 'a release of what nothing drives' 'scene.yaml:10: .*releases .top. in y'
with start <<'E'
start: {confinement: -1}
E
bad 'negative confinement' 'scene.yaml:4: .*confinement'
with start <<'E'
start: {confinement: 1, balance: true}
E
bad 'two ways to start' 'scene.yaml:4: .*confinement.*balance'
with start </dev/null
bad 'a packing under stress without load' 'scene.yaml:1: .*under stress.*start: \{confinement'
printf 'packing: [ok.data\ncontact: {' >scene.yaml
bad 'no YAML' 'scene.yaml:[0-9]+: '
: >scene.yaml
bad 'empty scene' 'scene.yaml'
scene_file=nowhere.yaml
bad 'missing scene' 'nowhere.yaml'
scene_file=

scene >scene.yaml
: >file
out=file
bad 'an output directory that is a file' 'file: .*(file|folder)'
out=file/below
bad 'an output directory below a file' 'file: .*(file|folder|directory)'
out=

# Decimal commas: in a map they make a key of their own
with steps <<'E'
steps: [{increments: 1, displace: [{edge: top, y: -0,2}]}]
E
bad 'a decimal comma in a displacement' 'scene.yaml:[0-9]+: -0,2 has a comma: a decimal point is wanted'
with steps <<'E'
steps: [{increments: 1, displace: [{edge: top, x: 0,1, y: -0,1}]}]
E
bad 'two decimal commas' 'scene.yaml:[0-9]+: 0,1 has a comma: a decimal point is wanted'
with start <<'E'
start: {confinement: 1,5e-2}
E
bad 'a decimal comma and an exponent' 'scene.yaml:4: 1,5e-2 has a comma'
with contact <<'E'
contact: {normal_stiffness: 1,000}
E
bad 'a comma between thousands' 'scene.yaml:2: 1,000 has a comma: .*no sign between thousands'
with contact <<'E'
contact:
  normal_stiffness: 50,5
E
bad 'a decimal comma in a line of its own' "scene.yaml:3: normal_stiffness: '50,5' is not a finite number \(a comma"
with mesh <<'E'
mesh: {rectangle: {size: [10,5, 10], elements: [2, 2]}}
E
bad 'a decimal comma in a list' 'scene.yaml:5: size has 3 items, 2 numbers are wanted \(with decimal commas\?'

# Packings: line 12 of ok.data is its first grain
packing() { sed "$1" ok.data >bad.data; echo 'packing: bad.data' | scene packing >scene.yaml; }
packing 'd'
bad 'empty data file' 'bad.data'
packing '100,$d'
bad 'truncated data file' 'bad.data.*(150|atoms)'
packing '13s/^2 /1 /'
bad 'an id that occurs twice' 'bad.data:13: .*(id|1).*twice|bad.data:13: '
packing '12s/0\.25/0/'
bad 'zero radius' 'bad.data:12: '
packing '12s/0\.25/-0.25/'
bad 'negative radius' 'bad.data:12: '
packing '12s/-0\.31[0-9]*/nan/'
bad 'a coordinate that is NaN' 'bad.data:12: .*nan'
packing '12s/0\.0$/0.5/'
bad 'a grain out of the plane' 'bad.data:12: '

packing "13s/ [-0-9.]* [-0-9.]* 0\.0\$/ $(sed -n 12p ok.data | cut -d ' ' -f 5,6) 0.0/"
bad 'two grains at one place' 'bad.data: grains 1 and 2 are at one place'
packing 's/^.*xlo xhi/0 1e-9 xlo xhi/'
bad 'a cell far too small for its grains' 'bad.data: the grains fill the cell .* times'
packing 's/^150 atoms/150000 atoms/'
bad 'fewer grains than the header states' 'bad.data:[0-9]+: 150 atoms, but the header .* states 150000'
packing '12s/ 1 / 7 /'
bad 'a type beyond the number of types' "bad.data:12: type '7'"
echo 'packing: .' | scene packing >scene.yaml
bad 'a folder for a packing' 'scene.yaml:1: .*is a folder'

# More of scenes and meshes
with mesh <<'E'
mesh: {rectangle: {size: [10, 1e-300], elements: [2, 2]}}
E
bad 'a mesh without area' 'scene.yaml:5: .*element 0 .*inverted'
with mesh <<'E'
mesh: {rectangle: {size: [10, 10], elements: [100000, 100000]}}
E
bad 'a mesh beyond all memory' 'scene.yaml:5: .*elements are more than'
mesh_file() { # with the third of its four corners at $1
  cat >bad.msh <<E
\$MeshFormat
2.2 0 8
\$EndMeshFormat
\$Nodes
4
1 0 0 0
2 1 0 0
3 $1 0
4 0 1 0
\$EndNodes
\$Elements
1
1 3 2 1 1 1 2 3 4
\$EndElements
E
}
echo 'mesh: {gmsh: bad.msh}' | scene mesh >scene.yaml
mesh_file '0.1 0.1'
bad 'a mesh file with an element that is not convex' 'scene.yaml:5: .*bad.msh:13: quadrilateral 1 is inverted or not convex'
mesh_file 'nan 1'
bad 'a mesh file with NaN' 'scene.yaml:5: .*bad.msh:8: '
: >bad.msh
bad 'an empty mesh file' 'scene.yaml:5: .*bad.msh:1: the file is empty'
head -c 100000 /dev/zero | tr '\0' '[' >scene.yaml
bad 'a scene of brackets' 'scene.yaml:1: more than 200 brackets are open'
with steps <<'E'
steps:
  - {increments: 1, displace: [{edge: top, y: .nan}]}
E
bad 'a displacement that is NaN' 'scene.yaml:10: .*nan'
with extra <<'E'
output: {rves: [999]}
E
bad 'an integration point to record that is not there' 'scene.yaml:[0-9]+: .*999.*15'
with extra <<'E'
solver: {method: magic}
E
bad 'a solver that does not exist' 'scene.yaml:[0-9]+: .*magic.*newton'

# A packing without contacts is none of these: it is computed, and the failure states which points carry nothing
awk 'NF == 7 && $4 == 1 { $3 *= 0.2 } { print }' ok.data >bad.data
echo 'packing: bad.data' | scene packing >scene.yaml
"$granhom" run scene.yaml -o loose --quiet >log 2>err; code=$?
if [ $code = 1 ] && grep -q '16 of 16 integration points are unjammed .*: 0, 1, 2' err; then
  echo 'ok - a packing without contacts: exit 1, the unjammed points are named'
else
  echo "not ok - a packing without contacts: exit $code"
  sed 's/^/#   /' err
  failed=1
fi

# Pictures
scene >scene.yaml
"$granhom" run scene.yaml -o good --quiet >log 2>err
# badplot WHAT PATTERN ARGUMENTS...: a single message, exit status 2
badplot() {
  what=$1 pattern=$2
  shift 2
  "$granhom" plot "$@" >log 2>err; code=$?
  if [ $code = 2 ] && grep -Eq "$pattern" err && [ "$(grep -c '^granhom' err)" = 1 ]; then echo "ok - plot: $what"
  else echo "not ok - plot: $what: exit $code"; sed 's/^/#   /' err; failed=1; fi
}
badplot 'a folder that does not exist' 'nothere: holds no results' nothere
badplot 'a file for a folder' 'file: holds no results' file
badplot 'a folder without results' 'holds no results' .
badplot 'no folder' 'a folder of results is needed'
badplot 'an unknown option' 'unknown option --foo' good --foo
h5=$("$granhom" --version | grep '^HDF5 yes') || echo 'skip - plot: recorded points (no HDF5)'
[ -z "$h5" ] || badplot 'a point that is not recorded' 'integration point 99 is not recorded' good --point 99
badplot 'a point that is no number' 'point must be an integer from 0 to 100000000, not "x"' good --point x
cp -r good cut
if [ -n "$h5" ]; then
  head -c 3000 good/results.h5 >cut/results.h5
  badplot 'a truncated file of results' 'cut/results.h5: is damaged' cut
fi
echo '{' >cut/run.json
badplot 'a broken run.json' 'cut/run.json: is no JSON' cut
rm -f good/*.png
[ -z "$h5" ] || badplot 'a point that is not recorded, once more' 'integration point 99 is not recorded' good --point 99
cp -r good odd && sed -i '2s/^[^,]*/x/' odd/convergence.csv
badplot 'a table of the last picture that cannot be read' 'odd/convergence.csv:2' odd
if ls good/*.png odd/*.png >log 2>&1; then echo 'not ok - plot: pictures before a refusal'; failed=1
else echo 'ok - plot: no picture is drawn before a refusal'; fi

# Options
"$granhom" run 2>err; code=$?
[ $code = 2 ] && grep -q 'scene file is needed' err && echo 'ok - run without arguments' || { echo 'not ok - run without arguments'; failed=1; }
"$granhom" runn 2>err; code=$?
[ $code = 2 ] && grep -q "did you mean 'run'" err && echo 'ok - a command that does not exist' || { echo 'not ok - a command that does not exist'; failed=1; }
exit $failed
