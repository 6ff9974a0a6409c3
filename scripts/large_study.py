"""Tables of the large examples: large_study.py OUTDIR REPORT.md

Reads the results of scripts/large-study.sh in OUTDIR and replaces what stands between `<!-- begin NAME -->` and `<!-- end NAME -->` in
REPORT.md. Python's own library only. SPDX-License-Identifier: GPL-2.0-or-later"""
import csv
import json
import os
import re
import sys

BIAXIAL = ("biaxial_taylor", "biaxial_restricted", "biaxial_periodic")
SLOPE = ("slope_taylor", "slope_periodic_friction")
CONFINED = 10  # increments of the confinement of the biaxial test
SELECTED = {"slope_taylor": (1, 10, 21), "slope_periodic_friction": (1, 24, 32, 40, 56, 72)}
LOADS = (0, 10, 20, 40)  # MN, of the footing


def rows_of(path):
    with open(path) as f:
        return list(csv.DictReader(f))


class Run:
    def __init__(self, out, name):
        self.name = name
        folder = os.path.join(out, name)
        self.present = os.path.exists(f"{folder}/history.csv")
        if not self.present:
            return
        self.steps = [{k: v if k == "name" else float(v) for k, v in row.items()} for row in rows_of(f"{folder}/history.csv")]
        for step, times in zip(self.steps, rows_of(f"{folder}/timing.csv")):  # one row per increment, as in history.csv
            step |= {k: float(v) for k, v in times.items()}
        self.attempts = {}  # increment -> attempts, each a list of residuals over the first
        last = {}
        for row in rows_of(f"{folder}/convergence.csv"):
            step, iteration = int(row["step"]), int(row["iteration"])
            attempts = self.attempts.setdefault(step, [])
            if not attempts or iteration <= last[step]:
                attempts.append([])
            last[step] = iteration
            attempts[-1].append(float(row["first"]))
        with open(f"{folder}/run.json") as f:
            record = json.load(f)
        self.status = record["status"]
        self.seconds = sum(s["seconds"] for s in self.steps)
        self.micro = sum(s["micro_seconds"] for s in self.steps)

    def total(self, name):
        return int(sum(s[name] for s in self.steps))


def markdown(head, rows):
    lines = [head, ["---"] * len(head)] + rows
    return "\n".join("| " + " | ".join(str(c) for c in line) + " |" for line in lines) + "\n"


def residuals(runs, selected):
    """One row per load step: residuals of the last attempt, and how many went before."""
    rows = [[r.name, m, " ".join(f"{v:.3E}" for v in r.attempts[m][-1][1:]), len(r.attempts[m]) - 1]
            for r in runs for m in selected[r.name] if m < len(r.steps)]
    return markdown(["run", "mls", "residuals from iteration 2 on", "attempts before"], rows)


def runs_table(runs):
    rows = []
    for r in runs:
        increments = len(r.steps) - 1
        rows.append([r.name, r.status, increments, r.total("iterations"), r.total("cuts"), r.total("jumps"),
                     f"{min(s['min_acoustic'] for s in r.steps):.3g}", int(max(s["unjammed"] for s in r.steps)), f"{r.seconds:.0f}",
                     f"{100 * r.micro / r.seconds:.0f} %"])
    return markdown(["run", "outcome", "increments", "iterations", "bisections", "instabilities", "smallest acoustic eigenvalue", "unjammed points",
                     "seconds", "of these micro"], rows)


def biaxial_table(runs):
    rows = []
    for r in runs:
        steps = r.steps[CONFINED:]
        if not steps:
            continue
        low = min(steps, key=lambda s: s["dilatancy"])
        rows.append([r.name, f"{-steps[-1]['uy_top']:.1f}", f"{steps[0]['bottom_y']:.2f}", f"{steps[-1]['bottom_y']:.2f}",
                     f"{steps[0]['dilatancy']:.2f}", f"{low['dilatancy']:.2f}", f"{-low['uy_top']:.1f}", f"{steps[-1]['dilatancy']:.2f}"])
    return markdown(["run", "reached (mm)", "axial force at 0 mm (N)", "at the end (N)", "dilatancy at 0 mm (%)", "lowest (%)", "at (mm)",
                     "at the end (%)"], rows)


def slope_table(runs):
    rows = []
    for r in runs:
        for load in LOADS:  # the last row with this load
            found = [k for k, s in enumerate(r.steps) if k > 0 and abs(-s["footing_fy_footing"] / 1e6 - load) < 1e-3]
            if not found:
                continue
            m, s = found[-1], r.steps[found[-1]]
            rows.append([r.name, m, f"{load}", f"{-s['footing_uy_footing']:.3f}", f"{s['footing_ux_footing']:.3f}",
                         f"{-s['footing_turn_footing'] * 57.29577951308232:.3f}", f"{s['dilatancy']:.3f}", f"{s['min_acoustic']:.3g}"])
    return markdown(["run", "mls", "load (MN)", "settlement (m)", "towards the slope (m)", "rotation (degrees)",
                     "dilatancy (%)", "smallest acoustic eigenvalue (N/m)"], rows)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    out, report = sys.argv[1:]
    biaxial = [r for r in (Run(out, n) for n in BIAXIAL) if r.present]
    slope = [r for r in (Run(out, n) for n in SLOPE) if r.present]
    parts = {"runs": runs_table(biaxial + slope), "biaxial": biaxial_table(biaxial), "slope": slope_table(slope),
             "biaxial residuals": residuals(biaxial, {n: (10, 25, 45) for n in BIAXIAL}), "slope residuals": residuals(slope, SELECTED)}
    with open(report) as f:
        text = f.read()
    for name, part in parts.items():
        pattern = re.compile(rf"(<!-- begin {name} -->\n).*?(<!-- end {name} -->)", re.S)
        if not pattern.search(text):
            sys.exit(f"large_study.py: {report} has no place for {name}")
        text = pattern.sub(lambda m: m[1] + "\n" + part + "\n" + m[2], text)
    with open(report + ".tmp", "w") as f:
        f.write(text)
    os.replace(report + ".tmp", report)


main()
