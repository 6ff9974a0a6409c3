#!/usr/bin/env bash
# The unit tests under valgrind: no wrong access, no use of what was never set, no leak of ours. BUILD: a build for a processor that
# valgrind knows (make valgrind). Tests that take long there can be left out: tests/valgrind.sh test_a test_b runs only these.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
cd "$(dirname "$0")/.." || exit 1
BUILD=${BUILD:-build-valgrind}
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
export OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_MCA_btl=self,vader
export SANITIZED=1 # tests of memory that is not there leave that out
failed=0 passed=0
output=$(mktemp) || exit 1
trap 'rm -f "$output"' EXIT
for source in tests/unit/test_*.c; do
  name=$(basename "${source%.c}")
  [ $# -gt 0 ] && [[ " $* " != *" $name "* ]] && continue
  valgrind --quiet --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite --show-leak-kinds=definite \
    --num-callers=25 --suppressions=tests/valgrind.supp "$BUILD/tests/unit/$name" >"$output" 2>&1 </dev/null
  code=$?
  if [ $code -eq 0 ]; then
    passed=$((passed + 1))
    echo "ok - $name"
  else
    failed=$((failed + 1))
    echo "not ok - $name (exit status $code)"
    grep -vE '^\[ (RUN     |      OK) \]' "$output" | head -n 150 | sed 's/^/    /'
  fi
done
echo "$passed passed, $failed failed"
[ $failed -eq 0 ] && [ $passed -gt 0 ]
