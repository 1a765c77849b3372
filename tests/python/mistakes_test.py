# SPDX-License-Identifier: BSD-3-Clause
"""What people get wrong at first: each is answered by one sentence that holds the right word.

The list was written from how people use the neighbours of this module (impedance.py, lmfit, scipy.optimize, python-control), before
the sentences.
"""

import math

import numpy as np
import pytest

import fracfit
from fracfit import FractionalPid, FrequencyResponse, Model, TimeSeries

F = np.logspace(-1, 3, 25)
Z = 10 + 50 / (1 + (2j * np.pi * F * 0.01) ** 0.8)
DATA = FrequencyResponse.from_hz(F, Z, unit="ohm")
LAG = "K/(T s^a + 1)"
RESULT = fracfit.fit(DATA, LAG)
TIME = np.linspace(0, 3, 20)
RECORD = TimeSeries(TIME, np.ones(20), 2 - 2 * np.exp(-2 * TIME))
OMEGA = np.linspace(15, 35, 5)
PLANT = Model("1/(s^1.5 + s)")

# name: (what is called, words that the sentence must hold)
MISTAKES = {
    "the name of a file in place of data": (lambda: fracfit.fit("cell.csv", "zarc"), ["fracfit.read("]),
    "values without frequencies": (lambda: fracfit.fit(Z, "zarc"), ["frequencies"]),
    "a pair in place of two arguments": (lambda: fracfit.fit((F, Z), "zarc"), ["two arguments"]),
    "real values": (lambda: fracfit.fit(F, Z.real, "zarc"), ["complex"]),
    "one value too few": (lambda: fracfit.fit(F, Z[:-1], "zarc"), ["25", "24"]),
    "frequencies and values the other way round": (lambda: fracfit.fit(Z, F, "zarc"), ["f", "real"]),
    "no model": (lambda: fracfit.fit(DATA), ["model", "presets()"]),
    "a preset misspelt": (lambda: fracfit.fit(DATA, "zark"), ["zarc"]),
    "an underscore in a preset": (lambda: fracfit.fit(DATA, "two_zarc"), ["two-zarc"]),
    "a capital in a preset": (lambda: fracfit.fit(DATA, "Two-ZARC"), ["two-zarc"]),
    "an option misspelt": (lambda: fracfit.fit(DATA, LAG, bouds={"K": (0, 1)}), ["bounds"]),
    "a word for a switch of a fit": (lambda: fracfit.fit(DATA, LAG, passive="no"), ["passive", "True or False"]),
    "a word for a switch": (lambda: fracfit.tune(PLANT, crossover=1, phase_margin=1, flat_phase="no"), ["flat_phase", "True or False"]),
    "p0 as in scipy": (lambda: fracfit.fit(DATA, LAG, p0=[1, 1, 1]), ["start"]),
    "initial_guess as in impedance.py": (lambda: fracfit.fit(DATA, LAG, initial_guess=[1, 1, 1]), ["start"]),
    "weight_by_modulus as in impedance.py": (lambda: fracfit.fit(DATA, LAG, weight_by_modulus=True), ["weight"]),
    "starts as a list": (lambda: fracfit.fit(DATA, LAG, start=[1, 1, 1]), ["start", "by name"]),
    "a weight of another package": (lambda: fracfit.fit(DATA, LAG, weight="modulus"), ["relative"]),
    "a parameter that the model has not": (lambda: fracfit.fit(DATA, LAG, fixed={"R": 1}), ["R", "K, T, a"]),
    "one number for limits": (lambda: fracfit.fit(DATA, LAG, bounds={"K": 5}), ["(lower, upper)"]),
    "limits the other way round": (lambda: fracfit.fit(DATA, LAG, bounds={"K": (5, 0)}), ["K", "5", "0"]),
    "a start outside of the limits": (lambda: fracfit.fit(DATA, LAG, bounds={"K": (0, 1)}, start={"K": 100}), ["K", "100"]),
    "a word for a number": (lambda: fracfit.fit(DATA, LAG, start={"K": "big"}), ["start K", "number"]),
    "the model of scipy.signal in a fit": (lambda: fracfit.fit(DATA, object()), ["Model", "formula"]),
    "too few points": (lambda: fracfit.fit(DATA[:2], "two-zarc"), ["7 free parameters"]),
    "the component of a record": (lambda: fracfit.fit(RECORD, LAG, component="real"), ["component", "over time"]),
    "a parameter in lower case": (lambda: RESULT["k"], ["K, T, a"]),
    "params as in lmfit": (lambda: RESULT.params, ["parameters"]),
    "stderr as in lmfit": (lambda: RESULT.stderr, ["standard_errors"]),
    "aic": (lambda: RESULT.aic, ["aicc"]),
    "an unknown picture": (lambda: RESULT.plot(kind="nyquest"), ["nyquist"]),
    "the frequency of data": (lambda: DATA.frequency, ["did you mean f?"]),
    "Z of data": (lambda: DATA.Z, ["response"]),
    "a column of data": (lambda: DATA["omega"], ["slice"]),
    "a point beyond the last": (lambda: DATA[1000], ["25 points"]),
    "powers as in Python": (lambda: Model("K/(T s**a + 1)"), ["^"]),
    "a parenthesis too few": (lambda: Model("K/(T s^a + 1"), ["parenthesis"]),
    "a parameter of a model in lower case": (lambda: Model(LAG, k=2), ["K, T, a"]),
    "a step without values": (lambda: Model(LAG).step([0, 1]), ["K, T, a"]),
    "frequency 0": (lambda: Model("1/(s + 1)").frequency_response([0, 1]), ["omega", "0"]),
    "a fractional model for python-control": (lambda: Model("1/(s^0.5 + 1)").control(), ["realise"]),
    "a number for a formula": (lambda: Model(3), ["text"]),
    "two lengths": (lambda: FrequencyResponse([1, 2], [1]), ["2", "1"]),
    "a NaN in the values": (lambda: FrequencyResponse([1, 2], [1, math.nan]), ["finite"]),
    "a file that is not there": (lambda: fracfit.read("nofile.csv"), ["nofile.csv"]),
    "load in place of read": (lambda: fracfit.load, ["read"]),
    "a function misspelt": (lambda: fracfit.identfy, ["identify"]),
    "e for the restitution": (lambda: fracfit.describing_function(OMEGA, e=0.6), ["restitution"]),
    "gap for the clearance": (lambda: fracfit.describing_function(OMEGA, restitution=0.6, gap=1), ["clearance"]),
    "a restitution in percent": (lambda: fracfit.describing_function(OMEGA, restitution=60), ["restitution", "60", "1"]),
    "falling frequencies": (lambda: fracfit.describing_function(OMEGA[::-1], restitution=0.6), ["omega"]),
    "no restitution": (lambda: fracfit.describing_function(OMEGA), ["restitution"]),
    "nothing to tune for": (lambda: fracfit.tune(PLANT), ["crossover"]),
    "data in place of a plant": (lambda: fracfit.tune(DATA, crossover=1.0), ["fit"]),
    "a phase margin in degrees": (lambda: fracfit.tune(PLANT, crossover=1.0, phase_margin=60), ["rad"]),
    "a fractional PID without a band": (lambda: FractionalPid(ki=1, lambda_=0.5, sample_time=0.01), ["band"]),
    "a PID without a sample time": (lambda: FractionalPid(1, 1), ["sample_time"]),
    "Ts for the sample time": (lambda: FractionalPid(1, 1, Ts=0.1), ["sample_time"]),
    "a model drawn without frequencies": (lambda: fracfit.plot_bode(PLANT), ["omega"]),
    "one response for many": (lambda: fracfit.batch(DATA, LAG), ["sequence"]),
    "an option of a batch misspelt": (lambda: fracfit.batch([DATA], LAG, wieght="relative"), ["weight"]),
    "nothing shared": (lambda: fracfit.joint_fit([DATA, DATA], LAG), ["shared"]),
    "times that fall": (lambda: TimeSeries([0, 2, 1], [1, 1, 1], [0, 1, 2]), ["time"]),
    "the name of a file for its validity": (lambda: fracfit.validate("cell.csv"), ["fracfit.read("]),
    "a record without its output": (lambda: fracfit.response(TIME, np.sin(TIME)), ["output"]),
    "times that are not equal steps": (lambda: fracfit.response(TIME**2, np.sin(TIME), np.cos(TIME)), ["equal steps"]),
    "no times of a record": (lambda: fracfit.response(input=np.sin(TIME), output=np.cos(TIME)), ["sample_time"]),
    "dt for the sample time": (lambda: fracfit.response(input=np.sin(TIME), output=np.cos(TIME), dt=0.1), ["sample_time"]),
    "a period that is not whole samples": (lambda: fracfit.multisine((1, 2), period=10.03, sample_time=0.1), ["period", "whole number"]),
    "times of data": (lambda: fracfit.drt(DATA, tau=[1, 2, 3]), ["tau", "fits and models"]),
    "an unknown circuit": (lambda: fracfit.export_spice("1/s^0.5", kind="resistor", band=(1, 10)), ["impedance"]),
    "an unknown part": (lambda: fracfit.fit(DATA, LAG, component="imag"), ["imaginary"]),
    "prediction by text": (lambda: RESULT.predict("10"), ["omega"]),
    "columns of a matrix": (lambda: fracfit.fit(F.reshape(-1, 1), Z.reshape(-1, 1), "zarc"), ["f", "one dimension", "ravel()"]),
    "parts as rows of a matrix": (lambda: fracfit.fit(F, np.array([Z.real, Z.imag]), "zarc"), ["Z", "(2, 25)", "one dimension"]),
    "pairs for complex values": (lambda: fracfit.fit(F, [(z.real, z.imag) for z in Z], "zarc"), ["Z", "one dimension"]),
    "frequencies as texts": (lambda: fracfit.fit([str(f) for f in F], Z, "zarc"), ["f holds text", "real numbers"]),
    "values as texts": (lambda: fracfit.fit(F, [str(z) for z in Z], "zarc"), ["Z holds text", "complex numbers"]),
    "a NaN among the frequencies": (lambda: fracfit.fit(np.r_[F[:-1], math.nan], Z, "zarc"), ["omega[24]", "finite"]),
    "both sides of a spectrum": (lambda: fracfit.fit(np.fft.fftfreq(25), Z, "zarc"), ["omega[0]", "positive"]),
    "the mean of a spectrum": (lambda: fracfit.fit(np.r_[0.0, F[1:]], Z, "zarc"), ["omega[0] = 0", "positive"]),
    "no data": (lambda: fracfit.fit([], [], "zarc"), ["empty"]),
    "one sigma for all": (lambda: FrequencyResponse(F, Z, 0.1), ["25 values", "1 sigmas"]),
    "a complex sigma": (lambda: FrequencyResponse(F, Z, Z), ["sigma", "real"]),
    "a table without a frequency": (lambda: fracfit.fit({"a": F, "b": Z.real, "c": Z.imag}, "zarc"), ["no frequency column", "a, b, c", "f_Hz"]),
    "models as a list": (lambda: fracfit.fit(DATA, ["zarc"]), ["list", "model"]),
    "a preset with a blank": (lambda: fracfit.fit(DATA, "two zarc"), ["two-zarc"]),
    "a blank behind a preset": (lambda: fracfit.fit(DATA, "zarc "), ["zarc"]),
    "a circuit of impedance.py": (lambda: fracfit.fit(DATA, "R0-p(R1,C1)"), ["formula of s", "R0 + R1/(1 + R1 C1 s)"]),
    "an empty model": (lambda: fracfit.fit(DATA, ""), ["empty"]),
    "j omega in a model": (lambda: fracfit.fit(DATA, "K/(1 + jw T)"), ["s"]),
    "a decimal comma": (lambda: Model("1/(0,5 s + 1)"), ["point"]),
    "an equation": (lambda: Model("G = 1/(s + 1)"), ["right-hand side"]),
    "weights of points": (lambda: fracfit.fit(DATA, LAG, weight=np.ones(25)), ["weight", "ndarray", "text"]),
    "sigma as the weight": (lambda: fracfit.fit(DATA, LAG, weight="sigma"), ["given"]),
    "the weight given without sigma": (lambda: fracfit.fit(DATA, LAG, weight="given"), ["standard deviation"]),
    "bounds as in scipy": (lambda: fracfit.fit(DATA, LAG, bounds=([0, 0, 0], [1, 1, 1])), ["bounds", "by name"]),
    "three limits": (lambda: fracfit.fit(DATA, LAG, bounds={"K": (0, 1, 2)}), ["(lower, upper)"]),
    "fixed by name alone": (lambda: fracfit.fit(DATA, LAG, fixed=["K"]), ["NAME=VALUE"]),
    "a complex start": (lambda: fracfit.fit(DATA, LAG, start={"K": 1 + 1j}), ["start K", "real"]),
    "a seed of numpy": (lambda: fracfit.fit(DATA, LAG, seed=None), ["seed", "whole number"]),
    "the loss of scipy": (lambda: fracfit.fit(DATA, LAG, loss="soft_l1"), ["huber"]),
    "a prior without its error": (lambda: fracfit.fit(DATA, LAG, prior={"K": 3}), ["(value, deviation)"]),
    "an order the other way round": (lambda: fracfit.fit(DATA, LAG, constraint="K>T"), ["<"]),
    "a quantity without a name": (lambda: fracfit.fit(DATA, LAG, derive="K*T"), ["NAME = FORMULA"]),
    "the profile of what is no parameter": (lambda: RESULT.profile("k"), ["k", "K, T, a"]),
    "two parameters at once": (lambda: RESULT["K", "T"], ["K, T, a"]),
    "a condition on a word of others": (lambda: DATA.where("freq > 1"), ["omega or f"]),
    "a condition with a comparison of its own": (lambda: DATA.where("f >> 1"), ["condition 'f>>1'", ">>", "im<0"]),
    "a realisation by its name alone": (lambda: PLANT.frequency_response(OMEGA, realisation="oustaloup"), ["realisation", "by name"]),
    "an order of a realisation": (lambda: PLANT.frequency_response(OMEGA, realisation={"name": "oustaloup", "order": 5}), ["order", "poles"]),
    "times and input the other way round": (lambda: PLANT.respond(np.sin(TIME), TIME), ["time", "after"]),
    "a hold of python-control": (lambda: PLANT.respond(TIME, TIME, hold="zoh"), ["zero-order"]),
    "a Mittag-Leffler function of texts": (lambda: fracfit.mittag_leffler("0.5", 1, 1.0), ["alpha", "real"]),
    "shapes that do not go together": (lambda: fracfit.mittag_leffler([0.5, 0.6], 1, [1.0, 2.0, 3.0]), ["alpha (2,)", "z (3,)"]),
    "scenes that do not go together": (lambda: fracfit.describing_function(OMEGA, restitution=[0.6, 0.7], force=[1, 2, 3]), ["restitution (2,)", "force (3,)"]),
    "times for a sample time": (lambda: fracfit.derivative([1, 2], 0.5, [0, 1]), ["sample_time", "one number"]),
    "a NaN among samples": (lambda: fracfit.derivative([1, math.nan], 0.5, 1.0), ["samples[1]", "finite"]),
    "a band as one number": (lambda: fracfit.approximate(0.5, 10, tolerance=1e-3), ["band", "two numbers"]),
    "N for the poles": (lambda: fracfit.approximate(0.5, (1, 10), N=5), ["poles"]),
    "Kp for kp": (lambda: FractionalPid(Kp=1, sample_time=1), ["kp"]),
    "a force as text": (lambda: fracfit.describing_function(OMEGA, restitution=0.6, force="40"), ["force", "real"]),
    "the load for its position": (lambda: fracfit.describing_function(OMEGA, restitution=0.6, body="load"), ["body", "x1"]),
    "no mass": (lambda: fracfit.describing_function(OMEGA, restitution=0.6, mass1=0), ["mass1", "positive"]),
    "a start beyond the walls": (lambda: fracfit.history(20, restitution=0.6, position=5), ["position", "clearance"]),
    "a duration in seconds": (lambda: fracfit.history(20, restitution=0.6, duration=5), ["periods"]),
    "half a period": (lambda: fracfit.history(20, restitution=0.6, periods=2.5), ["periods", "whole"]),
    "a range the other way round": (lambda: fracfit.orbits(2.5, 1.9, restitution=0.6), ["start", "less than stop"]),
    "an unknown parameter of orbits": (lambda: fracfit.orbits(1.9, 2.5, parameter="freq", restitution=0.6), ["parameter", "omega"]),
    "a controller with names": (lambda: fracfit.limit_cycles("k + s^0.5", restitution=0.6), ["k"]),
    "a set-point as one number": (lambda: fracfit.loop("1 + s", restitution=0.6, setpoint=1.0), ["setpoint", "instants"]),
    "wc for the crossover": (lambda: fracfit.tune(PLANT, wc=1.0), ["crossover"]),
    "PID in capitals": (lambda: fracfit.tune(PLANT, crossover=1.0, structure="PID"), ["pid"]),
    "a plant without values": (lambda: fracfit.tune(LAG, crossover=1.0), ["K, T, a", "fit"]),
    "an impedance for a scene": (lambda: fracfit.identify_scene([DATA], 10), ["curves[0]", "ohm", "m/N"]),
    "parameters separated by blanks": (lambda: fracfit.joint_fit([DATA, DATA], LAG, shared="T a"), ["T a", "K, T, a"]),
    "a folder for a file": (lambda: fracfit.read("."), ["folder", "file"]),
    "files as a list": (lambda: fracfit.read(["a.csv", "b.csv"]), ["path"]),
    "Axes that are none": (lambda: RESULT.plot(ax=3), ["ax", "matplotlib"]),
    "numbers for a curve": (lambda: fracfit.plot_bode([1, 2, 3]), ["a curve is of the type list", "FrequencyResponse"]),
    "a circuit before its fit": (lambda: fracfit.CustomCircuit("R0").predict(F), ["fit(f, Z)"]),
    "kHz": (lambda: FrequencyResponse(F, Z, frequency_unit="kHz"), ["Hz"]),
    "a band beyond half the sampling rate": (lambda: fracfit.multisine((1, 1000), period=10, sample_time=0.1), ["band", "sampling"]),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_the_sentence_has_the_right_word(name):
    call, words = MISTAKES[name]
    with pytest.raises((ValueError, TypeError, AttributeError, LookupError, RuntimeError)) as caught:
        call()
    said = str(caught.value)
    for word in words:
        assert word in said, said
    # A caret under the place stands in lines of its own; nothing else takes more than a sentence.
    assert "\n" not in said or "^" in said, said
    assert len(said) < 400, said
    assert not any(each in said for each in ("std::", "incompatible function", "Unable to cast", "NoneType", "unexpected keyword")), said
    # What is wrong is told where it was given, not from within.
    assert caught.value.__cause__ is None, repr(caught.value.__cause__)


def test_there_are_at_least_40():
    assert len(MISTAKES) >= 40
