#!/usr/bin/env bash
# kill -9 at twenty random moments (six with sanitizers, where a run takes twenty times as long), on one, two and three ranks: every restart, on another number of ranks, ends with the history.csv of an
# undisturbed run. SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, say
begin memory
has HDF5 "restarts of killed runs" || exit 0
export OMPI_MCA_mpi_yield_when_idle=1
packing=$root/tests/data/cases/packings/p50.data

cat >scene.yaml <<E
packing: $packing
contact: {normal_stiffness: 50}
micro: {boundary: periodic, engine: native}
start: {confinement: 0.3}
mesh: {rectangle: {size: [10, 10], elements: [1, 1]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps:
  - {name: press, increments: 4, pressure: [{edge: right, to: 0.32, follow: true}, {edge: top, to: 0.31}]}
  - {name: shear, increments: 8, displace: [{edge: top, x: 0.1}]}
E
begin=$(date +%s%N)
"$granhom" run scene.yaml -o whole --quiet 2>err; say $? 'the undisturbed run'
whole=$((($(date +%s%N) - begin) / 1000000)) # ms

most=3
mpirun -n 2 true 2>err || { echo 'skip - mpirun does not start here: one rank only'; most=1; }
: >err

# start RANKS DIR: in the background; job: its process; pids: of the ranks
start() {
  rm -f pid.*
  if [ "$1" = 1 ]; then
    "$granhom" run scene.yaml -o "$2" --quiet --restart 2>err &
    job=$!
    echo $job >pid.0
  else
    mpirun -n "$1" sh -c 'echo $$ >pid.$OMPI_COMM_WORLD_RANK; exec "$@"' sh "$granhom" run scene.yaml -o "$2" --quiet --restart 2>err &
    job=$!
  fi
}
# all processes of the run are gone within ten seconds
gone() {
  for _ in $(seq 100); do
    local left=0 file
    for file in pid.*; do [ -e "$file" ] && kill -0 "$(cat "$file")" 2>/dev/null && left=1; done
    [ $left = 0 ] && return 0
    sleep 0.1
  done
  return 1
}
# strike VICTIM: kill -9 of a rank, or of mpirun ("job")
strike() {
  local pid=$job
  [ "$1" != job ] && [ -e "pid.$1" ] && pid=$(cat "pid.$1")
  kill -9 "$pid" 2>/dev/null
  wait "$job" 2>/dev/null
  gone
}

RANDOM=${SEED:-$(($(date +%s) % 32768))}
echo "# SEED=$RANDOM, undisturbed $whole ms"
lost=0 differ=0 hung=0 behind=0 rows=
for k in $(seq "${KILLS:-$([ -n "${SANITIZED:-}" ] && echo 6 || echo 20)}"); do
  ranks=$((k % most + 1))
  victim=$((RANDOM % (ranks + 1)))
  [ $victim = $ranks ] && victim=job
  start $ranks run$k
  if [ $((k % 3)) != 0 ]; then # after the first row, else from the very beginning
    for _ in $(seq 600); do [ -s run$k/history.csv ] && break; sleep 0.02; done
  fi
  delay=$((RANDOM % whole))
  sleep "$(printf '%d.%03d' $((delay / 1000)) $((delay % 1000)))"
  strike $victim || hung=1
  before=$(($(wc -l 2>/dev/null <run$k/history.csv || echo 1) - 1))
  rows="$rows $before"
  # a row comes before its checkpoint: at most the last one is computed again
  /usr/bin/python3 -c "
import h5py
with h5py.File('run$k/checkpoint.h5') as h5: assert h5['/run/position'][0] >= $before - 2" 2>err || [ $before -le 1 ] || { behind=1; echo "# run $k has lost more than the increment under way"; }
  if [ $((k % 5)) = 0 ]; then # once more, on the way back
    start $ranks run$k
    sleep "0.$((RANDOM % 9))"
    strike 0 || hung=1
  fi
  ranks=$(((k + 1) % most + 1))
  start $ranks run$k
  wait $job || { lost=1; echo "# restart $k on $ranks ranks failed"; sed 's/^/#   /' err; }
  cmp -s whole/history.csv run$k/history.csv || { differ=1; echo "# run $k differs"; }
done
echo "# rows of history.csv when killed:$rows"
say $lost 'every restart runs to its end'
say $differ 'and leaves the history.csv of the undisturbed run'
say $behind 'no more than the increment under way is lost'
say $hung 'no process stays behind'
exit $bad
