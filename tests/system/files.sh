#!/usr/bin/env bash
# Files: one writer in a folder, checksums, new files beside old ones, nothing written for wrong input, standard output that cannot be written.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
root=$(pwd)
granhom=$(cd "${BUILD:-build}" && pwd)/granhom
work=$(mktemp -d)
runner=
trap '[ -n "$runner" ] && kill -9 $runner 2>/dev/null; rm -rf "$work"' EXIT
failed=0
say() { if [ "$1" = 0 ]; then echo "ok - $2"; else echo "not ok - $2"; failed=1; fi; }
cd "$work" || exit 1

printf 'diameter,count\n1,12\n1.4,8\n' >sieve.csv
"$granhom" pack --sieve sieve.csv --seed 3 --finish overlap=0.01 -o p.data >/dev/null 2>&1 || exit 1
"$granhom" pack --sieve sieve.csv --seed 4 --finish overlap=0.01 -o q.data >/dev/null 2>&1
printf 'F11,F12,F21,F22\n1,0,0,1\n0.998,0,0,1.001\n' >path.csv
printf 'F11,F12,F21,F22\n1e-08,0,0,1e-08\n' >first.csv
printf 'F11,F12,F21,F22\n1,0,0,1\n0.78,0,0,0.78\n' >second.csv
rve() { local p=$1; shift; "$granhom" rve "$p" --boundary periodic --engine native "$@"; }
others() { find . -name '*.tmp' | wc -l; }

# --- one writer in a folder ---
sed -e 's/increments: 30/increments: 4000/' -e "s|sand150.data|$root/scenes/block/sand150.data|" "$root/scenes/block/p02_taylor.yaml" >long.yaml
"$granhom" run long.yaml -o out --quiet >/dev/null 2>&1 & runner=$!
for _ in $(seq 600); do [ -e out/history.csv ] && break; sleep 0.05; done
second() { "$granhom" "$@" >said 2>err </dev/null; echo $? >code; }
h5=$("$granhom" --version | grep '^HDF5 yes') || echo 'skip - restart, pictures of packings, checksums and states (no HDF5)'
mpi=$("$granhom" --version | grep '^MPI yes') || echo 'skip - ranks (no MPI)'
for how in run ${h5:+restart} study crosscheck; do
  case $how in
  run) second run long.yaml -o out ;;
  restart) second run long.yaml -o out --restart ;;
  study) printf 'rve:\n  packing: p.data\n  contact: {normal_stiffness: 1}\n  micro: {boundary: periodic, engine: native}\n  path: {legs: [{to: [0.998, 0, 0, 1], increments: 2}]}\nvary: {micro.tolerance: [1e-6, 1e-8]}\nreference: {set: {micro.tolerance: 1e-10}}\n' >study.yaml
    second study study.yaml -o out ;;
  crosscheck) second crosscheck p.data --path path.csv --engines native,gran -o out ;;
  esac
  [ "$(cat code)" = 1 ] && grep -q "^granhom: out: process $runner on host $(hostname) writes into this folder (out/.lock)" err || { cat err; false; }
  say $? "$how in a folder that a run writes into: exit 1, process and host named"
done
rows=$(wc -l <out/history.csv); for _ in $(seq 200); do [ "$(wc -l <out/history.csv)" -gt "$rows" ] && break; sleep 0.05; done; [ "$(wc -l <out/history.csv)" -gt "$rows" ] && [ -z "$(ls out | grep study)" ]; say $? 'the first run continues'
[ -z "$h5" ] || { "$granhom" plot out -o pictures >/dev/null 2>err; [ -s pictures/mesh.png ]; say $? 'pictures can be drawn meanwhile'; }
kill -9 $runner; wait $runner 2>/dev/null; runner=
[ -e out/.lock ]; say $? 'a killed run leaves its lock file'
sed 's/increments: 4000/increments: 2/' long.yaml >short.yaml
"$granhom" run short.yaml -o out --quiet >/dev/null 2>err; [ $? = 0 ] && [ ! -e out/.lock ]; say $? 'which is no obstacle, and goes with the next run'
sed 's/^packing:.*/packing: none.data/' short.yaml >bad.yaml
"$granhom" run bad.yaml -o new/deep >/dev/null 2>err; [ $? = 2 ] && [ ! -e new ]; say $? 'wrong input makes no folder'
[ -z "$mpi" ] || { mpirun --oversubscribe -n 2 "$granhom" run short.yaml -o two --quiet >/dev/null 2>err; [ $? = 0 ] && [ ! -e two/.lock ]; say $? 'the ranks of a run are one owner'; }

# --- checksums ---
if [ -n "$h5" ]; then
flip() { # FILE BYTE BIT
  python3 - "$@" <<'P'
import sys
name, at, bit = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
b = bytearray(open(name, "rb").read()); b[at] ^= 1 << bit
open(name, "wb").write(b)
P
}
rve p.data --path path.csv --save-state s.h5 >/dev/null 2>&1; size=$(stat -c %s s.h5); bad=0
RANDOM=${SEED:=$$}; echo "# SEED=$SEED"
for k in $(seq 24); do
  cp s.h5 f.h5; at=$((k < 8 ? 61 * k : (RANDOM * 32768 + RANDOM) % size)); flip f.h5 $at $((k % 8))
  rve p.data --path path.csv --load-state f.h5 -o f.csv 2>err; [ $? = 2 ] && grep -q '^granhom: f.h5: is damaged' err && [ ! -e f.csv ] || { bad=1; echo "# byte $at"; cat err; }
done
say $bad 'a state with any bit flipped is refused: exit 2, damaged, nothing written'
rve p.data --path path.csv --load-state s.h5 -o g.csv 2>err; say $? 'the state itself is taken'
for what in "q.data --path path.csv|the state belongs to another packing" "p.data --path path.csv --normal-stiffness 2|another contact law: normal stiffness was 1, now it is 2" \
  "p.data --path path.csv --friction-angle 20|another contact law: friction"; do
  rve ${what%%|*} --load-state s.h5 -o f.csv 2>err; [ $? = 2 ] && grep -q "s.h5: .*${what#*|}" err && [ ! -e f.csv ]; say $? "refused: ${what#*|}"
done
"$granhom" rve p.data --path path.csv --boundary restricted --engine native --load-state s.h5 >/dev/null 2>err; [ $? = 2 ] && grep -q 'saved with --boundary periodic' err; say $? 'refused: another boundary condition'
rve p.data --path path.csv --load-state out/results.h5 >/dev/null 2>err; [ $? = 2 ] && grep -q 'holds a results 1 of granhom, wanted is a state' err; say $? 'refused: another kind of file'
head -c 511 s.h5 >f.h5; rve p.data --path path.csv --load-state f.h5 >/dev/null 2>err; [ $? = 2 ] && grep -q 'f.h5: is damaged' err; say $? 'refused: a part of the header'
for name in results.h5 rves.h5; do
  cp -r out broken; flip broken/$name 3000 2
  "$granhom" report broken >/dev/null 2>err; [ $? = 2 ] && grep -q "broken/$name: is damaged" err && [ ! -e broken/report.html ]; say $? "a report of a damaged $name is refused"
  rm -r broken
done
head -n 1 out/results.h5 | grep -qa '^granhom binary file, format 1$'; say $? 'a file states what it is'
/usr/bin/python3 - <<'P'
import h5py, meshio
with h5py.File("out/results.h5") as f:
    assert f.userblock_size == 512 and f["/step0001/displacement"].shape == (16, 3)
with meshio.xdmf.TimeSeriesReader("out/results.xdmf") as reader:
    points, cells = reader.read_points_cells()
    assert points.shape == (16, 3) and reader.num_steps == len([s for s in h5py.File("out/results.h5") if s.startswith("step")])
    reader.read_data(reader.num_steps - 1)
P
say $? 'h5py and meshio read the results'
fi

# --- new files beside old ones ---
echo mine >victim; ln -s victim o.csv.tmp; rve p.data --path path.csv -o o.csv 2>err
[ "$(cat victim)" = mine ] && [ ! -L o.csv ] && [ "$(wc -l <o.csv)" = 3 ]; say $? 'a link at a temporary name is not followed'
chmod 640 o.csv; ln -s o.csv link.csv; rve p.data --path path.csv -o link.csv 2>err
[ -L link.csv ] && [ "$(stat -c %a o.csv)" = 640 ]; say $? 'a link stays, and so do the permissions behind it'
for _ in 1 2 3 4; do rve p.data --path path.csv -o same.csv 2>/dev/null & rve p.data --path second.csv -o same.csv 2>/dev/null & wait; done
head -n 1 same.csv | grep -q '^step,F11' && [ "$(tail -n +2 same.csv | awk -F, 'NF != 20' | wc -l)" = 0 ]; say $? 'two at the same time leave a whole file'
if [ "$(id -u)" = 0 ]; then ask='setpriv --reuid 65534 --regid 65534 --clear-groups'; else ask=; fi
mkdir locked free; cp o.csv free/ro.csv; chmod 755 . locked; chmod 444 free/ro.csv; chmod 777 free
if $ask true 2>/dev/null; then
  for to in locked/x.csv free/ro.csv; do
    $ask "$granhom" rve p.data --path path.csv --boundary periodic --engine native -o "$PWD/$to" 2>err </dev/null; code=$?
    [ $code = 1 ] && grep -q "$to: cannot write: Permission denied" err && [ "$(wc -l <free/ro.csv)" = 3 ]; say $? "$to cannot be written: exit 1, and a message"
  done
fi
[ "$(others)" = 1 ]; say $? 'no temporary file is left' # the link of above

# --- wrong input writes nothing ---
nothing() { # NAME EXIT FILE... -- COMMAND...
  local name=$1 want=$2 code; shift 2; local files=(); while [ "$1" != -- ]; do files+=("$1"); shift; done; shift
  "$@" >/dev/null 2>err; code=$?; local left=0; for f in "${files[@]}"; do [ -e "$f" ] && left=1; done
  [ $code = "$want" ] && [ $left = 0 ] && [ "$(grep -c '^granhom' err)" = 1 ]; local good=$?; say $good "nothing is written: $name"; [ $good = 0 ] || { echo "# exit $code"; cat err; }
  rm -f "${files[@]}"
}
nothing 'F that no packing can follow' 2 a.csv t.csv d.dump s2.h5 -- rve p.data --path first.csv -o a.csv --tangent t.csv --dump d.dump --save-state s2.h5
printf 'F11,F12,F21,F22\n1,0,0,1\n1,0,0,1\n1,0,0,-1\n' >late.csv
nothing 'a bad row late in the path' 2 a.csv t.csv -- rve p.data --path late.csv -o a.csv --tangent t.csv
nothing 'a state of another packing' 2 a.csv d.dump -- rve q.data --path path.csv --load-state s.h5 -o a.csv --dump d.dump
nothing 'two results in one file' 2 a.csv -- rve p.data --path path.csv -o a.csv --tangent a.csv
nothing 'a bad option behind good ones' 2 a.csv -- rve p.data --path path.csv -o a.csv --tolerance x
[ -z "$h5" ] || nothing 'a folder for the state that is missing' 1 a.csv -- rve p.data --path path.csv -o a.csv --save-state none/s.h5
printf 'steps: [{increments: 1, control: {F11: 0.999, F22: 1, F12: 0}}]\n' >good.yaml
nothing 'an element test of another packing' 2 a.csv s2.h5 -- "$granhom" element q.data --control good.yaml --engine native --load-state s.h5 -o a.csv --save-state s2.h5
nothing 'an element test with a table that is none' 2 a.csv -- "$granhom" element p.data --path sieve.csv --engine native -o a.csv
nothing 'a packing with a bad picture' 2 a.data a.gif -- "$granhom" pack --sieve sieve.csv -o a.data --picture a.gif
nothing 'a packing in a cell that is too small' 2 a.data -- "$granhom" pack --sieve sieve.csv --count 2 -o a.data
nothing 'packings with a seed that is none' 2 a-001.data -- "$granhom" pack --sieve sieve.csv -o a.data --ensemble 2 --seed x
rve p.data --path second.csv -o rows.csv --tangent t.csv 2>err; [ $? = 1 ] && [ "$(wc -l <rows.csv)" = 2 ] && [ "$(wc -l <t.csv)" = 2 ]; say $? 'a row behind others that no packing can follow: exit 1, the rows before it are written'
echo before >kept.csv; rve p.data --path first.csv -o kept.csv 2>err; [ $? = 2 ] && [ "$(cat kept.csv)" = before ]; say $? 'an old file stays when the input is wrong'

# --- time limit and standard output ---
begin=$(date +%s); "$granhom" pack --sieve sieve.csv --count 60000 --seconds 1 -o big.data >said 2>err; code=$?; end=$(date +%s)
[ $code = 0 ] && grep -q 'the time limit was reached' said && grep -q 'collisions .* in 1\.[01]' said && [ $((end - begin)) -le 20 ]; say $? 'growth ends at its time limit, and reports how far it came'
for words in help 'help rve' --version 'run --help' "run $work/short.yaml --explain" "rve $work/p.data --path $work/path.csv --engine native"; do
  "$granhom" $words >/dev/full 2>err; [ $? = 1 ] && grep -qi '^granhom: standard output' err; say $? "$words on a full device: exit 1"
done
"$granhom" help >&- 2>err; [ $? = 1 ] && grep -q 'standard output cannot be written' err; say $? 'help with standard output closed: exit 1'
rve p.data --path path.csv -o closed.csv >&- 2>&-; head -n 1 closed.csv | grep -q '^step,F11'; say $? 'a file does not take the place of a stream that is closed'
exit $failed
