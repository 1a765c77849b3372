# SPDX-License-Identifier: BSD-3-Clause
"""Ordinary use of the module, as users with a strict type checker write it; typing_test.py checks it and runs it."""

from __future__ import annotations

import math
import os
import pathlib
import sys
import tempfile

import numpy as np
import numpy.typing as npt

import fracfit
from fracfit import FitResult, FractionalPid, FrequencyResponse, Model, TimeSeries

Floats = npt.NDArray[np.float64]


def cell() -> FrequencyResponse:
    """An impedance with an outlier-free seeded noise of 0.5 %."""
    model = Model("R0 + R1/(1 + R1 Q1 s^n1)", R0=0.02, R1=0.03, Q1=0.05, n1=0.85)
    exact = model.frequency_response(2 * np.pi * np.logspace(-1, 4, 40))
    noise = np.random.default_rng(7).normal(size=(2, exact.size))
    values = exact.response * (1 + 0.005 * (noise[0] + 1j * noise[1]))
    return FrequencyResponse(exact.omega, values, unit="ohm", frequency_unit="Hz")


def describe_data(data: FrequencyResponse) -> str:
    omega, response = data
    low: float = float(omega[0])
    size: int = data.size
    loudest = float(max(abs(value) for value in response))
    sigma = data.sigma
    known = "known" if sigma is not None else "unknown"
    part = data.where("f > 1", "f < 100")
    first: FrequencyResponse = data[:5]
    masked = data[data.magnitude > 0.01]
    return f"{size} points from {low:g} rad/s, up to {loudest:g} {data.unit}, noise {known}, {part.size}, {first.size}, {masked.size}"


def fit_cell(data: FrequencyResponse) -> FitResult:
    result = fracfit.fit(
        data,
        "R0 + R1/(1 + R1 Q1 s^n1)",
        bounds={"n1": (0.5, 1.0), "R0": (None, 1.0)},
        start={"R1": 0.02},
        prior={"R0": (0.02, 0.01)},
        derive="f1 = (R1 Q1)^(-1/n1)/(2 pi)",
        weight="relative",
        seed=3,
    )
    assert result.usable, result.message
    value: float = result["n1"]
    lower, upper = result.ci95["n1"]
    errors: dict[str, float] = result.standard_errors
    cost: float = result.cost
    starts: int = result.starts
    formula: str = result.formula
    covariance = result.covariance
    residuals = result.residuals
    assert lower < value < upper and errors["n1"] > 0 and cost > 0 and starts >= 1 and formula
    assert covariance.shape == (4, 4) and residuals.shape == (data.size,)
    for name in result:
        assert math.isfinite(result[name])
    for quantity in result.derived:
        print(quantity["name"], quantity["value"])
    return result


def by_arrays(data: FrequencyResponse) -> FitResult:
    return fracfit.fit(data.f, data.response, "zarc", fix={"R0": 0.02}, outliers="keep")


def judge(result: FitResult) -> bool:
    lack = result.lack_of_fit()
    adequate: bool = lack["adequate"]
    low, high = result.profile("R1")
    band = result.band(np.array([1.0, 10.0]))
    widths: Floats = band.re_upper - band.re_lower
    return adequate and low < high and bool(np.all(widths > 0))


def ranking(data: FrequencyResponse) -> str:
    found = fracfit.identify(data, ["zarc", "rc", "two-rc"])
    best: FitResult = found.best
    verdict: str = found.verdict
    evidence: float = found.evidence
    chosen: int = found.chosen
    skipped = found.skipped
    print(best.formula, verdict, evidence, chosen, len(skipped), found.verdict_sentence)
    return verdict


def validity(data: FrequencyResponse) -> str:
    found = fracfit.validate(data, level=0.05)
    noise: float = found.noise
    outliers: list[int] = found.outliers
    drift: float = found.drift
    print(found.summary, noise, len(outliers), drift)
    times = fracfit.drt(data)
    strongest = max(times.peaks, key=lambda peak: float(peak["area"]))
    tau: float = strongest["tau"]
    print(times.kernel, times.misfit, tau)
    return found.validity


def together(data: FrequencyResponse) -> float:
    result = fracfit.joint_fit([data, data[::2]], "zarc", shared=["R1", "n1"], names=["all", "half"])
    shared: dict[str, float] = result.parameters
    own: npt.NDArray[np.float64] = result.each["R0"]
    chance: float = result.sharing_p_value
    assert own.shape == (2,) and math.isfinite(chance)
    return shared["n1"]


def loop_of(plant: Model) -> FractionalPid:
    found = fracfit.tune(plant, crossover=2.0, phase_margin=math.radians(60), structure="pi")
    assert found.usable, found.message
    kp: float = found.kp
    order: float = found.lambda_
    sensitivity: float = found.max_sensitivity
    print(kp, order, sensitivity, found.closed_loop)
    loop = found.model * plant
    margins = loop.margins()
    margin: float = margins.phase_margin
    stable: str = loop.closed_loop_stability()
    assert abs(margin - math.radians(60)) < 1e-6 and stable == "stable"
    pid = found.pid(sample_time=1e-3, band=(0.01, 300.0), minimum=-1.0, maximum=1.0)
    output: float = pid.step(1.0, 0.0)
    header: str = pid.c_header("pi_controller", precision="float")
    assert math.isfinite(output) and "pi_controller_step" in header
    return pid


def over_time(plant: Model) -> TimeSeries:
    time = np.linspace(0.0, 10.0, 101)
    t, y = plant.step(time)
    answer = plant.respond(time, np.sin(time), hold="first-order")
    estimate: float = answer.error_estimate
    poles = plant.poles()
    stability = plant.stability()
    kind: str = stability.stability
    assert y.shape == t.shape and estimate >= 0 and poles.dtype.kind == "c" and kind
    record = TimeSeries(time, np.sin(time), answer.output, hold="first-order")
    return record


def approximations(plant: Model) -> float:
    half = fracfit.approximate(0.5, (0.01, 100.0), tolerance=1e-3)
    zeros, poles, gain = half.zpk
    small = plant.realise((0.01, 10.0), 1e-2)
    a, b, c, d = small.ss
    error: float = small.max_relative_error
    assert zeros.size == poles.size and gain > 0 and a.shape[0] == b.shape[0] == c.shape[1] and d.shape == (1, 1)
    return error + half.max_relative_error


def backlash() -> float:
    omega = np.linspace(15.0, 35.0, 21)
    curve = fracfit.describing_function(omega, restitution=0.6, force=40.0, clearance=0.3)
    regimes: npt.NDArray[np.str_] = curve.regime
    values = curve.response
    data: FrequencyResponse = curve.data()
    scene = fracfit.identify_scene([data], [40.0], fixed={"mass1": 1.0})
    jump = fracfit.jump_frequency(restitution=0.5)
    law = fracfit.jump_law(restitution=[0.5], force=[10.0, 20.0], clearance=[0.1, 0.2])
    constant: float = law.mean_similarity_constant
    motion = fracfit.history(20.0, restitution=0.6, force=40.0, clearance=0.3, skip=50, periods=2)
    largest: float = float(max(abs(place) for place in motion.x1))
    cycles = fracfit.limit_cycles("1 + s^0.5", restitution=0.6, starts=0)
    frequency: float = cycles.cycles[0]["omega"]
    branch = fracfit.orbits(1.9, 2.0, restitution=0.6)[0]
    stable: bool = bool(branch.stable.all())
    loop = fracfit.loop("1 + s^0.5", restitution=0.6, velocity2=1.0, duration=10.0)
    drive = fracfit.multisine((1.0, 20.0), period=10.0, sample_time=0.05, periods=3)
    measured = fracfit.response(drive.time, drive.input, 2 * drive.input)
    spectrum: FrequencyResponse = measured.frequency_response()
    assert measured.excitation == "periodic" and spectrum.size == drive.lines.size == measured.sigma.size
    map_of_starts = fracfit.basins(1.41, restitution=0.6, position=[0.2, 0.8], velocity=[0.0])
    assert regimes.size == values.size and jump is not None and math.isfinite(largest) and stable
    print(frequency, loop.impacts, loop.end, map_of_starts.shares.tolist())
    return constant + scene["restitution"]


def rig() -> fracfit.RigRecord:
    motion = fracfit.history(20.0, restitution=0.6, clearance=0.3, force=40, periods=1)
    speeds: Floats = motion.v1
    record = fracfit.history([20.0, 25.0], restitution=0.6, clearance=0.3, force=40, periods=2, sample_time=0.01, sensor_noise=1e-4, seed=2)
    series: TimeSeries = record.series("x1")
    closed = fracfit.loop("2 + s", restitution=0.6, velocity2=1.0, duration=2, every=0.1, record=True, quantisation=1e-3)
    assert speeds.size and series.time.size == record.x1.size and closed.force.size > 10
    return record


def constants() -> list[float | None]:
    found = fracfit.jump_law(constants=True, restitution=[0.5], criterion="contact-at-rest")
    law = fracfit.jump_law(restitution=[0.5], force=[10, 20], clearance=[0.1, 0.2])
    assert law.laws[0]["clearance"] == 0.1
    digital = fracfit.approximate(0.5, (0.1, 100), tolerance=1e-2, sample_time=1e-3).digital
    assert digital is not None and digital.rates.size == digital.feeds.size
    return [row["similarity_constant"] for row in found.rows]


def files(data: FrequencyResponse, folder: pathlib.Path) -> FrequencyResponse:
    path = folder / "cell.csv"
    data.to_csv(path)
    again = fracfit.read(path)
    if isinstance(again, TimeSeries):
        raise SystemExit("expected a frequency response")
    names: list[str] = fracfit.sweep_names(path)
    circuit = fracfit.export_spice("1/s^0.5", kind="impedance", band=(1.0, 1e3), out=folder / "half.lib")
    code: str = fracfit.export_c99("1/(s^0.5 + 1)", sample_time=0.01, name="lag")
    assert circuit.usable and os.path.exists(folder / "half.lib") and "lag_step" in code and names == []
    return again


def main() -> int:
    data = cell()
    print(describe_data(data))
    result = fit_cell(data)
    print(by_arrays(data).parameters)
    print(judge(result), ranking(data), validity(data), together(data))
    plant = Model("K exp(-L s)/(T s^a + 1)", K=2, L=0.1, T=0.5, a=0.7)
    pid = loop_of(plant)
    record = over_time(Model("1/(0.5 s^0.7 + 1)"))
    print(pid.error, record.size, approximations(plant), backlash())
    print(rig(), constants())
    many = fracfit.batch([data, data[5:]], "zarc", threads=1)
    columns: dict[str, Floats] = many.parameters
    print(columns["R1"], many.errors, fracfit.mittag_leffler(0.5, 1.0, -3.0), fracfit.derivative([1.0, 1.0], 0.5, 1.0))
    with tempfile.TemporaryDirectory() as folder:
        assert files(data, pathlib.Path(folder)).size == data.size
    return 0


if __name__ == "__main__":
    sys.exit(main())
