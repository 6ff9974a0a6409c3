# Mutated scripts, scenes, studies, paths and options through the program itself. SPDX-License-Identifier: GPL-2.0-or-later
#
# A trial is decided by its name alone. What must hold: no signal, no report of a sanitizer, no hang (a computation that takes
# long ends soon after SIGTERM); exit status 0, 1 or 2; with 2 one message and nothing written; with 0 no number that is not
# finite in any file, and no residual above the tolerance.
import csv
import glob
import os
import random
import re
import shutil
import signal
import subprocess

KINDS = ("lammps", "rve", "element", "pack", "scene", "study", "plot")
LIMIT, GRACE = 20, 20  # seconds
NUMBERS = ["0", "-1", "1e308", "-1e308", "1e-308", "nan", "inf", "-inf", "1e9", "2147483647", "2147483648", "9223372036854775807",
           "1e19", "0.5", "2", "1e-3", "-0.0", "1e3", "0.999999999999"]
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])")
# Columns of history.csv and OUT.csv that may be nan: nothing drives the set, no tangent was made, nothing to compare with.
MAY_BE_NAN = re.compile(r"^u[xy]_|^footing_|acoustic|^error|energy_defect|^estimate|defect")


class Trial:
    def __init__(self):
        self.wrong, self.said, self.slow, self.command, self.folder = "", "", 0, [], ""


def mutate(text, r, words):
    """One to four changes: numbers to extreme values, words swapped, lines dropped, repeated or swapped."""
    for _ in range(r.choice((1, 1, 1, 2, 2, 3, 4))):
        lines = text.split("\n")
        k = r.randrange(len(lines))
        kind = r.randrange(10)
        if kind < 5:
            found = list(NUMBER.finditer(text))
            if found:
                m = r.choice(found)
                text = text[:m.start()] + r.choice(NUMBERS) + text[m.end():]
        elif kind == 5:
            found = list(re.finditer(r"[A-Za-z_][\w/-]*", text))
            if len(found) > 1:
                m, other = r.choice(found), r.choice(found).group() if r.random() < 0.5 or not words else r.choice(words)
                text = text[:m.start()] + other + text[m.end():]
        elif kind == 6:
            text = "\n".join(lines[:k] + lines[k + 1:])
        elif kind == 7:
            text = "\n".join(lines[:k + 1] + lines[k:])
        elif kind == 8:
            j = r.randrange(len(lines))
            lines[k], lines[j] = lines[j], lines[k]
            text = "\n".join(lines)
        else:
            at = r.randrange(len(text) + 1)
            text = text[:at] + r.choice(["\t", ",", ":", "[", "}", "#", "\u00b5", "\r", '"', "-", " "]) + text[at + r.randrange(2):]
    return text


def tree(folder):
    return sorted(os.path.relpath(os.path.join(d, f), folder) for d, subs, files in os.walk(folder) for f in files + subs)


def is_odd(text):
    return text.strip().lower().lstrip("+-") in ("nan", "inf", "infinity")


class Driver:
    def __init__(self, kind, granhom, data, root, work, env):
        self.kind, self.granhom, self.data, self.root, self.work, self.env = kind, granhom, data, root, work, dict(env)
        self.env["ASAN_OPTIONS"] = "detect_leaks=0:allocator_may_return_null=1:max_allocation_size_mb=3000"
        self.env["TMPDIR"] = work
        with open(os.path.join(os.path.dirname(data), "words")) as f:
            self.words = [line.strip()[1:-1] for line in f if "\\" not in line]

    def text(self, *paths):
        with open(os.path.join(*paths)) as f:
            return f.read()

    # ---- what is run: files into `here`, the command without the program ----

    def options(self, r):
        o = ["--engine", r.choice(("native", "native", "lammps")),
             "--boundary", r.choice(("taylor", "taylor-cell", "restricted", "periodic"))]
        if r.random() < 0.5:
            o += ["--friction-angle", r.choice(("0", "20", "45", "89.9"))]
            o += r.choice(([], ["--hardening", "0.1"], ["--hardening", "3", "--hardening-law", "proportional"], ["--rotations", "fixed"], ["--slip", "objective"], ["--tangential-stiffness", "3"]))
        if r.random() < 0.3:
            o += r.choice((["--relaxation", "fire"], ["--relaxation", "damped"], ["--max-steps", "20"], ["--accept", "1e-3"],
                           ["--tolerance", "1e-3"]))
        if r.random() < 0.2:
            o[r.randrange(len(o) // 2) * 2 + 1] = r.choice(NUMBERS + ["", "x"])
        return o

    # A script of few steps: what takes long is no hang.
    @staticmethod
    def short(script):
        script = script.replace("granhom/relax ", "granhom/relax max_steps 5000 ")
        script = re.sub(r"cells index \d+", "cells index 5", re.sub(r"steps index \d+", "steps index 50", script))
        return re.sub(r"^(run\s+)\d+", r"\g<1>2000", re.sub(r"loop \d+", "loop 2", script), flags=re.M)

    def make_lammps(self, here, r):
        scripts = sorted(glob.glob(self.root + "/lammps-inputs/in.*") + glob.glob(self.root + "/tests/fuzz/in.*"))
        shutil.copy(self.data + "/packings/p.data", here + "/p150.data")
        shutil.copy(self.data + "/packings/p.data", here + "/p20.data")
        script = mutate(self.short(self.text(r.choice(scripts))), r, None)
        self.put(here, "in.x", script)
        return ["lammps", "-in", "in.x", "-screen", "none"] if r.random() < 0.5 else ["lammps", "-in", "in.x", "-log", "none"]

    def make_rve(self, here, r):
        self.put(here, "p.data", mutate(self.text(self.data, "packings/p.data"), r, None) if r.random() < 0.3 else self.text(self.data, "packings/p.data"))
        path = self.text(self.data, "packings/path.csv")
        self.put(here, "path.csv", mutate(path, r, None) if r.random() < 0.8 else path)
        more = r.choice(([], ["--tangent", "out/t.csv"], ["--dump", "out/d"], ["--save-state", "out/s.h5"], ["--estimate-error"]))
        return ["rve", "p.data", "--path", "path.csv", "-o", "out/o.csv", *self.options(r), *more]

    def make_element(self, here, r):
        shutil.copy(self.data + "/packings/p.data", here)
        scenes = [self.data + "/packings/e.yaml"] * 3 + sorted(glob.glob(self.root + "/scenes/element/*.yaml"))
        self.put(here, "e.yaml", mutate(self.text(r.choice(scenes)), r, self.words))
        return ["element", "p.data", "--control", "e.yaml", "-o", "out/o.csv", *self.options(r)]

    def make_pack(self, here, r):
        shutil.copytree(self.root + "/scenes/packings", here, dirs_exist_ok=True)
        name = os.path.basename(r.choice(sorted(glob.glob(self.root + "/scenes/packings/*.yaml"))))
        self.put(here, name, mutate(self.text(here, name), r, self.words))
        sieve = os.path.basename(r.choice(sorted(glob.glob(self.root + "/scenes/packings/*.csv"))))
        self.put(here, sieve, mutate(self.text(here, sieve), r, None))
        if r.random() < 0.5:
            return ["pack", name, "-o", "out/o.data", "--seconds", "1"]
        return ["pack", "--sieve", sieve, "-o", "out/o.data", "--seconds", "1", "--count", r.choice(["30", "100"] + NUMBERS),
                "--dimension", r.choice("23")]

    def make_scene(self, here, r):
        shutil.copytree(self.data + "/scenes/block", here, dirs_exist_ok=True)
        shutil.copy(self.data + "/packings/p.data", here)
        text = self.text(self.data, "packings/s.yaml")
        if r.random() < 0.3:
            text = self.text(r.choice(sorted(glob.glob(here + "/*_*.yaml")))).replace("[3, 3]", "[1, 1]")
        text = text.replace("taylor-cell", r.choice(("taylor", "taylor-cell", "restricted", "periodic")))
        self.put(here, "s.yaml", mutate(text, r, self.words))
        return ["run", "s.yaml", "-o", "out/run", "--quiet"]

    def make_study(self, here, r):
        shutil.copytree(self.data + "/packings", here + "/packings")
        text = self.text(self.data, "studies/small.yaml").replace("../packings", "packings")
        if r.random() < 0.4:
            text = "scene: packings/s.yaml\nvary: {micro.tolerance: [1e-4, 1e-8]}\nreference: {set: {micro.tolerance: 1e-10}}\n"
        self.put(here, "s.yaml", mutate(text, r, self.words))
        return ["study", "s.yaml", "-o", "out/study", "--quiet"]

    def make_plot(self, here, r):
        shutil.copytree(self.data + "/run", here + "/out", dirs_exist_ok=True)
        name = r.choice(("run.json", "history.csv", "convergence.csv", "timing.csv"))
        self.put(here, "out/" + name, mutate(self.text(here, "out", name), r, self.words))
        return [r.choice(("plot", "report")), "out"]

    def put(self, here, name, text):
        with open(os.path.join(here, name), "w") as f:
            f.write(text)

    # ---- a trial ----

    def trial(self, name):
        r, t = random.Random(name), Trial()
        t.folder = os.path.join(self.work, "trial")
        shutil.rmtree(t.folder, ignore_errors=True)
        os.makedirs(t.folder + "/out")
        words = getattr(self, "make_" + self.kind)(t.folder, r)
        t.command = [self.granhom, *words]
        before = tree(t.folder)
        child = subprocess.Popen(t.command, cwd=t.folder, env=self.env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                 stderr=subprocess.PIPE, start_new_session=True)
        try:
            out, err = child.communicate(timeout=LIMIT)
        except subprocess.TimeoutExpired:
            t.slow = 1
            out, err = self.end(child, t)
        t.said = "# %s\n%s\n%s" % (name, err.decode(errors="replace"), out.decode(errors="replace")[-3000:])
        if not t.wrong:
            self.judge(t, child.returncode, err.decode(errors="replace"), before)
        return t

    def end(self, child, t):
        child.send_signal(signal.SIGTERM)
        try:
            return child.communicate(timeout=GRACE)
        except subprocess.TimeoutExpired:
            t.wrong = "hang: does not end on SIGTERM"
            os.killpg(child.pid, signal.SIGABRT)
            return child.communicate()

    def judge(self, t, code, err, before):
        # An allocation beyond the limit of these runs fails as it would elsewhere; the sanitizer states that it did.
        err = re.sub(r"^==\d+==WARNING: AddressSanitizer failed to allocate.*$", "", err, flags=re.M)
        if re.search(r"Sanitizer|runtime error:", err):
            t.wrong = "a report of a sanitizer"
        elif code < 0 and not (t.slow and code == -signal.SIGTERM):
            t.wrong = "signal %d" % -code
        elif t.slow or (self.kind == "lammps" and code != 2):
            return
        elif code not in (0, 1, 2):
            t.wrong = "exit status %d" % code
        elif code == 2 and tree(t.folder) != before:
            t.wrong = "exit status 2, and something was written: %s" % (set(tree(t.folder)) - set(before))
        elif code == 2 and len(re.findall(r"^granhom", err, flags=re.M)) != 1:
            t.wrong = "exit status 2 without one message"
        elif code == 1 and not re.search(r"^granhom", err, flags=re.M):
            t.wrong = "exit status 1 without a message"
        elif code == 0 and self.kind != "plot":
            self.numbers(t)

    # The tolerance that the residuals of a table are to meet; 0: it has none of its own.
    @staticmethod
    def limit(t, path):
        words = t.command
        if os.path.basename(path) != "o.csv" or "--accept" in words:
            return 0
        return float(words[words.index("--tolerance") + 1]) if "--tolerance" in words else 1e-8

    def numbers(self, t):
        for path in sorted(glob.glob(t.folder + "/out/**/*.csv", recursive=True)):
            with open(path, newline="") as f:
                rows = list(csv.DictReader(f))
            if self.kind == "study":
                continue  # configurations without a result have empty or nan errors
            limit = self.limit(t, path)
            for row in rows:
                residual = row.get("residual")
                if limit and residual and not float(residual) <= limit:
                    t.wrong = "exit status 0, and the residual %s is above %g" % (residual, limit)
                for column, value in row.items():
                    if column and value and is_odd(str(value)) and not MAY_BE_NAN.search(column):
                        t.wrong = "exit status 0, and %s is %s in %s" % (column, value, os.path.basename(path))
        for path in glob.glob(t.folder + "/out/*.data"):
            if any(is_odd(word) for word in self.text(path).split()):
                t.wrong = "exit status 0, and a packing with numbers that are not finite"
