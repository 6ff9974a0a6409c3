"""Tables of the block study: block_study.py OUTDIR REPORT.md

Reads the results of scripts/block-study.sh in OUTDIR, replaces what stands between `<!-- begin NAME -->` and `<!-- end NAME -->` in
REPORT.md, and writes OUTDIR/acoustic_*.txt for the pictures. Python's own library only; HDF5 is read through the C library that
granhom itself links. SPDX-License-Identifier: GPL-2.0-or-later"""
import csv
import ctypes
import ctypes.util
import json
import math
import os
import re
import sys

BOUNDARIES = ("taylor", "restricted", "periodic")
PRESSURES = ("p01", "p02", "p03")
VALUE = {"p01": 0.1, "p02": 0.2, "p03": 0.3}
SELECTED = (7, 11, 22, 28)
# Residuals over forces: below the first is round-off; below the second, what packings relaxed to 1e-8 leave in their stress.
ROUNDOFF, RELAXED = 1e-13, 1e-11
CONFINED, COMPRESSED = 10, 40  # increments that end the two parts of the loading


class Hdf5:
    """Just enough of the HDF5 library to read a dataset of doubles."""

    def __init__(self, path):
        name = ctypes.util.find_library("hdf5_openmpi") or ctypes.util.find_library("hdf5")
        if not name:
            sys.exit("block_study.py: no HDF5 library found")
        self.lib = ctypes.CDLL(name, mode=ctypes.RTLD_GLOBAL)
        for function in ("H5Fopen", "H5Dopen2", "H5Dget_space"):
            getattr(self.lib, function).restype = ctypes.c_int64
        self.lib.H5Sget_simple_extent_npoints.restype = ctypes.c_int64
        self.lib.H5open()
        self.double = ctypes.c_int64.in_dll(self.lib, "H5T_NATIVE_DOUBLE_g")
        self.file = ctypes.c_int64(self.lib.H5Fopen(path.encode(), 0, ctypes.c_int64(0)))
        if self.file.value < 0:
            sys.exit(f"block_study.py: cannot open {path}")

    def read(self, name):
        data = ctypes.c_int64(self.lib.H5Dopen2(self.file, name.encode(), ctypes.c_int64(0)))
        if data.value < 0:
            sys.exit(f"block_study.py: no dataset {name}")
        space = ctypes.c_int64(self.lib.H5Dget_space(data))
        values = (ctypes.c_double * self.lib.H5Sget_simple_extent_npoints(space))()
        zero = ctypes.c_int64(0)
        if self.lib.H5Dread(data, self.double, zero, zero, zero, values) < 0:
            sys.exit(f"block_study.py: cannot read {name}")
        self.lib.H5Sclose(space)
        self.lib.H5Dclose(data)
        return list(values)

    def close(self):
        self.lib.H5Fclose(self.file)


class Run:
    """Results of one run; `steps` holds the rows of history.csv as numbers (and `name`)."""

    def __init__(self, out, name):
        self.name = name
        folder = os.path.join(out, name)
        self.present = os.path.exists(f"{folder}/history.csv")
        with open(f"{out}/{name}.log", errors="replace") as f:
            self.log = f.read().splitlines()
        if not self.present:
            return
        self.steps = [{k: v if k == "name" else float(v) for k, v in row.items()} for row in table(f"{folder}/history.csv")]
        for step, times in zip(self.steps, table(f"{folder}/timing.csv")):  # one row per increment, as in history.csv
            step |= {k: float(v) for k, v in times.items()}
        self.attempts = {}  # increment -> attempts, each a list of rows with rising iterations
        for row in table(f"{folder}/convergence.csv"):
            row = {k: float(v) for k, v in row.items()}
            attempts = self.attempts.setdefault(int(row["step"]), [])
            if not attempts or row["iteration"] <= attempts[-1][-1]["iteration"]:
                attempts.append([])
            attempts[-1].append(row)
        with open(f"{folder}/run.json") as f:
            self.done = json.load(f)["status"] == "done"
        h5 = Hdf5(f"{folder}/results.h5")
        self.acoustic = [h5.read(f"/step{k:04d}/points/acoustic") for k in range(len(self.steps))]
        self.gauss = h5.read("/mesh/gauss")
        h5.close()
        self.jumps = self.read_jumps()

    def read_jumps(self):
        """Increment -> [(point, change of its stress)], from the log: the events of an increment stand before its end."""
        jumps, increment = {}, 0
        for line in self.log:
            if found := re.search(r"instability.*integration point (\d+), stress changes by ([-+.\de]+)", line):
                jumps.setdefault(increment, []).append((int(found[1]), float(found[2])))
            if re.match(r"\S.* \d+/\d+ done: ", line):
                increment += 1
        return jumps

    def column(self, name, first=0):
        return [s[name] for s in self.steps[first:]]

    def displacement(self):
        return abs(self.steps[-1]["uy_top"])

    def total(self, name):
        return sum(self.column(name))

    def lowest(self):
        """Smallest acoustic eigenvalue over the run: value, increment, integration point."""
        return min((v, k, p) for k, values in enumerate(self.acoustic) for p, v in enumerate(values))


def table(path):
    with open(path) as f:
        return list(csv.DictReader(f))


def markdown(head, rows):
    lines = [head, ["---"] * len(head)] + rows
    return "\n".join("| " + " | ".join(str(c) for c in line) + " |" for line in lines) + "\n"


def number(value):
    return f"{value:.3E}"


def residual_table(runs):
    """Residuals of the last attempt of the selected increments, over the first of the attempt."""
    rows = []
    for run in runs:
        for m in (m for m in SELECTED if m < len(run.steps)):
            s, last = run.steps[m], run.attempts[m][-1]
            rows.append([run.name, m, " ".join(number(r["first"]) for r in last[1:]), int(s["substeps"]), int(s["iterations"])])
    return markdown(["run", "mls", "residuals from iteration 2 on", "substeps", "iterations in all"], rows)


def ending(rows):
    """Residuals over forces above round-off of an attempt, when the last three of them fall."""
    r = [row["relative"] for row in rows if row["relative"] > ROUNDOFF]
    return r if len(r) >= 3 and r[-3] > r[-2] > r[-1] else []


def order(r):
    return math.log(r[-1] / r[-2]) / math.log(r[-2] / r[-3])


def constant(r):
    """C = r_k+1 / r_k^2 of the last pair above what the packings leave."""
    r = [v for v in r if v > RELAXED]
    return r[-1] / r[-2]**2


def median(values):
    v = sorted(values)
    return (v[len(v) // 2] + v[(len(v) - 1) // 2]) / 2


def order_table(runs):
    rows = []
    for run in runs:
        plain = [a[0] for k, a in run.attempts.items() if k < len(run.steps) and len(a) == 1]
        ends = [r for r in map(ending, plain) if r]
        if not ends:
            continue
        orders, constants = sorted(map(order, ends)), sorted(map(constant, ends))
        iterations = [len(r) - 1 for r in plain]
        rows.append([run.name, f"{len(plain)}/{len(run.steps)}", f"{min(iterations)}-{max(iterations)}", f"{median(orders):.2f}",
                     f"{sum(p < 1.5 for p in orders)}/{len(orders)}", f"{constants[-1]:.2g}"])
    return markdown(["run", "one attempt", "iterations", "median order", "below 1.5", "largest C"], rows)


def run_table(runs):
    rows = []
    for run in runs:
        seconds = run.total("seconds")
        rows.append([run.name, int(run.total("iterations")), int(run.total("substeps")), int(run.total("cuts")), int(run.total("jumps")),
                     sum(j > 0 for j in run.column("jumps")), f"{run.lowest()[0]:.2f}",
                     f"{100 * sum(v <= 0 for a in run.acoustic for v in a) / (36 * len(run.acoustic)):.1f} %",
                     f"{seconds:.2g}" if seconds < 10 else f"{seconds:.0f}"])
    return markdown(["run", "iterations", "substeps", "bisections", "instabilities", "in increments", "smallest acoustic eigenvalue", "lost",
                     "seconds"], rows)


def jump_share(runs):
    """Do the points that jump have lost ellipticity before? Beside the share of all points that have."""
    rows = []
    for run in runs:
        events = [(k, p) for k, jumps in run.jumps.items() if 0 < k < len(run.steps) for p, _ in jumps]
        if not events:
            continue
        lost = sum(run.acoustic[k - 1][p] <= 0 for k, p in events)
        befores = [v <= 0 for k in {k for k, _ in events} for v in run.acoustic[k - 1]]
        rows.append([run.name, len(events), f"{lost} ({100 * lost / len(events):.0f} %)", f"{100 * sum(befores) / len(befores):.0f} %"])
    return markdown(["run", "instabilities", "at a point at or below 0 before", "share of all points at or below 0"], rows)


def curve_table(runs):
    rows = []
    for run in runs:
        if len(run.steps) <= CONFINED:
            continue
        force, dilatancy, u = run.column("bottom_y", CONFINED), run.column("dilatancy", CONFINED), run.column("uy_top", CONFINED)
        low = dilatancy.index(min(dilatancy))
        rows.append([run.name, f"{force[0]:.2f}", f"{force[-1]:.2f}", sum(b < a for a, b in zip(force, force[1:])), f"{dilatancy[low]:.3f}",
                     f"{-u[low]:.1f}", f"{dilatancy[-1]:.3f}"])
    return markdown(["run", "force at 0 mm (N)", "at 3 mm (N)", "decreases", "lowest dilatancy (%)", "at (mm)", "at 3 mm (%)"], rows)


def ordered(runs, boundary, name, sign):
    """(holds, of, smallest gap) for neighbouring pressures over the increments of the compression."""
    chosen = [r for p in PRESSURES for r in runs if r.name == f"{p}_{boundary}"]
    gaps = [[sign * (b - a) for a, b in zip(x.column(name, CONFINED), y.column(name, CONFINED))] for x, y in zip(chosen, chosen[1:])]
    together = list(zip(*gaps)) if len(gaps) == 2 else []
    if not together:
        return 0, 0, math.nan
    return sum(min(g) > 0 for g in together), len(together), min(min(g) for g in together)


def order_of_curves(runs):
    lines = []
    for boundary in BOUNDARIES:
        force, dilatancy = ordered(runs, boundary, "bottom_y", 1), ordered(runs, boundary, "dilatancy", -1)
        lines.append(f"- {boundary}: force in {force[0]} of {force[1]} states (smallest distance {force[2]:.2f} N), dilatancy in {dilatancy[0]} of "
                     f"{dilatancy[1]} ({dilatancy[2]:.4f} %)\n")
    return "".join(lines)


def rve_table(out):
    """What tests/verify/test_rve_cases printed: the larger error of the two engines."""
    rows, errors, tangents, engine, limits = {}, {}, {}, {}, {}
    name, worst = None, {}
    with open(f"{out}/rve_cases.txt", errors="replace") as f:
        for line in f:
            if found := re.search(r"RUN.*\] (\w+)_(native|lammps)", line):
                name = found[1], found[2]
            elif found := re.search(r"tangent at step \d+: (\S+) of", line):
                tangents[name] = max(tangents.get(name, 0), float(found[1]))
            elif found := re.search(r"^\s*\w+: (\S+) of the largest stress", line):
                errors[name] = float(found[1])
            elif found := re.search(r"(OK|FAILED) +\] (\w+)_(native|lammps)", line):
                rows.setdefault(found[2], {})[found[3]] = found[1] == "OK"
    with open("tests/data/cases/cases.csv") as f:
        for row in csv.DictReader(f):
            limits[row["name"]] = row["tolerance"]
    def larger(case, store):
        found = [store[case, e] for e in ("native", "lammps") if (case, e) in store]
        return f"{max(found):.1e}" if found else "-"
    return markdown(["case", "stress allowed", "stress", "tangent", "met"],
                    [[case, limits[case], larger(case, errors), larger(case, tangents), "yes" if all(met.values()) and len(met) == 2 else "NO"]
                     for case, met in rows.items()])


def ends_table(runs):
    rows = []
    for run in runs:
        if run.present and run.done:
            continue
        rows.append([run.name, f"{run.displacement():g}" if run.present else "0", run.log[-1] if run.log else "no output"])
    return "All runs reached their end.\n" if not rows else markdown(["run", "reached (mm)", "why it ended"], rows)


def write_acoustic(out, runs):
    """For gnuplot: maps (x, y, value) at two increments, (increment, point, value) of all, and the jumps (increment, point)."""
    for run in runs:
        for k in (CONFINED, COMPRESSED):
            with open(f"{out}/acoustic_{run.name}_{k}.txt", "w") as f:
                for p, value in enumerate(run.acoustic[k] if k < len(run.acoustic) else 36 * [math.nan]):
                    f.write(f"{run.gauss[2 * p]:.6g} {run.gauss[2 * p + 1]:.6g} {value:.6g} {p}\n")
        with open(f"{out}/acoustic_{run.name}.txt", "w") as f:
            for k, values in enumerate(run.acoustic):
                f.writelines(f"{k} {p} {value:.6g}\n" for p, value in enumerate(values))
        with open(f"{out}/jumps_{run.name}.txt", "w") as f:
            f.write("-9 -9\n")  # gnuplot wants a row
            f.writelines(f"{k} {p}\n" for k, jumps in run.jumps.items() for p, _ in jumps)


def replace(report, parts):
    with open(report) as f:
        text = f.read()
    for name, part in parts.items():
        pattern = re.compile(rf"(<!-- begin {name} -->\n).*?(<!-- end {name} -->)", re.S)
        if not pattern.search(text):
            sys.exit(f"block_study.py: {report} has no place for {name}")
        text = pattern.sub(lambda m: m[1] + "\n" + part + "\n" + m[2], text)
    with open(report + ".tmp", "w") as f:
        f.write(text)
    os.replace(report + ".tmp", report)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    out, report = sys.argv[1:]
    nine = [Run(out, f"{p}_{b}") for b in BOUNDARIES for p in PRESSURES]
    others = [Run(out, name) for name in ("p150_p02", "p150d_p02", "p150d_p10")]
    runs = [r for r in nine if r.present]
    shown = [r for r in others if r.present]
    periodic = [r for r in runs if r.name.endswith("periodic")]
    parts = {"residuals": residual_table([r for r in runs if r.name.startswith("p02")])}
    parts.update({"runs": run_table(runs + shown), "ends": ends_table(nine + others),
                  "curves": curve_table(runs), "ordered": order_of_curves(runs), "rve cases": rve_table(out)})
    write_acoustic(out, periodic)
    replace(report, parts)
    print(order_table(runs + shown))
    print(jump_share(runs + shown))


if __name__ == "__main__":
    main()
