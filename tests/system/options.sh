#!/usr/bin/env bash
# The options of every command, as its help lists them: --help in every place, values that are missing, empty or given twice, names
# that are mistyped or abbreviated, both ways to write a value. SPDX-License-Identifier: GPL-2.0-or-later
set -u
. "$(dirname "$0")/../shell.sh" # begin, check, ok, not_ok
begin
mkdir clean

# said COMMAND ARGUMENTS...: the exit status and both outputs of a call that writes nothing
said() {
  (cd clean && "$granhom" "$@" >../out 2>../err)
  code=$?
  [ -z "$(ls -A clean)" ] || { not_ok "granhom $* writes nothing" "$(ls -A clean)"; rm -rf clean; mkdir clean; }
}
# The options of a command that take a value, and those that do not, from its help.
valued() { sed -n 's/^  \(-[a-z], \)\{0,1\}--\([a-z-]*\) [^ ].*$/\2/p' "$1.help"; }
listed() { sed -n 's/^  \(-[a-z], \)\{0,1\}--\([a-z-]*\).*$/\2/p' "$1.help" | grep -vx help; }
flags() { listed "$1" | grep -vxF "$(valued "$1")"; }
# The first value that a refusal names as good: a word, a number
good_value() {
  case $1 in
    *'must be an integer from '*) sed -n 's/.* from \([0-9]*\) to.*/\1/p' <<<"$1" ;;
    *'must be an angle'*) echo 20 ;;
    *'number of an integration point'* | *'whole number'*) echo 0 ;;
    *'number'* | *'volume fraction'*) echo 0.5 ;;
    *'lengths with commas'*) echo 1,1 ;;
    *'tilts'*) echo 0.1 ;;
    *'overlap=X'*) echo overlap=0.01 ;;
    *'only be periodic'*) echo periodic ;;
    *'--engines are'*) echo native,gran ;;
    *'x=traction,y=displacement'*) echo x=traction,y=displacement ;;
    *'must be '*) sed -n 's/.* must be \([a-z-]*\).*/\1/p' <<<"$1" ;;
    *) echo text ;;
  esac
}

for command in run direct rve element study crosscheck pack; do
  check "$command has --quiet" sh -c "'$granhom' help $command | grep -q '^  --quiet  *only warnings and errors on the screen$'"
done
said rve a.data --path a.csv --normal-stiffness 0,5
check "a decimal comma in an option is named" grep -qF -- '--normal-stiffness must be a positive number, not "0,5" (a comma: a decimal point is wanted' err
commands=$("$granhom" help | sed -n 's/^  \([a-z][a-z]*\)  *[^ ].*$/\1/p' | grep -vx help)
check "the commands are found" test "$(wc -w <<<"$commands")" -ge 9
for command in $commands; do
  "$granhom" help "$command" >"$command.help"
  check "help $command describes options" grep -q '^  -h, --help' "$command.help"
  missed=
  for arguments in --help "nowhere --help" "--help nowhere" "nowhere -o --help" "-o out nowhere --help -x" "--nonsense --help" -h; do
    # shellcheck disable=SC2086
    said "$command" $arguments
    [ $code = 0 ] && [ ! -s err ] && cmp -s out "$command.help" || missed="$missed [$arguments]"
  done
  check "$command: --help in every place is its page, exit 0" test -z "$missed"
  long=$(awk 'length > 100' "$command.help" | head -n 1)
  check "$command: no line of its help is wider than 100 columns" test -z "$long"
done

# refusal COMMAND WORDS ARGUMENTS...: exit 2, one message with the command's name and WORDS, nothing on standard output
refusal() {
  local command=$1 words=$2
  shift 2
  said "$command" "$@"
  [ $code = 2 ] && [ ! -s out ] && grep -qF -- "granhom $command: $words" err && [ "$(grep -c ^granhom err)" = 1 ] &&
    grep -qF "Try \`granhom help $command\`" err && return 0
  missed="$missed [$* -> $code: $(head -n 1 err)]"
}
for command in $(grep -vx lammps <<<"$commands"); do
  listed=0 missed=
  for option in $(listed "$command"); do
    listed=$((listed + 1))
    refusal "$command" "unknown option --${option:0:1}q${option:1}; did you mean --" nowhere "--${option:0:1}q${option:1}"
  done
  check "$command: each of $listed options, mistyped, is refused with a suggestion" test $listed -ge 2 -a -z "$missed"
  missed=
  for option in $(flags "$command"); do refusal "$command" "--$option takes no value: --$option=1" nowhere "--$option=1"; done
  check "$command: flags take no value" test -z "$missed"
  missed=
  for option in $(valued "$command"); do
    [ "$option" = allow-overlap ] && continue # its value may be left out
    refusal "$command" "--$option needs a value" nowhere "--$option"
  done
  check "$command: a value that is missing" test -z "$missed"
  # "@" is refused by all that are no texts; what they would take is in the message, and is taken twice, with a blank and with =
  missed= checked=0 subject=nowhere
  [ "$command" = pack ] && subject=--sieve=nowhere # a file of its own would be read first
  for option in $(valued "$command"); do
    said "$command" "$subject" "--$option=@"
    grep -q "^granhom $command: .*--$option" err || continue # a text: a file, a program
    [ $code = 2 ] && grep -qF '@' err || missed="$missed [$option @ -> $code: $(head -n 1 err)]"
    good=$(good_value "$(head -n 1 err)")
    checked=$((checked + 1))
    said "$command" "$subject" "--$option="
    [ $code = 2 ] && grep -q "^granhom $command: .*--$option" err || missed="$missed [$option, empty -> $code: $(head -n 1 err)]"
    said "$command" "--$option" "$good" "$subject" "--$option=$good" --
    grep -q -- "--$option\( \|:\)must\|--$option .*not \"\|needs a value" err && missed="$missed [$option $good -> $(head -n 1 err)]"
    said "$command" "$subject" "--$option" "$good" "--$option=@"
    [ $code = 2 ] && grep -q "^granhom $command: .*--$option.*@" err || missed="$missed [$option, the second wrong -> $code]"
  done
  check "$command: $checked options check their values, empty and second ones too" test -z "$missed"
  [ -z "$missed" ] || printf '  %s\n' "$missed"
  missed=
  if "$granhom" help "$command" | grep -q '^usage: .*OTHER'; then # shellcheck disable=SC2046
    refusal "$command" "at most 32 more folders" nowhere -- --elsewhere $(seq 33)
  else
    refusal "$command" "one " nowhere elsewhere
    refusal "$command" "one " nowhere -- --elsewhere
  fi
  refusal "$command" "unknown option -x" nowhere -x
  check "$command: too many operands, one of them behind --; an unknown letter" test -z "$missed"
done

# --- abbreviations, letters, what stands for standard input ---
missed=
refusal rve "the option --s is ambiguous: --servo-gain, --servo-tolerance, --servo-acceleration, --slip, --save-state" nowhere --s x
refusal rve "--relaxation must be polished, damped or fire, not \"@\"" nowhere --rel @
refusal pack "the option --se is ambiguous: --seed, --seconds" --se 1
refusal run "--engine must be lammps or native, not \"yade\"" nowhere --eng=yade
refusal plot "--point must be an integer from 0 to 100000000, not \"-1\"" nowhere --point -1
check "abbreviations are taken where they have one meaning" test -z "$missed"
packing=$root/tests/data/cases/packings/p20.data
printf 'step,F11,F12,F21,F22\n0,1,0,0,1\n' >path.csv
rve() { POSIXLY_CORRECT=$1 "$granhom" rve "$packing" --engine=native --tol 1e-6 --path - -o"$2" <path.csv 2>/dev/null; }
rve 1 - | cut -d, -f1-17 >written
check "-o-, --path -, an abbreviation and an operand in front of options" grep -q '^0,1,0,0,1,' written
unset POSIXLY_CORRECT
rve "" one.csv && "$granhom" rve --engine native --engine lammps --engine native --tolerance 0.5 --tolerance 1e-6 --path path.csv \
  --output two.csv -- "$packing" 2>/dev/null
check "an option that is given twice counts with its last value" cmp <(cut -d, -f1-17 one.csv) <(cut -d, -f1-17 two.csv)

# --- LAMMPS's own options are LAMMPS's ---
said lammps --allow-shel -in nowhere
check "lammps: a mistyped --allow-shell is refused" test $code = 2
check "  with a suggestion" grep -qF 'unknown option --allow-shel; did you mean --allow-shell?' err
said lammps -in nowhere --allow-shell
check "lammps: no such script" sh -c "test $code = 2 && grep -q 'cannot open the input script nowhere' err"

# --- commands ---
for word in runn plto elemnt; do
  "$granhom" $word 2>err
  check "no command $word: exit 2, with a suggestion" sh -c "test $? = 2 && grep -q \"there is no command '$word'; did you mean '\" err"
done
check "help of a command that there is not" sh -c "'$granhom' help nonsense 2>err; test \$? = 2 && grep -q 'there is no command' err"
check "help help is the page of all commands" cmp <("$granhom" help help) <("$granhom" help)

# --- a line of standard error is one write: mpirun mixes the pieces of others ---
cat >whole.py <<'P'
import socket, subprocess, sys
ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)  # keeps writes apart
subprocess.run(sys.argv[1:], stderr=theirs)
theirs.close()
writes = list(iter(lambda: ours.recv(65536), b""))
assert writes and all(w.endswith(b"\n") for w in writes), writes
assert b"granhom" in writes[0], writes
P
printf 'packing: %s\n%0500d: 1\n' "$packing" 0 >long.yaml
for words in 'run long.yaml -o none' 'rve --nonsense' "nonsense" "pack --sieve $(printf 'a%.0s' $(seq 200)) -o none"; do
  # shellcheck disable=SC2086
  check "granhom ${words:0:20}: lines of standard error are written whole" /usr/bin/python3 whole.py "$granhom" $words
done
exit $bad
