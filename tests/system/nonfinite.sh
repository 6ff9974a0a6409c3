#!/usr/bin/env bash
# Loads, lengths and stiffnesses beyond what numbers hold: an error with the reason, never nan or inf in a file. The BLAS
# is named, and another one is warned of. SPDX-License-Identifier: GPL-2.0-or-later
set -u
granhom=$(cd "${BUILD:-build}" && pwd)/granhom
cases=$(pwd)/tests/data/cases
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failed=0
ok() { echo "ok - $1"; }
not_ok() { echo "not ok - $1"; shift; printf '#   %s\n' "$@"; failed=1; }

# scaled FACTOR FILE: the packing p20 with all lengths times FACTOR
scaled() {
  awk -v s="$1" '/[xy]lo/ {printf "%.17g %.17g %s %s\n", $1*s, $2*s, $3, $4; next}
    /^Atoms/ {atoms = 1} atoms && NF == 7 {printf "%s %s %.17g %s %.17g %.17g 0\n", $1, $2, $3*s, $4, $5*s, $6*s; next} {print}' \
    "$cases/packings/p20.data" >"$2"
}

# clean FOLDER_OR_FILE: no number in it is nan or inf
clean() { ! grep -rEiq '(^|[, :])[-+]?(nan|inf)([, ]|$)' "$@" --include='*.csv' --include='*.json' --include='*.lammpstrj'; }

cp "$cases/packings/p20.data" p.data
# scene LINES...: a block of four elements with these lines
scene() {
  printf '%s\n' 'packing: p.data' 'contact: {normal_stiffness: 50}' 'micro: {boundary: taylor-cell, engine: native}' \
    'start: {balance: true}' 'mesh: {rectangle: {size: [10, 10], elements: [2, 2]}}' \
    "supports: [{edge: left, fix: x}, {edge: ${fixed:-bottom}, fix: y}]" "$@" >scene.yaml
}
# fails WHAT PATTERN LINES...: the scene ends with status 1, the reason, and clean files
fails() {
  local what=$1 pattern=$2
  shift 2
  scene "$@"
  rm -rf out
  timeout 100 "$granhom" run scene.yaml -o out >log 2>err
  local code=$?
  if [ $code = 1 ] && grep -Eq "^granhom: .*$pattern" err && clean out; then ok "$what"
  else not_ok "$what" "exit status $code" "$(tail -n 1 err)" "$(grep -rEi 'nan|inf' out/*.csv | head -n 2)"; fi
}
fails 'a force whose square overflows' 'no equilibrium' 'steps: [{increments: 1, forces: [{set: top, to: [0, -1e160]}]}]'
fails 'the same in several increments' 'increment 1 of 3' 'steps: [{increments: 3, forces: [{set: top, to: [0, -1e170]}]}]'
fails 'a weight whose square overflows' 'no equilibrium' 'gravity: [0, -1e153]' 'steps: [{increments: 1, forces: [{set: top, to: [0, 0]}]}]'
scene 'steps: [{increments: 1, displace: [{edge: top, y: 1e200}]}]'
rm -rf out
"$granhom" run scene.yaml -o out >log 2>err; code=$?
if [ $code = 2 ] && grep -q '^granhom: scene.yaml:7: this displacement' err && [ ! -e out ]; then ok 'a displacement whose square overflows is refused'
else not_ok 'a displacement whose square overflows is refused' "exit status $code" "$(tail -n 1 err)"; fi
fixed=left fails 'a footing with a force whose square overflows' 'no equilibrium' 'steps: [{increments: 1, footing: [{edge: right, force: [-1e160, 0], at: [10, 7]}]}]'

# packings in other units: the stress of the plain one, or a refusal
printf 'step,F11,F12,F21,F22\n0,1,0,0,1\n1,0.999,0,0,1\n' >path.csv
stress() { tail -n 1 "$1" | cut -d, -f6; }
"$granhom" rve p.data --path path.csv --normal-stiffness 50 -o plain.csv >/dev/null 2>&1
right=$(stress plain.csv)
for engine in native lammps; do
  for s in 1e-100 1e100; do
    scaled $s s.data
    if timeout 100 "$granhom" rve s.data --path path.csv --normal-stiffness 50 --engine $engine -o s.csv >log 2>err &&
      awk -v a="$right" -v b="$(stress s.csv)" 'BEGIN {d = a/b - 1; exit !(d < 1e-7 && d > -1e-7)}'; then
      ok "$engine: lengths times $s give the same stress"
    else not_ok "$engine: lengths times $s" "$right $(stress s.csv)" "$(tail -n 1 err)"; fi
  done
  for s in 1e-160 1e-130 1e130 1e150; do
    scaled $s s.data
    rm -f s.csv
    timeout 100 "$granhom" rve s.data --path path.csv --normal-stiffness 50 --engine $engine -o s.csv >log 2>err
    code=$?
    if [ $code = 2 ] && grep -q 'choose other units' err && [ ! -e s.csv ]; then ok "$engine: lengths times $s are refused"
    else not_ok "$engine: lengths times $s are refused" "exit status $code" "$(tail -n 1 err)"; fi
  done
done
scaled 1e-160 s.data
scene 'steps: [{increments: 1, displace: [{edge: top, y: -0.01}]}]'
sed -i 's/p.data/s.data/' scene.yaml
rm -rf out
"$granhom" run scene.yaml -o out >log 2>err
code=$?
if [ $code = 2 ] && grep -q 'choose other units' err && [ ! -e out ]; then ok 'a scene with tiny grains is refused, and nothing is written'
else not_ok 'a scene with tiny grains is refused' "exit status $code" "$(tail -n 1 err)"; fi

# the BLAS: named, and told when it is another
blas=$(ldd "$granhom" | awk '/blas/ {print $3; exit}')
scene 'steps: [{increments: 2, displace: [{edge: top, y: -0.01}]}]'
rm -rf out
"$granhom" run scene.yaml -o out >log 2>&1
file=$(basename "$(readlink -f "$blas")")
if grep -q "\"blas\":.*$file" out/run.json; then ok "run.json names the BLAS ($file)"
else not_ok "run.json names the BLAS" "$blas" "$(grep blas out/run.json)"; fi
"$granhom" rve p.data --path path.csv --normal-stiffness 50 -o o.csv --save-state state.h5 >/dev/null 2>&1
cat >other.c <<'C'
void dgemm_(const char *ta, const char *tb, const int *m, const int *n, const int *k, const double *a, const double *A,
            const int *lda, const double *B, const int *ldb, const double *b, double *C, const int *ldc);
void dgemm_(const char *ta, const char *tb, const int *m, const int *n, const int *k, const double *a, const double *A,
            const int *lda, const double *B, const int *ldb, const double *b, double *C, const int *ldc) {
  for (int i = 0; i < *m; i++)
    for (int j = 0; j < *n; j++) {
      double sum = 0;
      for (int l = 0; l < *k; l++)
        sum += (*ta == 'N' ? A[i + l * *lda] : A[l + i * *lda]) * (*tb == 'N' ? B[l + j * *ldb] : B[j + l * *ldb]);
      C[i + j * *ldc] = *a * sum + (*b == 0 ? 0 : *b * C[i + j * *ldc]);
    }
}
const char *bli_info_get_version_str(void);
const char *bli_info_get_version_str(void) { return "version 7 of another one"; }
C
if ! "$granhom" --version | grep -q '^HDF5 yes'; then
  echo "skip - another BLAS at a restart (no HDF5)"
elif ! ${CC:-cc} -shared -fPIC -o libother.so other.c 2>err; then
  echo "skip - no compiler for another BLAS"
else
  "$granhom" run scene.yaml -o out --restart >log 2>&1
  if grep -q 'BLAS' log; then not_ok 'a restart under the same BLAS warns of nothing' "$(grep BLAS log)"; else ok 'a restart under the same BLAS warns of nothing'; fi
  LD_PRELOAD=$work/libother.so "$granhom" run scene.yaml -o out --restart >log 2>&1
  code=$?
  if [ $code = 0 ] && grep -q "made with the BLAS .*$file.*now it is .*libother.so; version 7 of another one" log; then ok 'a restart under another BLAS warns'
  else not_ok 'a restart under another BLAS warns' "exit status $code" "$(tail -n 3 log)"; fi
  LD_PRELOAD=$work/libother.so "$granhom" rve p.data --path path.csv --normal-stiffness 50 -o o.csv --load-state state.h5 >log 2>&1
  code=$?
  if [ $code = 0 ] && grep -q "saved with the BLAS .*$file.*now it is .*libother.so" log; then ok 'a state that another BLAS has made warns'
  else not_ok 'a state that another BLAS has made warns' "exit status $code" "$(tail -n 3 log)"; fi
fi
[ $failed = 0 ]
