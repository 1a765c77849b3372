# SPDX-License-Identifier: BSD-3-Clause
"""Fits against truths, the command line and scipy."""

import functools
import inspect
import itertools
import os
import pickle

import command_line
import numpy as np
import pytest
from scipy import optimize

import fracfit
from fracfit import FrequencyResponse, Model

CELL = os.path.join(command_line.DATA, "examples", "cell.csv")
STEP = os.path.join(command_line.DATA, "examples", "step.csv")
FORCES = [os.path.join(command_line.DATA, "examples", name) for name in ("f20.csv", "f40.csv")]
CIRCUIT = "R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)"
OMEGA = np.logspace(-1, 2, 20)
EXACT = Model("2/(0.5 s^0.7 + 1)").frequency_response(OMEGA)


def same_as_command_line(found, result):
    assert [p["name"] for p in found["parameters"]] == list(result.parameters)
    # Compiled twice, and some compilers fuse products and sums into one rounding: some of the last bits.
    same = functools.partial(np.testing.assert_allclose, rtol=1e-13)
    same([p["value"] for p in found["parameters"]], list(result.parameters.values()))
    # JSON knows neither NaN nor infinity: where there is no interval both its ends are null, and an open end is.
    ends = np.array([p["ci95"][0] for p in found["parameters"]], dtype=float)
    same(ends, [low if np.isfinite(low) else np.nan for low, _ in result.ci95.values()])


@pytest.fixture(scope="module")
def cell():
    return fracfit.fit(fracfit.read(CELL), CIRCUIT)


def test_numbers_of_the_command_line(cell):
    same_as_command_line(command_line.json_of("fit", CELL, "--model", CIRCUIT, "--component", "both"), cell)
    plain = fracfit.fit(fracfit.read(CELL, where="f<1"), "cole-cole", component="imaginary", weight="absolute", seed=3)
    found = command_line.json_of(
        "fit", CELL, "--model", "cole-cole", "--component", "imaginary", "--where", "f<1", "--weight", "absolute", "--seed", 3
    )
    same_as_command_line(found, plain)
    held = fracfit.fit(fracfit.read(CELL), CIRCUIT, fixed={"R0": 0.02}, bounds={"n1": (None, 1)}, start={"R1": 0.03})
    found = command_line.json_of(
        "fit", CELL, "--model", CIRCUIT, "--component", "both", "--fix", "R0=0.02", "--bound", "n1=:1", "--start", "R1=0.03"
    )
    same_as_command_line(found, held)


def test_defaults_are_those_of_the_command_line(cell):
    options = command_line.json_of("fit", CELL, "--model", CIRCUIT)["options"]
    assert (options["component"], options["weight"]) == ("both", "learned")
    for function in (fracfit.fit, fracfit.identify):
        assert inspect.signature(function).parameters["component"].default == options["component"]
    assert (cell.component, cell.weight) == ("both", "learned")
    # Of many at once as of one.
    assert fracfit.batch([fracfit.read(CELL)], CIRCUIT)[0] == cell


def test_data_without_a_real_part_are_fitted_by_the_imaginary_one(tmp_path):
    omega = np.logspace(-1, 2, 30)
    imaginary = Model("2/(0.5 s + 1)")(1j * omega).imag
    path = tmp_path / "alone.csv"
    np.savetxt(path, np.column_stack([omega, imaginary]), header="omega_rad_s,im", delimiter=",", comments="")
    read = fracfit.read(path)
    assert "no column holds a real part" in read.metadata["notes"]
    for data in (FrequencyResponse(omega, 1j * imaginary), read):
        with pytest.warns(UserWarning, match="the imaginary part alone is fitted"):
            found = fracfit.fit(data, "K/(T s + 1)")
        assert found.component == "imaginary" and found.residual_count == 30
        # Written and read with 18 digits; the search stops some decades above rounding.
        assert found["K"] == pytest.approx(2, rel=1e-6) and found["T"] == pytest.approx(0.5, rel=1e-6)
        # What follows from the fit is of the same component.
        assert found == fracfit.batch([data], "K/(T s + 1)")[0]
        low, high = found.profile("T")
        assert low <= found["T"] <= high
        with pytest.warns(UserWarning, match="the imaginary part alone is fitted"):
            ranking = fracfit.identify(data, ["lag", "gain"])
        assert ranking.component == ranking.best.component == "imaginary"
        assert found == fracfit.fit(data, "K/(T s + 1)", component="imaginary")
        assert fracfit.fit(data, "K/(T s + 1)", component="real").usable is False


def test_a_formula_is_the_preset_that_it_is():
    # Exact data of an exact model: the search ends at rounding.
    data = Model("2 s^0.5 - 0.5 s^0.9").frequency_response(OMEGA)
    plain, other = (fracfit.fit(data, each) for each in ("two-power-laws", "B2*s^y+s^x*B1"))
    assert list(other.parameters) == ["B1", "x", "B2", "y"]
    np.testing.assert_allclose(list(other.parameters.values()), list(plain.parameters.values()), rtol=1e-8)
    assert other.limits == {"B1": (-np.inf, np.inf), "x": (-4, 4), "B2": (-np.inf, np.inf), "y": (-4, 4)}
    with pytest.raises(ValueError, match="did you mean lag"):
        fracfit.fit(data, "Lag")


def test_a_power_law_of_one_part_is_that_of_the_command_line(tmp_path):
    omega = 0.1 * 1.2 ** np.arange(40)
    response = 100 * np.cos(np.arange(40)) - 3j * omega**-0.7
    data = FrequencyResponse(omega, response)
    result = fracfit.fit(data, "component-power-law", component="imaginary", outliers="keep")
    # Exact data, whose last digit moves both by some roundings; the real part has no say.
    np.testing.assert_allclose([result["K"], result["b"]], [-3, -0.7], rtol=0, atol=1e-11)
    assert result.law.startswith("Im = K omega^b, a power law of the imaginary part alone") and result.law in repr(result)
    np.testing.assert_allclose(result.predict(), 1j * response.imag, atol=1e-11)
    assert pickle.loads(pickle.dumps(result)) == result
    # With noise, which a law of one part weighs by that part: so do its intervals.
    response.imag *= 1 + 0.01 * np.random.default_rng(4).standard_normal(40)
    noisy = FrequencyResponse(omega, response)
    path = tmp_path / "part.csv"
    path.write_text("\n".join(["omega_rad_s,re,im", *(f"{w!r},{z.real!r},{z.imag!r}" for w, z in zip(omega.tolist(), response.tolist()))]))
    arguments = ("fit", path, "--model", "component-power-law", "--component", "imaginary", "--outliers", "keep")
    found = command_line.json_of(*arguments, "--profile", "--bootstrap", 20)
    result = fracfit.fit(noisy, "component-power-law", component="imaginary", outliers="keep")
    same_as_command_line(found, result)
    assert str(result.profile("b")[0]) in str(found) and str(result.bootstrap(20)["b"][0]) in str(found)
    assert result.lack_of_fit()["adequate"]
    assert fracfit.batch([noisy], "component-power-law", component="imaginary", outliers="keep")[0] == result
    assert fracfit.fit(noisy, "lag").law is None
    for wrong, sentence in (
        (lambda: fracfit.fit(noisy, "component-power-law"), "component both: component-power-law is a power law of one part"),
        (lambda: fracfit.identify(noisy, ["component-power-law"]), "is one of fit and batch"),
        (lambda: fracfit.fit(fracfit.read(STEP), "component-power-law"), "no meaning with samples over time"),
    ):
        with pytest.raises(ValueError, match=sentence):
            wrong()


def test_what_helps_is_said_in_words_of_python():
    # The best T >= 0 is 0, as that of the data is below it.
    held = fracfit.fit(Model("3/(s^0.5 - 0.01)").frequency_response(np.logspace(-2, 2, 41)), "K/(s^0.5 + T)")
    assert held.limits["T"] == (0, np.inf)
    assert held.message.endswith("Others are given by bounds={'T': (lower, upper)}.") and held.message in repr(held)
    assert pickle.loads(pickle.dumps(held)) == held


@pytest.fixture(scope="module")
def torn(tmp_path_factory):
    """A lag with noise of 1 % and two points far off the others: as a file, as data, and without the two."""
    chance = np.random.default_rng(20)
    omega = np.logspace(-1, 3, 41)
    response = Model("3/(0.4 s^0.8 + 1)")(1j * omega)
    response *= 1 + 0.01 * (chance.standard_normal(41) + 1j * chance.standard_normal(41))
    response[[12, 30]] *= 1.4, 0.7
    path = tmp_path_factory.mktemp("torn") / "torn.csv"
    rows = [f"{w!r},{z.real!r},{z.imag!r}" for w, z in zip(omega.tolist(), response.tolist())]
    path.write_text("\n".join(["omega_rad_s,re,im", *rows]))
    others = np.delete(np.arange(41), [12, 30])
    return path, fracfit.read(path), FrequencyResponse(omega[others], response[others])


def test_sentences_name_frequencies_in_the_unit_of_the_data(torn, tmp_path):
    path, data, _ = torn
    rows = [f"{f!r},{z.real!r},{z.imag!r}" for f, z in zip(data.f.tolist(), data.response.tolist())]
    in_hertz = tmp_path / "hertz.csv"
    in_hertz.write_text("\n".join(["f_Hz,re,im", *rows]))
    for each in (fracfit.read(in_hertz), FrequencyResponse.from_hz(data.f, data.response)):
        assert each.frequency_unit == "Hz" and each.where("f > 0").frequency_unit == "Hz"
        assert repr(each).startswith(f"FrequencyResponse(41 points, {data.f[0]:g} to {data.f[-1]:g} Hz")
        with pytest.warns(UserWarning, match="Hz") as told:
            result = fracfit.fit(each, "fractional-lag")
        assert "rad/s" not in str(told[0].message)
        assert repr(result).endswith(f"left out: f = {data.f[12]:.6g}, {data.f[30]:.6g} Hz")
    assert fracfit.read(path).frequency_unit == "rad/s"
    with pytest.raises(ValueError, match="frequency_unit is 'kHz'; expected rad/s or Hz"):
        FrequencyResponse([1.0], [1.0], frequency_unit="kHz")


def test_points_that_contradict_their_neighbours_are_left_out_as_on_the_command_line(torn):
    path, data, others = torn
    arguments = ("fit", path, "--model", "fractional-lag", "--component", "both")
    with pytest.warns(UserWarning, match="contradict their neighbours") as told:
        result = fracfit.fit(data, "fractional-lag")
    same_as_command_line(command_line.json_of(*arguments), result)
    assert result.left_out == [12, 30] and "left out: omega = " in repr(result)
    sentence = str(told[0].message)
    assert sentence.partition(", and taken in")[0] in command_line.notes_of(*arguments)
    assert sentence.endswith('outliers="keep"')
    # The others alone give the same; what is computed from the data afterwards goes by them too.
    alone = fracfit.fit(others, "fractional-lag")
    assert alone.left_out == [] and alone.parameters == result.parameters
    assert alone.profile("K") == result.profile("K") and alone.lack_of_fit()["noise"] == result.lack_of_fit()["noise"]
    assert result.predict().shape == data.response.shape
    assert pickle.loads(pickle.dumps(result)).left_out == [12, 30]
    together = fracfit.batch([data, others], "fractional-lag")
    assert [each.left_out for each in together] == [[12, 30], []]
    assert together[0].parameters == result.parameters


def test_points_that_contradict_their_neighbours_are_kept_where_asked(torn, recwarn):
    path, data, _ = torn
    kept = fracfit.fit(data, "fractional-lag", outliers="keep")
    found = command_line.json_of("fit", path, "--model", "fractional-lag", "--component", "both", "--outliers", "keep")
    same_as_command_line(found, kept)
    assert kept.left_out == [] and set(kept.outliers) >= {12, 30}
    assert fracfit.fit(data, "fractional-lag", loss="cauchy").left_out == []
    assert not recwarn.list
    with pytest.raises(ValueError, match="expected one of leave-out, keep"):
        fracfit.fit(data, "fractional-lag", outliers="drop")


def test_identify_leaves_out_the_same_points(torn):
    path, data, others = torn
    with pytest.warns(UserWarning, match="2 of 41 points"):
        found = fracfit.identify(data, ["fractional-lag", "lag"], curves={"itself": data.response})
    alone = fracfit.identify(others, ["fractional-lag", "lag"], curves={"itself": others.response})
    assert found.left_out == [12, 30] and alone.left_out == []
    assert found.evidence == alone.evidence and found.best.parameters == alone.best.parameters
    assert found.best.left_out == [12, 30]
    with pytest.raises(ValueError, match="40 values; expected one for each of the 41"):
        fracfit.identify(data, ["lag"], curves={"short": data.response[1:]})


def test_a_preset_with_limits_of_its_own_can_be_fixed():
    result = fracfit.fit(fracfit.read(CELL), "cole-cole", fixed={"K": 0.11})
    assert result["K"] == 0.11 and result.standard_errors["K"] == 0
    same_as_command_line(command_line.json_of("fit", CELL, "--model", "cole-cole", "--component", "both", "--fix", "K=0.11"), result)
    with pytest.raises(ValueError, match="no start"):
        fracfit.fit(EXACT, "K/s", fixed={"K": 1}, start={"K": 1})


def test_bits_over_time():
    model = "K/(A s^a + B s^b + 1)"
    result = fracfit.fit(fracfit.read(STEP), model)
    same_as_command_line(command_line.json_of("fit", STEP, "--model", model), result)
    assert "offset" in result.parameters
    assert result.predict().shape == fracfit.read(STEP).time.shape
    residual = fracfit.read(STEP).output - result.predict()
    assert np.sum(residual**2) == pytest.approx(result.cost, rel=1e-9)


def test_bits_of_a_family():
    result = fracfit.fit(fracfit.read(CELL), "rational:3")
    same_as_command_line(command_line.json_of("fit", CELL, "--model", "rational:3", "--component", "both"), result)
    with pytest.raises(ValueError, match="family"):
        fracfit.fit(EXACT, "rational:3", fixed={"p1": 1})


@pytest.mark.bits
def test_priors_orders_and_derived_quantities_of_the_command_line(cell):
    both = ("--component", "both")
    found = command_line.json_of(
        "fit", CELL, "--model", "zarc", *both, "--prior", "R0=0.02+-5%", "--prior", "n1=0.8+-0.05", "--derive", "f1 = (R1 Q1)^(-1/n1)/(2 pi)"
    )
    ours = fracfit.fit(fracfit.read(CELL), "zarc", prior={"R0": "0.02 +- 5%", "n1": (0.8, 0.05)})
    same_as_command_line(found, ours)
    for theirs, mine in zip(found["priors"], ours.priors, strict=True):
        assert {key: theirs[key] for key in ("value", "deviation", "distance", "share")} == {
            key: mine[key] for key in ("value", "deviation", "distance", "share")
        }
    derived = ours.derive("f1 = (R1 Q1)^(-1/n1)/(2 pi)")
    assert [found["derived"][0][key] for key in ("name", "value", "standard_error")] == [
        derived[key] for key in ("name", "value", "standard_error")
    ]
    again = pickle.loads(pickle.dumps(ours))
    assert again == ours and again.profile("n1") == ours.profile("n1")
    with pytest.raises(ValueError, match="no residual can resample"):
        ours.bootstrap(20)

    found = command_line.json_of("fit", CELL, "--model", "two-zarc", *both, "--constraint", "Q1<Q2")
    held = fracfit.fit(fracfit.read(CELL), "two-zarc", constraint="Q1<Q2")
    same_as_command_line(found, held)
    assert held["Q1"] <= held["Q2"]
    assert cell.priors == [] and cell.growth is None


def test_bounds_and_priors_of_a_quantity_are_those_of_a_formula_that_has_it_as_parameter():
    omega = np.logspace(-1, 5, 60)
    random = np.random.default_rng(5)
    noise = 0.3 * (random.standard_normal(60) + 1j * random.standard_normal(60))
    data = FrequencyResponse(omega, 10 + 50 / (1 + (1j * omega * 0.02) ** 0.8) + noise)

    def values(parameters):  # of the circuit that is written with Q1
        series, resistance, capacity, order = parameters
        return series + resistance / (1 + resistance * capacity * (1j * omega) ** order)

    def cost(parameters):
        return np.sum(np.abs(data.response - values(parameters)) ** 2)

    def log_tau(parameters):
        return np.log(parameters[1] * parameters[2]) / parameters[3]

    def gradient(function, parameters):  # by ln of the parameters; central differences err by the cube root of rounding, squared
        steps = 1e-5 * np.eye(4)
        return np.array([(function(parameters * np.exp(step)) - function(parameters * np.exp(-step))) / 2e-5 for step in steps])

    def circuit(result):
        tau, resistance, order = (result[name] for name in ("tau", "R1", "n1"))
        return np.array([result["R0"], resistance, tau**order / resistance, order])

    ours = {"model": "R0 + R1/(1 + (tau s)^n1)", "weight": "absolute"}
    # The same optimum: both searches end where a step changes the cost by 1e-12.  Errors are widened for each parameter and keep the
    # correlations of white noise, so that it matters by a few per cent which parameters a formula has.
    plain = fracfit.fit(data, **ours)
    other = fracfit.fit(data, "zarc", weight="absolute").derive("tau = (R1 Q1)^(1/n1)")
    assert plain.cost == pytest.approx(cost(circuit(plain)), rel=1e-9)
    assert plain["tau"] == pytest.approx(other["value"], rel=1e-5)
    assert plain.standard_errors["tau"] == pytest.approx(other["standard_error"], rel=0.1)

    # A prior of 30 ms within 2 %, of the logarithm: at the least sum the gradients by the parameters of the circuit cancel, with the
    # squared noise as factor, which is the cost to a degree of freedom, of 116 to 120.
    known = fracfit.fit(data, **ours, prior={"tau": "0.03 +- 2%"})
    at = circuit(known)
    of_cost = gradient(cost, at)
    of_prior = gradient(lambda p: ((log_tau(p) - np.log(0.03)) / 0.02) ** 2, at)
    factor = -(of_cost @ of_prior) / (of_prior @ of_prior)
    assert np.linalg.norm(of_cost + factor * of_prior) <= 1e-3 * np.linalg.norm(of_cost)
    assert known.cost / 120 <= factor <= known.cost / 116
    assert plain["tau"] < known["tau"] < 0.03

    # A bound that is in force: the least cost of the circuit where its quantity is held there, by scipy.
    held = fracfit.fit(data, **ours, bounds={"tau": (0.025, 1)})
    assert held["tau"] == pytest.approx(0.025, rel=1e-6)

    def cost_on_bound(parameters):
        series, resistance, order = parameters
        return cost((series, resistance, 0.025**order / resistance, order))

    least = optimize.minimize(cost_on_bound, [10, 50, 0.8], method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-12, "maxiter": 4000})
    assert held.cost == pytest.approx(least.fun, rel=1e-8)


def test_growth_of_the_command_line():
    found = command_line.json_of("fit", CELL, "--grow", "arcs", "--component", "both")
    grown = fracfit.fit(fracfit.read(CELL), grow="arcs")
    same_as_command_line(found, grown)
    assert grown.formula == found["model"]
    assert grown.growth["chosen"] == found["growth"]["chosen"]
    assert grown.growth["reason"] == found["growth"]["reason"]
    assert [fit["formula"] for fit in grown.growth["fits"]] == [fit["model"] for fit in found["growth"]["fits"]]
    assert grown.lack_of_fit()["misfit"] == found["lack_of_fit"]["misfit"]


def test_fit_is_that_of_scipy():
    result = fracfit.fit(EXACT, "K/(T s^a + 1)", weight="relative")

    def residuals(theta):
        model = theta[0] / (theta[1] * (1j * OMEGA) ** theta[2] + 1)
        relative = (model - EXACT.response) / np.abs(EXACT.response)
        return np.concatenate([relative.real, relative.imag])

    theirs = optimize.least_squares(residuals, [1.0, 1.0, 0.9], xtol=1e-15, ftol=1e-15, gtol=1e-15)
    assert np.allclose(list(result.parameters.values()), theirs.x, rtol=1e-6)


def test_standard_errors_are_those_of_the_jacobian():
    # White noise of one size in all parts: (J'J)^-1 with the residual variance, by finite differences; the factor that
    # allows for correlation of neighbours is within a fifth of 1 for white noise of 400 points.
    omega = np.logspace(-1, 2, 400)
    truth = np.array([2.0, 0.5, 0.7])

    def response(theta):
        return theta[0] / (theta[1] * (1j * omega) ** theta[2] + 1)

    noise = np.random.default_rng(5).normal(scale=0.01, size=(2, omega.size))
    result = fracfit.fit(FrequencyResponse(omega, response(truth) + noise[0] + 1j * noise[1]), "K/(T s^a + 1)", weight="absolute")
    columns = []
    for k in range(3):
        step = np.zeros(3)
        step[k] = 1e-6
        columns.append((response(truth + step) - response(truth - step)) / 2e-6)
    jacobian = np.array([np.concatenate([c.real, c.imag]) for c in columns]).T
    expected = 0.01 * np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))
    assert np.allclose(list(result.standard_errors.values()), expected, rtol=0.25)
    assert np.allclose(np.sqrt(np.diag(result.covariance)), list(result.standard_errors.values()), rtol=1e-12)


def test_prediction_and_intervals(cell):
    assert np.array_equal(cell.predict(), cell.model.frequency_response(cell.data.omega).response)
    truth = {"R0": 0.02, "R1": 0.03, "Q1": 0.05, "n1": 0.85, "R2": 0.06, "Q2": 4, "n2": 0.75}
    for name, value in truth.items():
        # Five standard errors: one in two million.
        assert abs(cell[name] - value) < 5 * cell.standard_errors[name]
    low, high = cell.profile("R1")
    assert low < cell["R1"] < high
    intervals = cell.bootstrap(40)
    assert set(intervals) == set(truth)
    assert cell.bootstrap(40, threads=1) == intervals
    assert cell.deviation([1.0, 10.0]).shape == (2, 4)
    assert cell.lack_of_fit()["adequate"]
    with pytest.raises(ValueError):
        cell.profile("nobody")
    with pytest.raises(ValueError):
        cell.bootstrap(3)
    with pytest.raises(KeyError):
        cell["nobody"]
    with pytest.raises(AttributeError):
        cell.nothing


def test_profile_and_bootstrap_of_the_command_line(cell):
    found = command_line.json_of("fit", CELL, "--model", CIRCUIT, "--component", "both", "--bootstrap", 30, "--profile")
    assert str(cell.profile("n2")[0]) in str(found)
    assert str(cell.bootstrap(30)["n2"][0]) in str(found)


def test_identify_of_the_command_line():
    models = ["fractional-lag", "cole-cole", "lag", CIRCUIT]
    result = fracfit.identify(fracfit.read(CELL), models)
    found = command_line.json_of("identify", CELL, "--models", ",".join(models), "--component", "both")
    assert found["verdict"] == result.verdict
    assert found["evidence"] == result.evidence or np.isnan(result.evidence)
    assert str(result.best["n1"]) in str(found)
    assert result.best.data is not None and result.best.profile("R2")[0] < result.best["R2"]
    over_time = fracfit.identify(fracfit.read(STEP), ["lag", "fractional-lag"])
    assert len(over_time.ranking) == 2
    curve = fracfit.identify(EXACT, ["lag"], curves={"itself": EXACT.response})
    assert "itself" in [each["name"] for each in curve.ranking]


@pytest.mark.bits
def test_the_distribution_is_that_of_the_command_line():
    models = ["two-zarc", "two-rc", "rational:1..8"]
    found = command_line.json_of("identify", CELL, "--models", ",".join(models))
    result = fracfit.identify(fracfit.read(CELL), models)
    assert result.verdict == found["verdict"] == "fractional-or-distribution"
    assert result.distribution == found["distribution"]
    assert "/(1 + s t1)" in result.distribution["model"]


@pytest.mark.bits
def test_the_next_measurement_is_that_of_the_command_line(tmp_path):
    chance = np.random.default_rng(1)
    omega = np.logspace(-1, 1, 14)
    response = Model("1/(0.3 s^1.7 + 0.4 s^0.9 + 1)")(1j * omega)
    response *= 1 + 0.03 * (chance.standard_normal(14) + 1j * chance.standard_normal(14))
    path = tmp_path / "open.csv"
    path.write_text("\n".join(["omega_rad_s,re,im", *(f"{w!r},{z.real!r},{z.imag!r}" for w, z in zip(omega.tolist(), response.tolist()))]))
    models = ["fractional-oscillator", "oscillator", "rational:0..4"]
    found = command_line.json_of("identify", str(path), "--models", ",".join(models), "--component", "both")["next_measurement"]
    result = fracfit.identify(fracfit.read(path), models)
    assert result.next_measurement == (found["lower"], found["upper"], found["points"])
    assert (result.next_accuracy, result.next_evidence) == (found["accuracy"], found["expected_evidence"])


@pytest.mark.bits
def test_economy_of_the_command_line(tmp_path):
    path = tmp_path / "scene.csv"
    arguments = ("--force", 40, "--clearance", 0.3, "--restitution", 0.6, "--omega", "19.1:35:24")
    path.write_text(command_line.run("simulate", *arguments, "--format", "csv"))
    found = command_line.json_of("identify", path, "--models", "power-law,lag", "--component", "imaginary")["economy"]
    data = fracfit.read(path)
    static = fracfit.static_describing_function(data.omega, force=40, clearance=0.3).response
    result = fracfit.economy(data, component="imaginary", curves={"static-backlash": static})
    assert {name: getattr(result, name) for name in found} == found
    # Integer powers follow it better than real ones: K1/s^3 + K2 s to 0.173 % of 160 points, K s^a to 1.63 %.
    assert result.needs["integer-powers-of-s"][:2] == (2, 3) and result.needs["real-powers"][0] == 4
    assert result.needs["static-backlash"] == (None, None, None)
    assert result.verdict == "integer-cheaper" and result.sentence in repr(result)
    count, error = result.points("rational")
    assert (np.diff(count) > 0).all() and (np.diff(error) < 0).all()
    # The same from identify, which knows the file as computed; a model need not meet it.
    identified = fracfit.identify(data, ["power-law", "lag"], component="imaginary", curves={"static-backlash": static})
    assert identified.without_noise and "`economy`" in repr(identified)
    before = pickle.loads(pickle.dumps(identified))
    assert identified.economy == result
    after = pickle.loads(pickle.dumps(identified))
    assert before.economy == after.economy == result and before == identified == after


def least_error(target, columns):
    """Of the best real coefficients, relative to the target."""
    scaled = np.stack(columns, axis=1) / target[:, None]
    left = 1 - scaled @ np.linalg.lstsq(scaled, np.ones(len(target)), rcond=None)[0]
    return np.sqrt(np.mean(left**2))


def test_economy_of_laws_that_are_known():
    power = fracfit.economy(Model("2.5 s^0.4").frequency_response(OMEGA), most_parameters=4)
    assert power.needs["real-powers"] == power.needs["commensurate"] == power.needs["terms"] == (2, 2, 2)
    assert power.needs["integer-powers-of-s"][2] is None and power.verdict == "fractional-cheaper"
    assert power.points("real-powers")[1][-1] < power.rounding
    whole = fracfit.economy(Model("3/s^3 + 2 s").frequency_response(OMEGA), component="imaginary", most_parameters=4)
    assert whole.needs["integer-powers-of-s"] == whole.needs["integer-powers-of-omega"] == (2, 2, 2)
    assert whole.needs["real-powers"] == (4, 4, 4) and whole.verdict == "integer-cheaper"
    assert whole.curves[1]["points"][-1]["model"] == "3 s^(-3) + 2 s" and whole.curves[1]["points"][-1]["proven"]


def test_economy_of_powers_is_that_of_scipy():
    omega = np.linspace(1, 4, 25)
    data = FrequencyResponse(omega, Model("1/(1 + (2 s)^0.8)^0.6")(1j * omega))
    target = data.response.imag
    found = fracfit.economy(data, component="imaginary", most_parameters=4)
    assert len(found.points("real-powers")[0]) == 2
    # Every subset of whole powers; the library's least squares and these differ by rounding.
    powers = np.arange(-9, 10)
    for count, error in list(zip(*found.points("integer-powers-of-omega")))[:3]:
        subsets = itertools.combinations(powers, count)
        least = min(least_error(target, [omega ** float(n) for n in subset]) for subset in subsets)
        assert error == pytest.approx(least, rel=1e-6, abs=1e-10)
    # Real powers from 20 random starts: the library's search ends within 1e-9 of the cost, scipy's no better.
    chance = np.random.default_rng(7)
    for count, error in zip(*found.points("real-powers")):
        def cost(orders):
            return least_error(target, [omega**order for order in orders])

        starts = chance.uniform(-9, 9, (20, count // 2))
        limits = [(-9, 9)] * (count // 2)
        least = min(optimize.minimize(cost, start, bounds=limits).fun for start in starts)
        assert error <= least * 1.0001


def test_computed_data_have_no_chance():
    # K s^a misses it by some per cent.
    curve = fracfit.describing_function(np.linspace(19.1, 35, 40), force=40, clearance=0.3, restitution=0.6).data()
    fitted = fracfit.fit(curve, "power-law", component="imaginary")
    joint = fracfit.joint_fit([curve, curve], "power-law", each="K", component="imaginary")
    ranked = fracfit.identify(curve, ["power-law", "lag"], component="imaginary")
    for result in (fitted, joint, ranked):
        assert result.without_noise and "These data carry no noise" in repr(result)
        for shown in (repr(result), result._repr_html_()):
            for word in ("95 %", "not identified", "odds", "white noise", "Akaike"):
                assert word not in shown
    assert "95 %" in repr(fracfit.fit(fracfit.FrequencyResponse(curve.omega, curve.response), "power-law"))


def test_identify_tells_data_without_noise():
    exact = fracfit.identify(EXACT, ["fractional-lag"])
    assert exact.without_noise and exact.economy.needs["terms"][2] == 3
    chance = np.random.default_rng(2)
    noisy = fracfit.identify(FrequencyResponse(OMEGA, EXACT.response * (1 + 1e-6 * chance.standard_normal(20))), ["fractional-lag"])
    assert not noisy.without_noise and noisy.economy is None and "economy" not in repr(noisy)
    assert fracfit.identify(fracfit.read(STEP), ["lag"]).economy is None
    real_at_once = FrequencyResponse([0.1, 1, 2], [3, 1 - 1j, 0.5 - 2j], metadata={"computed_by": "hand"})
    zero = fracfit.identify(real_at_once, ["gain"], component="both", weight="absolute")
    assert zero.economy.most_parameters == 5
    zero = fracfit.identify(real_at_once, ["power-law"], component="imaginary", weight="absolute")
    with pytest.raises(ValueError, match="the imaginary part at omega = 0.1 rad/s is 0, where no relative error exists"):
        zero.economy
    for option, sentence in (
        ({"component": "phase"}, "component phase"),
        ({"most_parameters": 9}, "most parameters = 9"),
        ({"largest_power": 10}, "largest power = 10"),
        ({"curves": {"short": [1, 2]}}, "2 values; expected one for each of the 20"),
    ):
        with pytest.raises(ValueError, match=sentence):
            fracfit.economy(EXACT, **option)
    with pytest.raises(ValueError, match="expected a FrequencyResponse"):
        fracfit.economy([1, 2])


def test_batch_is_each_fit_alone():
    curves = [Model("K/(0.5 s^0.7 + 1)", K=k).frequency_response(OMEGA) for k in (1, 2, 3)]
    curves.insert(1, FrequencyResponse([1.0], [1.0]))  # fewer residuals than parameters
    told = []
    result = fracfit.batch(curves, "K/(T s^a + 1)", progress=lambda *counts: told.append(counts))
    assert told[-1] == (4, 4)
    assert result.usable.tolist() == [True, False, True, True]
    assert list(result.errors) == [1] and "parameters" in result.errors[1]
    assert result[2] == fracfit.fit(curves[2], "K/(T s^a + 1)")
    assert np.isnan(result.parameters["K"][1])
    assert fracfit.batch(curves, "K/(T s^a + 1)", threads=1).parameters["T"].tobytes() == result.parameters["T"].tobytes()
    assert "4 fits, 3 usable" in repr(result)
    with pytest.raises(TypeError, match="no argument 'colour'"):
        fracfit.batch(curves, "K/s", colour=1)


def test_tune_of_the_command_line():
    plant = "3.13 exp(-50 s)/(433.33 s + 1)"
    found = command_line.json_of("tune", plant, "--crossover", 0.008, "--phase-margin", 60, "--flat-phase")
    result = fracfit.tune(plant, crossover=0.008, phase_margin=np.pi / 180 * 60, flat_phase=True)
    assert result.usable
    assert [found["controller"][name] for name in ("kp", "ki", "kd")] == [result.kp, result.ki, result.kd]
    loop = result.model * Model(plant)
    assert loop.margins().phase_margin == pytest.approx(np.pi / 3, rel=1e-6)
    assert result.pid(1.0, (1e-4, 0.5)).error < 0.1


@pytest.mark.bits
def test_scene_of_the_command_line():
    curves = [fracfit.read(path) for path in FORCES]
    result = fracfit.identify_scene(curves, [20, 40], fixed={"mass1": 1}, contact="hard")
    found = command_line.json_of("identify-scene", *FORCES, "--fix", "mass1=1", "--contact", "hard")
    assert str(result["restitution"]) in str(found)
    assert str(result["clearance"]) in str(found)
    # The data are of two masses of 1 kg, 0.3 m, restitution 0.6; five standard errors.
    for each, truth in zip(result.parameters, (1, 1, 0.3, 0.6)):
        assert abs(each["value"] - truth) <= 5 * each["standard_error"]
    with pytest.raises(ValueError, match="entries"):
        fracfit.identify_scene(curves, [20])
    with pytest.raises(ValueError, match="soft"):
        fracfit.identify_scene(curves, [20, 40], contact="soft")


def test_contacts_that_take_time():
    contact = fracfit.contact_of_frequency(150, restitution=0.5)
    curves = [
        fracfit.describing_function(np.linspace(*band, 12), force=force, clearance=0.3, protocol="two-impact", **contact).data()
        for force, band in ((10, (12.8, 18)), (40, (25.6, 36)))
    ]
    result = fracfit.identify_scene(curves, [10, 40], fixed={"mass1": 1})
    assert result.contact_verdict == "compliant"
    # Exact data.
    assert result["contact_stiffness"] == pytest.approx(0.5 * 150**2, rel=1e-5)
    assert result["restitution"] == pytest.approx(0.5, rel=1e-5)
    hard = fracfit.identify_scene(curves, [10, 40], fixed={"mass1": 1}, contact="hard")
    assert hard.contact == [] and hard.rms > 1e3 * result.rms


def test_circuit_in_the_manner_of_impedance_py():
    cell = fracfit.read(CELL)
    circuit = fracfit.CustomCircuit(CIRCUIT, {"R1": 0.03})
    with pytest.raises(RuntimeError, match="has not been fitted"):
        circuit.predict([1.0])
    assert circuit.fit(cell.f[::-1], cell.response[::-1]) is circuit
    assert circuit.get_param_names() == ["R0", "R1", "Q1", "n1", "R2", "Q2", "n2"]
    assert circuit.parameters_.shape == circuit.conf_.shape == (7,)
    mixed = np.array([3.0, 1.0, 2.0])
    assert np.array_equal(circuit.predict(mixed)[[1, 2, 0]], circuit.predict(np.sort(mixed)))


@pytest.mark.bits
def test_described_numbers_are_attributes_and_documented(cell):
    found = command_line.json_of("fit", CELL, "--model", CIRCUIT)
    kinds = {"flag": bool, "count": int, "number": float, "text": str}
    for name, kind, meaning, entries in fracfit._fit._fitting.described["FitResult"]:
        assert name in dir(cell)
        value = getattr(cell, name)
        documented = inspect.getdoc(vars(fracfit.FitResult)[name]) if name in vars(fracfit.FitResult) else fracfit.FitResult.__doc__
        assert documented and (name in vars(fracfit.FitResult) or f"\n{name} : " in documented)
        key = {"formula": "model", "residual_count": "residuals"}.get(name, name)
        if kind in kinds:
            assert isinstance(value, kinds[kind])
            # JSON knows no NaN; a fit does not take the same time twice.
            assert key == "seconds" or found[key] == (None if value != value else value), name


def test_ranking_and_scene_have_what_is_described():
    ranking = fracfit.identify(EXACT, ["lag", "fractional-lag"])
    curves = [fracfit.describing_function(np.linspace(20, 35, 8), restitution=0.6, force=40, clearance=0.3).data()]
    for result in (ranking, fracfit.identify_scene(curves, [40], fixed={"mass1": 1}), ranking.economy):
        for name, kind, meaning, entries in fracfit._fit._fitting.described[type(result).__name__]:
            assert hasattr(result, name) and f"\n{name} : " in type(result).__doc__
            for each in getattr(result, name) if entries and kind == "list of objects" and name != "points" else []:
                assert set(entries.split(", ")) <= set(each)


def test_results_pickle(cell):
    again = pickle.loads(pickle.dumps(cell))
    assert again == cell
    assert again.profile("R1") == cell.profile("R1")
    assert repr(again) == repr(cell) and "R1" in repr(cell)
    assert "<table>" in cell._repr_html_()
    for result in (
        fracfit.identify(EXACT, ["lag", "fractional-lag"]),
        fracfit.tune("1/(s^1.5 + s)", crossover=1.0, phase_margin=1.0),
        fracfit.batch([EXACT], "lag"),
        fracfit.CustomCircuit("R0 + R1/(1 + R1 Q1 s^n1)").fit(EXACT.f, EXACT.response),
    ):
        again = pickle.loads(pickle.dumps(result))
        assert repr(again) == repr(result)
    ranking = fracfit.identify(EXACT, ["lag", "fractional-lag"])
    assert pickle.loads(pickle.dumps(ranking)) == ranking


def test_a_start_of_the_model_is_a_start():
    with pytest.raises(ValueError, match="start"):
        fracfit.fit(EXACT, "K/(T s^a + 1)", global_start=False)
    result = Model("K/(T s^a + 1)", K=1.5, T=1.0, a=0.9).fit(EXACT, global_start=False)
    assert result["a"] == pytest.approx(0.7, rel=1e-9)
    assert result.starts == 1


def test_wrong_requests_are_our_sentences():
    for wrong, sentence in (
        ({"component": "left"}, "component"),
        ({"weight": "heavy"}, "weight"),
        ({"weight": "given"}, "standard deviation"),
        ({"fixed": {"Q": 1}}, "Q"),
        ({"bounds": {"K": 3}}, "expected"),
        ({"bounds": {"K": (2, 1)}}, "K"),
        ({"fixed": {"K": "two"}}, "expected a number"),
        ({"prior": {"K": 2}}, "expected .value, deviation"),
        ({"prior": {"K": "2+-x"}}, "expected .value, deviation"),
        ({"prior": {"K": (2, 0)}}, "must be positive"),
        ({"fixed": {"K": 2}, "prior": {"K": (2, 1)}}, "fixed"),
        ({"constraint": "K"}, "names with <"),
        ({"constraint": ["K<T", "a<T"]}, "one chain"),
        ({"grow": "arcs"}, "either model"),
        ({"seed": "one"}, "whole number"),
        ({"component": 3}, "expected a text"),
        ({"weight": np.ones(20)}, "expected a text"),
    ):
        with pytest.raises(ValueError, match=sentence):
            fracfit.fit(EXACT, "K/(T s^a + 1)", **wrong)
    with pytest.raises(ValueError, match="expected one of powers"):
        fracfit.fit(EXACT, grow="trees")
    with pytest.raises(ValueError, match="the data choose"):
        fracfit.fit(EXACT, grow="arcs", constraint="Q1<Q2")
    with pytest.raises(ValueError, match="follow from the data"):
        fracfit.fit(EXACT, grow="rational", fixed={"K": 1})
    with pytest.raises(ValueError, match="expected a FrequencyResponse"):
        fracfit.fit(([1], [2]), "K/s")
    with pytest.raises(ValueError):
        fracfit.fit(FrequencyResponse([1.0], [1.0]), "K/(T s^a + 1)")


def test_options_without_influence_are_refused():
    time = np.linspace(0, 10, 40)
    record = fracfit.TimeSeries(time, np.ones(40), 2 - 2 * np.exp(-time / 3) + 1e-3 * np.sin(9 * time))
    for option in ({"component": "imaginary"}, {"weight": "relative"}, {"realisation": {"name": "oustaloup"}}):
        with pytest.raises(ValueError, match=f"{list(option)[0]} = .* has no meaning with samples over time"):
            fracfit.fit(record, "lag", **option)
    for option in ({"trend": True}, {"offset": 0.0}, {"earlier_input": True}, {"noise": "coloured"}):
        with pytest.raises(ValueError, match=f"{list(option)[0]} = .* has no meaning with a frequency response"):
            fracfit.fit(EXACT, "lag", **option)
        with pytest.raises(ValueError, match="has no meaning"):
            fracfit.identify(EXACT, ["lag"], **option)
    with pytest.raises(ValueError, match="component"):
        fracfit.identify(record, ["lag"], component="real")
    assert fracfit.fit(record, "lag", weight="absolute") == fracfit.fit(record, "lag")


def test_options_of_reading_without_influence_are_refused():
    for option in ({"select": 1}, {"weight_column": "sigma"}, {"repeats": True}):
        with pytest.raises(ValueError, match="has no meaning with samples over time"):
            fracfit.read(STEP, **option)
    for option in ({"hold": "first-order"}, {"input_at_rest": 1.0}):
        with pytest.raises(ValueError, match=f"{list(option)[0]} has no meaning with a frequency response"):
            fracfit.read(CELL, **option)


def test_a_fit_over_time_has_the_deviation_of_its_response():
    time = np.linspace(0, 10, 40)
    record = fracfit.TimeSeries(time, np.ones(40), 2 - 2 * np.exp(-time / 3) + 1e-3 * np.sin(9 * time))
    result = fracfit.fit(record, "lag", trend=True)
    # Far below 1/T the response is the gain.
    assert result.deviation([1e-9])[0, 0] == pytest.approx(result.standard_errors["K"], rel=1e-9)


def test_a_derived_quantity_without_a_value_is_said(cell):
    with pytest.warns(UserWarning, match="log\\(-R1\\) is no finite number"):
        assert np.isnan(cell.derive("q = log(-R1)")["value"])


def test_a_ranking_marks_the_chosen_model():
    assert fracfit.identify(EXACT, ["fractional-lag", "lag"])._repr_html_().count(">chosen<") == 1
    noisy = fracfit.FrequencyResponse(EXACT.omega, EXACT.response * np.exp(0.01j * np.arange(EXACT.omega.size) ** 2))
    html = fracfit.identify(noisy, ["fractional-lag", "lag"])._repr_html_()
    assert html.count(">chosen<") == 1 and "misses the data" in html


def test_threads_fit_side_by_side():
    import concurrent.futures

    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        results = list(pool.map(lambda _: fracfit.fit(EXACT, "K/(T s^a + 1)"), range(8)))
    assert all(result == results[0] for result in results)


def test_pictures():
    pytest.importorskip("matplotlib")
    import matplotlib.pyplot as plt

    result = fracfit.fit(EXACT, "K/(T s^a + 1)")
    upper, lower = result.plot()
    assert len(upper.lines) == 2 and lower.get_xlabel() == "angular frequency, rad/s"
    assert result.plot(kind="nyquist").get_aspect() == 1.0
    assert EXACT.plot(kind="nyquist").get_aspect() == 1.0
    axes = fracfit.plot_bode(EXACT, Model("1/s"), labels=["a", "b"])
    assert np.allclose(axes[0].lines[1].get_ydata(), 1 / axes[0].lines[1].get_xdata())
    with pytest.raises(ValueError, match="omega"):
        fracfit.plot_nyquist(Model("1/s"))
    with pytest.raises(ValueError, match="bode or nyquist"):
        EXACT.plot(kind="nichols")
    plt.close("all")


def test_a_result_is_a_mapping_of_its_parameters(cell):
    assert "R0" in cell and "R9" not in cell
    assert list(cell) == cell.keys() == ["R0", "R1", "Q1", "n1", "R2", "Q2", "n2"]
    assert dict(cell) == cell.parameters and len(cell) == 7
    with pytest.raises(KeyError, match="no parameter 'R9'"):
        cell["R9"]


def test_a_misspelt_preset_is_no_formula():
    for given, meant in (("lagg", "lag"), ("havriliak_negami", "havriliak-negami"), ("cole-col", "cole-cole")):
        with pytest.raises(ValueError, match=f"neither a preset nor a formula of s; did you mean {meant}"):
            fracfit.fit(EXACT, given)
    with pytest.raises(ValueError, match="neither a preset"):
        fracfit.batch([EXACT], "wobble")
    assert fracfit.fit(EXACT, "lag").formula


def test_a_guess_without_names_goes_by_appearance():
    f = np.logspace(-2, 4, 40)
    truth = {"R0": 0.02, "R1": 0.03, "Q1": 0.5, "n1": 0.85}
    impedance = Model("R0 + R1/(1 + R1 Q1 s^n1)", **truth)(2j * np.pi * f)
    for circuit in ("R0 + R1/(1 + R1 Q1 s^n1)", "zarc"):
        guess = fracfit.CustomCircuit(circuit, initial_guess=[0.03, 0.02, 1, 0.8])
        assert guess.initial_guess == {"R0": 0.03, "R1": 0.02, "Q1": 1, "n1": 0.8}
        assert np.allclose(guess.fit(f, impedance).parameters_, list(truth.values()), rtol=1e-9)
    with pytest.raises(ValueError, match="2 entries; expected those of R0, R1, Q1, n1"):
        fracfit.CustomCircuit("zarc", initial_guess=[1, 2])
    with pytest.raises(ValueError, match="initial_guess is None, or holds it"):
        fracfit.CustomCircuit("zarc", initial_guess=[1, None, 2, 3])
    with pytest.raises(ValueError, match="K is None"):
        Model("K/(s + 1)", K=None)


def test_a_mirrored_spectrum_is_told():
    # Real and imaginary part of an arc belong together; the complex conjugate is the response of no causal system.
    arc = Model("3 + 5/(1 + (0.1 s)^0.8)").frequency_response(np.logspace(-1, 4, 51))
    mirrored = FrequencyResponse(arc.omega, np.conj(arc.response))
    found = fracfit.validate(mirrored)
    assert found.validity == "invalid" and found.reversed_sign and "reversed" in found.summary
    assert fracfit.validate(arc).validity == "valid" and not fracfit.validate(arc).reversed_sign
    with pytest.warns(UserWarning, match="sign of the imaginary part looks reversed"):
        fracfit.fit(mirrored, "cole-cole")
    with pytest.raises(ValueError, match="tolerance"):
        fracfit.validate(arc, tolerance=-1)
