# SPDX-License-Identifier: BSD-3-Clause
"""Models against scipy, closed forms and the command line."""

import copy
import math
import pickle

import command_line
import numpy as np
import pytest
from scipy import signal, special

import fracfit
from fracfit import Model

EPS = np.finfo(float).eps
# Third-order system with a pair: numerator and denominator as scipy takes them.
NUMERATOR, DENOMINATOR = [2.0, 3.0], [1.0, 1.4, 5.2, 4.0]
WHOLE = Model("(2 s + 3)/(s^3 + 1.4 s^2 + 5.2 s + 4)")
FRACTIONAL = "1/(0.8 s^2.2 + 0.5 s^0.9 + 1)"


def test_frequency_response_is_that_of_scipy():
    omega = np.logspace(-3, 3, 200)
    _, expected = signal.freqs(NUMERATOR, DENOMINATOR, omega)
    w, response = WHOLE.frequency_response(omega)
    assert np.array_equal(w, omega)
    # Four terms whose sum is at least a tenth of their moduli (damping of the pair): some 50 roundings.
    assert np.max(np.abs(response / expected - 1)) < 50 * EPS


def test_models_that_are_no_ratio_are_combined_as_formulas():
    s = 1j * np.logspace(-2, 2, 9)
    havriliak, a = Model("K/(1 + (1e-3 T s)^a)^b", K=-2, T=700, a=0.8, b=0.6), Model("K s^a", K=3, a=0.4)
    film, delayed = Model("tanh(sqrt(T s))/sqrt(T s)", T=2), Model("exp(-0.3 s)/(s + 1)")
    for found, expected in [
        (havriliak + a, havriliak(s) + a(s)),
        (0.1 - film, 0.1 - film(s)),
        (havriliak * film, havriliak(s) * film(s)),
        (a / havriliak, a(s) / havriliak(s)),
        (-film, -film(s)),
        (delayed + a, delayed(s) + a(s)),
        (delayed.feedback(), delayed(s) / (1 + delayed(s))),
        (film.feedback(a, sign=1), film(s) / (1 - film(s) * a(s))),
    ]:
        # A dozen operations, and a sum that cancels to no less than a hundredth.
        assert np.max(np.abs(found(s) / expected - 1)) < 1e-13, found
    with pytest.raises(ValueError, match="is no ratio of sums of powers of s"):
        (film + 1).poles()


def test_a_closed_loop_with_dead_time_answers_over_time():
    # u = k (1 - y) of an integrator: y = sum (-1)^j (k (t - (j + 1) L))^(j + 1)/(j + 1)! over the positive ones.
    k, delay = 0.8, 0.7
    t = np.linspace(0, 8, 41)
    exact = np.zeros(t.size)
    for j in range(12):
        since = np.maximum(t - (j + 1) * delay, 0)
        exact += (-1) ** j * (k * since) ** (j + 1) / math.factorial(j + 1)
    plant, controller = Model("exp(-L s)/s", L=delay), Model("k", k=k)
    closed = (controller * plant).feedback()
    response = closed.step(t)
    # The largest power is (0.8 7.3)^6/6! = 55: some 1e-14 of rounding.
    assert np.max(np.abs(response.output - exact)) < response.error_estimate + 1e-13
    assert response.meets_tolerance and response.method == "closed-loop"
    # A disturbance in front of the plant, with values changed afterwards and as a formula of its own.
    loaded = plant.feedback(controller)
    assert np.allclose(k * loaded.step(t).output, response.output, rtol=0, atol=1e-8)
    written = Model("k exp(-L s)/s/(1 + k exp(-L s)/s)", k=1, L=1).with_parameters(k=k, L=delay)
    assert np.allclose(written.step(t).output, response.output, rtol=0, atol=1e-8)
    # A held input that is 1 throughout is the step.
    assert np.allclose(closed.respond(t, np.ones(t.size)).output, response.output, rtol=0, atol=1e-8)
    with pytest.raises(ValueError, match="has one method"):
        closed.step(t, method="bdf2")
    with pytest.raises(ValueError, match="infinitely many poles"):
        closed.poles()


def test_a_preset_is_no_formula_of_a_model():
    with pytest.raises(ValueError, match="zarc is taken as a formula of one parameter"):
        Model("zarc", R0=1)


def test_models_are_summed():
    models = [Model("1/(s + 1)"), Model("2/(s + 3)"), Model("tanh(sqrt(s))")]
    # Three values of about 1.
    assert sum(models)(1j) == pytest.approx(sum(model(1j) for model in models), rel=10 * EPS)


def test_numbers_that_are_not_finite_are_refused():
    with pytest.raises(ValueError, match="K is nan; expected a finite number"):
        Model("K/(s + 1)", K=math.nan)
    with pytest.raises(ValueError, match="the factor is inf"):
        math.inf * WHOLE


def test_value_at_any_s_is_the_ratio_of_polynomials():
    s = np.random.default_rng(1).normal(size=(5, 4)) + 1j * np.random.default_rng(2).normal(size=(5, 4))
    expected = np.polyval(NUMERATOR, s) / np.polyval(DENOMINATOR, s)
    values = WHOLE(s)
    assert values.shape == (5, 4)
    # Random s may lie near a pole or the zero: powers through the logarithm err by |q ln s| eps.
    assert np.max(np.abs(values / expected - 1)) < 1e-13
    assert WHOLE(0) == 0.75
    assert WHOLE(3j) == WHOLE.frequency_response([3.0]).response[0]


def test_principal_value_on_the_branch_cut():
    # sqrt(-4) = 2i from above, -2i from below.
    root = Model("s^0.5")
    assert root(complex(-4, 0.0)) == pytest.approx(2j, abs=4 * EPS)
    assert root(complex(-4, -0.0)) == pytest.approx(-2j, abs=4 * EPS)
    delayed = Model("exp(-0.5 s)/s^0.5")
    s = 0.3 + 1.1j
    assert abs(delayed(s) - np.exp(-0.5 * s) / np.sqrt(s)) < 10 * EPS


def test_poles_are_those_of_numpy():
    found = np.sort_complex(WHOLE.poles())
    assert np.allclose(found, np.sort_complex(np.roots(DENOMINATOR)), rtol=1e-12)
    assert WHOLE.is_stable()
    assert not Model("1/(s^2 - s + 1)").is_stable()
    assert len(Model("1/(s + 2)^3").poles()) == 3


def test_step_and_impulse_are_those_of_scipy():
    time = np.linspace(0, 12, 121)
    system = signal.TransferFunction(NUMERATOR, DENOMINATOR)
    for ours, theirs in ((WHOLE.step(time), signal.step(system, T=time)), (WHOLE.impulse(time), signal.impulse(system, T=time))):
        t, y = ours
        assert np.array_equal(t, time)
        # The tolerance of ours is 1e-9 of the largest output; scipy integrates exactly between samples.
        assert np.max(np.abs(y - theirs[1])) < 2e-9 * np.max(np.abs(y)) + 1e-11


def test_response_to_samples_is_that_of_scipy():
    time = np.linspace(0, 10, 201)
    samples = np.random.default_rng(3).normal(size=time.size)
    _, expected, _ = signal.lsim((NUMERATOR, DENOMINATOR), samples, time, interp=False)
    t, y = WHOLE.respond(time, samples)
    assert np.max(np.abs(y - expected)) < 1e-8 * np.max(np.abs(expected))
    _, straight, _ = signal.lsim((NUMERATOR, DENOMINATOR), samples, time, interp=True)
    assert np.max(np.abs(WHOLE.respond(time, samples, hold="first-order").output - straight)) < 1e-8


def test_half_order_step_is_the_error_function():
    time = np.array([0.1, 1.0, 4.0, 25.0])
    # 1 - e^t erfc(sqrt t), by Laplace transform.
    answer = Model("1/(s^0.5 + 1)").step(time)
    assert answer.meets_tolerance
    assert np.max(np.abs(answer.output - (1 - special.erfcx(np.sqrt(time))))) < 1e-9


def test_norms_of_a_lag():
    lag = Model("3/(2 s + 1)")
    assert lag.h2_norm() == pytest.approx(3 / math.sqrt(2 * 2), rel=1e-12)
    assert lag.hinf_norm()[0] == pytest.approx(3, rel=1e-12)


def test_margins_of_a_triple_lag():
    # K/(s + 1)^3 crosses -pi at omega = sqrt 3, where |L| = K/8.
    margins = Model("4/(s + 1)^3").margins()
    assert margins.gain_margin == pytest.approx(2, rel=1e-12)
    assert margins.phase_crossovers[0, 0] == pytest.approx(math.sqrt(3), rel=1e-12)


def test_algebra_is_that_of_values():
    a, b = Model("(s^0.5 + 2)/(s + 1)"), Model("exp(-L s)/(s^1.2 + 3)", L=0.0)
    s = np.array([0.2 + 1j, 3 - 0.5j, 0.1j])
    for combined, expected in (
        (a + b, a(s) + b(s)),
        (a - b, a(s) - b(s)),
        (a * b, a(s) * b(s)),
        (a / b, a(s) / b(s)),
        (2 - a, 2 - a(s)),
        (3 / a, 3 / a(s)),
        (-a, -a(s)),
        (a.feedback(b), a(s) / (1 + a(s) * b(s))),
        (a.feedback(0.5, sign=1), a(s) / (1 - 0.5 * a(s))),
    ):
        assert np.max(np.abs(combined(s) / expected - 1)) < 1e-13
    assert (np.float64(2) * a)(1j) == (a * 2)(1j)
    with pytest.raises(TypeError):
        a + "text"


@pytest.mark.filterwarnings("ignore:Badly conditioned")  # of scipy's way from a state space to polynomials
def test_realisation_keeps_its_tolerance_in_scipy():
    small = Model(FRACTIONAL).realise((0.1, 10), 1e-3)
    omega = np.logspace(-1, 1, 50)
    _, response = signal.freqresp(signal.StateSpace(*small.ss), omega)
    exact = Model(FRACTIONAL).frequency_response(omega).response
    assert small.usable
    assert np.max(np.abs(response / exact - 1)) < 1.01e-3


def test_approximation_keeps_its_tolerance_in_scipy():
    half = fracfit.approximate(-1.3, (0.01, 100), tolerance=1e-2)
    omega = np.logspace(-2, 2, 50)
    _, response = signal.freqs_zpk(*half.zpk, omega)
    assert half.usable
    assert np.max(np.abs(response / (1j * omega) ** -1.3 - 1)) < 1.01e-2


def test_bits_of_the_command_line():
    omega = [0.1, 0.7, 1.0, 3.3, 40.0]
    found = command_line.columns_of("evaluate", FRACTIONAL, "--omega", ",".join(map(repr, omega)))
    response = Model(FRACTIONAL).frequency_response(omega).response
    assert found["re"] == response.real.tolist()
    assert found["im"] == response.imag.tolist()

    found = command_line.columns_of("respond", FRACTIONAL, "--time", "0:30:301")
    assert found["output"] == Model(FRACTIONAL).step(np.array(found["time_s"])).output.tolist()

    found = command_line.json_of("analyse", "2/(s (s + 1)^2)")
    margins = Model("2/(s (s + 1)^2)").margins()
    assert found["margins"]["phase_margin_rad"] == margins.phase_margin
    assert found["margins"]["delay_margin_s"] == margins.delay_margin

    for z in (-3 + 0j, 0.5 - 1.25j):
        text = command_line.run("mittag-leffler", "--alpha", 1.5, "--beta", 2, "--z", f"{z.real},{z.imag}")
        real, imaginary = map(float, text.split(","))
        assert fracfit.mittag_leffler(1.5, 2, z) == complex(real, imaginary)


def test_mittag_leffler_in_closed_forms():
    z = np.linspace(-5, 2, 40)
    # At (1/2, 1) it is exp(z^2) erfc(-z); the documented error is 1e-14 (1 + |E|) max(1, |z E'/E|).
    expected = special.erfcx(-z)
    slope = np.abs(z * (2 * z + 2 / (np.sqrt(np.pi) * expected)))
    assert np.all(np.abs(fracfit.mittag_leffler(0.5, 1, z) - expected) < 2e-14 * (1 + expected) * np.maximum(1, slope))
    alpha = np.array([[1.0], [2.0]])
    grid = fracfit.mittag_leffler(alpha, 1, -z[z < 0])
    assert grid.shape == (2, np.sum(z < 0))
    assert np.allclose(grid[0], np.exp(-z[z < 0]), rtol=1e-12)
    assert np.allclose(grid[1], np.cosh(np.sqrt(-z[z < 0])), rtol=1e-12)
    assert fracfit.mittag_leffler(1, 1, 0.5, derivative=True) == pytest.approx(math.exp(0.5), rel=1e-12)
    assert fracfit.mittag_leffler(1, 1, []).shape == (0,)


def test_derivative_of_a_power():
    # Half-order derivative of t is 2 sqrt(t/pi), the sum being of first order in the step.
    step = 1e-4
    time = step * np.arange(10_001)
    found = fracfit.derivative(time, 0.5, step)
    assert found[-1] == pytest.approx(2 / math.sqrt(math.pi), rel=1e-4)


def test_controller_is_its_transfer_function_in_the_loop():
    pid = fracfit.FractionalPid(2, 3, lambda_=0.8, sample_time=1e-3, band=(0.1, 300))
    omega = np.logspace(0, 2, 20)
    exact = Model("2 + 3/s^0.8").frequency_response(omega).response
    assert np.max(np.abs(pid.frequency_response(omega).response / exact - 1)) <= pid.error
    assert pid.error < 2e-3

    measured = np.random.default_rng(4).normal(size=500)
    one_by_one = [copy.copy(pid).step(1.0, float(measured[0]))]
    outputs = pid.run(1.0, measured)
    assert outputs[0] == one_by_one[0]
    pid.reset()
    assert [pid.step(1.0, float(y)) for y in measured] == outputs.tolist()

    header = command_line.run("controller", "--kp", 2, "--ki", 3, "--lambda", 0.8, "--sample-time", 1e-3, "--band", "0.1:300", "--format", "c")
    ours = pid.c_header()
    numbers = lambda text: [line for line in text.splitlines() if line.lstrip().startswith(("0x", "{", "-0x"))]
    assert numbers(ours) == numbers(header)


def test_controller_refuses_what_it_cannot_be():
    with pytest.raises(ValueError, match="band"):
        fracfit.FractionalPid(1, 1, lambda_=0.5, sample_time=1e-3)
    with pytest.raises(TypeError):
        fracfit.FractionalPid(1)
    pid = fracfit.FractionalPid(1, sample_time=1.0)
    pid.step(float("nan"), 0)
    assert pid.bad_input
    with pytest.raises(ValueError, match="setpoint holds text"):
        pid.step("a", 0)
    with pytest.raises(ValueError, match=r"setpoint has the shape \(3,\)"):
        pid.step(np.ones(3), 0)
    with pytest.raises(ValueError, match="poles is 2.5; expected a whole number"):
        fracfit.FractionalPid(1, 1, lambda_=0.5, sample_time=1e-3, band=(1, 100), poles=2.5)


def test_a_controller_pickles_in_the_middle_of_its_motion():
    pid = fracfit.FractionalPid(2, 3, 0.1, lambda_=0.8, mu=0.6, sample_time=1e-3, band=(0.1, 300), maximum=1.5)
    measured = np.random.default_rng(5).normal(size=200)
    pid.run(1.0, measured[:100])
    again = pickle.loads(pickle.dumps(pid))
    assert again.output == pid.output
    assert again.run(1.0, measured[100:]).tolist() == pid.run(1.0, measured[100:]).tolist()
    state = pid.__getstate__()
    with pytest.raises(ValueError, match="the pickle is of"):
        again.__setstate__({**state, "version": "0"})
    with pytest.raises(ValueError, match="the pickle is of"):
        again.__setstate__({**state, "state": b""})


def test_errors_are_our_sentences():
    with pytest.raises(ValueError, match=r"\^"):
        Model("1/(s +")
    with pytest.raises(ValueError, match="no parameter Q"):
        Model("K/s", Q=1)
    with pytest.raises(ValueError, match="no value for T, a"):
        Model("K/(T s^a + 1)", K=1)(1j)
    with pytest.raises(ValueError, match="omega"):
        Model("1/s").frequency_response([0.0])
    with pytest.raises(ValueError, match="method"):
        Model("1/s").step([0, 1], method="guess")
    with pytest.raises(ValueError, match="needs band"):
        Model("1/s^0.5").frequency_response([1.0], realisation={"name": "ladder"})


def test_models_and_results_pickle():
    model = Model("K/(T s^a + 1)", K=2, T=0.3, a=0.7)
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        assert pickle.loads(pickle.dumps(model, protocol)) == model
    for result in (model.step([0, 1.0]), model.margins(), model.stability(), model.realise((0.1, 10)), fracfit.approximate(0.5, (0.1, 10), poles=3)):
        again = pickle.loads(pickle.dumps(result))
        assert again == result
        assert repr(again) == repr(result)
        assert "<table>" in result._repr_html_()
    product = model * Model("1/s^0.3")
    assert np.array_equal(pickle.loads(pickle.dumps(product))(np.array([1j, 2j])), product(np.array([1j, 2j])))


def test_core_needs_no_solver():
    import subprocess
    import sys

    code = "import fracfit, sys; fracfit.Model('1/s')(1j); assert 'fracfit._fitting' not in sys.modules and 'fracfit._files' not in sys.modules; print([l.split()[-1] for l in open('/proc/self/maps') if 'ceres' in l or 'nlopt' in l])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == "[]"


def test_a_closed_loop_with_dead_time_is_told_stable_or_not():
    # The first root of 1 + K exp(-T s)/s^a on the axis: K T^a = (pi (1 - a/2))^a.
    for order, dead_time in ((1, 1.0), (0.5, 0.3)):
        limit = (np.pi * (1 - order / 2) / dead_time) ** order
        plant = fracfit.Model(f"exp(-{dead_time} s)/s^{order}")
        for gain, stable in ((0.999 * limit, True), (1.001 * limit, False)):
            assert (gain * plant).feedback().is_stable() is stable
            assert plant.feedback(gain).is_stable() is stable
    with pytest.raises(ValueError, match="infinitely many poles; is_stable"):
        plant.feedback().poles()
    # What stands in front of the loop stays.
    assert not (fracfit.Model("1/(s - 1)") * fracfit.Model("exp(-s)/(s + 2)").feedback()).is_stable()
