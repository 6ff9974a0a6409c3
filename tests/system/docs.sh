#!/usr/bin/env bash
# Documents: no row of a table stands there twice, links lead somewhere, and the reference is what the program prints.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
. tests/shell.sh

# twice FILE...: lines of rows that repeat one of the same table, or its first cell where that is a word of code
twice() {
  awk '
    FNR == 1 || !/^\|/ { split("", seen); split("", key); row = 0 }
    !/^\|/ { next }
    ++row <= 2 { next }
    {
      first = $0
      sub(/^\| */, "", first)
      sub(/ *\|.*/, "", first)
      if (($0 in seen) || (first ~ /^`.*`$/ && first in key)) print FILENAME ":" FNR ": " $0
      seen[$0] = key[first] = 1
    }' "$@"
}

bad_table=$(mktemp)
trap 'rm -f "$bad_table"' EXIT
printf '| a | b |\n| --- | --- |\n| `x` | 1 |\n| y | 2 |\n| `x` | 3 |\n| y | 2 |\n\n| a | b |\n| --- | --- |\n| y | 2 |\n' >"$bad_table"
if [ "$(twice "$bad_table" | wc -l)" = 2 ]; then ok "rows that are there twice are found"; else not_ok "rows that are there twice are found" "$(twice "$bad_table")"; fi
found=$(find README.md docs scenes -name '*.md' -print0 | xargs -0 -n 1 bash -c "$(declare -f twice); twice \"\$1\"" twice)
if [ -z "$found" ]; then ok "no row of a table is there twice"; else not_ok "no row of a table is there twice" "$found"; fi

# --- links ---
begin
printf '# A b, c!\n[there](#a-b-c) [not](#a-c) [not](no.md)\n```\n[no link](no.md)\n```\n' >links.md
if [ "$(/usr/bin/env python3 "$root/tests/docs_links.py" links.md | wc -l)" = 2 ]; then ok "links that lead nowhere are found"; else not_ok "links that lead nowhere are found"; fi
(cd "$root" && find README.md docs scenes -name '*.md' -exec /usr/bin/env python3 tests/docs_links.py {} +) >links
if [ -z "$(cat links)" ]; then ok "links lead somewhere"; else not_ok "links lead somewhere" "$(cat links)"; fi

# --- the reference is what the program prints ---
mkdir reference changed
cp "$root"/docs/reference/*.md reference
cp "$root"/docs/reference/*.md changed
check "docs.sh runs" "$root/scripts/docs.sh" "$granhom" reference
if different=$(diff -r "$root/docs/reference" reference | grep -v '^Only in .*: lammps$'); then
  not_ok "keys, columns and commands of docs/reference are those of the program: make docs" "$different"
else
  ok "keys, columns and commands of docs/reference are those of the program"
fi
sed -i '/`dilatancy`/d' changed/columns.md
"$root/scripts/docs.sh" "$granhom" changed
check "a column that a page lacks comes back" grep -q '`dilatancy`' changed/columns.md
if "$root/scripts/docs.sh" false changed 2>/dev/null; then not_ok "docs.sh fails where the program does"; else ok "docs.sh fails where the program does"; fi
if diff -r reference changed && [ -z "$(ls changed/*.new 2>/dev/null)" ]; then ok "and changes no page"; else not_ok "and changes no page"; fi
for page in keys columns commands; do
  count=$(grep -c '^<!-- granhom help' "reference/$page.md")
  if [ "$count" -ge 3 ]; then ok "$page.md is generated"; else not_ok "$page.md is generated" "$count blocks"; fi
done
missing=$("$granhom" help | sed -n 's/^  \([a-z][a-z]*\)  *[^ ].*$/\1/p' | grep -vx help | while read -r command; do
  grep -q "^<!-- granhom help $command -->" reference/commands.md || echo "$command"
done)
if [ -z "$missing" ]; then ok "commands.md has all commands"; else not_ok "commands.md has all commands" "$missing"; fi
"$granhom" help keys nonsense >said 2>err
if [ $? = 2 ] && grep -q nonsense err; then ok "help of keys that are none"; else not_ok "help of keys that are none"; fi

# --- headers that a run writes, against the literal ones of the contract ---
printf 'step,F11,F12,F21,F22\n0,1,0,0,1\n' >path.csv
"$granhom" rve "$root/scenes/block/sand150.data" --path path.csv --engine native --friction-coefficient 0.3 -o out.csv 2>err
if [ "$(head -n 1 out.csv)" = step,F11,F12,F21,F22,P11,P12,P21,P22,s11,s12,s21,s22,energy,contacts,rattlers,residual,seconds,energy_t,dissipation,sliding,ramps,events,newton ]; then
  ok "columns of rve"
else
  not_ok "columns of rve" "$(head -n 1 out.csv)"
fi
exit $bad
