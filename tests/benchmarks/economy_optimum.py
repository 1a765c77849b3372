# SPDX-License-Identifier: BSD-3-Clause
"""Entries of economy tables against an independent search: numpy, nothing of the library's but its answer.

Each structure of a class is fitted from 60 random starts (--starts): coefficients by least squares, places and orders by
the method of Levenberg and Marquardt with differences for derivatives, all starts at once.  Prints a row for each entry: class, parameters, the least error of
the library and of this search in per cent, and their ratio; above 1.01 the library's entry is too high.

The bands are those of methods/economy.md: two masses of 1 kg, force 40 N, clearance 0.3 m, restitution 0.6.
Needs the module: PYTHONPATH=build/tools/python python3 tests/benchmarks/economy_optimum.py --band chatter --parameters 5
"""

import argparse
import itertools
import warnings

import numpy as np

import fracfit

BANDS = {"chatter": (0.5, 4.99), "between": (5.0, 19.0), "two-impacts": (19.1, 35.0)}


class Search:
    def __init__(self, data, component, starts):
        centre = np.sqrt(data.omega[0] * data.omega[-1])
        self.log_s = np.log(data.omega / centre) + 0.5j * np.pi
        self.half = np.log(data.omega[-1] / centre)
        self.component = component
        size = np.abs({"imaginary": data.response.imag, "real": data.response.real, "both": data.response}[component])
        self.weight = 1 / size
        self.target = self.seen(data.response[None, :, None])[0, :, 0]
        self.starts = starts
        self.chance = np.random.default_rng(2026)

    def power(self, order, log_place=0.0):
        """(s exp(log_place))^order for each row of order and place."""
        return np.exp(np.asarray(order)[..., None] * (self.log_s + np.asarray(log_place)[..., None]))

    def seen(self, columns):
        weighted = columns * self.weight[:, None]
        parts = {"imaginary": [weighted.imag], "real": [weighted.real], "both": [weighted.real, weighted.imag]}
        matrix = np.concatenate(parts[self.component], axis=1)
        # Rounding of a column that the part is blind to is no column: s^2 has no imaginary part.
        blind = np.linalg.norm(matrix, axis=1) <= 1e-12 * np.linalg.norm(weighted, axis=1)
        return matrix * ~blind[:, None, :]

    def projected(self, matrix):
        """Of each start the residual, the space of the columns and their coefficients."""
        length = np.linalg.norm(matrix, axis=1)
        length[length == 0] = 1
        left, values, right = np.linalg.svd(matrix / length[:, None, :], full_matrices=False)
        told = values > 1e-11 * values[:, :1]
        left = left * told[:, None, :]
        share = np.einsum("bmc,m->bc", left, self.target)
        coefficients = np.einsum("bkc,bk->bc", right, share / np.where(told, values, 1)) / length
        return self.target - np.einsum("bmc,bc->bm", left, share), left, coefficients

    def descended(self, columns, x, lower, upper, steps):
        """Levenberg and Marquardt from all rows of x at once, coefficients eliminated (Kaufman 1975)."""
        damping = np.full(len(x), 1e-2)
        residual, left, coefficients = self.projected(self.seen(columns(x)))
        for _ in range(steps):
            h = np.where(x + 1e-7 < upper, 1e-7, -1e-7)
            base, slopes = self.seen(columns(x)), []
            for k in range(x.shape[1]):
                moved = x.copy()
                moved[:, k] += h[:, k]
                change = np.einsum("bmc,bc->bm", (self.seen(columns(moved)) - base) / h[:, k, None, None], coefficients)
                slopes.append(-change + np.einsum("bmc,bc->bm", left, np.einsum("bmc,bm->bc", left, change)))
            slope = np.nan_to_num(np.stack(slopes, axis=2))
            normal, towards = np.einsum("bmk,bml->bkl", slope, slope), np.einsum("bmk,bm->bk", slope, residual)
            diagonal = np.einsum("bkk->bk", normal)
            scale = damping[:, None] * diagonal + 1e-14 * diagonal.max(axis=1, keepdims=True) + 1e-300
            step = np.linalg.solve(normal + scale[:, :, None] * np.eye(x.shape[1]), -towards[:, :, None])[:, :, 0]
            tried = np.clip(x + np.clip(step, -2, 2), lower, upper)
            found = self.projected(np.nan_to_num(self.seen(columns(tried)), posinf=0, neginf=0))
            better = np.linalg.norm(found[0], axis=1) < np.linalg.norm(residual, axis=1)
            damping = np.where(better, damping / 5, np.minimum(damping * 4, 1e8))
            x = np.where(better[:, None], tried, x)
            residual = np.where(better[:, None], found[0], residual)
            left = np.where(better[:, None, None], found[1], left)
            coefficients = np.where(better[:, None], found[2], coefficients)
        return x, np.linalg.norm(residual, axis=1) / np.sqrt(len(self.log_s))

    def least(self, columns, lower, upper, first, last):
        """Least relative error of columns(x) with x between the limits, from starts between first and last.

        All starts are followed for some steps, and the best quarter of them to the end.
        """
        lower, upper = np.array(lower, float), np.array(upper, float)
        start = self.chance.uniform(first, last, (self.starts if len(lower) else 1, len(lower)))
        if not len(lower):
            return np.linalg.norm(self.projected(self.seen(columns(start)))[0]) / np.sqrt(len(self.log_s))
        x, error = self.descended(columns, start, lower, upper, 12)
        ahead = np.argsort(error)[: max(1, self.starts // 4)]
        return self.descended(columns, x[ahead], lower, upper, 60)[1].min()

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
                        order = x[:, poles] if free_order else np.ones(len(x))
                        denominator = np.ones((len(x), len(self.log_s)), complex)
                        for k in range(0, poles - 1, 2):
                            at = self.power(order, -x[:, k])
                            denominator = denominator * (1 + 2 * np.sinh(x[:, k + 1, None]) * at + at**2)
                        if poles % 2:
                            denominator = denominator * (1 + self.power(order, -x[:, poles - 1]))
                        if of_omega:
                            return np.stack([1j * np.exp((first + 2.0 * c) * self.log_s.real) / abs(denominator) ** 2 for c in range(seen)], 2)
                        return np.stack([self.power((offset + c) * order) / denominator for c in range(count)], 2)

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
                        one = np.ones(len(x))
                        values, x = [self.power(order * one) for order in whole], list(x.T)
                        for m in members:
                            if m == "power":
                                values.append(self.power(x.pop(0)))
                                continue
                            place = -x.pop(0)
                            if m == "arc":
                                values.append(1 / (1 + self.power(x.pop(0), place)))
                                continue
                            at = self.power(one, place)
                            if m == "whole-arc":
                                values.append(1 / (1 + at))
                            else:
                                values.append((at if m == "high-mode" else 1) / (1 + 2 * np.exp(x.pop(0))[:, None] * at + at**2))
                        return np.stack(values, 2)

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
    economy = fracfit.economy(data, component=asked.component)
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
