# SPDX-License-Identifier: BSD-3-Clause
"""The program as an independent way to the same numbers."""

import csv
import io
import json
import os
import re
import subprocess

import fracfit

PROGRAM = os.environ["FRACFIT"]
DATA = os.environ["FRACFIT_DATA"]

# Commands that compute, each with its function in Python, whose words are compared with the options.
FUNCTIONS = {
    "approximate": "approximate",
    "basins": "basins",
    "controller": "FractionalPid",
    "drt": "drt",
    "export arduino": "export_arduino",
    "export c99": "export_c99",
    "export fmu": "export_fmu",
    "export spice": "export_spice",
    "fit": "fit",
    "history": "history",
    "identify": "identify",
    "identify-scene": "identify_scene",
    "joint-fit": "joint_fit",
    "jump-law": "jump_law",
    "limit-cycles": "limit_cycles",
    "loop": "loop",
    "map": "regime_map",
    "mittag-leffler": "mittag_leffler",
    "multisine": "multisine",
    "orbits": "orbits",
    "realise": "Model.realise",
    "report": "report",
    "respond": "Model.respond",
    "response": "response",
    "simulate": "describing_function",
    "tune": "tune",
    "validate": "validate",
}
# Methods without options of their own, and batch, whose options are those of fit.
METHODS = {"analyse": "Model.stability", "batch": "batch", "convert": "FrequencyResponse.to_csv", "evaluate": "FitResult.band"}
# These compute nothing: texts for shells, documents and clusters, and files joined.
TEXTS = {"cluster-script", "completion", "describe", "man", "merge"}


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


def commands():
    """The names of all, as the program lists them."""
    return set(re.findall(r"^  ([a-z][a-z-]+(?: [a-z][a-z0-9]*)?)  ", run("--help"), flags=re.M))


def function(where):
    """What stands at a place of FUNCTIONS or METHODS."""
    thing = fracfit
    for name in where.split("."):
        thing = getattr(thing, name)
    return thing
