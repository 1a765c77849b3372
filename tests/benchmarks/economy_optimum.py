# SPDX-License-Identifier: BSD-3-Clause
"""Entries of economy tables against an independent search: numpy and scipy, nothing of the library's but its answer.

Each structure of a class is fitted from 60 random starts (--starts): coefficients by least squares, places and orders by
scipy's trust region with differences for derivatives.  Prints a row for each entry: class, parameters, the least error of
the library and of this search in per cent, and their ratio; above 1.01 the library's entry is too high.

The bands are those of methods/economy.md: two masses of 1 kg, force 40 N, clearance 0.3 m, restitution 0.6.
Needs the module: PYTHONPATH=build/tools/python python3 tests/benchmarks/economy_optimum.py --band chatter --parameters 5
"""

import argparse
import itertools
import warnings

import numpy as np
from scipy import optimize

import fracfit

BANDS = {"chatter": (0.5, 4.99), "between": (5.0, 19.0), "two-impacts": (19.1, 35.0)}


class Search:
    def __init__(self, data, component, starts):
        centre = np.sqrt(data.omega[0] * data.omega[-1])
        self.s = 1j * data.omega / centre
        self.half = np.log(data.omega[-1] / centre)
        self.component = component
        size = np.abs({"imaginary": data.response.imag, "real": data.response.real, "both": data.response}[component])
        self.weight = 1 / size
        self.target = self.seen(data.response[:, None])[:, 0]
        self.starts = starts
        self.chance = np.random.default_rng(2026)

    def seen(self, columns):
        weighted = columns * self.weight[:, None]
        parts = {"imaginary": [weighted.imag], "real": [weighted.real], "both": [weighted.real, weighted.imag]}
        matrix = np.concatenate(parts[self.component])
        # Rounding of a column that the part is blind to is no column: s^2 has no imaginary part.
        matrix[:, np.linalg.norm(matrix, axis=0) <= 1e-12 * np.linalg.norm(weighted, axis=0)] = 0
        return matrix

    def residual(self, columns):
        matrix = self.seen(columns)
        if not np.isfinite(matrix).all():
            return np.full(len(self.target), 1e3)
        length = np.linalg.norm(matrix, axis=0)
        length[length == 0] = 1
        left, values, _ = np.linalg.svd(matrix / length, full_matrices=False)
        left = left[:, values > 1e-11 * values[0]]
        return self.target - left @ (left.T @ self.target)

    def least(self, columns, lower, upper, first, last):
        """Least relative error of columns(x) with x between the limits, from starts between first and last."""
        lower, upper = np.array(lower, float), np.array(upper, float)
        points = np.sqrt(len(self.s))
        if len(lower) == 0:
            return np.linalg.norm(self.residual(columns(lower))) / points
        best = np.inf
        for start in self.chance.uniform(first, last, (self.starts, len(lower))):
            start = np.clip(start, lower + 1e-9, upper - 1e-9)
            found = optimize.least_squares(lambda x: self.residual(columns(x)), start, bounds=(lower, upper), x_scale=1.0, max_nfev=60)
            best = min(best, np.linalg.norm(found.fun) / points)
        return best

    def ratios(self, parameters, free_order):
        best = np.inf
        own = int(free_order)
        for poles in range(parameters - own):
            seen = parameters - own - poles
            for offset in range(-4, 5):
                # Of one part every other power of a ratio in s is seen: more coefficients cost nothing.
                counts = range(seen, 2 * seen + 1) if self.component == "imaginary" and not free_order else [seen]
                for count in counts:
                    first = offset + (1 if offset % 2 == 0 else 0)
                    odd = max(0, (offset + count + poles - 1 - first) // 2 + 1)
                    of_omega = len(counts) > 1 and odd <= count
                    if len(counts) > 1 and min(odd, count) != seen:
                        continue

                    def columns(x):
                        order = x[poles] if free_order else 1.0
                        denominator = np.ones_like(self.s)
                        for k in range(0, poles - 1, 2):
                            at = (self.s * np.exp(-x[k])) ** order
                            denominator = denominator * (1 + 2 * np.sinh(x[k + 1]) * at + at**2)
                        if poles % 2:
                            denominator = denominator * (1 + (self.s * np.exp(-x[poles - 1])) ** order)
                        if of_omega:
                            return np.stack([1j * abs(self.s) ** (first + 2.0 * c) / abs(denominator) ** 2 for c in range(seen)], 1)
                        return np.stack([(self.s**order) ** (offset + c) / denominator for c in range(count)], 1)

                    damping = [k % 2 == 1 for k in range(poles)]
                    lower = [0 if d else -self.half - 7 for d in damping] + [0.1] * own
                    upper = [9 if d else self.half + 7 for d in damping] + [1.5] * own
                    begin = [0 if d else -self.half - 3 for d in damping] + [0.1] * own
                    end = [2.5 if d else self.half + 3 for d in damping] + [1.5] * own
                    best = min(best, self.least(columns, lower, upper, begin, end))
        return best

    def terms(self, parameters):
        kinds = ["power", "whole-arc", "arc", "low-mode", "high-mode"]
        price = {"power": 2, "whole-arc": 2, "arc": 3, "low-mode": 3, "high-mode": 3}
        best = np.inf
        whole_orders = [-1, 1] if self.component == "imaginary" else [-1, 0, 1]
        for whole in itertools.chain.from_iterable(itertools.combinations(whole_orders, n) for n in range(len(whole_orders) + 1)):
            for size in range(parameters):
                for members in itertools.combinations_with_replacement(kinds, size):
                    if sum(price[m] for m in members) + len(whole) != parameters or sum("mode" in m for m in members) > 2:
                        continue
                    ranges = []
                    for m in members:
                        if m == "power":
                            ranges.append((-2, 2, -2, 2))
                            continue
                        margin = 3 if "mode" in m else 4
                        ranges.append((-self.half - 7, self.half + 7, -self.half - margin, self.half + margin))
                        if m == "arc":
                            ranges.append((0.1, 1, 0.1, 1))
                        elif "mode" in m:
                            ranges.append((-9, -0.7, -5, -0.7))

                    def columns(x):
                        values, x = [self.s**order for order in whole], list(x)
                        for m in members:
                            if m == "power":
                                values.append(self.s ** x.pop(0))
                                continue
                            at = self.s * np.exp(-x.pop(0))
                            if m == "whole-arc":
                                values.append(1 / (1 + at))
                            elif m == "arc":
                                values.append(1 / (1 + at ** x.pop(0)))
                            else:
                                values.append((at if m == "high-mode" else 1) / (1 + 2 * np.exp(x.pop(0)) * at + at**2))
                        return np.stack(values, 1)

                    lower, upper, first, last = zip(*ranges) if ranges else ([], [], [], [])
                    best = min(best, self.least(columns, lower, upper, first, last))
        return best


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--band", choices=BANDS, default="chatter")
    parser.add_argument("--quantity", choices=["n", "minus-inverse"], default="n")
    parser.add_argument("--component", choices=["imaginary", "both"], default="imaginary")
    parser.add_argument("--classes", default="terms,commensurate,rational")
    parser.add_argument("--parameters", type=int, nargs="+", default=[5])
    parser.add_argument("--points", type=int, default=48)
    parser.add_argument("--starts", type=int, default=60)
    asked = parser.parse_args()
    curve = fracfit.describing_function(np.linspace(*BANDS[asked.band], asked.points), restitution=0.6, force=40, clearance=0.3)
    data = curve.data() if asked.quantity == "n" else curve.data().minus_inverse()
    economy = fracfit.economy(data, component=asked.component, most_parameters=max(asked.parameters))
    search = Search(data, asked.component, asked.starts)
    print(f"# {asked.band}, {asked.quantity}, {asked.component}, {asked.points} points, {asked.starts} starts of each structure")
    print("class,parameters,library_percent,search_percent,ratio")
    warnings.simplefilter("ignore")
    for name in asked.classes.split(","):
        counts, errors = economy.points(name)
        for parameters in asked.parameters:
            found = search.terms(parameters) if name == "terms" else search.ratios(parameters, name == "commensurate")
            library = errors[counts <= parameters][-1]
            print(f"{name},{parameters},{100 * library:.5g},{100 * found:.5g},{library / found:.4g}", flush=True)


if __name__ == "__main__":
    main()
