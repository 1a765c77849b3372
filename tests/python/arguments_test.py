# SPDX-License-Identifier: BSD-3-Clause
"""Arguments that nobody means, one at a time in every place: a result or one of our sentences, never that of a library."""

import inspect
import os
import warnings

import numpy as np
import pytest

import fracfit
from fracfit import FractionalPid, FrequencyResponse, Model, TimeSeries

OMEGA = np.logspace(-1, 2, 12)
TIME = np.linspace(0, 3, 20)
LAG = Model("K/(T s + 1)", K=2, T=0.5)
DATA = LAG.frequency_response(OMEGA)
RECORD = TimeSeries(TIME, np.ones(20), 2 - 2 * np.exp(-2 * TIME))
CURVE = fracfit.describing_function([20.0, 25.0, 30.0], restitution=0.6, force=40, clearance=0.3).data()
RESULT = fracfit.fit(DATA, LAG, global_start=False)
NOISY = fracfit.fit(FrequencyResponse(OMEGA, DATA.response * np.exp(0.01j * np.arange(12) ** 2)), LAG, global_start=False, outliers="keep")
PID = FractionalPid(1, 1, sample_time=0.1)

CALLS = {
    "FrequencyResponse": (FrequencyResponse, {"omega": OMEGA, "response": np.ones(12)}),
    "from_hz": (FrequencyResponse.from_hz, {"f": OMEGA, "response": np.ones(12)}),
    "TimeSeries": (TimeSeries, {"time": TIME, "input": TIME, "output": TIME}),
    "where": (lambda condition: DATA.where(condition), {"condition": "omega > 1"}),
    "frequency_response": (LAG.frequency_response, {"omega": OMEGA}),
    "oustaloup": (lambda **choice: LAG.frequency_response(OMEGA, realisation=choice), {"name": "oustaloup", "band": (0.1, 10), "poles": 3}),
    "step": (LAG.step, {"time": TIME}),
    "sine": (LAG.sine, {"time": TIME, "omega": 1.0}),
    "respond": (LAG.respond, {"time": TIME, "input": TIME}),
    "realise": (LAG.realise, {"band": (0.1, 10.0), "tolerance": 0.1}),
    "feedback": (LAG.feedback, {}),
    "approximate": (fracfit.approximate, {"order": 0.5, "band": (0.1, 10.0), "tolerance": 0.1}),
    "mittag_leffler": (fracfit.mittag_leffler, {"alpha": 0.5, "beta": 1.0, "z": -1.0}),
    "derivative": (fracfit.derivative, {"samples": TIME, "order": 0.5, "sample_time": 0.1}),
    "FractionalPid": (FractionalPid, {"kp": 1.0, "sample_time": 0.1}),
    "pid_step": (PID.step, {"setpoint": 1.0, "measured": 0.0}),
    "pid_run": (PID.run, {"setpoint": 1.0, "measured": TIME}),
    "c_header": (PID.c_header, {}),
    "describing_function": (fracfit.describing_function, {"omega": [2.0, 3.0], "restitution": 0.5}),
    "drive": (fracfit.drive, {"inertia1": 0.2, "torque": [1.0, 2.0]}),
    "static": (fracfit.static_describing_function, {"omega": [0.5]}),
    "symmetric_loss_factor": (fracfit.symmetric_loss_factor, {"restitution": 0.5}),
    "restitution_from_loss_factor": (fracfit.restitution_from_loss_factor, {"loss_factor": 0.2}),
    "regime_map": (fracfit.regime_map, {"restitution": [0.5], "omega": [2.0, 3.0]}),
    "orbits": (fracfit.orbits, {"start": 2.4, "stop": 2.5, "restitution": 0.6}),
    "limit_cycles": (fracfit.limit_cycles, {"controller": "20 + 8 s", "restitution": 0.6, "starts": 0}),
    "jump_frequency": (fracfit.jump_frequency, {"restitution": 0.6, "criterion": "two-impact-loss"}),
    "fit": (fracfit.fit, {"data": DATA, "model": LAG, "global_start": False}),
    "fit_of_record": (fracfit.fit, {"data": RECORD, "model": LAG, "global_start": False}),
    "grow": (fracfit.fit, {"data": DATA, "grow": "rational"}),
    "batch": (fracfit.batch, {"data": [DATA], "model": LAG, "global_start": False}),
    "identify": (fracfit.identify, {"data": DATA, "models": ["lag"]}),
    "tune": (fracfit.tune, {"plant": LAG, "crossover": 1.0, "phase_margin": 1.0, "structure": "pi", "lambda_": 1.0}),
    "identify_scene": (fracfit.identify_scene, {"curves": CURVE, "force": 40.0, "fixed": {"mass1": 1.0, "mass2": 1.0, "clearance": 0.3}}),
    "validate": (fracfit.validate, {"data": DATA}),
    "drt": (fracfit.drt, {"data": RESULT, "tau": [0.1, 1.0, 10.0]}),
    "drt_of_data": (fracfit.drt, {"data": DATA}),
    "joint_fit": (fracfit.joint_fit, {"data": [DATA, DATA], "model": LAG, "shared": "T"}),
    "jump_law": (fracfit.jump_law, {"restitution": [0.5], "force": [10.0, 20.0], "clearance": [0.1, 0.2]}),
    "history": (fracfit.history, {"omega": 2.0, "restitution": 0.5, "periods": 1, "samples": 2}),
    "multisine": (fracfit.multisine, {"band": (1.0, 20.0), "period": 10.0, "sample_time": 0.1, "rounds": 3}),
    "stepped_sine_plan": (fracfit.stepped_sine_plan, {"next_measurement": (1.0, 20.0, 3), "total_time": 1000.0}),
    "response": (fracfit.response, {"data": TIME, "input": np.sin(8 * TIME), "output": np.cos(8 * TIME)}),
    "response_by_step": (fracfit.response, {"input": np.sin(8 * TIME), "output": np.cos(8 * TIME), "sample_time": 0.1, "excitation": "arbitrary"}),
    "basins": (fracfit.basins, {"omega": 2.0, "restitution": 0.5, "position": [0.5], "velocity": [0.0]}),
    "loop": (fracfit.loop, {"controller": "1 + s", "restitution": 0.5, "velocity2": 1.0, "duration": 3.0}),
    "sampled_loop": (fracfit.loop, {"controller": "1 + s", "restitution": 0.5, "duration": 0.1, "sample_time": 0.01}),
    "export_spice": (fracfit.export_spice, {"model": "1/s^0.5", "kind": "impedance", "band": (1.0, 10.0), "out": os.devnull}),
    "export_c99": (fracfit.export_c99, {"source": "1/(s + 1)", "sample_time": 0.1, "out": os.devnull}),
    "tune_for_region": (fracfit.tune, {"plant": NOISY, "crossover": 1.0, "phase_margin": 1.0, "structure": "pi", "lambda_": 1.0}),
    "band": (RESULT.band, {"omega": OMEGA}),
    "predict": (RESULT.predict, {"omega": OMEGA}),
    "profile": (RESULT.profile, {"parameter": "K"}),
    "bootstrap": (RESULT.bootstrap, {"samples": 20}),
    "derive": (RESULT.derive, {"definition": "f = 1/T"}),
}
NONSENSE = (object(), "nonsense", 3, -1, 2.5, 2**70, float("nan"), 1j, np.ones(3), np.array(["a"]), {1: 2}, {"K": object()}, [("K", 1)], b"x", None)
# What a binding says of arguments it cannot take, and what Python says of code that took them unchecked.
OF_LIBRARIES = ("Unable to cast", "incompatible function arguments", "has no attribute", "not iterable", "std::")


@pytest.mark.parametrize("name", CALLS)
def test_every_argument_is_checked(name):
    function, valid = CALLS[name]
    function(**valid)
    names = dict.fromkeys([*valid, *(each.name for each in inspect.signature(function).parameters.values() if each.kind != each.VAR_KEYWORD)])
    for argument in names:
        for value in NONSENSE:
            if argument == "out" and isinstance(value, (str, bytes, int)):
                continue  # a file, or an open one
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    function(**{**valid, argument: value})
            except (ValueError, RuntimeError) as reason:
                said = str(reason)
                assert said and not any(each in said for each in OF_LIBRARIES), f"{name}({argument}={value!r}): {said}"
