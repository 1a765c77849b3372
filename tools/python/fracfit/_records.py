# SPDX-License-Identifier: BSD-3-Clause
"""Raw records of experiments as frequency responses, and excitations for them."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from . import _core
from ._arrays import NO_NUMBERS, Array, count, number, pair, path_of, real_array, seed_number, text
from ._data import FrequencyResponse, TimeSeries
from ._model import _Record
from ._motions import RigRecord
from ._tables import Table, column_unit
from ._text import html_table, short
from ._words import named

_MOST_SAMPLES = 10_000_000


class RecordResponse(_Record, Table):
    """Frequency response of a record, each value with what is known of its error.

    Points without a deviation are left out.  Of several outputs every array of points has a row for each.

    Attributes
    ----------
    omega : ndarray
        rad/s, rising; equal ones are further segments of a stepped sine.
    response : ndarray of complex
        Output per input.
    sigma : ndarray
        Standard deviation of each part, noise and distortion together: +-1.98 sigma hold 95 %.
    deviation_re, deviation_im, correlation : ndarray
        Of the errors of both parts.
    degrees_of_freedom : ndarray
        That the deviations come from.
    noise, distortion, even_distortion : ndarray
        Shares of sigma, and distortion of even order, which is no part of it; NaN where nothing tells them.
    distortion_low, distortion_high, even_distortion_low, even_distortion_high : ndarray
        Ends of the 95 % intervals of both distortions.
    coherence, h1 : ndarray
        Of an arbitrary input: squared coherence, and the usual estimate by Hann windows; else NaN.
    subharmonic : ndarray of int
        The motion repeats after so many periods of the input.
    harmonics, harmonics_sigma : ndarray
        Of a stepped sine, a column for each from the second on: over the amplitude of the input, and the deviation of each part.
    input_amplitude, periods : ndarray
        Of each line of the input; periods in what each point is made of.
    excitation : str
        periodic, stepped-sine or arbitrary.
    period : float
        Of a periodic excitation, s, else NaN.
    realisations : int
        Records that were averaged.
    left_out : list of (float, str)
        Frequency of each point without a deviation, rad/s, and why.
    remarks : list of str
        What was assumed of the file and noticed in the record.
    names, units : list of str
        Of the outputs and of the response of each; empty where nothing tells them.
    usable : bool
        Whether any point is left.
    """

    omega: Array
    response: Array
    sigma: Array
    deviation_re: Array
    deviation_im: Array
    correlation: Array
    degrees_of_freedom: Array
    noise: Array
    distortion: Array
    distortion_low: Array
    distortion_high: Array
    even_distortion: Array
    even_distortion_low: Array
    even_distortion_high: Array
    coherence: Array
    h1: Array
    subharmonic: Array
    harmonics: Array
    harmonics_sigma: Array
    input_amplitude: Array
    periods: Array
    excitation: str
    period: float
    realisations: int
    left_out: list[tuple[float, str]]
    remarks: list[str]
    names: list[str]
    units: list[str]
    input_unit: str
    usable: bool

    @property
    def size(self) -> int:
        """Number of points."""
        return self.omega.size

    def frequency_response(self, output: int = 0, harmonic: int = 1) -> FrequencyResponse:
        """Values with their sigma as data; `fit`, `identify` and the others weigh with it.

        Parameters
        ----------
        output : int
            Which of several, from 0.
        harmonic : int
            Of a stepped sine: which harmonic of the output, over the amplitude of the input.
        """
        rows = np.atleast_2d(self.response)
        chosen = count(output, "output")
        if chosen >= len(rows):
            raise ValueError(f"output is {chosen}; the record has {len(rows)}, counted from 0")
        if not self.usable:
            why = self.left_out[0][1] if self.left_out else "no line or segment of the excitation was found"
            raise ValueError(f"no point has a value with its deviation: {why}")
        order, orders = count(harmonic, "harmonic"), self.harmonics.shape[-1] + 1
        if not 1 <= order <= orders:
            raise ValueError(f"harmonic is {order}; allowed is 1 to {orders}")
        values, sigma = rows[chosen], np.atleast_2d(self.sigma)[chosen]
        if order > 1:
            values, sigma = (part.reshape(len(rows), -1, orders - 1)[chosen, :, order - 2] for part in (self.harmonics, self.harmonics_sigma))
        return FrequencyResponse(
            self.omega,
            values,
            sigma,
            unit=self.units[chosen],
            metadata={"excitation": self.excitation, "sigma": "measured", **({"output": self.names[chosen]} if self.names[chosen] else {})},
        )

    def _columns(self) -> dict[str, Any]:
        columns: dict[str, Any] = {"omega_rad_s": self.omega}
        several = self.response.ndim == 2
        distortion = {name: getattr(self, name) for name in ("distortion", "distortion_low", "distortion_high")}
        more = {
            "periodic": {**distortion, **{f"even_{name}": getattr(self, f"even_{name}") for name in distortion}},
            "stepped-sine": {"subharmonic": self.subharmonic},
            "arbitrary": {**distortion, "coherence": self.coherence, "h1_re": self.h1.real, "h1_im": self.h1.imag},
        }
        for row, unit in enumerate(self.units):
            label = f"_{self.names[row] or row + 1}" if several else ""
            named_columns = {f"{name}{label or column_unit(unit)}": part for name, part in (("re", self.response.real), ("im", self.response.imag), ("sigma", self.sigma))}
            for name in ("deviation_re", "deviation_im", "correlation", "degrees_of_freedom", "noise"):
                named_columns[name + label] = getattr(self, name)
            named_columns.update({name + label: part for name, part in more[self.excitation].items()})
            for k in range(self.harmonics.shape[-1]):
                of_order = {"re": self.harmonics.real, "im": self.harmonics.imag, "sigma": self.harmonics_sigma}
                named_columns.update({f"harmonic{k + 2}_{name}{label}": part[..., k] for name, part in of_order.items()})
            columns.update({name: part[row] if several else part for name, part in named_columns.items()})
        return {**columns, f"input_amplitude{column_unit(self.input_unit)}": self.input_amplitude, "periods": self.periods}

    def _head(self) -> dict[str, str]:
        return {"excitation": self.excitation}

    def plot(self, *, kind: str = "bode", ax: Any = None, **style: Any) -> Any:
        """The response of the first output, with matplotlib; see `FrequencyResponse.plot`."""
        return self.frequency_response().plot(kind=kind, ax=ax, **style)

    def __repr__(self) -> str:
        band = f", {short(float(self.omega[0]))} to {short(float(self.omega[-1]))} rad/s" if self.usable else ""
        left = f", {len(self.left_out)} left out" if self.left_out else ""
        return f"RecordResponse({self.excitation}, {self.size} point{'' if self.size == 1 else 's'}{band}{left})"

    def _repr_html_(self) -> str:
        return html_table(["remarks"] if self.remarks else [], [(each,) for each in self.remarks], repr(self))


class Multisine(_Record, Table):
    """A sum of sines of equal amplitude with a low peak.

    Attributes
    ----------
    time, input : ndarray
        s, and the samples to send.
    lines : ndarray of int
        Of the period, those that are excited.
    amplitude : float
        Of each line.
    crest_factor : float
        Peak over root mean square.
    """

    time: Array
    input: Array
    lines: Array
    amplitude: float
    crest_factor: float

    def _columns(self) -> dict[str, Any]:
        return {"time_s": self.time, "input": self.input}

    def _head(self) -> dict[str, str]:
        first, last = self.lines[[0, -1]].tolist()
        numbers = {"amplitude": repr(self.amplitude), "crest_factor": repr(self.crest_factor)}
        return {"lines": str(self.lines.size), "first_line": str(first), "last_line": str(last), **numbers}

    def __repr__(self) -> str:
        return f"Multisine({self.lines.size} lines, {self.input.size} samples, crest factor {short(self.crest_factor)})"

    def _repr_html_(self) -> str:
        return html_table([], [], repr(self))


class SteppedSinePlan(_Record, Table):
    """Steps of a sine, one after the other.

    Attributes
    ----------
    omega : ndarray
        rad/s, of each step.
    settling, measuring : ndarray of int
        Cycles of each step; those of settling come first.
    begin, end : ndarray
        s, of each step, settling included.
    """

    omega: Array
    settling: Array
    measuring: Array
    begin: Array
    end: Array

    def _columns(self) -> dict[str, Any]:
        return {"omega_rad_s": self.omega, "settling_cycles": self.settling, "measuring_cycles": self.measuring, "begin_s": self.begin, "end_s": self.end}

    def _head(self) -> dict[str, str]:
        return {"total_time_s": repr(float(self.end[-1]))}

    def __repr__(self) -> str:
        return f"SteppedSinePlan({self.omega.size} steps, {short(float(self.end[-1]))} s)"

    def _repr_html_(self) -> str:
        return html_table([], [], repr(self))


@named
def response(
    data: Any = None,
    input: Any = None,
    output: Any = None,
    *,
    reference: Any = None,
    sample_time: float | None = None,
    columns: str = "",
    input_file: Any = None,
    excitation: str | None = None,
    period: float | None = None,
    harmonics: int | None = None,
    sensor_delay: float = 0.0,
) -> RecordResponse:
    """Frequency response of an experiment, from samples over time, each value with its error.

    Parameters
    ----------
    data : array_like, TimeSeries, RigRecord, path, or a list of the latter three
        Times of the samples at equal steps, s, with `input` and `output`; or all of it: a `TimeSeries`, a record of `history` or
        `loop`, or a file.  Several are realisations of one excitation, or further steps of a stepped sine.
    input, output : array_like
        What drove the system and what it answered; several outputs as a list or as rows.  Of a `RigRecord` the output may be
        "x1" or "x2", else both are.
    reference : array_like, optional
        What drives a closed loop from outside; without it the input is taken as free of what disturbs the output.
    sample_time : float, optional
        s, in place of times.
    columns : str
        Which column of a file is what, by number or name, such as ``"time=1,input=2,output=3"``; keys time, input, reference,
        trigger (rises once a period; without an input it is that, a cosine), output.
    input_file : path, or a list of them, optional
        Times and input of each file of `data`, which then holds the outputs; joined by time.
    excitation : {"periodic", "stepped-sine", "arbitrary"}, optional
        What drove the experiment; found unless given.
    period : float, optional
        Of a periodic excitation, s; found unless given, to a fraction of a sample.
    harmonics : int, optional
        Of the output under a stepped sine, the first included; 5 by default.
    sensor_delay : float, optional
        Time by which outputs are read later than the input, s; it is taken out of the response.

    Raises
    ------
    RuntimeError
        A file cannot be read, or holds no record at equal steps.
    ValueError
        Lengths differ, a sample is not finite, times are not at equal steps, or no period is found where one is asked for.

    See Also
    --------
    multisine : what to send.

    Examples
    --------
    >>> import fracfit, numpy as np
    >>> drive = fracfit.multisine((1, 20), period=10, sample_time=0.05, periods=4).input
    >>> answer = 2 * drive + 0.01 * np.random.default_rng(1).normal(size=drive.size)
    >>> found = fracfit.response(input=drive, output=answer, sample_time=0.05)
    >>> found.excitation, round(found.period, 9)
    ('periodic', 10.0)
    >>> data = found.frequency_response()
    >>> result = fracfit.fit(data, "K")
    >>> result.weight, round(result["K"], 2)
    ('given', 2.0)
    """
    kinds = ("periodic", "stepped-sine", "arbitrary")
    if excitation is not None and text(excitation, "excitation") not in kinds:
        raise ValueError(f"excitation is {excitation!r}; expected one of {', '.join(kinds)}")
    if period is not None and excitation in ("stepped-sine", "arbitrary"):
        raise ValueError(f"period has no meaning with the excitation {excitation}, which has no common one")
    if harmonics is not None and excitation in ("periodic", "arbitrary"):
        raise ValueError(f"harmonics has no meaning with the excitation {excitation}, whose lines mix")
    orders = 5 if harmonics is None else count(harmonics, "harmonics", 1000)
    step = None if sample_time is None else number(sample_time, "sample_time")
    if step is not None and not 0 < step < np.inf:
        raise ValueError(f"sample_time is {step:g}; allowed is above 0")
    text(columns, "columns")
    notes: list[str] = []
    first: dict[str, Any] = {}
    wholes = list(data) if isinstance(data, (list, tuple)) and data and all(map(_is_whole, data)) else [data] if _is_whole(data) else []
    are_files = bool(wholes) and all(isinstance(each, (str, os.PathLike)) for each in wholes)
    inputs = list(input_file) if isinstance(input_file, (list, tuple)) else [] if input_file is None else [input_file]
    if inputs and not (are_files and len(inputs) == len(wholes)):
        raise ValueError(f"input_file names {len(inputs)} files; expected one for each file of data")
    late = number(sensor_delay, "sensor_delay")
    if not np.isfinite(late):
        raise ValueError(f"sensor_delay is {late:g}; it must be finite")
    if not wholes:
        if columns:
            raise ValueError("columns has no meaning with arrays; it is for files")
        records = [_of_arrays(data, input, output, reference, step)]
    else:
        are_rigs = all(isinstance(each, RigRecord) for each in wholes)
        for name, value in (("input", input), ("output", output), ("reference", reference)):
            if value is not None and not (are_rigs and name == "output"):
                raise ValueError(f"{name} has no meaning with a TimeSeries, a RigRecord or a file, which has its own")
        records = []
        for place, each in enumerate(wholes):
            if isinstance(each, RigRecord):
                if columns or step is not None:
                    raise ValueError(f"{'columns' if columns else 'sample_time'} has no meaning with a RigRecord, which has its own")
                rig = _of_rig(each, output)
                records.append(rig["record"])
                first = first or rig
                continue
            if isinstance(each, TimeSeries):
                if columns:
                    raise ValueError("columns has no meaning with a TimeSeries; it is for files")
                records.append(_of_arrays(each.time if step is None else None, each.input, each.output, None, step))
                continue
            from . import _files

            file = _files.raw_record(path_of(each, "data"), columns, step, path_of(inputs[place], "input_file") if inputs else "")
            records.append(file["record"])
            if abs(file["sensor_delay"] - (first or file).get("sensor_delay", 0.0)) > 1e-3 * file["record"][0]:
                raise ValueError(f"{os.fspath(each)}: its instants are {file['sensor_delay']:g} s before those of its input; expected as many as of the first file")
            notes += [f"{os.fspath(each)}: {note}" for note in file["notes"]]
            first = first or file
    if are_files:
        late += first["sensor_delay"]
        period = first["period"] if period is None and excitation in (None, "periodic") else period
    found = _core.response(records, excitation, None if period is None else number(period, "period"), orders, late)
    return _chosen(found, notes, first)


def _is_whole(data: Any) -> bool:
    return isinstance(data, (str, os.PathLike, TimeSeries, RigRecord))


def _of_rig(rig: RigRecord, output: Any) -> dict[str, Any]:
    bodies = ("x1", "x2") if output is None else (output,)
    if bodies[0] not in ("x1", "x2"):
        raise ValueError(f"output is {output!r}; expected x1 or x2, the positions of a RigRecord")
    if not rig.size:
        raise ValueError("the record is empty: its motion could not be followed to its end")
    signals = (rig.sample_time, rig.force, [getattr(rig, body) for body in bodies], rig.set_point, [])
    return {"record": signals, "names": [f"{body}_m" for body in bodies], "units": ["m/N"] * len(bodies), "input_unit": "N"}


def _of_arrays(time: Any, input: Any, output: Any, reference: Any, step: float | None) -> tuple[float, Array, list[Array], Array, list[tuple[int, int]]]:
    for name, value in (("input", input), ("output", output)):
        if value is None:
            raise ValueError(f"{name} has no value; expected times, input and output, a TimeSeries, or the path of a file")
    signal = real_array(input, "input")
    is_several = output.ndim == 2 if isinstance(output, np.ndarray) else isinstance(output, (list, tuple)) and len(output) > 0 and hasattr(output[0], "__len__")
    rows = list(output) if is_several else [output]
    outputs = [real_array(row, "output") for row in rows]
    drive = NO_NUMBERS if reference is None else real_array(reference, "reference")
    for name, each in [*(("output", row) for row in outputs), *([] if reference is None else [("reference", drive)])]:
        if each.size != signal.size:
            raise ValueError(f"{name} has {each.size} samples and input {signal.size}; expected as many")
    if (time is None) == (step is None):
        raise ValueError("expected the times of the samples or sample_time, one of them")
    return (_step_of(real_array(time, "data"), signal.size) if step is None else step), signal, outputs, drive, []


def _step_of(time: Array, size: int) -> float:
    if time.size != size:
        raise ValueError(f"data has {time.size} times and input {size} samples; expected as many, or sample_time=")
    if size < 2:
        raise ValueError(f"data has {size} times; expected at least 16")
    steps = np.diff(time)
    if not np.all(steps > 0) or not np.isfinite(time[-1] - time[0]):
        raise ValueError("data are times that do not rise; expected finite ones, s, at equal steps")
    step = float(time[-1] - time[0]) / (size - 1)
    # As of files: no sample is missing, and none is nearer to the place of another.
    late = np.abs((time - time[0]) / step - np.arange(size))
    if steps.max() > 1.5 * np.median(steps) or late.max() > 0.5:
        raise ValueError(f"data are times at steps of {steps.min():g} to {steps.max():g} s; expected equal steps")
    return step


def _chosen(found: dict[str, Any], notes: list[str], file: dict[str, Any]) -> RecordResponse:
    """The points that have a deviation in all outputs, by frequency."""
    by_row = {name for name, value in found.items() if isinstance(value, np.ndarray) and value.ndim > 1}
    is_kept = np.isfinite(found["sigma"]).all(axis=0)
    flags = found.pop("flags")
    left_out = []
    for i in np.flatnonzero(~is_kept).tolist():
        said = [of_output[i] for row, of_output in enumerate(flags) if not np.isfinite(found["sigma"][row, i])]
        left_out.append((float(found["omega"][i]), said[-1] or "no deviation"))
    kept = np.flatnonzero(is_kept)
    kept = kept[np.argsort(found["omega"][kept], kind="stable")]
    several = len(flags) > 1
    for name, value in found.items():
        if name in by_row:
            found[name] = value[:, kept] if several else value[0, kept]
        elif isinstance(value, np.ndarray):
            found[name] = value[kept]
    return RecordResponse(
        {
            **found,
            "left_out": left_out,
            "remarks": notes + found["remarks"],
            "names": file.get("names", [""] * len(flags)),
            "units": file.get("units", [""] * len(flags)),
            "input_unit": file.get("input_unit", ""),
            "usable": bool(kept.size),
        }
    )


@named
def multisine(
    band: Any,
    *,
    period: float,
    sample_time: float,
    lines: str = "odd-random",
    peak: float = 1.0,
    periods: int = 1,
    rounds: int = 500,
    seed: int = 1,
) -> Multisine:
    """An excitation for an experiment: a sum of sines of equal amplitude whose phases make the peak low.

    Parameters
    ----------
    band : (float, float)
        That is excited, rad/s.
    period, sample_time : float
        s; a period is a whole number of samples.
    lines : {"odd-random", "odd", "full"}
        Lines of the period: of four odd ones three, so that distortion of even and of odd order shows beside them; odd ones; all.
    peak : float
        Largest absolute value.
    periods : int
        Periods to send, at least three for `response` to tell noise.
    rounds : int
        In which the peak is lowered.
    seed : int
        Of phases and lines; another one is another realisation.

    See Also
    --------
    response : what becomes of the answer.

    Examples
    --------
    >>> import fracfit
    >>> drive = fracfit.multisine((1, 20), period=10, sample_time=0.05, peak=2, periods=4)
    >>> drive.input.size, round(float(abs(drive.input).max()), 9), drive.crest_factor < 1.8
    (800, 2.0, True)
    """
    sent = count(periods, "periods")
    every = number(sample_time, "sample_time")
    if text(lines, "lines") not in ("odd-random", "odd", "full"):
        raise ValueError(f"lines is {lines!r}; expected odd-random, odd or full")
    made = _core.multisine(
        pair(band, "band"), number(period, "period"), every, lines, number(peak, "peak"), seed_number(seed), count(rounds, "rounds", 1_000_000)
    )
    size = made["input"].size
    if not 1 <= sent <= _MOST_SAMPLES // size:
        raise ValueError(f"periods is {sent} of {size} samples each; allowed is 1 to {_MOST_SAMPLES // size}")
    return Multisine({"time": np.arange(sent * size) * every, "input": np.tile(made["input"], sent), **{k: v for k, v in made.items() if k != "input"}})


@named
def stepped_sine_plan(next_measurement: Any, total_time: float, *, settling: int = 10) -> SteppedSinePlan:
    """Steps of a sine where an undecided identification asks for them, each measured as long as the others.

    Parameters
    ----------
    next_measurement : (float, float, int)
        From omega to omega, rad/s, so many points, even in the logarithm: `Identification.next_measurement`.
    total_time : float
        s, of all steps.
    settling : int
        Cycles of each step before those that are measured, six or more.

    See Also
    --------
    identify : what asks for the measurement.
    multisine : all frequencies at once.

    Examples
    --------
    >>> import fracfit
    >>> plan = fracfit.stepped_sine_plan((0.1, 10, 5), 2000)
    >>> plan.omega.size, bool(plan.end[-1] <= 2000), int(plan.measuring.min()) >= 6
    (5, True, True)
    """
    try:
        low, high, points = next_measurement
    except (TypeError, ValueError):
        raise ValueError(f"next_measurement is {next_measurement!r}; expected (from omega, to omega, points), as Identification.next_measurement") from None
    lower, upper, steps = number(low, "next_measurement"), number(high, "next_measurement"), count(points, "next_measurement")
    if not 0 < lower <= upper < np.inf or not 1 <= steps <= _MOST_SAMPLES:
        raise ValueError(f"next_measurement is {next_measurement!r}; expected 0 < from omega <= to omega and 1 to {_MOST_SAMPLES} points")
    omega = [lower * (upper / lower) ** (i / (steps - 1) if steps > 1 else 0.5) for i in range(steps)]
    return SteppedSinePlan(_core.stepped_sine_plan(omega, number(total_time, "total_time"), count(settling, "settling")))
