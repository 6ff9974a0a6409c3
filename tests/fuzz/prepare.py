# The folder that fuzz targets work in, and what they begin with. SPDX-License-Identifier: GPL-2.0-or-later
import glob
import os
import re
import shutil
import subprocess

SCENE = """title: small
packing: p.data
contact: {normal_stiffness: 50}
micro: {boundary: taylor-cell, engine: native}
start: {confinement: 0.3}
mesh: {rectangle: {size: [10, 10], elements: [1, 1]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps:
  - {name: press, increments: 1, pressure: [{edge: right, to: 0.32}, {edge: top, to: 0.31}]}
  - {name: shear, increments: 2, displace: [{edge: top, x: 0.01}]}
results: {rves: all}
"""
STUDY = """title: small
rve:
  packing: ../packings/p.data
  contact: {normal_stiffness: 50, friction_angle: 20}
  micro: {boundary: taylor, engine: native}
  path: {legs: [{to: [0.99, 0, 0, 1], increments: 4}]}
vary:
  micro.tolerance: [1e-4, 1e-8]
reference: {set: {micro.tolerance: 1e-10}}
"""
PATH = "step,F11,F12,F21,F22\n0,1,0,0,1\n1,0.999,0,0,1.001\n2,0.998,0.001,0,1.001\n"
ELEMENT = """steps:
  - {name: press, increments: 2, control: {s11: -0.3, s22: -0.3, s12: 0}}
  - {name: load, increments: 2, control: {F22: {by: -0.001}, s11: hold, s12: 0}, until: {s22: -0.4}}
"""
WORDS = """1e-8
s11
(s11+s22)/2
det F
F11
J
p
pressure=0.01
overlap=0.02
count 100
cell 1,2
tilt 0.1
dimension 3
collision momentum
finish pressure=0.01
finish-cell relaxed
anisotropy 0.1
volume-fraction 0.8
seconds 1
seed 7
"""
ODD = ["0", "-1", "1e308", "-1e308", "1e-308", "nan", "inf", ".nan", ".inf", "1e9", "1000000000", "2147483647", "2147483648",
       "9223372036854775807", "99999999999999999999", "0x10", "1,5", "~", "[]", "{}", "&a", "*a", "\\xef\\xbb\\xbf", "\\x00"]


def write(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as f:
        f.write(text if isinstance(text, bytes) else text.encode())


def read(path):
    with open(path, "rb") as f:
        return f.read()


class Work:
    """build-fuzz/fuzz: data/ (FUZZ_DATA), seeds/TARGET/, words (a dictionary)."""

    def __init__(self, root, build, folder):
        self.root, self.granhom, self.folder = root, os.path.join(build, "granhom"), folder
        self.data = os.path.join(folder, "data")
        self.packing = read(os.path.join(root, "tests/fuzz/p20.data"))

    def run(self, *words):
        done = subprocess.run([self.granhom, *words], cwd=self.data, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        if done.returncode != 0:
            raise SystemExit("granhom %s: %s" % (" ".join(words), done.stdout.decode(errors="replace")[:3000]))

    def make_data(self):
        for folder in ("data", "seeds"):
            shutil.rmtree(os.path.join(self.folder, folder), ignore_errors=True)
        shutil.copytree(os.path.join(self.root, "scenes"), os.path.join(self.data, "scenes"))
        for path in glob.glob(self.data + "/scenes/**/*.data", recursive=True):
            write(path, self.packing)
        for name in ("p88-001", "p150-001", "p300-001", "p2400-001"):
            write(self.data + "/scenes/studies/packings/%s.data" % name, self.packing)
        write(self.data + "/packings/p.data", self.packing)
        write(self.data + "/packings/s.yaml", SCENE)
        write(self.data + "/packings/path.csv", PATH)
        write(self.data + "/packings/e.yaml", ELEMENT)
        write(self.data + "/states/p.data", self.packing)
        write(self.data + "/studies/small.yaml", STUDY)
        self.run("run", "packings/s.yaml", "-o", "run", "--quiet")
        law = ["--friction-coefficient", "0.5", "--tangential-stiffness", "1"]
        for name, words in (("smooth", []), ("friction", law)):
            self.run("rve", "states/p.data", "--path", "packings/path.csv", "--engine", "native", "--boundary", "restricted",
                     "--save-state", "states/%s.h5" % name, "-o", "states/%s.csv" % name, *words)
        self.run("rve", "states/p.data", "--path", "packings/path.csv", "--engine", "native", "--boundary", "taylor",
                 "-o", "states/dump.csv", "--dump", "states/dump")
        self.run("study", "studies/small.yaml", "-o", "records", "--quiet")

    def seed(self, target, files, most=12000, head=b""):
        for k, item in enumerate(files):
            text = item if isinstance(item, bytes) else item.encode() if "\n" in item else read(item)
            if len(text) <= most:
                write("%s/seeds/%s/%03d" % (self.folder, target, k), head + text)

    def make_seeds(self):
        def scene(pattern):
            return sorted(glob.glob(self.root + "/" + pattern, recursive=True))

        p = self.packing.decode()
        tilted = p.replace("-0.5 0.5 zlo zhi", "-0.5 0.5 zlo zhi\n0.1 0 0 xy xz yz")
        images = re.sub(r" 0\.0$", " 0.0 0 0 0", p, flags=re.M)
        tables = scene("tests/data/cases/paths/*.csv")[:8] + scene("scenes/crosscheck/*.csv")
        sieves = scene("scenes/packings/*.csv") + scene("scenes/block/*.csv")
        yaml = scene("scenes/**/*.yaml") + scene("tests/data/io/*.yaml")
        setters = [read(f) + b"\n%%\nsteps.1.increments\n[1, {a: 2}]\n" for f in scene("scenes/block/p0*.yaml")]
        self.seed("lammps_data", [p, tilted, images] + scene("tests/data/io/*.data") + scene("tests/data/lammps/*"))
        self.seed("csv", tables + ["s11,s22,s12\n-0.1,-0.1,0\n-0.2,-0.1,0\n"] + sieves)
        self.seed("sieve", sieves + scene("tests/data/sieve/*"))
        self.seed("yaml", yaml + setters)
        self.seed("scene", scene("scenes/block/*.yaml") + scene("scenes/biaxial/*.yaml") + [SCENE])
        self.seed("element", scene("scenes/element/*.yaml") + [ELEMENT])
        self.seed("pack", scene("scenes/packings/*.yaml") + scene("scenes/crosscheck/*.yaml"))
        self.seed("study", scene("scenes/studies/*.yaml") + [STUDY.replace("../packings/", "../../packings/")])
        self.seed("gmsh", scene("tests/data/mesh/*.msh"))
        self.seed("words", [WORDS] + [w + "\n" for w in WORDS.split("\n")])
        self.seed("dump", [self.data + "/states/dump"])
        self.seed("record", sorted(glob.glob(self.data + "/records/runs/*.json")))
        changes = [bytes([kind, 3, 1, name, 5, 0, 200, 0, 9, 130]) for kind in range(5) for name in range(kind % 3, 12, 3)]
        self.seed("state", changes)
        self.seed("bytes", [bytes([k * 16 % 256, k // 16, 1 + k % 255]) for k in range(0, 380, 5)] + [b"\0\0\0"])
        self.seed("checkpoint", [b"\x00\x00\x00" + c for c in changes] + [b"\x80\x10\x01\x00", b"\x81\x10\x01\x00"])
        for k, name in enumerate(("run.json", "history.csv", "convergence.csv", "timing.csv")):
            self.seed_more("report", k, read(self.data + "/run/" + name))
        for k in range(4, 7):
            for j, change in enumerate(changes[::3]):
                self.seed_more("report", k * 100 + j, change, head=bytes([k]))

    def seed_more(self, target, number, text, head=None):
        write("%s/seeds/%s/%03d" % (self.folder, target, number), (bytes([number]) if head is None else head) + text)

    def make_words(self):
        keys = set()
        for pattern in ("src/scene/read*.c", "src/scene/packings.c", "src/study/read.c", "src/study/problem.c", "driver/*_spec.c",
                        "src/mesh/gmsh.c", "src/io/lammps_data.c", "src/packing/sieve.c", "src/control/condition.c",
                        "src/report/recorded.c", "src/report/report*.c", "src/study/record.c", "src/prepare/finish.c"):
            for path in glob.glob(os.path.join(self.root, pattern)):
                keys.update(re.findall(r'"([$#A-Za-z][A-Za-z0-9_ -]{0,30})"', read(path).decode()))
        lines = ['"%s"' % word for word in sorted(keys) + ODD]
        write(self.folder + "/words", "\n".join(lines) + "\n")

    def make(self):
        os.makedirs(self.folder, exist_ok=True)
        self.make_data()
        self.make_seeds()
        self.make_words()
