"""Tables, checks and curves of the friction study: friction_study.py OUTDIR DOCS

Reads the results of scripts/friction-study.sh in OUTDIR, replaces what stands between `<!-- begin NAME -->` and `<!-- end NAME -->` in
DOCS/reports/friction.md and DOCS/reports/verification.md, and writes OUTDIR/curve_*.txt for the pictures. Exit status 1 when a check fails.
Python's own library only. SPDX-License-Identifier: GPL-2.0-or-later"""
import csv
import glob
import math
import os
import re
import sys

import block_study as block
from block_study import markdown, median

E = 1000.0  # normal stiffness: stresses are scaled by it
ANGLES = (0, 10, 20, 30)
BOUNDARIES = ("taylor", "restricted", "periodic")
MOST = {"uniaxial": {"taylor": "0.3"}, "shear": {"taylor": "1"}, "cyclic": {"taylor": "0.5"}}
LESS = {"uniaxial": "0.1", "shear": "0.2", "cyclic": "0.05"}
START = 10  # increments of the compression before the shear
# What a check allows.
LINEAR = 0.98  # R^2 of a straight line
NORMAL, SHEAR = 0.02, 0.1  # change of the stresses of simple shear


def most(kind, boundary):
    return MOST[kind].get(boundary, LESS[kind])


def mean(values):
    return sum(values) / len(values)


def deviation(values):
    """Standard deviation of a sample."""
    m = mean(values)
    return math.sqrt(sum((v - m)**2 for v in values) / (len(values) - 1)) if len(values) > 1 else 0.0


class Path:
    """One packing along one path: columns as lists, the exit status, and how many increments were cut."""

    def __init__(self, stem):
        self.packing = stem.rsplit("_", 1)[1]
        with open(stem + ".csv") as f:
            rows = list(csv.DictReader(f))
        self.column = {k: [float(r[k]) for r in rows] for k in rows[0]} if rows else {}
        with open(stem + ".status") as f:
            self.status = int(f.read())
        with open(stem + ".log", errors="replace") as f:
            self.log = f.read()
        self.cut = len(re.findall(r"reached in \d+", self.log))
        self.rows = len(rows)

    def stress(self, name):
        return [v / E for v in self.column[name]]


class Set:
    """The ensemble along one path."""

    def __init__(self, out, kind, boundary, axis, angle, hardening):
        self.kind, self.boundary, self.axis, self.angle, self.hardening = kind, boundary, axis, angle, hardening
        stem = f"{out}/{kind}_{boundary}_{axis}_{most(kind, boundary)}_{angle}_{hardening}"
        self.paths = [Path(name[:-len(".status")]) for name in sorted(glob.glob(stem + "_*.status"))]
        self.whole = [p for p in self.paths if p.status == 0]

    def strain(self):
        c = self.whole[0].column
        if self.kind == "uniaxial":
            return [1 - v for v in c["F11" if self.axis == 1 else "F22"]]
        return c["F12" if self.axis == 1 else "F21"]

    def values(self, name, row):
        return [p.stress(name)[row] for p in self.whole]

    def row_at(self, strain):
        """The increment with this strain, the first after the compression."""
        first = 0 if self.kind == "uniaxial" else START
        return next(k for k, v in enumerate(self.strain()) if k >= first and abs(v - strain) < 1e-9)

    def write(self, path):
        """Strain, then mean and standard deviation of s11, s22, s12 (pressure positive in s11, s22)."""
        first = 0 if self.kind == "uniaxial" else START
        columns = {s: [p.stress(s) for p in self.whole] for s in ("s11", "s22", "s12")}
        with open(path, "w") as f:
            for k, strain in enumerate(self.strain()):
                if k < first:
                    continue
                numbers = [strain]
                for s in ("s11", "s22", "s12"):
                    v = [-c[k] if s != "s12" else c[k] for c in columns[s]]
                    numbers += [mean(v), deviation(v)]
                f.write(" ".join(f"{v:.9g}" for v in numbers) + "\n")


def share_packings(sets):
    """Means of different angles, or of hardening, are to be compared: of the packings that came to the end of all of them."""
    for key in {k[:3] for k in sets}:
        chosen = [s for k, s in sets.items() if k[:3] == key and s.whole]
        common = set.intersection(*({p.packing for p in s.whole} for s in chosen)) if chosen else set()
        for s in chosen:
            s.whole = [p for p in s.whole if p.packing in common]


def line(x, y):
    """Least squares: slope and R^2."""
    mx, my = mean(x), mean(y)
    sxy, sxx, syy = (sum((a - p) * (b - q) for a, b in zip(u, v)) for u, v, p, q in ((x, y, mx, my), (x, x, mx, mx), (y, y, my, my)))
    return sxy / sxx, sxy**2 / (sxx * syy)


class Checks:
    """A check belongs to a group; the page has a row per group with the range of what was found."""

    def __init__(self):
        self.rows, self.failed = [], 0

    def add(self, group, what, value, unit, good):
        self.rows.append((group, what, value, unit, "yes" if good else "NO"))
        self.failed += not good


# ---- uniaxial compression ----

def angle_table(sets, checks):
    """Stress along and across the compression over the angle of friction."""
    tangents = [math.tan(math.radians(a)) for a in ANGLES]
    rows = []
    for boundary in BOUNDARIES:
        for axis in (1, 2):
            chosen = [sets["uniaxial", boundary, axis, a, 0] for a in ANGLES]
            if not all(s.whole for s in chosen):
                continue
            end = float(most("uniaxial", boundary))
            for strain in (0.05, 0.1, 0.2, 0.3):
                if strain > end + 1e-9:
                    continue
                for name, what in (("s11", "along"), ("s22", "across")) if axis == 1 else (("s22", "along"), ("s11", "across")):
                    means = [-mean(s.values(name, s.row_at(strain))) for s in chosen]
                    spread = max(deviation(s.values(name, s.row_at(strain))) for s in chosen)
                    slope, fit = line(tangents, means)
                    if axis == 1 and (strain == 0.1 or strain == end):
                        rows.append([boundary, f"{strain:g}", what] + [f"{m:.4f}" for m in means] +
                                    [f"{spread:.4f}", f"{fit:.4f}"])
                    if boundary == "taylor":
                        good = fit > LINEAR and (slope > 0) == (what == "along")
                        checks.add(f"Taylor, compression: stress {what} {'rises' if what == 'along' else 'falls'} linearly in tan(rho), "
                                   f"R^2 > {LINEAR}", f"axis {axis}, {strain:g}", fit, "", good)
    return markdown(["condition", "strain", "stress"] + [f"{a} deg" for a in ANGLES] +
                    ["largest deviation", "R^2"], rows)


# ---- simple shear ----

def shear_change(sets, boundary, axis, name, angle):
    """Largest change of the mean stress by friction: over the largest frictionless one; at which shear; over the deviation of the
    ensemble there."""
    plain, rough = sets["shear", boundary, axis, 0, 0], sets["shear", boundary, axis, angle, 0]
    scale = max(abs(mean(plain.values(name, k))) for k in range(START, len(plain.strain())))
    worst = max(range(START, len(plain.strain())), key=lambda k: abs(mean(rough.values(name, k)) - mean(plain.values(name, k))))
    change = mean(rough.values(name, worst)) - mean(plain.values(name, worst))
    return abs(change) / scale, plain.strain()[worst], abs(change) / (deviation(plain.values(name, worst)) or math.nan)


def shear_table(sets, checks):
    rows = []
    for boundary in BOUNDARIES:
        for axis in (1, 2):
            if not all(sets["shear", boundary, axis, a, 0].whole for a in ANGLES):
                continue
            for name in ("s11", "s22", "s12"):
                changes = [shear_change(sets, boundary, axis, name, a) for a in ANGLES[1:]]
                last = [mean(sets["shear", boundary, axis, a, 0].values(name, -1)) for a in ANGLES]
                if axis == 1:
                    rows.append([boundary, name[1:]] + [f"{last[0]:.4f}", f"{last[-1]:.4f}"] + [f"{100 * c[0]:.1f} %" for c in changes])
                if boundary == "taylor":
                    limit = SHEAR if name == "s12" else NORMAL
                    checks.add(f"Taylor, simple shear, {'shear' if name == 's12' else 'normal'} stress: 30 degrees change it by less than "
                               f"{100 * limit:g} %", f"axis {axis}, component {name[1:]}", 100 * changes[-1][0], " %", changes[-1][0] < limit)
    return markdown(["condition", "component", "end, 0 deg", "end, 30 deg"] + [f"change, {a} deg" for a in ANGLES[1:]], rows)


# ---- cyclic shear ----

def loop(p):
    """Area of the loop of s12 over F12 and largest |s12|, over E."""
    x, y = p.column["F12"][START:], p.stress("s12")[START:]
    area = sum(0.5 * (a + b) * (v - u) for u, v, a, b in zip(x, x[1:], y, y[1:]))
    return area, max(map(abs, y))


def cyclic_table(sets, checks):
    rows = []
    for boundary in BOUNDARIES:
        both = {h: sets["cyclic", boundary, 1, 30, h] for h in (0, 1000) if sets["cyclic", boundary, 1, 30, h].whole}
        size, wide = float(most("cyclic", boundary)), {}
        for h, s in both.items():
            loops = [loop(p) for p in s.whole]
            area, top = (mean([v[k] for v in loops]) for k in range(2))
            wide[h] = area, area / (4 * size * top), top
            rows.append([boundary, f"{size:g}", "0" if h == 0 else "E", len(loops), f"{area:.5f}", f"{deviation([v[0] for v in loops]):.5f}",
                         f"{wide[h][1]:.3f}", f"{top:.4f}"])
        if boundary == "taylor" and len(wide) == 2:
            checks.add("Taylor: the loop with h = 0 is flat, area below 0.1 of its rectangle", "", wide[0][1], "", wide[0][1] < 0.1)
            checks.add("Taylor: the loop with h = E has more than twice that area", "", wide[1000][0] / wide[0][0], " times",
                       wide[1000][0] > 2 * wide[0][0])
            checks.add("Taylor: the amplitude of the shear stress grows with hardening", "", wide[1000][2] / wide[0][2], " times",
                       wide[1000][2] > wide[0][2])
    return markdown(["condition", "amplitude", "h", "packings", "area of the loop", "its deviation", "area over its rectangle",
                     "largest shear stress"], rows)


# ---- what went wrong on the way ----

def effort_table(sets):
    rows = []
    for kind in ("uniaxial", "shear", "cyclic"):
        for boundary in BOUNDARIES:
            groups = {}
            for key, s in sets.items():
                if key[:2] == (kind, boundary):
                    groups.setdefault("h = E" if s.hardening else "h = 0", []).extend(s.paths)
            for name, paths in groups.items():
                if not paths:
                    continue
                rows.append([kind, boundary, name, len(paths), sum(p.rows for p in paths),
                             sum(p.cut for p in paths), sum(p.status != 0 for p in paths),
                             f"{1000 * median([mean(p.column['seconds']) for p in paths if p.rows]):.1f}"])
    return markdown(["experiment", "condition", "hardening", "paths", "increments", "bisected", "ended early", "ms an increment"], rows)


def failures(sets):
    """Last messages of the paths that ended early; those with hardening have a table of their own."""
    lost = [(s, p) for s in sets.values() for p in s.paths if p.status and not s.hardening]
    return [f"{s.kind} {s.boundary} axis {s.axis} {s.angle} deg h={s.hardening} packing {p.packing}: {p.log.strip().splitlines()[-1]}" for s, p in lost]


# ---- what test_friction printed ----

def rotation_table(text):
    """A row for each condition with the printed slip; of the objective one the largest over all conditions."""
    rows, head, objective = [], [], []
    for boundary, slip, values in re.findall(r"^([\w-]+) +(projected|objective)((?: +[\d.]+: \S+)+)", text, re.M):
        pairs = re.findall(r"([\d.]+): (\S+)", values)
        head = [f"{a} deg" for a, _ in pairs]
        if slip == "projected":
            rows.append([boundary] + ["no equilibrium" if v == "inf" else v for _, v in pairs])
        else:
            objective.append([float(v) for _, v in pairs])
    rows.append(["objective slip, all"] + [f"{max(column):.1e}" for column in zip(*objective)])
    return markdown(["condition"] + head, rows)


def energy_table(text):
    rows = []
    for boundary, coarse, fine in re.findall(r"^([\w-]+) +energy imbalance with 8 increments (\S+), with 64 (\S+)", text, re.M):
        rows.append([boundary, coarse, fine, f"{math.log(float(coarse) / float(fine)) / math.log(8):.2f}"])
    return markdown(["condition", "8 increments", "64 increments", "order"], rows)


# ---- the block ----

def better_than_linear(runs):
    """Of the ends of the Newton iterations: the share whose order log(r_k+1/r_k)/log(r_k/r_k-1) is above 1.5, and above 1."""
    rows = []
    for run in runs:
        attempts = [(k, a[-1]) for k, a in run.attempts.items() if k < len(run.steps)]
        ends = [(k, r) for k, r in ((k, block.ending(a)) for k, a in attempts) if r]
        orders = sorted(block.order(r) for _, r in ends)
        iterations = [len(a) - 1 for _, a in attempts]
        rows.append([run.name, f"{min(iterations)}-{max(iterations)}", f"{len(ends)}/{len(run.steps)}", f"{median(orders):.2f}",
                     f"{sum(p > 1 for p in orders)} ({100 * sum(p > 1 for p in orders) / len(orders):.0f} %)",
                     f"{sum(p > 1.5 for p in orders)} ({100 * sum(p > 1.5 for p in orders) / len(orders):.0f} %)"])
    return markdown(["run", "iterations of the last substep", "with an order", "median order", "above 1", "above 1.5"], rows)


def block_parts(out, checks):
    runs = {f"{k}_{b}": block.Run(out, f"block_{k}_{b}") for k in ("friction20", "p02") for b in BOUNDARIES}
    for name, run in runs.items():
        run.name = name
    shown = [r for r in runs.values() if r.present]
    main = runs["friction20_periodic"]
    checks.add("Block, 20 degrees, periodic: reaches 3 mm", "", main.displacement(), " mm", main.present and main.done and main.displacement() == 3)
    orders = [block.order(r) for r in (block.ending(a[-1]) for k, a in main.attempts.items() if k < len(main.steps)) if r]
    share = sum(p > 1.5 for p in orders) / len(main.steps)
    checks.add("Block, 20 degrees, periodic: order above 1.5 in most increments", f"of {len(main.steps)}", 100 * share, " %", share > 0.5)
    rough = [r for r in shown if r.name.startswith("friction20")]
    print(better_than_linear(rough))
    return {"friction runs": block.run_table(rough), "friction curves": block.curve_table(rough)}


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    out, docs = sys.argv[1:]
    checks, sets = Checks(), {}
    for boundary in BOUNDARIES:
        for axis in (1, 2):
            for angle in ANGLES:
                for kind in ("uniaxial", "shear"):
                    sets[kind, boundary, axis, angle, 0] = Set(out, kind, boundary, axis, angle, 0)
        for hardening in (0, 1000):
            sets["cyclic", boundary, 1, 30, hardening] = Set(out, "cyclic", boundary, 1, 30, hardening)
    share_packings(sets)
    for (kind, boundary, axis, angle, hardening), s in sets.items():
        curve = f"{out}/curve_{kind}_{boundary}_{axis}_{angle}_{hardening}.txt"
        if s.whole:
            s.write(curve)
        elif os.path.exists(curve):
            os.remove(curve)
    with open(f"{out}/test_friction.txt", errors="replace") as f:
        text = f.read()
    parts = {"angles": angle_table(sets, checks), "shear": shear_table(sets, checks), "cyclic": cyclic_table(sets, checks),
             "rotations": rotation_table(text), "energy": energy_table(text)}
    blocks = block_parts(out, checks)
    print(effort_table(sets) + "".join(f"\n- {t}" for t in failures(sets)))
    block.replace(f"{docs}/reports/friction.md", parts)
    block.replace(f"{docs}/reports/verification.md", blocks)
    for group, what, value, unit, met in checks.rows:
        print(f"{'ok  ' if met == 'yes' else 'FAIL'} {group}{', ' * bool(what)}{what}: {value:.4g}{unit}")
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main())
