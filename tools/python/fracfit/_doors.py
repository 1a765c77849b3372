# SPDX-License-Identifier: BSD-3-Clause
"""Data and models of other packages, recognised by what they have, so that none of these packages is needed."""

from __future__ import annotations

import os
import re
from typing import Any

import numpy as np

from ._arrays import Array, complex_array, real_array
from ._data import FrequencyResponse, TimeSeries, read

_EXPECTED = (
    "a FrequencyResponse, a TimeSeries, frequencies f (Hz) and values Z as two arrays, a table with named columns (pandas, xarray) "
    "or a response of python-control"
)


def data_of(given: Any, values: Any = None, *, name: str = "data") -> FrequencyResponse | TimeSeries:
    """Data from whatever has them.

    Two arrays are frequencies in Hz and complex values.
    """
    if values is not None:
        return _of_arrays(given, values)
    if isinstance(given, (FrequencyResponse, TimeSeries)):
        return given
    if isinstance(given, (str, os.PathLike)):
        raise ValueError(f"{name} is {os.fspath(given)!r}; expected data, such as fracfit.read({os.fspath(given)!r})")
    for recognised in (_of_control, _of_data_array, _of_table):
        found = recognised(given)
        if found is not None:
            return found
    if hasattr(given, "data") and callable(given.data) and isinstance(made := given.data(), FrequencyResponse):
        return made
    hint = ""
    if isinstance(given, (tuple, list)) and len(given) == 2:
        hint = "; write the two arrays as two arguments, frequencies in Hz first, or FrequencyResponse(omega, response) for rad/s"
    elif isinstance(given, np.ndarray):
        hint = "; an array alone has no frequencies"
    are = "is" if name.startswith("a ") else "are"
    raise ValueError(f"{name} {are} of the type {type(given).__name__}; expected {_EXPECTED}{hint}")


def response_of(given: Any, values: Any = None, *, name: str = "data") -> FrequencyResponse:
    """The same where samples over time have no meaning."""
    found = data_of(given, values, name=name)
    if not isinstance(found, FrequencyResponse):
        raise ValueError(f"{name} are of the type {type(found).__name__}; expected FrequencyResponse")
    return found


def _of_arrays(f: Any, values: Any) -> FrequencyResponse:
    if isinstance(f, (FrequencyResponse, TimeSeries)):
        raise ValueError(f"the second argument is of the type {type(values).__name__}, but {type(f).__name__} has its values already; the model is expected there")
    frequencies, response = real_array(f, "f"), complex_array(values, "Z")
    if frequencies.size != response.size:
        raise ValueError(f"f has {frequencies.size} entries and Z has {response.size}; expected one value for each frequency")
    if not frequencies.size:
        raise ValueError("f and Z are empty; expected one value for each frequency")
    if not np.iscomplexobj(values):
        raise ValueError("Z is real; expected complex values, such as re + 1j*im")
    return FrequencyResponse.from_hz(frequencies, response)


def _single(array: Any, what: str) -> Array:
    values = np.asarray(array)
    if values.ndim > 1 and values.size != values.shape[-1]:
        raise ValueError(f"the {what} has the shape {values.shape}; expected one input and one output, such as response[0, 0]")
    return values.reshape(-1)


def _of_control(given: Any) -> FrequencyResponse | TimeSeries | None:
    """python-control: a response over frequency has omega and fresp (or frdata), one over time inputs and outputs."""
    if type(given).__module__.partition(".")[0] == "control" and hasattr(given, "time") and hasattr(given, "outputs"):
        if given.inputs is None:
            raise ValueError("the response over time has no input; expected one that was computed with an input")
        return TimeSeries(given.time, _single(given.inputs, "input"), _single(given.outputs, "output"))
    if not hasattr(given, "omega"):
        return None
    values = getattr(given, "fresp", None)
    if values is None:
        values = getattr(given, "frdata", None)
    if values is None:
        return None
    return FrequencyResponse(given.omega, _single(values, "response"))


def _of_data_array(given: Any) -> FrequencyResponse | None:
    """xarray.DataArray: complex values over one coordinate, whose name or unit says what frequency it is."""
    if not (hasattr(given, "dims") and hasattr(given, "coords") and hasattr(given, "values") and not callable(given.values)):
        return None
    if len(given.dims) != 1 or given.dims[0] not in given.coords:
        raise ValueError(f"the array has the dimensions {tuple(given.dims)}; expected one, with the frequencies as its coordinate")
    axis = given.coords[given.dims[0]]
    named = f"{given.dims[0]}_{axis.attrs.get('units', '')}".lower()
    unit = str(given.attrs.get("units", ""))
    if any(word in named for word in ("rad", "omega")):
        return FrequencyResponse(axis.values, given.values, unit=unit)
    if "hz" in named or given.dims[0] in ("f", "freq", "frequency"):
        return FrequencyResponse.from_hz(axis.values, given.values, unit=unit)
    raise ValueError(f"the coordinate {given.dims[0]!r} has no unit of frequency; name it omega or f, or give it attrs['units'] = 'Hz'")


def _of_table(given: Any) -> FrequencyResponse | TimeSeries | None:
    """Columns by name, as in a file: pandas, polars, xarray.Dataset, structured arrays, a dict of arrays."""
    columns = _columns(given)
    if not columns:
        return None
    written = {}
    for name, column in columns.items():
        values = np.asarray(column)
        if values.ndim != 1:
            raise ValueError(f"column {name!r} has the shape {values.shape}; expected one dimension")
        if values.dtype.kind == "c":
            written[f"re_{name}"], written[f"im_{name}"] = values.real, values.imag
        else:
            written[name] = values
    _one_value(written)
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "table.csv")
        with open(path, "w", encoding="utf-8") as file:
            file.write(",".join('"' + each.replace('"', "'") + '"' if "," in each else each for each in written) + "\n")
            for row in zip(*(column.tolist() for column in written.values())):
                file.write(",".join(map(_cell, row)) + "\n")
        try:
            found = read(path)
        except RuntimeError as reason:
            said = re.sub(r":1:\d+: ", " has ", str(reason).replace(path, "the table").removesuffix(" with frequency_unit"), count=1)
            raise ValueError(said.replace(", or columns f=1,re=2,im=3", "")) from None
    if isinstance(found, FrequencyResponse):
        found.metadata.pop("source", None)
    return found


def _one_value(written: dict[str, Any]) -> None:
    """Complex values are called so in every language; parts of files have no such name."""
    parts = [name for name in written if name.startswith("re_") and "im_" + name[3:] in written]
    if len(parts) == 1 and parts[0][3:].lower() in ("z", "response", "impedance", "value", "h", "g", "y", "n"):
        name = parts[0][3:]
        for part in ("re", "im"):
            written[part] = written.pop(f"{part}_{name}")


def _columns(given: Any) -> dict[str, Any]:
    if isinstance(given, np.ndarray):
        return {name: given[name] for name in given.dtype.names or ()}
    if isinstance(given, dict):
        return {str(name): np.asarray(value) for name, value in given.items()} if all(isinstance(key, str) for key in given) else {}
    if hasattr(given, "data_vars"):
        return {str(name): given[name].values for name in [*given.coords, *given.data_vars]}
    if not hasattr(given, "columns") or not hasattr(given, "__getitem__"):
        return {}
    columns = {}
    index = getattr(given, "index", None)
    if getattr(index, "name", None):
        columns[str(index.name)] = np.asarray(index)
    for name in given.columns:
        columns[str(name)] = np.asarray(given[name])
    return columns


def _cell(value: Any) -> str:
    return repr(value) if isinstance(value, float) else str(value)


def formula_of(given: Any) -> str | None:
    """The formula of a transfer function of another package, or None where it is none.

    Those of python-control and scipy.signal, and what scipy.signal takes for one: (num, den), (zeros, poles, gain),
    (A, B, C, D).
    """
    dt = getattr(given, "dt", None)
    if isinstance(given, tuple):
        if len(given) not in (2, 3, 4):
            return None
        parts: Any = given
    elif hasattr(given, "zeros") and hasattr(given, "gain") and hasattr(given, "poles") and not callable(given.zeros):
        parts = (given.zeros, given.poles, given.gain)
    elif hasattr(given, "num") and hasattr(given, "den"):
        parts = (given.num, given.den)
    elif all(hasattr(given, each) for each in "ABCD"):
        parts = (given.A, given.B, given.C, given.D)
    else:
        return None
    if dt is not None and dt is not False and dt != 0:
        raise ValueError(f"the system is sampled every {dt} s; a formula of s is of continuous time")
    if len(parts) == 2:
        return _ratio(_polynomial(parts[0], "numerator"), _polynomial(parts[1], "denominator"))
    if len(parts) == 3:
        return _factored(*parts)
    return _of_state_space(*(np.atleast_2d(np.asarray(each, dtype=float)) for each in parts))


def _polynomial(given: Any, what: str) -> Array:
    while isinstance(given, (list, np.ndarray)) and len(given) == 1 and np.ndim(given[0]) >= 1:
        given = given[0]
    if isinstance(given, (list, np.ndarray)) and len(given) and np.ndim(given[0]) >= 1:
        raise ValueError(f"the {what} has {len(given)} rows; expected one input and one output")
    found = np.trim_zeros(real_array(np.atleast_1d(given), what), "f")
    if not np.all(np.isfinite(found)):
        raise ValueError(f"the {what} has an entry that is not finite")
    return found


def _number(value: float) -> str:
    return repr(float(value)).removesuffix(".0")


def _sum(coefficients: Array) -> str:
    """Of falling whole powers of s."""
    said = ""
    for power, value in zip(range(len(coefficients) - 1, -1, -1), coefficients):
        if value == 0:
            continue
        sign = ("-" if value < 0 else "") if not said else (" - " if value < 0 else " + ")
        name = "" if power == 0 else "s" if power == 1 else f"s^{power}"
        size = _number(abs(value))
        said += sign + (name if name and size == "1" else f"{size} {name}".strip())
    return said or "0"


def _ratio(numerator: Array, denominator: Array) -> str:
    if not denominator.size:
        raise ValueError("the denominator is 0")
    if denominator.size == 1 and denominator[0] == 1:
        return _sum(numerator)
    return f"({_sum(numerator)})/({_sum(denominator)})"


def _factored(zeros: Any, poles: Any, gain: Any) -> str:
    def factors(roots: Any, what: str) -> str:
        said = ""
        points = list(complex_array(np.atleast_1d(roots), what))
        while points:
            root = points.pop()
            if root.imag == 0:
                said += f" ({_sum(np.array([1.0, -root.real]))})"
                continue
            at = min(range(len(points)), key=lambda i: abs(points[i] - root.conjugate()), default=None)
            if at is None or abs(points[at] - root.conjugate()) > 1e-9 * abs(root):
                raise ValueError(f"{what} have {root:.6g} without its conjugate")
            points.pop(at)
            said += f" ({_sum(np.array([1.0, -2 * root.real, abs(root) ** 2]))})"
        return said

    factor = np.asarray(gain, dtype=float).reshape(-1)
    if factor.size != 1:
        raise ValueError(f"the gain has {factor.size} entries; expected one input and one output")
    below = factors(poles, "poles").strip()
    return f"{_number(factor[0])}{factors(zeros, 'zeros')}" + (f"/({below})" if below else "")


def _of_state_space(a: Array, b: Array, c: Array, d: Array) -> str:
    states = a.shape[0] if a.size else 0
    if d.size != 1:
        raise ValueError(f"D has the shape {d.shape}; expected one input and one output")
    if states == 0:
        return _number(d[0, 0])
    # det(s - A + B C) = det(s - A) (1 + C (s - A)^-1 B).
    denominator = np.poly(a)
    numerator = np.poly(a - b.reshape(states, 1) @ c.reshape(1, states)) + (d[0, 0] - 1) * denominator
    return _ratio(np.trim_zeros(numerator.real, "f"), denominator.real)
