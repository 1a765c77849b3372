# SPDX-License-Identifier: BSD-3-Clause
"""Every option of a computing command has a word in Python, or stands here with the reason why it has none."""

import inspect
import re

import pytest

import command_line
from command_line import FUNCTIONS

# Of the program, whatever it computes.
OF_PROGRAMS = {
    "help": "help()",
    "format": "attributes, to_csv, to_dataframe",
    "out": "to_csv",
    "quiet": "warnings.filterwarnings",
    "time-limit": "Ctrl-C and the caller's own clock",
    "threads": "where the function is faster with several it has the argument",
    "shard": "a job of its own",
    "picture": "plot()",
    "pictures": "plot()",
}
# What a file does not tell of itself is told to `read`, and points are chosen by `where`.
OF_FILES = {"columns", "frequency-unit", "select", "where", "by"}
# Words of a rotating drive.
OF_DRIVES = {"inertia1", "inertia2", "gear-ratio", "gap-degrees", "torque", "torque-limit", "load-torque", "step-degrees", "friction-torque1", "friction-torque2"}
REALISATION = dict.fromkeys(("band", "poles", "sample-time", "memory"), "realisation={...}")
RECORD = dict.fromkeys(("hold", "input-at-rest"), "TimeSeries")
QUANTITY = {"quantity": "FrequencyResponse.minus_inverse"}
PAIR = dict.fromkeys(("contact-frequency", "contact-ratio", "contact-restitution"), "contact_of_frequency")
CONTROLLER = dict.fromkeys(
    ("kp", "ki", "kd", "lambda", "mu", "model", "poles", "min", "max", "swing", "sample-count", "derivative-filter", "anti-windup", "discretisation")
    + ("cascade", "derivative-setpoint-weight", "setpoint-weight", "tracking-time"),
    "FractionalPid, which is the source",
)

# The same under another word: a name that Python reserves, a spelled-out one, or the first argument.
RENAMED = {
    "controller": {"derivative-filter": "derivative_filter_time", "lambda": "lambda_", "max": "maximum", "min": "minimum", "swing": "most_swing"},
    "fit": {"fix": "fixed", "bound": "bounds"},
    "identify": {"bound": "bounds"},
    "identify-scene": {"fix": "fixed", "bound": "bounds", "harmonic-orders": "harmonic"},
    "joint-fit": {"fix": "fixed", "bound": "bounds"},
    "limit-cycles": {"omega": "band"},
    "map": {"orbit-tolerance": "tolerance"},
    "orbits": {"from": "start", "to": "stop"},
    "simulate": {"orbit-tolerance": "tolerance"},
    "tune": {"derivative-filter": "derivative_filter_time", "lambda": "lambda_", "model": "plant", "fit": "plant", "step": "load_step"},
}
# What has a place of its own in Python.
ELSEWHERE = {
    "basins": PAIR,
    "controller": {"cascade": "kp, ki, kd and setpoint_weight", "model": "Model.realise", "sample-count": "FractionalPid", "name": "FractionalPid.c_header", "precision": "FractionalPid.c_header"},
    "drt": {"fit": "the data, which may be a FitResult"},
    "export arduino": CONTROLLER,
    "export c99": CONTROLLER,
    "export fmu": CONTROLLER,
    "fit": {**REALISATION, **RECORD, **QUANTITY, "profile": "FitResult.profile", "bootstrap": "FitResult.bootstrap", "refits": "FitResult.bootstrap"},
    "history": PAIR,
    "identify": {**REALISATION, **RECORD, **QUANTITY, **dict.fromkeys(("force", "clearance", "mass1", "mass2"), "curves={...} of static_describing_function")},
    "identify-scene": {"compare": "identify", "print": "attributes"},
    "joint-fit": {**REALISATION, **RECORD, **QUANTITY, "master": "JointFit.master_curve"},
    "jump-law": PAIR,
    "limit-cycles": {**PAIR, "over": "a loop over calls"},
    "loop": {**PAIR, "setpoint-file": "setpoint, which may be arrays"},
    "map": {**PAIR, **QUANTITY},
    "multisine": {"name": "a name for the exported C text", **dict.fromkeys(("next-measurement", "total-time", "settling"), "stepped_sine_plan")},
    "orbits": PAIR,
    "realise": {"model": "Model", "form": "the modal one; scipy.signal has others"},
    "respond": {"model": "Model", "feedback": "Model.feedback", "omega": "Model.sine"},
    "simulate": {**PAIR, **QUANTITY, "motion": "static_describing_function", "print": "the numbers that are given", "diagnostics": "attributes of the curve"},
    "tune": PAIR,
    "validate": {"all-points": "all are judged"},
}
# What Python has no word for yet.
MISSING: dict[str, set[str]] = {}


def options_of(name):
    return set(re.findall(r"^  (?:-\w,)?--([a-z0-9-]+)", command_line.run("help", *name.split()), flags=re.M)) - {"help"}


def words_of(name):
    return set(inspect.signature(command_line.function(FUNCTIONS[name])).parameters)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_option_has_its_place(name):
    options, words = options_of(name), words_of(name)
    assert len(options) > 1
    renamed, elsewhere, missing = RENAMED.get(name, {}), ELSEWHERE.get(name, {}), MISSING.get(name, set())
    named = {option for option in options if option.replace("-", "_") in words}
    placed = named | set(OF_PROGRAMS) | OF_FILES | OF_DRIVES | set(renamed) | set(elsewhere) | missing
    assert not options - placed, f"options without a word in Python: {sorted(options - placed)}"
    # The lists stay true: no entry for an option that is none, or that has its word.
    own = (set(elsewhere) if elsewhere is not CONTROLLER else set()) | missing
    assert not own - options, f"no options of {name}: {sorted(own - options)}"
    assert not missing & named, f"no longer missing: {sorted(missing & named)}"
    assert not set(renamed.values()) - words, f"no arguments of {FUNCTIONS[name]}: {sorted(set(renamed.values()) - words)}"
