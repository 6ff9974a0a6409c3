#!/bin/sh
# Grains with friction: the experiments of section 7.3 of the dissertation with an ensemble of packings, the same under restricted and
# periodic conditions, and the block with friction. Runs what has no results yet, checks them in numbers (exit status 1 when a
# check fails), puts tables into docs/reports/friction.md and docs/reports/verification.md and curves into docs/figures.
#   friction-study.sh BUILD [OUTDIR]     ENGINE=lammps|native, FRESH=1 repeats all runs, JOBS=2 at a time,
#                                        PACKINGS=15 for Taylor, RELAXED=5 for the other conditions,
#                                        TABLES=1 runs nothing and takes what is there
# Frictionless blocks are taken over from scripts/block-study.sh where BUILD has its results.
# SPDX-License-Identifier: GPL-2.0-or-later
set -eu
cd "$(dirname "$0")/.."
root=$(pwd)
build=${1:-build}
ENGINE=${ENGINE:-lammps}
PACKINGS=${PACKINGS:-15}
RELAXED=${RELAXED:-5}
mkdir -p "${2:-$build/friction-study}/$ENGINE"
out=$(cd "${2:-$build/friction-study}/$ENGINE" && pwd)
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 ENGINE FRESH="${FRESH:-0}"

# the program may be rebuilt while this is running
cp "$build/granhom" "$out/granhom"
cp "$build/tests/verify/test_friction" "$out/test_friction"
scenes/friction/paths.sh "$out/paths"
[ "$FRESH" = 0 ] && [ -e "$out/sand-$(printf %03d "$PACKINGS").data" ] ||
  "$out/granhom" pack scenes/friction/sand.yaml --ensemble "$PACKINGS" -o "$out/sand.data" >"$out/sand.log"

# The block with friction under three conditions, and without friction for comparison.
for boundary in taylor restricted periodic; do
  for kind in friction20 p02; do
    sed -e "s|^packing: *|packing: $root/scenes/block/|" -e "s|boundary: periodic|boundary: $boundary|" \
      "scenes/block/${kind}_periodic.yaml" >"$out/${kind}_$boundary.yaml"
  done
done

for boundary in taylor restricted periodic; do
  from="$build/block-study/p02_$boundary" to="$out/block_p02_$boundary"
  if [ -e "$from/history.csv" ] && grep -q '"status":[[:space:]]*"done"' "$from/run.json" && ! [ -e "$to.status" ]; then
    cp -r "$from" "$to" && cp "$from.log" "$to.log" && echo 0 >"$to.status"
  fi
done

# A job is a name: block_SCENE, or KIND_BOUNDARY_AXIS_MOST_ANGLE_HARDENING_PACKING. A run that fails is a result, too: it leaves its
# exit status, its last message, and the increments before.
cat >"$out/one.sh" <<'E2'
cd "$1" || exit 1
[ "$FRESH" = 0 ] && [ -e "$2.status" ] && exit 0
code=0
# programs that begin and end at the same time would take away each other's directory of Open MPI
TMPDIR=$(mktemp -d) && export TMPDIR
case $2 in
block_*) ./granhom run "${2#block_}.yaml" -o "$2" --engine "$ENGINE" >"$2.log" 2>&1 || code=$? ;;
*)
  IFS=_ read -r kind boundary axis most angle hardening packing <<E3
$2
E3
  # floating grains may need many steps; with hardening there may be no equilibrium to wait for
  [ "$hardening" = 0 ] && steps=400000 || steps=50000
  [ "$kind" = cyclic ] && path="cyclic-$most" || path="$kind-$axis-$most"
  ./granhom rve "sand-$packing.data" --path "paths/$path.csv" --boundary "$boundary" --engine "$ENGINE" --normal-stiffness 1000 \
    --friction-angle "$angle" --hardening "$hardening" --max-steps $steps --allow-overlap -o "$2.csv" >"$2.log" 2>&1 || code=$?
  ;;
esac
rm -rf "$TMPDIR"
echo $code >"$2.status"
echo "$2: $(tail -n 1 "$2.log") (exit status $code)"
E2

# jobs KIND AXES MOST ANGLES HARDENINGS BOUNDARIES PACKINGS
jobs() {
  for packing in $(seq -f %03g "$7"); do
    for boundary in $6; do
      for axis in $2; do
        for angle in $4; do
          for hardening in $5; do echo "$1_${boundary}_${axis}_$3_${angle}_${hardening}_$packing"; done
        done
      done
    done
  done
}
{
  for boundary in periodic restricted taylor; do echo "block_friction20_$boundary block_p02_$boundary"; done
  jobs uniaxial "1 2" 0.3 "0 10 20 30" 0 taylor "$PACKINGS"
  jobs uniaxial "1 2" 0.1 "0 10 20 30" 0 "restricted periodic" "$RELAXED"
  jobs cyclic 1 0.5 30 "0 1000" taylor "$PACKINGS"
  jobs shear "1 2" 1 "0 10 20 30" 0 taylor "$PACKINGS"
  jobs shear "1 2" 0.2 "0 10 20 30" 0 "restricted periodic" "$RELAXED"
  jobs cyclic 1 0.05 30 "0 1000" "restricted periodic" "$RELAXED"
} | xargs -n 1 | if [ "${TABLES:-0}" = 0 ]; then xargs -n 1 -P "${JOBS:-2}" sh "$out/one.sh" "$out"; else cat >"$out/jobs.txt"; fi

GH_ENGINE=$ENGINE "$out/test_friction" >"$out/test_friction.txt" 2>&1 || echo "test_friction failed: see $out/test_friction.txt" >&2
python=/usr/bin/python3
verdict=0
"$python" -B scripts/friction_study.py "$out" docs || verdict=$?
figures=docs/figures/friction
for kind in uniaxial shear; do
  gnuplot -e "out='$out'; png='$figures-$kind.png'; kind='$kind'; left='taylor 1'; right='taylor 2'" scripts/friction-curves.gp
  gnuplot -e "out='$out'; png='$figures-$kind-relaxed.png'; kind='$kind'; left='restricted 1'; right='periodic 1'" scripts/friction-curves.gp
done
gnuplot -e "out='$out'; png='$figures-cyclic.png'; conditions='taylor'" scripts/friction-cyclic.gp
gnuplot -e "out='$out'; png='$figures-cyclic-relaxed.png'; conditions='restricted periodic'" scripts/friction-cyclic.gp
gnuplot -e "out='$out'; png='$figures-block.png'" scripts/friction-block.gp
echo "docs/reports/friction.md, docs/reports/verification.md and docs/figures/friction-*.png are up to date"
exit $verdict
