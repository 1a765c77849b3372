# SPDX-License-Identifier: BSD-3-Clause
"""The program as an independent way to the same numbers."""

import csv
import io
import json
import os
import subprocess

PROGRAM = os.environ["FRACFIT"]
DATA = os.environ["FRACFIT_DATA"]


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def notes_of(*arguments):
    """What the program tells beside its result."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stderr


def json_of(*arguments):
    return json.loads(run(*arguments, "--format", "json"))


def columns_of(*arguments):
    """Columns of CSV, as doubles where they are; the program prints the shortest text that reads back to the same."""
    lines = [line for line in run(*arguments, "--format", "csv").splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(io.StringIO("\n".join(lines))))

    def value(text):
        try:
            return float(text)
        except ValueError:
            return text

    return {name: [value(row[name]) for row in rows] for name in rows[0]}
