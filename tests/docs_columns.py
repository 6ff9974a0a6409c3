#!/usr/bin/env python3
"""Results against what is documented: docs_columns.py PAGE DIR. PAGE is what `granhom help columns run` prints, DIR the results of a run
with friction. Prints datasets and columns that are in one of them alone. SPDX-License-Identifier: GPL-2.0-or-later"""

import re
import sys

import h5py


def documented(path):
    """Names of each list, by its title."""
    tables = {}
    title = ""
    with open(path, encoding="utf-8") as page:
        for line in page:
            if line.startswith("### "):
                title = line[4:].strip()
            elif line.startswith("- `"):
                tables.setdefault(title, []).extend(re.findall(r"`([^`]*)`", line.split(": ")[0]))
    return tables


def compare(what, there, known):
    for name in sorted(set(there) - set(known)):
        print(f"{what}: {name} is not documented")
    for name in sorted(set(known) - set(there)):
        print(f"{what}: {name} is documented and not there")


def main(page, folder):
    tables = documented(page)
    numbers = next(names for title, names in tables.items() if "one number each" in title)
    with h5py.File(f"{folder}/results.h5") as file:
        compare("/mesh", file["mesh"], tables["results.h5: /mesh"])
        step = file["step0001"]
        nodes = tables["results.h5: /stepNNNN"]
        compare("/step0001", set(step) - {"points", "cells"}, nodes)
        compare("points", step["points"], tables["results.h5: /stepNNNN/points"] + numbers)
        means = [name for name in numbers if not name.endswith("_angle")]
        compare("cells", step["cells"], tables["results.h5: /stepNNNN/cells"] + means)
    with h5py.File(f"{folder}/rves.h5") as file:
        compare("rves.h5", next(iter(file["rve"].values())), tables["rves.h5: /rve/POINT"])
    for name in ("timing.csv", "convergence.csv"):
        with open(f"{folder}/{name}", encoding="utf-8") as file:
            compare(name, file.readline().strip().split(","), tables[name])


if __name__ == "__main__":
    main(*sys.argv[1:])
