# SPDX-License-Identifier: BSD-3-Clause
"""What was probably meant by a name that there is not."""

from __future__ import annotations

import functools
from typing import Any, Callable, Iterable, TypeVar

F = TypeVar("F", bound=Callable[..., Any])

# What other packages, textbooks and the command line call it.
_SYNONYMS = {
    "frequency": ("f", "omega"),
    "frequencies": ("f", "omega"),
    "freq": ("f", "omega"),
    "freqs": ("f", "omega"),
    "hz": ("f",),
    "w": ("omega",),
    "z": ("response",),
    "impedance": ("response",),
    "values": ("response", "parameters"),
    "value": ("response", "parameters"),
    "data": ("response",),
    "mag": ("magnitude",),
    "abs": ("magnitude",),
    "angle": ("phase",),
    "params": ("parameters",),
    "popt": ("parameters",),
    "x": ("parameters",),
    "best_values": ("parameters",),
    "pcov": ("covariance",),
    "cov": ("covariance",),
    "covar": ("covariance",),
    "errors": ("standard_errors",),
    "stderr": ("standard_errors",),
    "std": ("standard_errors", "sigma"),
    "uncertainty": ("standard_errors", "sigma"),
    "conf": ("ci95",),
    "confidence": ("ci95",),
    "conf_int": ("ci95",),
    "aic": ("aicc",),
    "success": ("usable",),
    "converged": ("usable",),
    "chi2": ("cost",),
    "chisqr": ("cost",),
    "best_fit": ("predict",),
    "eval": ("predict", "frequency_response"),
    "evaluate": ("predict", "frequency_response"),
    "freqresp": ("frequency_response",),
    "bode": ("frequency_response", "plot"),
    "nyquist": ("plot",),
    "params0": ("start",),
    "p0": ("start",),
    "x0": ("start",),
    "guess": ("start",),
    "initial": ("start",),
    "initial_guess": ("start",),
    "init": ("start",),
    "limits": ("bounds",),
    "constraints": ("constraint", "bounds"),
    "constants": ("fixed",),
    "weights": ("weight",),
    "weighting": ("weight",),
    "weight_by_modulus": ("weight",),
    "part": ("component",),
    "random_state": ("seed",),
    "n_jobs": ("threads",),
    "workers": ("threads",),
    "num_threads": ("threads",),
    "duration": ("periods",),
    "cycles": ("periods",),
    "tspan": ("time",),
    "m1": ("mass1",),
    "m2": ("mass2",),
    "gap": ("clearance",),
    "backlash": ("clearance",),
    "delta": ("clearance",),
    "e": ("restitution",),
    "eps": ("restitution",),
    "epsilon": ("restitution",),
    "amplitude": ("force",),
    "f": ("omega", "force"),
    "output": ("body", "response"),
    "lam": ("lambda_",),
    "lmbda": ("lambda_",),
    "dt": ("sample_time",),
    "ts": ("sample_time",),
    "sampling_time": ("sample_time",),
    "wc": ("crossover",),
    "pm": ("phase_margin",),
    "ax": ("ax",),
    "axis": ("ax",),
    "axes": ("ax",),
    "n": ("samples", "poles"),
    "order": ("poles", "order"),
    "load": ("read",),
    "open": ("read",),
    "read_csv": ("read",),
    "transferfunction": ("Model",),
    "tf": ("Model",),
    "fotf": ("Model",),
    "zpk": ("Model",),
    "impedance_data": ("FrequencyResponse",),
    "pid": ("FractionalPid",),
    "simulate": ("describing_function", "respond"),
    "map": ("regime_map",),
    "kramers_kronig": ("validate",),
    "linkk": ("validate",),
    "lin_kk": ("validate",),
    "validity": ("validate",),
    "lsim": ("respond",),
    "minimize": ("minimise",),
    "analyse": ("stability",),
}


def meant(name: str, known: Iterable[str]) -> str:
    """ "; did you mean ..." where one of the known names is near, else empty."""
    names = [each for each in known if not each.startswith("_")]
    for each in _SYNONYMS.get(name.lower(), ()):
        if each in names:
            return f"; did you mean {each}?"
    import difflib

    lowered = {each.lower().replace("_", ""): each for each in names}
    near = difflib.get_close_matches(name.lower().replace("_", ""), lowered, 1, 0.7)
    return f"; did you mean {lowered[near[0]]}?" if near else ""


def no_attribute(thing: Any, name: str, known: Iterable[str] = ()) -> AttributeError:
    """What a missing attribute raises."""
    suggestion = "" if name.startswith("_") else meant(name, [*dir(type(thing)), *known])
    return AttributeError(f"a {type(thing).__name__} has no attribute {name!r}{suggestion}")


def named(function: F) -> F:
    """A function that says which of its arguments was meant by one that it has not."""
    code = function.__code__
    has_others = code.co_flags & 0x08  # **options
    names = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
    if has_others:
        return function
    known = frozenset(names)

    @functools.wraps(function)
    def checked(*arguments: Any, **by_name: Any) -> Any:
        if not known.issuperset(by_name):
            wrong = next(name for name in by_name if name not in known)
            raise TypeError(f"{function.__qualname__.removesuffix('.__init__')}() has no argument {wrong!r}{meant(wrong, [each for each in names if each != 'self'])}")
        return function(*arguments, **by_name)

    checked.__kwdefaults__ = function.__kwdefaults__
    return checked  # type: ignore[return-value]
