#!/bin/sh
# A file that cannot grow any more (as on a full disk) ends the run with a message and exit status 1; what is complete stays readable.
# SPDX-License-Identifier: GPL-2.0-or-later
set -u
granhom=$(cd "${BUILD:-build}" && pwd)/granhom
"$granhom" --version | grep -q '^HDF5 yes' || { echo "skip - results on a full disk (no HDF5)"; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
say() { if [ "$1" = 0 ]; then echo "ok - $2"; else echo "not ok - $2"; failed=1; fi; }

# The limit counts blocks of 512 or 1024 bytes, as the shell likes: results.h5 of the whole run is larger than both, the other files are not.
sed -e 's/increments: 30/increments: 110/' -e "s|sand150.data|$(pwd)/scenes/block/sand150.data|" scenes/block/p02_taylor.yaml >"$work/long.yaml"
echo 'results: {rves: none}' >>"$work/long.yaml"
(ulimit -f 2000; "$granhom" run "$work/long.yaml" -o "$work/out" --quiet >"$work/log" 2>"$work/err")
[ $? = 1 ]; say $? 'exit status 1'
grep -q '^granhom: .*results.h5: cannot write: ' "$work/err"; say $? 'the message names file and reason'
[ -z "$(find "$work/out" -name '*.tmp')" ]; say $? 'no half-written file is left'
cd "$work/out" && /usr/bin/python3 - <<'E'
import csv, json
import h5py
import meshio
rows = list(csv.DictReader(open("history.csv")))
assert 1 < len(rows) < 121, len(rows)
with h5py.File("results.h5") as h5:
    steps = [name for name in h5 if name.startswith("step")]
    assert len(steps) == len(rows)
    for name in steps:
        assert h5[f"{name}/points/P"][:].shape == (36, 4)
with meshio.xdmf.TimeSeriesReader("results.xdmf") as reader:
    reader.read_points_cells()
    assert reader.num_steps == len(rows)
    reader.read_data(reader.num_steps - 1)
assert json.load(open("run.json"))["status"] == "the operating system refused"
E
say $? 'all complete increments are readable'
[ $failed = 0 ] || sed 's/^/#   /' "$work/err"
exit $failed
