#!/usr/bin/env bash
# Commands of the documents: blocks of README, tutorial and how-to that are marked as `sh` run as they stand, page by page, with
# granhom in the PATH, and leave what the page states; scenes of the pages are read. SPDX-License-Identifier: GPL-2.0-or-later
set -u
. tests/shell.sh
if [ -n "${SANITIZED:-}" ] || ! "${BUILD:-build}/granhom" --version | grep -q 'MPI yes'; then
  echo "skip - commands of the documents (a sanitizer, or no MPI)"
  exit 0
fi
begin memory
cp -r "$root/scenes" "$root/lammps-inputs" .
ln -s "$root/docs" docs
export PATH="$BUILD:$PATH"

# blocks LANGUAGE PAGE: the text of the blocks in that language
blocks() { awk -v fence="\`\`\`$1" '$0 == fence { inside = 1; next } /^```/ { inside = 0 } inside' "$2"; }
# run PAGE FILE...: its commands succeed and leave the files
run() {
  local page=$1 file
  shift
  blocks sh "$root/$page" | sed 's#^export PATH=.*##' >commands
  if [ ! -s commands ]; then
    not_ok "$page: has commands"
    return
  fi
  if bash -e commands >said 2>&1 </dev/null; then ok "$page: commands run"; else not_ok "$page: commands run" "$(tail -n 5 said)"; fi
  for file in "$@"; do
    if [ -s "$file" ]; then ok "$page: leaves $file"; else not_ok "$page: leaves $file"; fi
  done
}

granhom run scenes/block/p02_taylor.yaml -o demo --quiet 2>err # in the place of `make demo`, and in a second
run README.md demo/report.html sand.data sand.png biaxial.csv
run docs/tutorial.md mysand/sand.png mysand/biaxial.png mysand/out/report.html mysand/out/mesh.png
# what the tutorial states of its results
angle=$(awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) c[$k] = k; next } { r = ($c["s11"] - $c["s22"]) / (-$c["s11"] - $c["s22"]); if (r > m) m = r }
  END { printf "%.3f", m }' mysand/biaxial.csv)
if [ "$(awk "BEGIN { print ($angle > 0.46 && $angle < 0.52) }")" = 1 ]; then ok "tutorial: sine of the angle about 0.49"; else not_ok "tutorial: sine of the angle about 0.49" "$angle"; fi
for page in docs/how-to/*.md; do
  grep -q '^```sh' "$page" && run "$page"
done
for file in sand.data shear-out.csv shear-tangent.csv shear.dump tolerance/study.md cross/crosscheck.png out/results.xdmf; do
  if [ -s "$file" ]; then ok "how-to: leaves $file"; else not_ok "how-to: leaves $file"; fi
done
for page in docs/how-to/*.md; do
  count=$(wc -w <"$page")
  if [ "$count" -le 300 ]; then ok "$page: at most 300 words"; else not_ok "$page: at most 300 words" "$count"; fi
done
if /usr/bin/python3 -c 'import h5py' 2>/dev/null && "$granhom" --version | grep -q 'HDF5 yes'; then
  { blocks python docs/how-to/results.md && echo 'assert len(u) == len(X) and len(stress[0]) == 4 and len(force) == len(rows)'; } >results.py
  check "docs/how-to/results.md: Python" /usr/bin/python3 results.py
  granhom help columns run >columns.md
  found=$(/usr/bin/python3 "$root/tests/docs_columns.py" columns.md mysand/out 2>&1)
  if [ -z "$found" ]; then ok "datasets and columns are those of the reference"; else not_ok "datasets and columns are those of the reference" "$found"; fi
  grep -v '`acoustic`' columns.md >fewer.md
  found=$(/usr/bin/python3 "$root/tests/docs_columns.py" fewer.md mysand/out | wc -l)
  if [ "$found" = 2 ]; then ok "a dataset without a word is found"; else not_ok "a dataset without a word is found" "$found"; fi
fi
# the script of the page: it converges, and the shear makes a shear stress
(cd lammps-inputs && blocks lammps "$root/docs/how-to/lammps.md" >in.page && granhom lammps -in in.page -log page.log >said 2>&1)
shear=$(awk '/^Step/ { getline; getline; last = $3 } END { print last }' lammps-inputs/page.log)
if awk -v s="$shear" 'BEGIN { exit !(s < -1e-6 || s > 1e-6) }' && ! grep -q WARNING lammps-inputs/said; then
  ok "docs/how-to/lammps.md: the script converges"
else
  not_ok "docs/how-to/lammps.md: the script converges" "shear $shear" "$(tail -n 3 lammps-inputs/said)"
fi
# the study of the page, beside those of scenes/studies
mkdir -p pages/studies
ln -s "$work/scenes/block" pages/block
blocks yaml docs/how-to/study.md >pages/studies/study.yaml
check "docs/how-to/study.md: the study is read" "$granhom" study pages/studies/study.yaml --explain
exit $bad
