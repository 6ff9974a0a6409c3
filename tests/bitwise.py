#!/usr/bin/python3
"""Compares two tables number by number: bitwise.py OLD.csv NEW.csv. Columns that only one of them has, and seconds, do not count;
rows count as far as both go. Exit status 1 when a text differs. SPDX-License-Identifier: GPL-2.0-or-later
"""
import csv
import sys


def table_read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def main():
    try:
        old, new = (table_read(path) for path in sys.argv[1:3])
    except OSError as wrong:
        print(wrong)
        return 1
    if not old or not new:
        print(f"{len(old)} and {len(new)} rows")
        return 1
    columns = [name for name in old[0] if name in new[0] and "seconds" not in name]
    apart = [(k, name, a[name], b[name]) for k, (a, b) in enumerate(zip(old, new)) for name in columns if a[name] != b[name]]
    rows = min(len(old), len(new))
    said = f"{rows} rows, {len(columns)} columns"
    if len(old) != len(new):
        said += f" (of {len(old)} and {len(new)} rows)"
    if apart:
        k, name, a, b = apart[0]
        said += f"; {len(apart)} numbers differ, first {name} in row {k}: {a}, now {b}"
    print(said)
    return 1 if apart else 0


if __name__ == "__main__":
    sys.exit(main())
