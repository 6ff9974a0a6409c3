#!/usr/bin/env python3
# Runs all fuzz targets, and mutated scripts through the program itself; prints a table and "N passed, N failed".
# SPDX-License-Identifier: GPL-2.0-or-later
#
# usage: run.py --build DIR [--seconds S] [--jobs J] [--seed N] [--sample] [TARGET...]
# --sample: from the seeds alone, nothing of earlier runs; for `make check`. Without TARGET: all.
import argparse
import concurrent.futures
import glob
import hashlib
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True  # nothing is left in the sources
import prepare  # noqa: E402
import programs  # noqa: E402

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
MOST_FINDINGS = 10
ENVIRONMENT = {
    "ASAN_OPTIONS": "detect_leaks=1:allocator_may_return_null=1:abort_on_error=0",
    "UBSAN_OPTIONS": "print_stacktrace=1",
    "LSAN_OPTIONS": "suppressions=%s/tests/fuzz/leaks.supp:print_suppressions=0" % ROOT,
    "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1",
    "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_btl_base_warn_component_unused": "0",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none"}
# Frames that say nothing of where a fault is.
NO_PLACE = re.compile(r"__asan|__ubsan|__sanitizer|__interceptor|fuzzer::|LLVMFuzzer|^abort|^raise|gsignal|fuzz_require|_start|libc\.so|nptl/|sysdeps/|stdlib/|csu/|fuzz_good|gh_quote")


class Row:
    def __init__(self, name):
        self.name, self.runs, self.edges, self.seconds, self.foreign, self.findings, self.slow = name, 0, 0, 0.0, 0, [], 0


def frames(text):
    return [f for f in re.findall(r"^\s*#\d+ 0x\w+ (?:in )?(.+)$", text, flags=re.M) if not NO_PLACE.search(f)]


# A fault inside HDF5, LAMMPS, YAML, cairo ..., not in what they were given: none of the first frames is ours.
def is_foreign(text):
    first = frames(text)[:3]
    return bool(first) and not re.search(r"out-of-memory|timeout", text) and all(
        re.search(r"\(/(usr/)?lib/|\.so", f) for f in first)


def place(text):
    first = [re.sub(r"0x\w+|\+.*$", "", f) for f in frames(text)[:2]]
    first += [line for line in re.findall(r"^fuzz: .*$", text, flags=re.M)][-1:]
    return hashlib.sha1("|".join(first).encode()).hexdigest()[:8]


class Fuzz:
    def __init__(self, options):
        self.o = options
        self.build = os.path.abspath(options.build)
        self.folder = os.path.join(self.build, "fuzz")
        self.findings = os.path.join(self.build, "findings")
        self.env = dict(os.environ, FUZZ_DATA=os.path.join(self.folder, "data"), **ENVIRONMENT)
        os.makedirs(self.findings, exist_ok=True)

    def keep(self, row, name, said, command, inputs=None):
        """A finding: what it said, its input and the command that shows it again."""
        folder = os.path.join(self.findings, "%s-%s" % (row.name, name))
        if folder in row.findings:
            return
        row.findings.append(folder)
        shutil.rmtree(folder, ignore_errors=True)
        if inputs:
            shutil.copytree(inputs, folder, symlinks=True)
        os.makedirs(folder, exist_ok=True)
        prepare.write(folder + "/said", said)
        prepare.write(folder + "/cmd", command.replace("@", folder) + "\n")

    # ---- targets ----

    def command(self, name, seconds, seed, artifact):
        seeds, binary = "%s/seeds/%s" % (self.folder, name), "%s/tests/fuzz/fuzz_%s" % (self.build, name)
        if not self.libfuzzer:
            return [binary, str(seed), str(seconds), artifact, seeds]
        grown = tempfile.mkdtemp(dir=self.temporary) if self.o.sample else "%s/corpus/%s" % (self.folder, name)
        os.makedirs(grown, exist_ok=True)
        return [binary, "-seed=%d" % seed, "-max_total_time=%d" % max(1, seconds), "-rss_limit_mb=2500", "-malloc_limit_mb=1000",
                "-timeout=20", "-max_len=16384", "-print_final_stats=1", "-exact_artifact_path=" + artifact,
                "-dict=%s/words" % self.folder, "-verbosity=1", grown, seeds]

    def target_turn(self, row, seconds, seed):
        artifact = tempfile.mktemp(prefix=row.name + "-", dir=self.temporary)
        begin = time.monotonic()
        command = self.command(row.name, seconds, seed, artifact)
        done = subprocess.run(command, env=self.env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              timeout=seconds + 300)
        said = done.stdout.decode(errors="replace")
        row.seconds += time.monotonic() - begin
        for pattern in (r"stat::number_of_executed_units:\s+(\d+)", r"^runs (\d+)"):
            row.runs += sum(int(n) for n in re.findall(pattern, said, flags=re.M))
        row.edges = max([row.edges] + [int(n) for n in re.findall(r"cov: (\d+)", said)])
        if done.returncode == 0:
            return
        if is_foreign(said):
            row.foreign += 1
            return
        prepare.write(artifact + ".d/input", prepare.read(artifact) if os.path.exists(artifact) else b"")
        again = "env FUZZ_DATA=%s %s %s @/input" % (
            self.env["FUZZ_DATA"], " ".join("%s=%s" % (k, shlex.quote(v)) for k, v in ENVIRONMENT.items() if "SAN" in k), command[0])
        if not self.libfuzzer:
            again = again.replace("@/input", "1 0 /tmp/finding @")
        self.keep(row, place(said), said[-20000:], again, artifact + ".d")

    def target(self, name, seconds):
        row = Row(name)
        end, seed = time.monotonic() + seconds, self.o.seed
        while len(row.findings) < MOST_FINDINGS:
            left = end - time.monotonic()
            if left < 1 and row.seconds > 0:
                break
            try:
                self.target_turn(row, max(1, int(left)), seed)
            except subprocess.TimeoutExpired:
                self.keep(row, "hang", "the target did not end", "seed %d" % seed)
                break
            seed += 1000
        return row

    # ---- programs ----

    def program(self, kind, seconds):
        row = Row(kind)
        work = tempfile.mkdtemp(prefix=kind + "-", dir=self.temporary)
        driver = programs.Driver(kind, os.path.join(self.build, "granhom"), self.folder + "/data", ROOT, work, self.env)
        begin, number = time.monotonic(), 0
        while time.monotonic() - begin < seconds and len(row.findings) < MOST_FINDINGS:
            trial = driver.trial("%d-%s-%d" % (self.o.seed, kind, number))
            number += 1
            row.runs += 1
            row.slow += trial.slow
            if trial.wrong and is_foreign(trial.said):
                row.foreign += 1
            elif trial.wrong:
                name = place(trial.said) if frames(trial.said) else re.sub(r"\W+", "-", trial.wrong)[:40]
                self.keep(row, name, trial.wrong + "\n" + trial.said[-20000:], "cd @ && " + shlex.join(trial.command), trial.folder)
        row.seconds = time.monotonic() - begin
        return row

    # ---- all ----

    def job(self, name, seconds):
        return self.program(name[4:], seconds) if name.startswith("run/") else self.target(name, seconds)

    def run(self):
        work = prepare.Work(ROOT, self.build, self.folder)
        os.environ.update({k: self.env[k] for k in ENVIRONMENT if k != "ASAN_OPTIONS"}, ASAN_OPTIONS="detect_leaks=0")
        work.make()
        targets = sorted(os.path.basename(p)[5:-2] for p in glob.glob(ROOT + "/tests/fuzz/fuzz_*.c"))
        self.libfuzzer = b"libFuzzer" in subprocess.run(["%s/tests/fuzz/fuzz_%s" % (self.build, targets[0]), "-help=1"],
                                                       stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=self.env).stdout
        names = [n for n in targets + ["run/" + k for k in programs.KINDS] if not self.o.targets or n in self.o.targets]
        each = self.o.seconds * self.o.jobs / max(1, len(names))
        print("fuzz: seed %d, %s, %d targets, %.0f s each, %d at a time" %
              (self.o.seed, "libFuzzer" if self.libfuzzer else "random changes", len(names), each, self.o.jobs), flush=True)
        with concurrent.futures.ThreadPoolExecutor(self.o.jobs) as pool:
            rows = list(pool.map(lambda n: self.job(n, each), names))
        return self.table(names, rows)

    def table(self, names, rows):
        print("%-16s %9s %8s %7s %8s %5s %9s" % ("target", "runs", "runs/s", "edges", "foreign", "slow", "findings"))
        for name, r in zip(names, rows):
            print("%-16s %9d %8.1f %7s %8d %5d %9d" %
                  (name, r.runs, r.runs / max(r.seconds, 1e-9), r.edges or "-", r.foreign, r.slow, len(r.findings)))
        for r in rows:
            for folder in r.findings:
                print("finding: %s/cmd" % folder)
        bad = sum(1 for r in rows if r.findings or r.runs == 0)
        print("%d passed, %d failed" % (len(rows) - bad, bad))
        return 1 if bad else 0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", default="build-fuzz")
    parser.add_argument("--seconds", type=float, default=3600)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--sample", action="store_true")
    parser.add_argument("targets", nargs="*")
    fuzz = Fuzz(parser.parse_args())
    with tempfile.TemporaryDirectory(prefix="granhom-fuzz-") as fuzz.temporary:
        return fuzz.run()


if __name__ == "__main__":
    sys.exit(main())
