# SPDX-License-Identifier: BSD-3-Clause
"""Controllers, models and scenes as SPICE netlists, functional mock-up units, C code and Arduino libraries, and reports."""

from __future__ import annotations

import os
import pathlib
import warnings
from typing import Any, Sequence

from . import _core
from ._arrays import count, number, pair, path_of, text
from ._controller import FractionalPid
from ._model import Model, _Record, _written
from ._text import reporter
from ._words import named



class Circuit(_Record):
    """A circuit that stands for a model on a band.

    Attributes
    ----------
    netlist : str
        The subcircuit, as SPICE reads it.
    max_relative_error, omega_at_maximum : float
        Largest ``|H/G - 1|`` on the band, measured on the values of the elements, and where (rad/s).
    usable : bool
        The tolerance is kept.
    message : str
    """

    netlist: str
    max_relative_error: float
    omega_at_maximum: float
    usable: bool
    message: str

    def __str__(self) -> str:
        return self.netlist


@named
def export_spice(
    model: Model | str,
    *,
    kind: str,
    band: tuple[float, float],
    tolerance: float = 1e-3,
    name: str = "model",
    out: str | os.PathLike[str] | None = None,
) -> Circuit:
    """SPICE subcircuit of an impedance, an admittance or a transfer function, with its error.

    Parameters
    ----------
    kind : {"impedance", "admittance", "transfer"}
        Impedances (ohm) and admittances (S) become resistors, capacitors and inductors, all positive; a transfer function from
        voltage to voltage becomes controlled sources.
    band : (float, float)
        rad/s.
    tolerance : float
        Largest ``|H/G - 1|`` on the band.
    name : str
        Of the subcircuit.
    out : path, optional
        File to write the netlist to.

    Examples
    --------
    >>> import fracfit
    >>> circuit = fracfit.export_spice("1/s^0.5", kind="impedance", band=(1, 1e4))
    >>> circuit.usable, circuit.netlist.count(".subckt model")
    (True, 1)
    """
    formula = _written("{}", model if isinstance(model, Model) else Model(model)).formula
    found = Circuit(_core.spice(formula, text(kind, "kind"), pair(band, "band"), number(tolerance, "tolerance"), text(name, "name")))
    if out is not None:
        pathlib.Path(path_of(out, "out")).write_text(found.netlist, encoding="utf-8")
    return found


@named
def export_c99(
    source: FractionalPid | Model | str,
    *,
    sample_time: float | None = None,
    band: tuple[float, float] | None = None,
    tolerance: float | None = None,
    name: str | None = None,
    precision: str = "double",
    fixed_point: tuple[float, float] | None = None,
    out: str | os.PathLike[str] | None = None,
) -> str:
    """A controller, or a model as a filter in the samples, as a self-contained C99 header.

    Parameters
    ----------
    source : FractionalPid, Model or str
        A model needs `sample_time` (s), and may have a `band` (rad/s) with a `tolerance` on it.
    name : str, optional
        Prefix of the functions: controller, of a model filter.
    precision : {"double", "float"}
        Arithmetic of the code.
    fixed_point : (float, float), optional
        Ranges of input and output: whole numbers of 32 bits instead, for processors without a floating-point unit.
    out : path, optional
        File to write it to.

    Examples
    --------
    >>> import fracfit
    >>> "filter_step" in fracfit.export_c99("1/(s^0.5 + 1)", sample_time=0.01)
    True
    """
    made = _in_samples(source, "c99", sample_time, band, tolerance, name, precision, fixed_point)
    if out is not None:
        pathlib.Path(path_of(out, "out")).write_text(made, encoding="utf-8")
    return made  # type: ignore[no-any-return]


@named
def export_arduino(
    source: FractionalPid | Model | str,
    out: str | os.PathLike[str],
    *,
    sample_time: float | None = None,
    band: tuple[float, float] | None = None,
    tolerance: float | None = None,
    name: str | None = None,
    precision: str = "float",
) -> list[pathlib.Path]:
    """The same as an Arduino library with a sketch; returns the files it has written into the folder `out`."""
    folder = pathlib.Path(path_of(out, "out"))
    written = []
    for path, contents in _in_samples(source, "arduino", sample_time, band, tolerance, name, precision, None):
        file = folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(contents, encoding="utf-8")
        written.append(file)
    return written


@named
def export_fmu(
    source: FractionalPid | Model | str | None = None,
    out: str | os.PathLike[str] | None = None,
    *,
    sample_time: float | None = None,
    band: tuple[float, float] | None = None,
    tolerance: float | None = None,
    name: str = "model",
    precision: str = "double",
    clearance: float | None = None,
    restitution: float | None = None,
    mass1: float = 1.0,
    mass2: float = 1.0,
    fmi: int = 2,
    windows: bool = False,
) -> pathlib.Path:
    """Functional mock-up unit (FMI 2.0 or 3.0) of a controller, a filter, a fractional plant, or two masses with backlash.

    Parameters
    ----------
    source : FractionalPid, Model or str, optional
        A model with `sample_time` is a filter, one without, on a `band` (rad/s), a continuous plant; left out where `clearance` (m)
        and `restitution` make a unit of two masses (kg).
    out : path
        File to write, ``.fmu``.
    fmi : {2, 3}
        Version of the Functional Mock-up Interface.
    windows : bool
        With a library for 64-bit Windows too, by the compiler x86_64-w64-mingw32-gcc.

    Raises
    ------
    RuntimeError
        A library for Windows is asked for, and the compiler is not there.

    Warns
    -----
    UserWarning
        The unit holds its sources only, since there is no C compiler; or the tolerance is not kept.
    """
    from . import _files

    if out is None:
        raise ValueError("out has no value; expected the file to write, such as 'model.fmu'")
    path = pathlib.Path(path_of(out, "out"))
    if not hasattr(_files, "fmu_archive"):
        raise RuntimeError("this installation of fracfit writes no units: it was built with FRACFIT_EXPORTS=OFF")
    label = text(name, "name")
    if fmi not in (2, 3):
        raise ValueError(f"fmi is {fmi}; expected 2 or 3")
    how = {
        "name": label,
        "precision": text(precision, "precision"),
        "fixed_point": None,
        "comment": "Made by fracfit.export_fmu.",
        "fmi": str(fmi),
    }
    note = ""
    if clearance is not None:
        if source is not None:
            raise ValueError("clearance makes a unit of two masses, which has no other source")
        for option, value in {"sample_time": sample_time, "band": band, "tolerance": tolerance}.items():
            if value is not None:
                raise ValueError(f"{option} has no meaning with clearance, which makes a unit of two masses")
        if restitution is None:
            raise ValueError("restitution has no value; it is needed with clearance")
        scene = (number(mass1, "mass1"), number(mass2, "mass2"), number(clearance, "clearance"), number(restitution, "restitution"))
        unit = _core.export_masses(*scene, how)
    elif isinstance(source, FractionalPid) or sample_time is not None:
        unit = _in_samples(source, "fmu", sample_time, band, tolerance, label, precision, None, fmi)
    else:
        if source is None:
            raise ValueError("source has no value; expected a controller, a model, or clearance and restitution of two masses")
        if band is None:
            raise ValueError("band has no value; a continuous plant needs it, (lower, upper) in rad/s, a filter sample_time")
        within = 1e-3 if tolerance is None else number(tolerance, "tolerance")
        unit, note = _core.export_plant(_model(source)._tf, pair(band, "band"), within, how)
    files, main_source, linux_library, windows_library = unit
    archive, no_library = _files.fmu_archive(files, main_source, linux_library, windows_library if windows else "")
    if no_library:
        warnings.warn(f"the unit holds its sources only: {no_library}", stacklevel=3)
    if note:
        warnings.warn(note, stacklevel=3)
    path.write_bytes(archive)
    return path


def _model(source: Any) -> Model:
    return source if isinstance(source, Model) else Model(source)


def _in_samples(
    source: Any, form: str, sample_time: Any, band: Any, tolerance: Any, name: Any, precision: Any, fixed_point: Any, fmi: int = 2
) -> Any:
    is_pid = isinstance(source, FractionalPid)
    how = {
        "name": text(name, "name") if name is not None else "controller" if is_pid else "filter",
        "precision": text(precision, "precision"),
        "comment": "",
        "fixed_point": None if fixed_point is None else pair(fixed_point, "fixed_point"),
        "fmi": str(fmi),
    }
    given = {"sample_time": sample_time, "band": band, "tolerance": tolerance}
    if is_pid:
        for option, value in given.items():
            if value is not None:
                raise ValueError(f"{option} has no meaning with a FractionalPid, which has its own")
        return source._controller.exported(form, how)
    model = _model(source)
    if sample_time is None:
        raise ValueError("sample_time has no value; a model is a filter in the samples, s apart")
    how["comment"] = f"Filter {model.formula}."
    made, note = _core.export_filter(
        model._tf,
        number(sample_time, "sample_time"),
        None if band is None else pair(band, "band"),
        None if tolerance is None else number(tolerance, "tolerance"),
        form,
        how,
    )
    if note:
        warnings.warn(note, stacklevel=4)
    return made


@named
def report(
    out: str | os.PathLike[str],
    data: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] = (),
    *,
    scene: str | os.PathLike[str] | None = None,
    quantity: str = "auto",
    columns: str = "",
    frequency_unit: str = "",
    select: str | int = "",
    threads: int = 0,
    progress: Any = None,
) -> pathlib.Path:
    """Writes the whole study as one page with figures, tables and numbers, as ``fracfit report`` does.

    Parameters
    ----------
    out : path
        Folder to write, made if missing.
    data : path or sequence of path
        Measured files; without any, the scenes of the paper.
    scene : path, optional
        A scene as JSON instead: mass1, mass2, clearance, restitution, force, omega.
    quantity, columns, frequency_unit, select
        What the files do not tell of themselves, see `read`; quantity also names a field, such as "impedance".

    Returns
    -------
    path
        The page, index.html.

    Warns
    -----
    UserWarning
        There are no pictures, since gnuplot is missing.
    """
    try:
        from . import _report
    except ImportError as reason:
        raise ImportError(f"this installation of fracfit writes no reports: {reason}; it needs its part _report") from None
    files = [os.fspath(data)] if isinstance(data, (str, os.PathLike)) else [os.fspath(each) for each in _paths(data)]
    folder, where = path_of(out, "out"), None if scene is None else path_of(scene, "scene")
    how = {
        "quantity": text(quantity, "quantity"),
        "columns": text(columns, "columns"),
        "frequency_unit": text(frequency_unit, "frequency_unit"),
        "select": str(select),
        "threads": count(threads, "threads"),
        "command": f"fracfit.report({folder!r}" + (f", {files!r}" if files else "") + ")",
    }
    index, has_pictures, message = _report.report(folder, files, where, how, reporter(progress, "report"))
    if not has_pictures:
        warnings.warn(message, stacklevel=3)
    return pathlib.Path(index)


def _paths(given: Any) -> list[Any]:
    listed = list(given) if isinstance(given, (list, tuple)) else None
    if listed is None or not all(isinstance(each, (str, os.PathLike)) for each in listed):
        raise ValueError(f"data are of the type {type(given).__name__}; expected paths of files")
    return listed
