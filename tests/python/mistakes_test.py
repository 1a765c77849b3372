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
