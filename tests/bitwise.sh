#!/usr/bin/env bash
# Results to the last bit: tests/bitwise.sh [COMMIT]. Builds COMMIT (1960c4c) with the same compiler in BUILD/bitwise, runs the same
# scenes and the paths of tests/data/cases with both programs, and compares every number of the columns that both have, but for
# seconds. For changes that must change no result. ONLY=PATTERN: those whose name has it; SCENES="block/p01_taylor ...": these
# scenes, or none; LIMIT: seconds of one run (900); what is stopped then is compared as far as both have come. An hour or more.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
cd "$(dirname "$0")/.." || exit 2
root=$(pwd) commit=${1:-1960c4c} build=$(cd "${BUILD:-build}" && pwd) || exit 2
work=$build/bitwise
mkdir -p "$work"
export OMP_NUM_THREADS=1 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
default="block/p01_taylor block/p02_taylor block/p03_taylor block/p01_restricted block/p02_restricted block/p03_restricted
  biaxial/taylor slope/slope_taylor biaxial/restricted block/p01_periodic block/p02_periodic block/p03_periodic
  block/friction20_periodic"
scenes=${SCENES-$default}

if [ ! -x "$work/$commit/build/granhom" ]; then
  rm -rf "${work:?}/$commit"
  git archive --prefix="$commit/" "$commit" | tar -x -C "$work" || exit 2
  make -j2 -C "$work/$commit" BUILD=build all >"$work/build.log" 2>&1 || { tail "$work/build.log"; exit 2; }
fi
passed=0 failed=0
# same NAME OLD NEW: the two tables; counts and prints
same() {
  if /usr/bin/python3 tests/bitwise.py "$2" "$3" >"$work/said"; then
    passed=$((passed + 1))
    echo "ok - $1: $(cat "$work/said")"
  else
    failed=$((failed + 1))
    echo "not ok - $1: $(cat "$work/said")"
  fi
}
for scene in $scenes; do
  [[ $scene == *${ONLY:-}* ]] || continue
  for which in old new; do
    granhom=$build/granhom
    [ $which = old ] && granhom=$work/$commit/build/granhom
    out=$work/$which/${scene//\//_}
    rm -rf "$out" && mkdir -p "$work/$which"
    timeout -s INT "${LIMIT:-900}" "$granhom" run "$root/scenes/$scene.yaml" -o "$out" --quiet >"$out.log" 2>&1
  done
  same "$scene" "$work/old/${scene//\//_}/history.csv" "$work/new/${scene//\//_}/history.csv"
done
while IFS=, read -r name packing path boundary stiffness tangential angle hardening _; do
  [[ $name == *${ONLY:-}* ]] || continue
  options=(--normal-stiffness "$stiffness" --boundary "$boundary" --tolerance 1e-11)
  [ -n "$tangential" ] && options+=(--tangential-stiffness "$tangential" --friction-angle "$angle" --hardening "$hardening")
  for engine in native lammps; do
    for which in old new; do
      granhom=$build/granhom
      [ $which = old ] && granhom=$work/$commit/build/granhom
      mkdir -p "$work/$which"
      timeout "${LIMIT:-900}" "$granhom" rve "tests/data/cases/$packing" --path "tests/data/cases/$path" "${options[@]}" --engine $engine \
        -o "$work/$which/$name.csv" --tangent "$work/$which/$name.tan.csv" </dev/null >"$work/$which/$name.log" 2>&1
    done
    same "$name, $engine" "$work/old/$name.csv" "$work/new/$name.csv"
    same "$name, $engine, tangents" "$work/old/$name.tan.csv" "$work/new/$name.tan.csv"
  done
done < <(tail -n +2 tests/data/cases/cases.csv)
echo "$passed passed, $failed failed"
[ $failed = 0 ]
