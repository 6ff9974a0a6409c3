#!/usr/bin/env bash
# Runs all tests that `make check` has built, and the scripts in tests/system, two at a time, the longest first. One line per program with
# its time, the output of those that failed, and a sum as the last line. BUILD: the folder of the build; SANITIZED=1: it holds a sanitizer.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
cd "$(dirname "$0")/.." || exit 1
export BUILD=${BUILD:-build}
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 # containers run as root
export OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_mpi_yield_when_idle=1 # more ranks than cores
export PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe # the same for Open MPI 5
# The ranks of a test are on one machine, whose network may not be usable; looking for networks takes longer than starting LAMMPS.
export OMPI_MCA_btl=^tcp,ofi,openib OMPI_MCA_pml=ob1
export OMPI_MCA_btl_base_warn_component_unused=0 OMPI_MCA_btl_vader_single_copy_mechanism=none
# What Open MPI, LAMMPS and CHOLMOD keep until the end is no leak of ours; tests/valgrind.sh looks for those. Sizes beyond all memory are
# refused as they are without a sanitizer, and libraries may be loaded before it.
export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_leaks=0:allocator_may_return_null=1:verify_asan_link_order=0} UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1}
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
# The jobs of `make -j check` are not those of make in a test, which would complain of it.
MAKEFLAGS=$(sed -E 's/(^| )(-j[0-9]*|--jobserver-[a-z]+=[^ ]*)//g' <<<"${MAKEFLAGS:-}") && export MAKEFLAGS
limit=${TEST_TIMEOUT:-1200} # seconds for one program
jobs=${TEST_JOBS:-2}

work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
export work limit

# Numbers of cmocka's own summary: "[  PASSED  ] 5 test(s)." and the like.
count() { sed -n "s/^\[ *$2 *\] \([0-9][0-9]*\) test(s).*/\1/p" "$1" | tail -n 1; }

# Runs one test; leaves its output and a line "passed failed skipped" behind, and prints its line.
run_one() {
  local test=$1 name out begin end code passed failed skipped
  name=${test#"$BUILD"/}
  name=${name#tests/}
  out=$work/${name//\//_}
  begin=$(date +%s.%N)
  local run=("$test")
  [ "${test%.sh}" != "$test" ] && run=(bash "$test")
  # Open MPI's session folders of processes that start and end at once get in each other's way
  mkdir -p "$out.mpi"
  export OMPI_MCA_orte_tmpdir_base=$out.mpi
  { timeout -k 10 "$limit" "${run[@]}" >"$out" 2>&1 </dev/null; } 2>/dev/null # the shell's own remark on a crash
  code=$?
  end=$(date +%s.%N)
  if [ "${test%.sh}" = "$test" ]; then
    passed=$(count "$out" PASSED) failed=$(count "$out" FAILED) skipped=$(count "$out" SKIPPED)
  else
    passed=$(grep -ac '^ok - ' "$out") failed=$(grep -ac '^not ok - ' "$out") skipped=$(grep -ac '^skip - ' "$out")
  fi
  passed=${passed:-0} failed=${failed:-0} skipped=${skipped:-0}
  if [ "$code" -ne 0 ] && [ "$failed" -eq 0 ]; then # a crash, a time-out, or a test that said nothing
    failed=1
    [ "$code" -eq 124 ] && echo "(stopped after $limit s)" >>"$out"
    echo "(exit status $code)" >>"$out"
  elif [ $((passed + failed + skipped)) -eq 0 ]; then
    failed=1
    echo "(it ran no test)" >>"$out"
  fi
  echo "$passed $failed $skipped" >"$out.sum"
  {
    local words="$passed passed"
    [ "$failed" -gt 0 ] && words="$words, $failed FAILED"
    [ "$skipped" -gt 0 ] && words="$words, $skipped skipped"
    printf '%-32s %6.1f s  %s\n' "$name" "$(echo "$end $begin" | awk '{print $1 - $2}')" "$words"
    # cmocka's successes say nothing about the failure
    [ "$failed" -gt 0 ] && grep -avE '^\[ (RUN     |      OK) \]|^ok - ' "$out" | tail -n 200 | sed 's/^/    /'
  } >"$out.told"
  cat "$out.told" # in one piece, so that two tests do not mix
}
export -f run_one count

# Those of half a minute and more, so that none of them runs alone at the end.
longest="fuzz lammps_changes kill_restart mpi_run lean options docs_commands restart rve report faults study foreign_files install files"
{
  for name in $longest; do printf '%s\0' "tests/system/$name.sh"; done
  for kind in unit verify extreme; do
    for source in tests/$kind/test_*.c; do
      # the Makefile does not build the test of HDF5 files without HDF5
      [ "$source" = tests/unit/test_io_h5.c ] && grep -q 'HDF5=0' "$BUILD/choice" 2>/dev/null && continue
      [ -e "$source" ] && printf '%s\0' "$BUILD/${source%.c}"
    done
  done
  for script in tests/system/*.sh; do
    name=${script##*/}
    [[ " $longest " = *" ${name%.sh} "* ]] || printf '%s\0' "$script"
  done
} >"$work/list"
xargs -0 -n 1 -P "$jobs" bash -c 'run_one "$1"' run_one <"$work/list"

wanted=$(tr -cd '\0' <"$work/list" | wc -c)
ran=$(find "$work" -name '*.sum' | wc -l)
passed=0 failed=0 skipped=0
for sum in "$work"/*.sum; do
  [ -e "$sum" ] || continue
  read -r p f s <"$sum"
  passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
done
failed=$((failed + wanted - ran))
[ $((passed + failed)) -eq 0 ] && { echo "no tests found"; failed=1; }
if [ "$skipped" -gt 0 ]; then echo "$passed passed, $failed failed, $skipped skipped"; else echo "$passed passed, $failed failed"; fi
[ "$failed" -eq 0 ]
