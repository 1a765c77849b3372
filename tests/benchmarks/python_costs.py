#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the Python module adds to the libraries: processor seconds, the least of several runs.

PYTHONPATH=build/tools/python tests/benchmarks/python_costs.py
Beside it stand the C++ programs `work_precision_fit` and `work_precision_describing_function`.
"""

import resource
import subprocess
import sys
import time

import numpy as np

import fracfit
import fracfit._fitting


def least(repeats, work):
    best = np.inf
    for _ in range(repeats):
        begin = time.process_time()
        work()
        best = min(best, time.process_time() - begin)
    return best


def seconds_of(code):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-c", code], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def warm_fit(points):
    """A fit from its truth, and the part of it that is spent in the compiled call."""
    data = fracfit.Model("2/(0.5 s^0.7 + 1)").frequency_response(np.logspace(-1, 2, points))
    compiled = fracfit._fitting.fit_spectrum
    inside = []

    def timed(*arguments):
        begin = time.process_time()
        found = compiled(*arguments)
        inside.append(time.process_time() - begin)
        return found

    fracfit._fitting.fit_spectrum = timed
    start = {"K": 2, "T": 0.5, "a": 0.7}
    whole = least(200, lambda: fracfit.fit(data, "K/(T s^a + 1)", start=start, global_start=False))
    fracfit._fitting.fit_spectrum = compiled
    return whole, min(inside)


def main():
    print("case,seconds")
    for name in ("pass", "import numpy", "import fracfit", "import fracfit; fracfit.fit"):
        print(f"{name},{min(seconds_of(name) for _ in range(10)):.4f}")
    omega = np.logspace(-1, 2, 20)
    for truth, formula in (("2 s^0.5", "K s^a"), ("2/(0.5 s^0.7 + 1)", "K/(T s^a + 1)")):
        data = fracfit.Model(truth).frequency_response(omega)
        print(f"fit {formula},{least(50, lambda: fracfit.fit(data, formula)):.6f}")
    for points in (20, 60, 200):
        whole, inside = warm_fit(points)
        print(f"warm fit at {points} points,{whole:.6f}\nits compiled call,{inside:.6f}")
    grid = np.linspace(2, 4, 100_000)
    curve = lambda: fracfit.describing_function(grid, restitution=0.6)
    print(f"describing_function of 1e5 points,{least(3, curve):.4f}")
    many = np.linspace(0.1, 100, 1_000_000)
    model = fracfit.Model("2/(0.5 s^0.7 + 1)")
    print(f"frequency_response of 1e6 points,{least(3, lambda: model.frequency_response(many)):.4f}")


main()
