#!/usr/bin/env bash
# make faults: every allocation and every call on files of granhom's commands fails once (faultpoint.c, faultcalls.c, drive.py). Prints what
# went wrong, a table, and "N passed, N failed". BUILD: the folder of the build; SAMPLE=N: so many points of each row, drawn with SEED;
# JOBS: rows at the same time; ROWS: those to go through ("run:io:hard restart:own:hard"). Of points that the same calls lead to, the first,
# the second and the last fail (with ranks, and in libraries, the first): some 25,000 runs, half an hour on two free cores.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
cd "$(dirname "$0")/../.." || exit 1
BUILD=$(cd "${BUILD:-build}" && pwd) || exit 1
here=$(pwd)/tests/faults
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_mpi_yield_when_idle=1
export OMPI_MCA_btl_base_warn_component_unused=0 OMPI_MCA_btl_vader_single_copy_mechanism=none
${CC:-gcc} -std=gnu17 -O2 -Wall -Wextra -shared -fPIC "$here/faultpoint.c" "$here/faultcalls.c" -o "$work/faultpoint.so" -ldl || exit 1

seed=${SEED:-$(date +%s)}
few=()
[ -n "${SAMPLE:-}" ] && { few=(--sample "$SAMPLE" "$seed"); echo "a sample of $SAMPLE points a row, SEED=$seed"; }
single="run restart rve element pack report plot study load explain rve-stdout rve-lammps run-lammps"
ranks="run-ranks@0 run-ranks@1 study-ranks@0 study-ranks@1"
if [ -z "${ROWS:-}" ]; then
  for case in $single; do
    ROWS="${ROWS:-} $case:own:hard $case:io:hard"
    [ "$case" = run-lammps ] || ROWS="$ROWS $case:lib:hard" # LAMMPS is in rve-lammps, the other libraries in run
    case $case in run | restart | rve | pack | report) ROWS="$ROWS $case:io:soft $case:io:short $case:io:full" ;; esac
  done
  for case in $ranks; do ROWS="$ROWS $case:own:hard $case:io:hard"; done
fi
one() {
  IFS=: read -r case kind flavour <<<"$1"
  "$here/drive.py" "$BUILD/granhom" "$work/faultpoint.so" "$case" "$kind" "$flavour" "${@:2}" 2>&1 ||
    echo "table $1 ended with an error: 0 0 0 0 0 0 1"
}
export -f one
export here work BUILD
# shellcheck disable=SC2086
printf '%s\n' $ROWS | xargs -P "${JOBS:-2}" -I{} bash -c 'one "$@"' one {} ${few[@]+"${few[@]}"} | tee "$work/said" | grep --line-buffered -v '^table'
echo
echo "command        kind fails   points   tried  exit 0  exit 1  theirs  failed"
sed -n 's/^table //p' "$work/said" | sort
awk '/^table/ { tried += $6; failed += $NF; theirs += $(NF - 1) } END { printf "%d passed, %d failed", tried - failed - theirs, failed
  printf theirs ? " (and %d in which a library crashes in its own code, where its own allocation fails)\n" : "\n", theirs }' "$work/said" >"$work/sum"
grep -o '(and.*' "$work/sum" | tr -d '()'
sed 's/ (.*//' "$work/sum"
! grep -qv ' 0 failed' <(sed 's/ (.*//' "$work/sum")
