#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What `tune --from-relay` and `tune --fit` are worth: seeded plants of several families, measured with noise, the
controller found for the data, and the loop of that controller with the true plant.

PYTHONPATH=build/tools/python tests/benchmarks/tune_rates.py [--data relay|frequency] [--crossover SHARE] [--count N]
    [--seed N] [--family NAME...] [program]

Data are samples of a relay experiment, or a frequency response of 40 points, to which a model of the plant's own
family is fitted (a second order with dead time to plants of high order).
Asked is a phase margin of 60 degrees at a share (0.4) of the frequency where the plant turns by 180 degrees, and |S| <= 1.8.
Printed for each family and noise: experiments, those with a controller that is said to keep the bound, of these the
true loops that are not stable and that exceed |S| = 1.8 by more than 1 %, the median error of the plant at the
crossover, and the median of the true phase margin; of a frequency response also the largest share, over the
controllers, of plants drawn as the covariance of the fit says that exceed the bound.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile

import numpy as np

import fracfit

BOUND = 1.8


def spread(random, low, high):
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def lag(random):
    return f"{spread(random, 0.5, 5):.4g} exp(-{spread(random, 0.1, 1):.4g} s)/(s + 1)"


def second_order(random):
    return (f"{spread(random, 0.5, 5):.4g} exp(-{spread(random, 0.05, 0.5):.4g} s)"
            f"/(s^2 + {2 * random.uniform(0.3, 1.5):.4g} s + 1)")


def fractional_lag(random):
    return f"{spread(random, 0.5, 5):.4g} exp(-{spread(random, 0.1, 1):.4g} s)/(s^{random.uniform(0.6, 1.3):.3g} + 1)"


def integrating(random):
    return f"{spread(random, 0.5, 5):.4g} exp(-{spread(random, 0.1, 0.5):.4g} s)/(s^2 + s)"


def high_order(random):
    return f"{spread(random, 0.5, 5):.4g}/({spread(random, 0.3, 1):.4g} s + 1)^{random.integers(3, 7)}"


FAMILIES = {each.__name__: each for each in (lag, second_order, fractional_lag, integrating, high_order)}


def turned(model):
    """rad/s where the plant has turned by 180 degrees."""
    omega = np.logspace(-2, 2, 4000)
    phase = np.unwrap(np.angle(model.frequency_response(omega).response))
    return float(omega[np.argmax(phase < -np.pi)])


def experiment(model, period, noise, random):
    """Six periods of a relay with hysteresis, forty samples in each, the first half a step to one side."""
    step = period / 40
    samples = 240
    time = step * np.arange(samples)
    answer = model.step(time).output
    hysteresis = 0.02 * np.abs(answer).max() * (1 + 5 * noise)
    size = float(np.abs(answer[: samples // 6]).max())
    u, y = np.zeros(samples), np.zeros(samples)
    now, since = 1.0, 0
    u[0] = now
    changes = [(0, 1.0)]
    for n in range(samples):
        y[n] = sum(change * answer[n - at] for at, change in changes)
        seen = y[n] + noise * size * random.normal()
        if n > 0 and now * seen > hysteresis:
            now = -now
            changes.append((n, 2 * now))
        u[n] = now
    return time, u, y + noise * size * random.normal(size=samples)


STRUCTURES = {
    "lag": "K exp(-L s)/(T s + 1)",
    "second_order": "K exp(-L s)/(T2 s^2 + T1 s + 1)",
    "fractional_lag": "K exp(-L s)/(T s^a + 1)",
    "integrating": "K exp(-L s)/(T s^2 + s)",
    "high_order": "K exp(-L s)/(T2 s^2 + T1 s + 1)",
}


def fitted(program, model, structure, limit, noise, random, folder):
    """Path of a fit, as JSON, of a measured frequency response."""
    omega = limit * np.logspace(-1.7, 0.5, 40)
    response = model.frequency_response(omega).response
    spoilt = response * (1 + noise / np.sqrt(2) * (random.normal(size=40) + 1j * random.normal(size=40)))
    data, path = f"{folder}/data.csv", f"{folder}/fit.json"
    np.savetxt(data, np.column_stack([omega, spoilt.real, spoilt.imag]), delimiter=",", header="omega_rad_s,re,im",
               comments="", fmt="%.12g")
    subprocess.run([program, "fit", data, "--model", structure, "--component", "both", "--quiet", "--format", "json",
                    "--out", path], capture_output=True)
    return path


def share_beyond(path, found, random, limit):
    """Of plants drawn as the covariance says, those whose loop exceeds the bound, on a grid."""
    fit = json.loads(pathlib.Path(path).read_text())
    parameters = fit["parameters"]
    errors = np.array([each["standard_error"] for each in parameters])
    covariance = np.array(fit["correlation"], dtype=float) * np.outer(errors, errors)
    values = np.array([each["value"] for each in parameters])
    omega = limit * np.logspace(-2.5, 2, 400)
    controller = sum(found["controller"][gain] * (1j * omega) ** order for gain, order in
                     (("kp", 0), ("ki", -found["controller"]["lambda"]), ("kd", found["controller"]["mu"])))
    beyond, draws = 0, 400
    for _ in range(draws):
        drawn = random.multivariate_normal(values, covariance)
        plant = fracfit.Model(fit["model"], **{each["name"]: float(max(value, 1e-9 * abs(best)))
                                               for each, value, best in zip(parameters, drawn, values)})
        loop = plant.frequency_response(omega).response * controller
        beyond += np.abs(1 / (1 + loop)).max() > 1.01 * BOUND
    return beyond / draws


def tuned(program, path, crossover, option):
    words = [program, "tune", option, path, "--crossover", f"{crossover:.6g}", "--phase-margin", "60",
             "--max-sensitivity", str(BOUND), "--quiet"]
    found = subprocess.run(words, capture_output=True, text=True)
    return (json.loads(found.stdout), "") if found.stdout else (None, found.stderr.strip())


def true_loop(model, found):
    """Largest |S|, phase margin in degrees; infinite where the loop is not stable."""
    gains = found["controller"]
    terms = [f"{gains['kp']!r}", f"{gains['ki']!r}/s^{gains['lambda']!r}", f"{gains['kd']!r} s^{gains['mu']!r}"]
    controller = fracfit.Model(" + ".join(term for term, gain in zip(terms, ("kp", "ki", "kd")) if gains[gain]))
    loop = model * controller
    try:
        is_stable = loop.closed_loop_stability() == "stable"
    except ValueError:
        # The true plant does not fall as that of the data does, and |L| stays above 1 at high frequency.
        is_stable = False
    if not is_stable:
        return np.inf, np.nan
    omega = np.logspace(-3, 3, 6000)
    response = loop.frequency_response(omega).response
    crossing = np.flatnonzero((np.abs(response[:-1]) > 1) & (np.abs(response[1:]) <= 1))
    margin = np.degrees(np.angle(-response[crossing[0]])) if crossing.size else np.nan
    return float(np.abs(1 / (1 + response)).max()), float(margin)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", choices=("relay", "frequency"), default="relay")
    parser.add_argument("--crossover", type=float, default=0.4, help="share of the frequency of 180 degrees")
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--family", nargs="*", default=list(FAMILIES))
    parser.add_argument("--show", action="store_true", help="each experiment")
    parser.add_argument("program", nargs="?", default="build/tools/fracfit/fracfit")
    given = parser.parse_args()
    program = str(pathlib.Path(given.program).resolve())
    of_region = given.data == "frequency"
    print("family,noise,experiments,said to keep,not stable,beyond the bound,median error of plant,median phase margin"
          + (",largest share of drawn plants beyond" if of_region else ""))
    for family in given.family:
        for noise in (0.01, 0.05):
            said = unstable = beyond = 0
            errors, margins, shares = [], [], []
            for case in range(given.count):
                random = np.random.default_rng([given.seed, list(FAMILIES).index(family), case])
                model = fracfit.Model(FAMILIES[family](random))
                limit = turned(model)
                with tempfile.TemporaryDirectory() as folder:
                    if of_region:
                        path = fitted(program, model, STRUCTURES[family], limit, noise, random, folder)
                        found, why = tuned(program, path, given.crossover * limit, "--fit")
                        if found and found["status"] == "met":
                            shares.append(share_beyond(path, found, random, limit))
                    else:
                        time, u, y = experiment(model, 2 * np.pi / limit, noise, random)
                        path = f"{folder}/relay.csv"
                        np.savetxt(path, np.column_stack([time, u, y]), delimiter=",", header="time_s,input,output",
                                   comments="", fmt="%.10g")
                        found, why = tuned(program, path, given.crossover * limit, "--from-relay")
                if found is None:
                    if given.show:
                        print("#", model.formula, why[:200])
                    continue
                plant = fracfit.Model(found["plant"])
                at = [given.crossover * limit]
                error = abs(plant.frequency_response(at).response[0] / model.frequency_response(at).response[0] - 1)
                errors.append(error)
                largest, margin = true_loop(model, found)
                if given.show:
                    print("#", model.formula, "->", found["plant"], found["status"], f"{error:.3f} {largest:.3f} {margin:.1f}")
                if found["status"] != "met":
                    continue
                said += 1
                unstable += np.isinf(largest)
                beyond += largest > 1.01 * BOUND
                margins.append(margin)
            middle = lambda values, digits: f"{np.nanmedian(values):.{digits}f}" if values else ""
            print(f"{family},{noise:g},{given.count},{said},{unstable},{beyond},{middle(errors, 4)},{middle(margins, 1)}"
                  + (f",{max(shares):.3f}" if shares else ""), flush=True)


main()
