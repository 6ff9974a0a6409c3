#!/usr/bin/python3
"""One command of granhom with every allocation and every call on files failing, one at a time.

drive.py GRANHOM LIBRARY CASE KIND FLAVOUR [--sample N SEED] [--point K]

Each point: no crash, no hang; exit 0 with the files of the undisturbed run, or exit 1 with one message, with
what was on disk before still there or complete, and nothing temporary left. Commands that can continue then do
so and give the files of the undisturbed run. Prints what failed, and a last line for the table of run.sh.
SPDX-License-Identifier: GPL-2.0-or-later
"""
import io
import os
import random
import re
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import zlib

import h5py
import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
PACKING = os.path.join(HERE, "../data/cases/packings/p20.data")
LIMIT = 30  # seconds of one run
THEIRS = "(theirs) "  # a library does not check its own allocation, and crashes, or one that it calls
BELOW = {"libcairo": ("libpixman", "libfreetype", "libfontconfig", "libpng")}

SCENE = """title: faults
packing: p.data
contact: {normal_stiffness: 50}
micro: {boundary: taylor-cell, engine: ENGINE}
start: {confinement: 0.3}
mesh: {rectangle: {size: [10, 10], elements: [1, 1]}}
supports: [{edge: left, fix: x}, {edge: bottom, fix: y}]
steps:
  - {name: press, increments: 1, pressure: [{edge: right, to: 0.32}, {edge: top, to: 0.31}]}
  - {name: shear, increments: 2, displace: [{edge: top, x: 0.01}]}
results: {dump: [0], rves: all}
"""
STUDY = """title: faults
rve:
  packing: p.data
  contact: {normal_stiffness: 50}
  micro: {boundary: taylor-cell, engine: native}
  path: {legs: [{to: [0.999, 0, 0, 1], increments: 2}]}
vary:
  micro.tolerance: [1e-2, 1e-4]
reference: {set: {micro.tolerance: 1e-10}}
"""
INPUTS = {
    "path.csv": "step,F11,F12,F21,F22\n0,1,0,0,1\n1,0.999,0,0,1.001\n",
    "control.yaml": "steps:\n  - {name: press, increments: 2, control: {s11: -0.4, s22: -0.4, s12: 0}}\n",
    "sieve.csv": "diameter,count\n0.25,4\n0.32,8\n",
    "s.yaml": SCENE.replace("ENGINE", "native"),
    "sl.yaml": SCENE.replace("ENGINE", "lammps").replace("taylor-cell", "restricted").replace("increments: 2", "increments: 1"),
    "study.yaml": STUDY,
}
RVE = "rve p.data --path path.csv --boundary restricted --friction-angle 20 -o out/o.csv --tangent out/t.csv --dump out/d --save-state out/s.h5"


class Case:
    """words: the command; before: what makes its folder; again: the command that continues after a failure; old: results that an
    earlier command has left, each of which stays or is replaced as a whole (or by its first lines)."""

    def __init__(self, words, before=(), again=None, old=(), ranks=1, half=False):
        self.words, self.before, self.again, self.old, self.ranks, self.half = words, before, again, old, ranks, half


CASES = {
    "run": Case("run s.yaml -o out --quiet", again="run s.yaml -o out --quiet --restart"),
    "run-lammps": Case("run sl.yaml -o out --quiet", again="run sl.yaml -o out --quiet --restart"),
    "restart": Case("run s.yaml -o out --quiet --restart", before=["run s.yaml -o out --quiet"], half=True,
                    again="run s.yaml -o out --quiet --restart"),
    "rve": Case(RVE + " --engine native", old=("o.csv", "t.csv", "d")),
    "rve-lammps": Case("rve p.data --path path.csv --boundary periodic -o out/o.csv", old=("o.csv",)),
    "rve-stdout": Case("rve p.data --path path.csv --boundary taylor-cell --engine native --tangent -"),
    "load": Case("rve p.data --path path.csv --engine native --boundary taylor-cell --load-state out/s.h5 -o out/o.csv",
                 before=["rve p.data --path path.csv --engine native --boundary taylor-cell --save-state out/s.h5 -o out/1.csv"],
                 old=("o.csv",)),
    "element": Case("element p.data --control control.yaml --engine native --boundary restricted --normal-stiffness 50 -o out/o.csv",
                    old=("o.csv",)),
    "pack": Case("pack --sieve sieve.csv --rate 0.05 -o out/o.data --finish overlap=0.01 --picture out/o.png", old=("o.data", "o.png")),
    "report": Case("report out -o out/page.html", before=["run s.yaml -o out --quiet"], old=("page.html",)),
    "plot": Case("plot out", before=["run s.yaml -o out --quiet"], old=("mesh.png", "rve.png", "curves.png", "convergence.png")),
    "study": Case("study study.yaml -o out --quiet", again="study study.yaml -o out --quiet"),
    "explain": Case("run s.yaml --explain"),
    "run-ranks": Case("run s.yaml -o out --quiet", again="run s.yaml -o out --quiet --restart", ranks=2),
    "study-ranks": Case("study study.yaml -o out --quiet", again="study study.yaml -o out --quiet", ranks=2),
}


# ---- running ----


def is_theirs(caller, crash, status):
    """Whether the library whose allocation failed crashed, or one that works for it alone. A jump of libpng's to nowhere leaves no name."""
    if status == 139 and crash in ("-", "") and caller.startswith("libcairo"):
        return True
    return crash.startswith("lib") and (caller == crash or crash.startswith(BELOW.get(caller.split(".")[0], "none")))


class Server:
    """granhom with the library; forks for each order."""

    def __init__(self, granhom, library, words, folder):
        ours, theirs = socket.socketpair()
        env = dict(os.environ, LD_PRELOAD=library, FAULT_FD=str(theirs.fileno()), TMPDIR=folder + ".tmp",
                   OMP_NUM_THREADS="1", OMPI_MCA_opal_signal="", OPENBLAS_NUM_THREADS="1")
        self.process = subprocess.Popen([granhom] + words.split(), env=env, pass_fds=[theirs.fileno()])
        theirs.close()
        self.file = ours.makefile("rw")
        self.socket, self.folder = ours, folder

    def order(self, kind="none", flavour="hard", point=0):
        self.file.write(f"{self.folder} {kind} {flavour} {point} {LIMIT}\n")
        self.file.flush()
        status, points, met, caller, crash, what = self.file.readline().rstrip("\n").split(" ", 5)
        if is_theirs(caller, crash, int(status)):
            what = THEIRS + what
        return int(status), int(points), met == "1", what

    def paths(self, _):
        with open(self.folder + ".paths", "rb") as file:
            return [path for path, in struct.iter_unpack("I", file.read())]


class Ranks:
    """granhom under mpirun; the point is one of the given rank. What continues afterwards is one process (Server): several times faster,
    and the results are those of any number of ranks."""

    def __init__(self, granhom, library, words, folder, ranks, rank):
        self.granhom, self.library, self.words, self.folder, self.ranks, self.rank = granhom, library, words, folder, ranks, rank

    def order(self, kind="none", flavour="hard", point=0):
        answer = self.folder + ".answer"
        env = dict(os.environ, TMPDIR=self.folder + ".tmp", OMP_NUM_THREADS="1", OMPI_MCA_opal_signal="", OPENBLAS_NUM_THREADS="1", FAULT_RANK=str(self.rank),
                   FAULT_ORDER=f"{self.folder} {kind} {flavour} {point} {LIMIT}", FAULT_ANSWER=answer)
        words = ["timeout", "-k", "2", str(LIMIT), "mpirun", "--oversubscribe", "-n", str(self.ranks), "env", "LD_PRELOAD=" + self.library,
                 self.granhom] + self.words.split()
        with open(self.folder + ".out", "wb") as out, open(self.folder + ".err", "wb") as err:
            status = subprocess.run(words, env=env, cwd=self.folder, stdin=subprocess.DEVNULL, stdout=out, stderr=err, check=False).returncode
        with open(answer, "rb") as file:
            points, met, what, caller, crash = (word.split(b"\0")[0] if isinstance(word, bytes) else word
                                                for word in struct.unpack_from("li200s64s64s", file.read(340)))
        if status < 0:
            status = 128 - status
        return status, points, met == 1, (THEIRS if is_theirs(caller.decode(), crash.decode(), status) else "") + what.decode()

    def paths(self, count):
        with open(self.folder + ".answer", "rb") as file:
            return struct.unpack_from(f"{count}I", file.read(), 340)


# ---- what is on disk ----


def files_read(folder):
    found = {}
    for root, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(root, name)
            with open(path, "rb") as file:
                found[os.path.relpath(path, folder)] = file.read()
    return found


# Columns that are measured: seconds, and what follows from them.
MEASURED = re.compile(rb".*seconds.*|wall|core|pareto")


def text_pieces(data):
    """Words of a text, without what is measured: seconds, and the memory of one RVE."""
    rows = data.split(b"\n")
    names = rows[0].split(b",")
    drop = {k for k, name in enumerate(names) if MEASURED.fullmatch(name)}
    if drop and len(names) > 1:
        rows = [b",".join(word for k, word in enumerate(row.split(b",")) if k not in drop) for row in rows]
    text = re.sub(rb"[-+.e0-9]+ (s|ms|min)\b", b"TIME", b"\n".join(rows))
    text = re.sub(rb"(bytes_of_one\":\s*)\d+", rb"\1BYTES", text)
    text = re.sub(rb"20\d\d-\d\d-\d\dT[\d:]+Z", b"TIME", text)
    return re.split(rb"([\s,;:<>\"=()]+)", text)


# Of checkpoint.h5: seconds and memory of RVEs among others; run.json has what else is in the summary.
MEASURED_SETS = (b"farm/measure", b"run/summary")


def hdf5_pieces(data):
    """Names, sizes and values of all datasets. By the low-level interface, which is several times faster."""
    found = []
    access = h5py.h5p.create(h5py.h5p.FILE_ACCESS)
    access.set_fapl_core(backing_store=False)
    access.set_file_image(data)
    file = h5py.h5f.open(b"image", h5py.h5f.ACC_RDONLY, access)

    def visit(name):
        item = h5py.h5o.open(file, name)
        if not isinstance(item, h5py.h5d.DatasetID) or b"seconds" in name or name in MEASURED_SETS:
            return
        value = numpy.empty(item.shape, item.dtype)
        if value.dtype.kind == "O":
            text = h5py.Dataset(item)[()]
            found.extend([name] + text_pieces(text if isinstance(text, bytes) else str(text).encode()))
            return
        if value.size:
            item.read(h5py.h5s.ALL, h5py.h5s.ALL, value)
        raw = value.tobytes()
        found.extend([name, value.shape])
        if name.startswith(b"text/"):
            found[-1:] = text_pieces(raw[8:].strip(b"\0"))
        elif value.dtype.kind == "S":
            found.extend(text_pieces(raw))
        else:
            found.append(value.dtype.str)
            found.extend(raw[k:k + 8] for k in range(0, len(raw), 8))

    h5py.h5o.visit(file, visit)
    file.close()
    return found


def pieces(name, data):
    """What is compared one by one. What a study states about the cheapest configuration depends on seconds: its end alone."""
    if name.endswith("study.md"):
        return data.split(b"\n")[-2:]
    if b"\x89HDF\r\n" in data[:4096]:
        try:
            return hdf5_pieces(data)
        except Exception as wrong:  # whatever HDF5 makes of a broken file
            return ["broken: " + str(wrong)]
    return [data] if b"\0" in data else text_pieces(data)


def png_pixels(data):
    """Height x width x 3 of an RGB picture of 8 bits, as cairo and gnuplot write them."""
    at, packed = 8, b""
    while at < len(data):
        size, name = struct.unpack(">I4s", data[at:at + 8])
        if name == b"IHDR":
            width, height = struct.unpack(">II", data[at + 8:at + 16])
        packed += data[at + 8:at + 8 + size] if name == b"IDAT" else b""
        at += 12 + size
    rows = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, 1 + 3 * width).astype(int)
    above, pixels = [0] * (3 * width), []
    for row in rows.tolist():
        way, line = row[0], row[1:]
        for i in range(3 * width if way else 0):
            a, b, c = line[i - 3] if i > 2 else 0, above[i], above[i - 3] if i > 2 else 0
            nearest = min((a, b, c), key=lambda v: abs(a + b - c - v))
            line[i] = (line[i] + (0, a, b, (a + b) // 2, nearest)[way]) % 256
        above = line
        pixels.append(line)
    return numpy.array(pixels).reshape(height, width, 3)


def pictures_alike(one, other):
    """Without memory for its best way, cairo smooths edges by another one: some pixels differ a little."""
    if not (one.startswith(b"\x89PNG") and other.startswith(b"\x89PNG")) or one[16:29] != other[16:29]:
        return False
    apart = abs(png_pixels(one) - png_pixels(other)).max(axis=2)
    return apart.max() <= 32 and (apart > 0).sum() <= 100


class Reference:
    """Files of several undisturbed runs: pieces in which these differ (seconds) are not compared. alike: bytes of each file, and
    where these are the same in all runs; most files are found right by them, and need not be read piece by piece."""

    def __init__(self, runs):
        self.pieces, self.alike = {}, {}
        for name in runs[0]:
            texts = [run.get(name, b"") for run in runs]
            if len({len(text) for text in texts}) == 1:
                table = numpy.array([numpy.frombuffer(text, numpy.uint8) for text in texts])
                self.alike[name] = (table[0], (table == table[0]).all(axis=0))
            ways = [pieces(name, text) for text in texts]
            if len({len(way) for way in ways}) > 1:
                self.pieces[name] = None  # its length depends on the time
            else:
                self.pieces[name] = [way[0] if len(set(way)) == 1 else None for way in zip(*ways)]

    def same(self, name, data):
        wanted = self.pieces.get(name)
        if wanted is None:
            return bool(data)
        if name in self.alike and len(data) == len(self.alike[name][0]):
            bytes_, fixed = self.alike[name]
            if not ((numpy.frombuffer(data, numpy.uint8) != bytes_) & fixed).any():
                return True
        found = pieces(name, data)
        if len(found) == len(wanted) == 1 and wanted[0] and pictures_alike(wanted[0], data):
            return True
        if len(found) != len(wanted):
            self.why = f"{len(found)} pieces instead of {len(wanted)}"
            return False
        apart = [(w, f) for w, f in zip(wanted, found) if w is not None and w != f]
        self.why = f"{apart[0][1]} instead of {apart[0][0]}" if apart else ""
        return not apart

    def begins(self, name, data):
        """Whole lines from the start of the file of a whole run."""
        found, wanted = pieces(name, data), self.pieces.get(name)
        if not data.endswith(b"\n") or wanted is None:
            return False
        found = found[:-1]
        return len(found) <= len(wanted) and all(w is None or w == f or "\n" in str(f) for w, f in zip(wanted, found))

    def difference(self, found):
        """Name of a file that is missing, wrong or too much."""
        for name in self.pieces:
            if name not in found:
                return "missing: " + name
            if not self.same(name, found[name]):
                return f"wrong: {name}: {self.why}"
        return None

    def surplus(self, found):
        extra = [name for name in found if name not in self.pieces]
        return "left: " + extra[0] if extra else None


# ---- one command ----


class Drive:
    def __init__(self, granhom, library, case, kind, flavour, rank):
        self.case, self.kind, self.flavour = case, kind, flavour
        base = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
        self.top = tempfile.mkdtemp(prefix="granhom-faults-", dir=base)
        self.folder, self.start = self.top + "/work", self.top + "/start"
        os.mkdir(self.start)
        os.mkdir(self.start + "/out")
        shutil.copy(PACKING, self.start + "/p.data")
        for name, text in INPUTS.items():
            with open(f"{self.start}/{name}", "w", encoding="ascii") as file:
                file.write(text)
        self.make = lambda words: Server(granhom, library, words, self.folder)
        self.servers = {}
        self.command = Ranks(granhom, library, case.words, self.folder, case.ranks, rank) if case.ranks > 1 else self.server(case.words)
        for words in case.before:
            self.prepare(words)
        self.reference = self.measure()
        for name in case.old:
            with open(f"{self.start}/out/{name}", "w", encoding="ascii") as file:
                file.write("old\n")

    def server(self, words):
        if words not in self.servers:
            self.servers[words] = self.make(words)
        return self.servers[words]

    def clean(self):
        shutil.rmtree(self.folder, ignore_errors=True)
        shutil.rmtree(self.folder + ".tmp", ignore_errors=True)
        shutil.copytree(self.start, self.folder)
        os.mkdir(self.folder + ".tmp")

    def prepare(self, words):
        """Leaves in `start` what a command makes; with `half`, of one whose disk fails after two thirds of its calls."""
        self.clean()
        status, points, _, _ = self.server(words).order("io", "hard", 0)
        assert status == 0, self.words_read(".err")
        if self.case.half:
            for k in range(points * 2 // 3, points):
                self.clean()
                status = self.server(words).order("io", "hard", k)[0]
                if status == 1 and os.path.exists(self.folder + "/out/checkpoint.h5"):
                    break
            assert status == 1, self.words_read(".err")
        shutil.rmtree(self.start)
        shutil.copytree(self.folder, self.start)

    def words_read(self, end):
        with open(self.folder + end, "rb") as file:
            return file.read().decode(errors="replace")

    def look(self):
        found = files_read(self.folder)
        found["(stdout)"] = self.words_read(".out").encode()
        found.update({"(temporary) " + name: data for name, data in files_read(self.folder + ".tmp").items() if "ompi." not in name})
        return found

    def measure(self):
        runs = []
        for _ in range(4):
            self.clean()
            status = self.command.order()[0]
            assert status == 0, (status, self.words_read(".err"))
            runs.append(self.look())
        return Reference(runs)

    def message(self):
        """What is wrong with the words of a run that failed."""
        lines = [line for line in self.words_read(".err").split("\n") if re.match("granhom[: ]", line)]
        if len(lines) != 1:
            return f"{len(lines)} messages"
        if re.search("not valid|malformed|not an? HDF5", lines[0]):
            return "blames the input: " + lines[0]
        return None

    def verdict(self, status, what):
        if status not in (0, 1):
            return "hang" if status in (124, 137) else f"exit {status}: " + " | ".join(self.words_read(".err").split("\n")[-3:])
        found = self.look()
        left = None if re.match(r"unlink|remove|rmdir|open\(.*\.tmp/granhom-", what) else self.reference.surplus(found)
        if status == 1 and self.case.ranks > 1 and left == "left: out/.lock":
            left = None  # a rank has ended the others: the lock goes with the next command (go_on)
        if status == 0:
            return left or self.reference.difference(found)
        wrong = left or self.message()
        for name in self.case.old:
            data = found.get("out/" + name)
            if data not in (b"old\n", b"") and (data is None or not (self.reference.same("out/" + name, data) or self.reference.begins("out/" + name, data))):
                wrong = wrong or "neither old nor new: " + name
        return wrong or self.go_on()

    def go_on(self):
        """The same results when the command is given again. Files that tell how it went, and when, differ."""
        if not self.case.again:
            return None
        status = self.server(self.case.again).order()[0]
        if status != 0:
            return f"afterwards exit {status}: " + self.words_read(".err").strip().split("\n")[-1]
        found = self.look()
        for name, data in found.items():
            if re.search(r"run\.json$|timing\.csv$|checkpoint\.h5$|study\.(md|json)$|\(stdout\)", name):
                continue
            if name in self.reference.pieces and not self.reference.same(name, data):
                return f"afterwards wrong: {name}: {self.reference.why}"
        missing = [name for name in self.reference.pieces if name not in found]
        return "afterwards missing: " + missing[0] if missing else self.reference.surplus(found)

    def points(self):
        """Number of points, and those to go through: of points that the same calls lead to, the first, the second and the last; in
        libraries, and with ranks, the first."""
        count = self.command.order(self.kind, self.flavour, -1)[1]
        where = {}
        for k, path in enumerate(self.command.paths(count), 1):
            where.setdefault(path, []).append(k)
        few = slice(0, 1) if self.kind == "lib" or self.case.ranks > 1 else slice(0, 2)
        last = slice(-1, None) if few.stop > 1 else slice(0, 0)
        return count, sorted({k for points in where.values() for k in points[few] + points[last]})

    def point(self, k):
        self.clean()
        status, _, met, what = self.command.order(self.kind, self.flavour, k)
        if not met and (self.case.ranks == 1 or status != 0):
            return status, what, "never met"
        return status, what, self.verdict(status, what)  # who of the ranks does what differs: a point may be the other one's


def main():
    granhom, library, name, kind, flavour = sys.argv[1:6]
    rest = sys.argv[6:]
    case, rank = CASES[name.split("@")[0]], int(name.split("@")[1]) if "@" in name else 0
    drive = Drive(granhom, library, case, kind, flavour, rank)
    try:
        drive.clean()
        count, points = drive.points()
        if rest and rest[0] == "--point":
            points = [int(word) for word in rest[1:]]
        elif rest:
            few = int(rest[1])
            points = sorted(random.Random(f"{rest[2]} {name} {kind} {flavour}").sample(points, few)) if few < len(points) else points
        codes, failed, theirs = {0: 0, 1: 0}, 0, 0
        for k in points:
            status, what, wrong = drive.point(k)
            codes[status] = codes.get(status, 0) + 1
            if what.startswith(THEIRS):
                theirs += 1
            elif wrong:
                failed += 1
                print(f"{name} {kind} {flavour} {k}: {what}: exit {status}: {wrong}", flush=True)
            elif rest and rest[0] == "--point":
                print(f"{name} {kind} {flavour} {k}: {what}: exit {status}\n{drive.words_read('.err')}", flush=True)
        print(f"table {name:12} {kind:4} {flavour:5} {count:7} {len(points):7} {codes[0]:7} {codes[1]:7} {theirs:7} {failed:7}", flush=True)
    finally:
        shutil.rmtree(drive.top, ignore_errors=True)


if __name__ == "__main__":
    main()
