#!/usr/bin/env bash
# The loops over pairs of the relaxation kernels are vectorised: in the objects of this build, seen by objdump, their innermost
# loops take square roots of several pairs at once and of no single one. What is left over at the end of a list has loops of its
# own, and the objective measure of slip calls atan2 for each pair: these are no failures.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
cd "$(dirname "$0")/../.." || exit 2
. tests/shell.sh
begin
choice=$(cat "$BUILD/choice" 2>/dev/null)
case $choice in
*-O0* | *-fsanitize*) echo "skip - vectorised kernels: a build without optimisation ($choice)" && exit 0 ;;
esac
command -v objdump >/dev/null || { echo "skip - vectorised kernels: there is no objdump" && exit 0; }

# packed OBJECT: for each innermost loop with a packed square root a line "function packed scalar", the numbers of both kinds
packed() {
  objdump -d --no-show-raw-insn "$1" | /usr/bin/python3 -c '
import re, sys
functions, name = {}, None
for line in sys.stdin:
    head = re.match(r"[0-9a-f]+ <(\S+)>:", line)
    code = re.match(r"\s+([0-9a-f]+):\s+(\S+)\s*(\S*)", line)
    if head:
        name = head.group(1)
        functions[name] = []
    elif code and name:
        functions[name].append((int(code.group(1), 16), code.group(2), code.group(3)))
for name, code in functions.items():
    starts = {a for a, _, _ in code}
    loops = []
    for at, op, to in code:
        if op.startswith("j") and re.fullmatch("[0-9a-f]+", to) and int(to, 16) <= at and int(to, 16) in starts:
            loops.append((int(to, 16), at))
    for low, high in loops:
        if any(other != (low, high) and low <= other[0] and other[1] <= high for other in loops):
            continue
        roots = [op for at, op, _ in code if low <= at <= high and "sqrt" in op]
        if "vsqrtpd" in roots:
            print(name, roots.count("vsqrtpd"), roots.count("vsqrtsd"))'
}
for object in relax:1 relax_friction:2; do
  file=$BUILD/src/engine/relax/${object%:*}.c.o wanted=${object#*:}
  if ! objdump -d "$file" | grep -q 'vsqrt'; then
    echo "skip - $file: built without AVX"
    continue
  fi
  packed "$file" >found
  check "${object%:*}: $wanted or more loops over pairs are vectorised" test "$(wc -l <found)" -ge "$wanted"
  check "${object%:*}: no scalar square root in them" awk '$3 > 0 { bad = 1 } { print } END { exit bad }' found
done
exit $bad
