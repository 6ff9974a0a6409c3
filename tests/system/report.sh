#!/bin/sh
# Packings as LAMMPS dumps, results at the integration points, and the HTML report. SPDX-License-Identifier: GPL-2.0-or-later
set -u
granhom=${BUILD:-build}/granhom
"$granhom" --version | grep -q '^HDF5 yes' || { echo "skip - reports and dumps (no HDF5)"; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cases=$(pwd)/tests/data/cases
failed=0
say() { if [ "$1" = 0 ]; then echo "ok - $2"; else echo "not ok - $2"; failed=1; fi; }

for name in periodic restricted friction; do
  boundary=$name contact=
  [ $name = friction ] && boundary=periodic contact=', tangential_stiffness: 40, friction_coefficient: 0.1'
  cat >"$work/$name.yaml" <<E
title: 'Block <b> & "sand"'
units: {length: mm, force: N}
packing: $cases/packings/block150.data
contact: {normal_stiffness: 50$contact}
micro: {boundary: $boundary, engine: native}
start: {confinement: 0.02}
mesh: {rectangle: {size: [100, 50], elements: [2, 1]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps:
  - {name: confine, increments: 2, supports: [{edge: top, fix: y}], pressure: [{edge: right, from: 0.02, to: 0.2}]}
  - {name: compress, increments: 4, displace: [{edge: top, y: -0.4}]}
results: {dump: [1, 6], dump_every: 2}
E
  "$granhom" run "$work/$name.yaml" -o "$work/$name" --quiet >"$work/log" 2>&1
  say $? "$name: the run ends"
done

# ---- dumps ----

cat >"$work/dumps.py" <<'E'
"""dumps.py RESULTS: every frame whole; law of the contacts, equilibrium, stress and fabric of the contacts as in results.h5."""
import sys
import h5py
import numpy as np
folder = sys.argv[1]
def frames(path):
    lines = open(path).read().split("\n")
    assert lines.pop() == ""
    while lines:
        assert lines[0] == "ITEM: TIMESTEP" and lines[2].startswith("ITEM: NUMBER OF "), lines[:3]
        step, rows = int(lines[1]), int(lines[3])
        bounds = [[float(x) for x in line.split()] for line in lines[5:8]]
        names = lines[8].split()[2:]
        data = np.array([[float(x) for x in line.split()] for line in lines[9:9 + rows]])
        assert data.shape == (rows, len(names)), (data.shape, rows, names)
        yield step, lines[4], bounds, {n: data[:, k] for k, n in enumerate(names)}
        lines = lines[9 + rows:]
sliding = []
def check(box, bounds, g, c, at, point):
    assert len(c["id1"]) == at["contacts"][point] and g["rattler"].sum() == at["rattlers"][point]
    i, j = c["id1"].astype(int) - 1, c["id2"].astype(int) - 1
    f, l = np.stack([c["fx"], c["fy"]], axis=1), np.stack([c["lx"], c["ly"]], axis=1)
    length = np.hypot(*l.T)
    assert np.allclose(g["radius"][i] + g["radius"][j] - length, c["overlap"], atol=1e-14) and c["overlap"].min() >= 0
    assert np.allclose(c["fn"], 50 * c["overlap"], rtol=1e-8) and np.allclose(np.hypot(*f.T), np.hypot(c["fn"], c["ft"]))
    if "sliding" in c:  # the coefficient of friction is 0.1; a factor near 1, |l^n|/|l| t^n.t, scales f_t (7.20)
        assert c["sliding"].sum() == at["sliding"][point] and "theta" in g
        assert (np.abs(c["ft"]) <= 0.1 * c["fn"] * 1.02).all()
        slides = c["sliding"] == 1
        assert np.allclose(np.abs(c["ft"])[slides], 0.1 * c["fn"][slides], rtol=0.02)
        sliding.append(slides.sum())
    else:
        assert np.abs(c["ft"]).max() < 1e-12
    total = np.zeros((len(g["id"]), 2))
    np.add.at(total, i, f)
    np.add.at(total, j, -f)
    assert np.abs(total[g["held"] == 0]).max() <= 1.0001e-8 * c["fn"].mean()
    assert np.allclose(c["x1"], g["x"][i]) and np.allclose(c["y1"], g["y"][i])
    d = np.stack([g["x"][j] - g["x"][i], g["y"][j] - g["y"][i]], axis=1)
    n = l / length[:, None]
    w = np.linalg.eigvalsh(n.T @ n / len(n))
    assert abs((w[1] - w[0]) / w.sum() - at["anisotropy"][point]) < 1e-12
    if "pp pp pp" not in box:
        assert np.abs(l - d).max() < 1e-12
        return
    tilt, b = bounds[0][2], bounds[1][1] - bounds[1][0]
    a = bounds[0][1] - bounds[0][0] - abs(tilt)
    cell, low = np.array([[a, tilt], [0, b]]), np.array([bounds[0][0] - min(tilt, 0), bounds[1][0]])
    k = np.linalg.solve(cell, (l - d).T)  # branches end at the grain or at an image of it
    assert np.abs(k - np.round(k)).max() < 1e-9
    s = np.linalg.solve(cell, (np.stack([g["x"], g["y"]], axis=1) - low).T)
    assert s.min() > -1e-12 and s.max() < 1 + 1e-12  # grains lie in the box
    ours, theirs = f.T @ l / (a * b), at["cauchy"][point].reshape(2, 2)  # up to the turn of the box
    assert abs(np.trace(ours) / np.trace(theirs) - 1) < 1e-9 and abs(np.linalg.det(ours) / np.linalg.det(theirs) - 1) < 1e-9
with h5py.File(f"{folder}/results.h5") as h5:
    for point in (1, 6):
        grains, contacts = (list(frames(f"{folder}/dumps/point_{point}.{k}dump")) for k in ("", "contacts."))
        assert [f[0] for f in grains] == [f[0] for f in contacts] == [0, 2, 4, 6]
        for (step, box, bounds, g), (_, _, _, c) in zip(grains, contacts):
            check(box, bounds, g, c, h5[f"/step{step:04d}/points"], point)
assert not sliding or max(sliding) > 0
E
for name in periodic restricted friction; do
  /usr/bin/python3 "$work/dumps.py" "$work/$name"
  say $? "$name: dumps hold whole frames, contact law, equilibrium, stress and anisotropy of results.h5"
done

(cd "$work/periodic" && /usr/bin/python3 - <<'E'
import h5py
import meshio
import numpy as np
with h5py.File("results.h5") as h5, h5py.File("traces.h5") as traces, h5py.File("rves.h5") as rves:
    with meshio.xdmf.TimeSeriesReader("points.xdmf") as reader:
        points, cells = reader.read_points_cells()
        assert points.shape == (8, 2) and cells[0].type == "vertex" and reader.num_steps == 7
        time, data, _ = reader.read_data(6)
    at = h5["/step0006/points"]
    assert time == 2 and np.allclose(data["cauchy"], at["cauchy"])
    for name in ("coordination", "rattlers", "sliding", "anisotropy", "volume_fraction", "acoustic", "acoustic_angle", "residual",
                 "steps", "factorisations", "seconds", "dissipation"):
        assert data[name].shape == (8,) and np.array_equal(data[name], at[name]), name
    assert (at["factorisations"][:] >= 1).all() and (at["sliding"][:] == 0).all()
    with meshio.xdmf.TimeSeriesReader("results.xdmf") as reader:
        reader.read_points_cells()
        _, _, cells = reader.read_data(6)
    least = at["acoustic"][:].reshape(2, 4).argmin(axis=1) + [0, 4]
    angle = at["acoustic_angle"][:][least]
    assert np.allclose(cells["acoustic_normal"][0], np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1))
    assert np.allclose(cells["F"][0][:, [0, 1, 3, 4]], at["F"][:].reshape(2, 4, 4).mean(axis=1))
    assert np.allclose(cells["anisotropy"][0], at["anisotropy"][:].reshape(2, 4).mean(axis=1))
    assert sorted(traces["/trace"]) == [f"{k:04d}" for k in range(8)]
    for k in range(8):
        assert np.array_equal(traces[f"/trace/{k:04d}/step0006"], rves[f"/rve/{k:04d}/positions"][:150])
    # grains follow F but for fluctuations, which are a fraction of a radius here
    x0, x6 = traces["/trace/0005/step0000"][:], traces["/trace/0005/step0006"][:]
    F0, F6 = h5["/step0000/points/F"][5].reshape(2, 2), at["F"][5].reshape(2, 2)
    away = x6.T - F6 @ np.linalg.solve(F0, x0.T)
    assert np.abs(away - away.mean(axis=1)[:, None]).max() < 0.1 and np.abs(x6 - x0).max() > 1e-3
E
)
say $? 'points.xdmf opens in meshio and agrees with results.h5; traces end where the grains are'

"$granhom" run "$work/restricted.yaml" -o "$work/periodic" --quiet >"$work/log" 2>&1 &&
  cmp -s "$work/periodic/dumps/point_1.dump" "$work/restricted/dumps/point_1.dump" &&
  cmp -s "$work/periodic/dumps/point_6.contacts.dump" "$work/restricted/dumps/point_6.contacts.dump"
say $? 'another run into the same folder replaces the dumps'
"$granhom" run "$work/periodic.yaml" -o "$work/periodic" --quiet >"$work/log" 2>&1

# ---- the report ----

"$granhom" report "$work/periodic" >"$work/log" 2>&1 && [ "$(cat "$work/log")" = "$work/periodic/report.html" ]
say $? 'granhom report writes DIR/report.html and states so'
"$granhom" report "$work/restricted" -o "$work/page.html" --points 3,0 >"$work/log" 2>&1 && [ ! -e "$work/restricted/report.html" ]
say $? 'and another file where -o asks for it'

cat >"$work/page.py" <<'E'
"""page.py PAGE RESULTS POINT...: balanced tags, nothing from outside, numbers as in the files."""
import csv, html.parser, json, sys
import h5py
page, folder, points = sys.argv[1], sys.argv[2], [int(x) for x in sys.argv[3:]]
text = open(page, encoding="utf8").read()
class Parser(html.parser.HTMLParser):
    void = {"meta", "input", "br", "link", "img"}
    def __init__(self):
        super().__init__()
        self.stack, self.ids, self.links, self.rows, self.table, self.cell, self.text = [], set(), [], {}, None, None, []
    def handle_starttag(self, tag, attributes):
        a = dict(attributes)
        assert len(a) == len(attributes) and "src" not in a, (tag, attributes)
        if tag not in self.void: self.stack.append(tag)
        if "id" in a:
            assert a["id"] not in self.ids, a["id"]
            self.ids.add(a["id"])
        if "href" in a: self.links.append(a["href"])
        if tag == "table": self.table = self.rows.setdefault(a.get("id"), [])
        if tag == "tr" and self.table is not None: self.table.append([])
        if tag in ("td", "th"): self.cell = ""
        if tag == "svg": assert "viewbox" in a
        for name in ("d", "x", "y", "cx", "cy", "r", "width", "height"):
            assert "nan" not in a.get(name, "") and "inf" not in a.get(name, ""), (tag, a)
    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in self.void: self.handle_endtag(tag)
    def handle_endtag(self, tag):
        assert self.stack and self.stack[-1] == tag, (tag, self.stack[-3:], self.getpos())
        self.stack.pop()
        if tag in ("td", "th"):
            if self.table is not None: self.table[-1].append(self.cell)
            self.cell = None
        if tag == "table": self.table = None
    def handle_data(self, data):
        if self.cell is not None: self.cell += data
        if self.stack and self.stack[-1] not in ("style", "script"): self.text.append(data)
p = Parser()
p.feed(text)
p.close()
assert p.stack == [], p.stack
assert all(link.startswith("#") and link[1:] in p.ids for link in p.links), p.links
assert not any(word in text for word in ("http:", "https:", "@import", "url("))
words = " ".join("".join(p.text).split())
assert 'Block <b> & "sand"' in words
history = list(csv.DictReader(open(f"{folder}/history.csv")))
table = p.rows["history"]
assert len(table) == len(history) + 1 == 8, len(table)
for cells, row in zip(table[1:], history):
    shown = dict(zip(table[0], cells))
    assert shown["step"] == row["name"] and shown["increment"] == row["step"]
    for name in ("uy_top", "top_y", "dilatancy", "iterations", "cuts", "jumps", "min_acoustic", "residual"):
        assert shown[name] == "%.6g" % float(row[name]), (name, shown[name], row[name])
attempts = []
for row in csv.DictReader(open(f"{folder}/convergence.csv")):
    if row["iteration"] == "0": attempts.append([])
    attempts[-1].append(row)
assert len(p.rows["residuals"]) == len(attempts) + 1
for cells, rows in zip(p.rows["residuals"][1:], attempts):
    assert cells[0] == rows[0]["step"] and cells[3] == str(len(rows) - 1)
    assert cells[4] == "%.3E" % float(rows[-1]["relative"]), (cells, rows[-1])
    if len(rows) <= 8: assert cells[5:5 + len(rows)] == ["%.3E" % float(r["first"]) for r in rows]
run = json.load(open(f"{folder}/run.json"))
assert run["status"] == "done" and "Done, and every increment converged" in words
assert "end of an increment %.2e" % max(float(r["residual"]) for r in history) in words
assert ("No instabilities" in words) == (sum(int(r["jumps"]) for r in history) == 0)
with h5py.File(f"{folder}/results.h5") as h5:
    lost = [int((h5[f"/step{k:04d}/points/acoustic"][:] <= 0).sum()) for k in range(7)]
    assert f"At the end in {lost[-1]} point" in words if max(lost) else "Elliptic everywhere" in words
    for k in points:
        s = h5["/step0006/points/cauchy"][k]
        assert f"Point {k}" in words and f"s11 {'%.4g' % s[0]}, s22 {'%.4g' % s[3]}" in words, k
        assert "coordination %.4g," % h5["/step0006/points/coordination"][k] in words
assert f"{run['summary']['relaxation_steps']} relaxation steps, {run['summary']['pair_evaluations']} pair evaluations, " in words
assert len(text) < 2e6
E
/usr/bin/python3 "$work/page.py" "$work/periodic/report.html" "$work/periodic" 0
say $? 'periodic: the page is whole, needs nothing from outside, and its numbers are those of the files'
/usr/bin/python3 "$work/page.py" "$work/page.html" "$work/restricted" 3 0
say $? 'restricted, chosen points: likewise'
"$granhom" report "$work/friction" -o "$work/page.html" >"$work/log" 2>&1 &&
  /usr/bin/python3 "$work/page.py" "$work/page.html" "$work/friction" 0 && grep -q 'purple: sliding contacts' "$work/page.html"
say $? 'friction: likewise, and sliding contacts are reported'

# ---- folders that lack something ----

# partly WHAT SENTENCE: the report of the folder `part` states the sentence
partly() {
  if "$granhom" report "$work/part" -o "$work/part.html" >"$work/log" 2>&1 && grep -q "$2" "$work/part.html"; then echo "ok - $1"
  else echo "not ok - $1"; sed 's/^/#   /' "$work/log"; failed=1; fi
  rm -rf "$work/part" "$work/part.html"
}
# change FOLDER: runs standard input with h5 = results.h5 and rves = rves.h5 open for change, both without their
# checksums, as older versions wrote them: what is read behind the checksum is to be tried
change() {
  for k in results.h5 rves.h5; do tail -c +513 "$work/$1/$k" >"$work/plain" && cp "$work/plain" "$work/$1/$k"; done
  { echo 'import h5py, sys'; echo "h5, rves = (h5py.File('$work/$1/' + k, 'a') for k in ('results.h5', 'rves.h5'))"; cat; } >"$work/change.py"
  /usr/bin/python3 "$work/change.py" || { echo "not ok - change of $1"; failed=1; }
}
cp -r "$work/periodic" "$work/part"
rm "$work/part/rves.h5" "$work/part/traces.h5"
partly 'a run without recorded grains' 'The run has recorded no grains'
cp -r "$work/periodic" "$work/part"
echo 'for k in (0, 1, 2, 3, 4, 6, 7): del rves[f"/rve/{k:04d}"]' | change part
partly 'a run that recorded one point shows it' '<h3 id="point5">Point 5, the largest von Mises stress of the recorded points, the smallest acoustic eigenvalue of the recorded points'
cp -r "$work/periodic" "$work/part"
rm "$work/part/traces.h5"
change part <<'E'
for k in range(7):
    for name in ("anisotropy", "sliding"): del h5[f"/step{k:04d}/points/{name}"]
E
partly 'a folder of an older version' 'recorded where the grains of this point were before'
cp -r "$work/periodic" "$work/part"
head -n 7 "$work/periodic/history.csv" >"$work/part/history.csv" # one increment behind results.h5
change part <<E
import json
run = json.load(open('$work/part/run.json'))
run['status'] = 'running'
del run['summary']
json.dump(run, open('$work/part/run.json', 'w'))
rves['/step'][()] = 5
E
partly 'a run that was killed' 'The run is under way, or was killed'

# ---- wrong input ----

# bad WHAT PATTERN ARGUMENTS...: one message, exit status 2, nothing written
bad() {
  what=$1 pattern=$2
  shift 2
  "$granhom" report "$@" -o "$work/bad.html" >"$work/log" 2>"$work/err"; code=$?
  if [ $code = 2 ] && grep -Eq "$pattern" "$work/err" && [ "$(grep -c '^granhom' "$work/err")" = 1 ] && [ ! -e "$work/bad.html" ]; then echo "ok - $what"
  else echo "not ok - $what: exit $code"; sed 's/^/#   /' "$work/err"; failed=1; rm -f "$work/bad.html"; fi
}
good=$work/periodic
bad 'no folder named' 'a folder of results is needed'
bad 'a folder that does not exist' 'nowhere: holds no results' "$work/nowhere"
bad 'a folder without results' 'holds no results' "$work"
bad 'a point that does not exist' 'no integration point 8: there are 8' "$good" --points 0,8
bad 'a point that is no number' "'x' is no number" "$good" --points 1,x
bad 'no points' 'holds no number' "$good" --points ,
bad 'too many points' 'at most 12 points' "$good" --points 0,1,2,3,4,5,6,7,0,1,2,3,4
bad 'an unknown option' 'unknown option --foo' "$good" --foo
damage() { rm -rf "$work/cut"; cp -r "$good" "$work/cut"; }
damage && head -c 5000 "$good/results.h5" >"$work/cut/results.h5"
bad 'truncated results.h5' 'cut/results.h5: is damaged: it has 5000 bytes instead of' "$work/cut"
damage && head -c 60000 "$good/rves.h5" >"$work/cut/rves.h5"
bad 'truncated rves.h5' 'cut/rves.h5: is damaged: it has 60000 bytes instead of' "$work/cut"
damage && echo 'del h5["/step0005/points"]' | change cut
bad 'an increment that is missing' 'history.csv has 7 increments, results.h5 has 5' "$work/cut"
damage && echo 'h5["/mesh/cells"][0, 0] = 77' | change cut
bad 'a mesh that cannot be' 'names the node 77 of 6' "$work/cut"
damage && echo 'for k in rves["/rve"]: rves[f"/rve/{k}/contact_pairs"][0, 0] = 5000' | change cut
bad 'a contact of a grain that does not exist' 'do not fit together' "$work/cut"
damage && echo 'h5["/step0006/displacement"][0, 0] = float("nan")' | change cut
bad 'a displacement that is no number' 'displacement holds a value that is not finite' "$work/cut"
damage && head -n 4 "$good/history.csv" | head -c -9 >"$work/cut/history.csv"
bad 'truncated history.csv' 'cut/history.csv: the last line is cut off' "$work/cut"
damage && sed -i '4s/,[^,]*$//' "$work/cut/history.csv"
bad 'a line of history.csv that lacks a field' 'cut/history.csv:4: has [0-9]+ fields' "$work/cut"
damage && head -n 8 "$good/convergence.csv" | head -c -9 >"$work/cut/convergence.csv"
bad 'truncated convergence.csv' 'cut/convergence.csv: the last line is cut off' "$work/cut"
damage && echo '{' >"$work/cut/run.json"
bad 'a broken run.json' 'cut/run.json: is no JSON' "$work/cut"
damage && rm "$work/cut/results.h5"
bad 'a run that came to no increment' 'holds no complete increment' "$work/cut"

# badscene WHAT RESULTS PATTERN: the scene with this key `results` is refused
badscene() {
  sed "s/^results: .*/results: $2/" "$work/periodic.yaml" >"$work/bad.yaml"
  "$granhom" run "$work/bad.yaml" -o "$work/none" >"$work/log" 2>"$work/err"; code=$?
  if [ $code = 2 ] && grep -Eq "$3" "$work/err" && [ ! -e "$work/none" ]; then echo "ok - scene: $1"
  else echo "not ok - scene: $1: exit $code"; sed 's/^/#   /' "$work/err"; failed=1; fi
}
badscene 'a point to dump that does not exist' '{dump: [8]}' 'bad.yaml:12: integration point'
badscene 'a word for points' '{dump: some}' "dump is 'some', it must be all, none or a list"
badscene 'dump_every without dumps' '{dump_every: 3}' 'dump_every belongs to a dump'
badscene 'dump_every of zero' '{dump: all, dump_every: 0}' 'dump_every'

# ---- a browser ----

browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome)
if [ -z "$browser" ]; then
  echo 'skip - the page in a browser: no chromium is installed'
  exit $failed
fi
/usr/bin/python3 - "$work/periodic/report.html" "$work/probe.html" <<'E'
import sys
page = open(sys.argv[1], encoding="utf8").read()
first = "<script>window.errors=[];addEventListener('error',e=>errors.push(e.message))</script>"
last = """<script>
const slider=document.querySelector('.slider input');slider.value=0;slider.dispatchEvent(new Event('input'));
const shown=[...document.querySelectorAll('[data-frame]')].filter(f=>!f.hasAttribute('hidden')).map(f=>f.dataset.frame).join('');
const c=document.querySelector('circle[data-t]'),b=c.getBoundingClientRect();
c.dispatchEvent(new PointerEvent('pointermove',{bubbles:true,clientX:b.x,clientY:b.y}));
const told=document.getElementById('tip').style.display;
const cut=[...document.querySelectorAll('main svg text')].filter(t=>{const r=t.getBoundingClientRect();
return r.width>0&&(r.left<-1||r.right>innerWidth+1)}).length;
document.title=['probe',errors.length,document.documentElement.scrollWidth-innerWidth,shown,told,cut].join(' ');
</script>"""
page = page.replace("<head>", "<head>" + first).replace("</body>", last + "</body>")
open(sys.argv[2], "w", encoding="utf8").write(page)
E
chrome() { timeout 100 "$browser" --headless --no-sandbox --disable-gpu --hide-scrollbars --user-data-dir="$work/browser" "$@" 2>"$work/log"; }
for width in 1280 500; do # a headless window is at least 500 pixels wide
  chrome --window-size=$width,900 --dump-dom "file://$work/probe.html" >"$work/dom"
  found=$(grep -o '<title>probe [^<]*' "$work/dom")
  [ "$found" = '<title>probe 0 0 000 block 0' ]
  say $? "a browser $width pixels wide: no errors, nothing wider than the window, slider and values under the pointer work"
done
chrome --window-size=1280,2000 --screenshot="$work/page.png" "file://$work/periodic/report.html" >"$work/dom"
[ "$(head -c 4 "$work/page.png" | tail -c 3)" = PNG ] && [ "$(wc -c <"$work/page.png")" -gt 50000 ]
say $? 'a browser draws the page'

# ---- packings that are accepted unconverged ----

sed 's/engine: native/&, max_steps: 40, accept: 1000/; s/^steps:/solver: {tolerance: 1e-2}\n&/; s/^results:.*//' "$work/periodic.yaml" >"$work/loose.yaml"
"$granhom" run "$work/loose.yaml" -o "$work/loose" >"$work/log" 2>&1
[ $? = 0 ] && grep -q 'in [1-9][0-9]* evaluations a packing was accepted unconverged' "$work/log"
say $? "a run that accepts packings unconverged states how often"
"$granhom" report "$work/loose" >/dev/null 2>&1 && grep -q 'Packings accepted unconverged' "$work/loose/report.html" &&
  ! grep -q 'Packings accepted unconverged' "$work/periodic/report.html"
say $? "the report states so among the first things"

exit $failed
