#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Whether 95 % intervals of `identify-scene` with receptances hold: seeded random bodies with viscous friction, the mass
of the drive known, N of x1 or x2 swept up at 20 and 40 N where impacts are mostly symmetric, noise of 1 %.

tests/benchmarks/receptance_rates.py [--count N] [--seed N] [program]

Printed: scenes, those with something identified, those confidently wrong (each interval stated excludes the truth),
intervals that hold of those stated, the median relative error of what is stated, and processor time for each scene.
"""

import argparse
import csv
import json
import math
import pathlib
import random
import resource
import statistics
import subprocess
import tempfile

CLEARANCE = 0.3


def log_uniform(draw, low, high):
    return math.exp(draw.uniform(math.log(low), math.log(high)))


def measured(arguments, draw, folder):
    """Curves of a random scene as files, and its truth."""
    m1, m2 = log_uniform(draw, 0.5, 2), log_uniform(draw, 0.5, 2)
    truth = {"m1": m1, "b1": m1 * log_uniform(draw, 0.1, 2), "b2": m2 * log_uniform(draw, 0.1, 2),
             "clearance": CLEARANCE, "restitution": draw.uniform(0.3, 0.8)}
    body = draw.choice(["x1", "x1", "x2"])
    files = []
    for force in (20, 40):
        unit = math.sqrt(force / (m2 * CLEARANCE))
        low, high = draw.uniform(1.3, 1.7) * unit, draw.uniform(2.4, 3.2) * unit
        exact = subprocess.run(
            [arguments.program, "simulate", "--force", str(force), "--clearance", str(CLEARANCE), "--restitution",
             str(truth["restitution"]), "--load-receptance", f"1/({m1} s^2 + {truth['b1']} s)", "--drive-receptance",
             f"1/({m2} s^2 + {truth['b2']} s)", "--omega", f"{low}:{high}:10", "--body", body, "--protocol",
             "sweep-up", "--format", "csv", "--quiet"], capture_output=True, text=True, check=True).stdout
        head = [line for line in exact.splitlines() if line.startswith("#")]
        rows = list(csv.DictReader(line for line in exact.splitlines() if not line.startswith("#")))
        for row in rows:
            value = complex(float(row["re_m_per_n"]), float(row["im_m_per_n"]))
            value += 0.01 * abs(value) * complex(draw.gauss(0, 1), draw.gauss(0, 1))
            row["re_m_per_n"], row["im_m_per_n"] = repr(value.real), repr(value.imag)
        files.append(folder / f"{force}.csv")
        lines = [",".join(rows[0])] + [",".join(row.values()) for row in rows]
        files[-1].write_text("\n".join(head + lines) + "\n")
    return files, truth, ["--body", body, "--drive-receptance", f"1/({m2} s^2 + b2 s)"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=25)
    parser.add_argument("--seed", type=int, default=11)
    parser.add_argument("program", nargs="?", default="build/tools/fracfit/fracfit")
    arguments = parser.parse_args()
    draw = random.Random(arguments.seed)
    answered = wrong = 0
    errors, holds, seconds = [], [], 0
    for _ in range(arguments.count):
        with tempfile.TemporaryDirectory() as folder:
            files, truth, options = measured(arguments, draw, pathlib.Path(folder))
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            # Exit code 1 says that the search did not converge, as the result does.
            result = json.loads(subprocess.run(
                [arguments.program, "identify-scene", *files, *options, "--load-receptance", "1/(m1 s^2 + b1 s)",
                 "--format", "json", "--quiet", "--threads", "1"], capture_output=True, text=True, check=False).stdout)
            seconds += resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        stated = [each for each in result["parameters"] if each["identified"]]
        held = [each["ci95"][0] <= truth[each["name"]] <= each["ci95"][1] for each in stated]
        errors += [abs(each["value"] / truth[each["name"]] - 1) for each in stated]
        holds += held
        answered += bool(stated)
        wrong += bool(stated) and not any(held)
    print(f"{arguments.count} scenes, {answered} answered, {wrong} confidently wrong, {sum(holds)} of {len(holds)} "
          f"intervals hold, median error {statistics.median(errors):.2g}, {seconds / arguments.count:.2g} s a scene")


if __name__ == "__main__":
    main()
