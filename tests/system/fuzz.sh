#!/usr/bin/env bash
# A minute of `make fuzz`: each reader, and mutated scripts, scenes and studies through the program, for some seconds from a fixed seed.
# With clang's libFuzzer and sanitizers where they are (a build without optimisation, kept in build/sample-fuzz), else with the build under
# test and random changes. FUZZ_SAMPLE: seconds in all. SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # ok, not_ok
build=${BUILD:-build}
seed=1 # fixed, so that a change of the sources is what changes the outcome
echo "# seed $seed"
if [ -z "${SANITIZED:-}" ] && scripts/has-libfuzzer.sh; then
  cache=
  command -v ccache >/dev/null && cache=ccache
  if make --no-print-directory fuzz-build BUILD="$build/sample" FUZZ_OPT=-O0 FUZZ_CACHE=$cache >"$build/fuzz-build.log" 2>&1; then
    ok "the build with sanitizers"
    build=$build/sample-fuzz
  else
    not_ok "the build with sanitizers" "$(grep -v '^  [A-Z]' "$build/fuzz-build.log" | tail -n 20)"
    exit 1
  fi
fi
python3 tests/fuzz/run.py --build "$build" --sample --seconds "${FUZZ_SAMPLE:-45}" --jobs "${FUZZ_JOBS:-1}" --seed $seed >"$build/fuzz.log" 2>&1
code=$?
sed 's/^/# /' "$build/fuzz.log"
while read -r name runs _ _ _ _ findings; do
  case $findings in
    0) [ "$runs" -gt 0 ] && ok "$name: $runs inputs" || not_ok "$name: no input was tried" ;;
    [1-9]*) not_ok "$name: $findings findings of $runs inputs" "$(for f in "$build/findings/${name#run/}"-*/; do cat "$f/cmd"; head -n 40 "$f/said"; done 2>&1 | head -n 150)" ;;
  esac
done < <(sed -n '/^target/,$p' "$build/fuzz.log" | grep -E '^[a-z/_]+ +[0-9]+ ')
[ $code = 0 ] || [ $bad = 1 ] || not_ok "tests/fuzz/run.py" "$(tail -n 20 "$build/fuzz.log")"
exit $bad
