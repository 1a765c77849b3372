# SPDX-License-Identifier: BSD-3-Clause
"""Two masses with a clearance between them: describing functions, regimes, orbits, limit cycles."""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np

from . import _core
from ._arrays import Array, body_of, count, flag, number, one_of, pair, real_array, shape_of, text
from ._data import FrequencyResponse
from ._model import Model, _Record
from ._tables import Table
from ._text import html_table, reporter
from ._words import named

REGIMES: tuple[str, ...] = _core.regimes
_COMPUTED = {"computed_by": "fracfit"}


class _Points(_Record, Table):
    """Values of a describing function on a grid, with what was found of the motion."""

    omega: Array
    response: Array
    uncertainty: Array
    regime_code: Array
    period: Array
    impacts_per_period: Array
    third_harmonic_ratio: Array
    even_harmonic_ratio: Array
    energy_defect: Array
    lyapunov_exponent: Array
    transient_possible: Array

    @property
    def size(self) -> int:
        """Number of points, of all curves."""
        return self.response.size

    def __bool__(self) -> bool:
        return True

    def _columns(self) -> dict[str, Any]:
        flat = {name: getattr(self, name).reshape(-1) for name in ("period", "impacts_per_period", "uncertainty", "third_harmonic_ratio")}
        columns = {"omega_rad_s": np.broadcast_to(self.omega, self.response.shape).reshape(-1)}
        if self.response.ndim > 1:
            columns = {"curve": np.repeat(np.arange(self.response.size // self.omega.size), self.omega.size), **columns}
        values = self.response.reshape(-1)
        columns.update({"re_m_per_n": values.real, "im_m_per_n": values.imag, "regime": self.regime.reshape(-1)})
        flat["uncertainty_m_per_n"] = flat.pop("uncertainty")
        return {**columns, **flat}

    def _head(self) -> dict[str, str]:
        return dict(_COMPUTED)

    @property
    def regime(self) -> Array:
        """Kind of motion at each point: rigid, free, symmetric, periodic, chatter or averaged."""
        return np.array(REGIMES)[self.regime_code]

    def __len__(self) -> int:
        warnings.warn(f"a {type(self).__name__} is no sequence: write its size in place of its len()", DeprecationWarning, stacklevel=2)
        return len(self.omega)

    def _counts(self) -> list[tuple[str, int]]:
        codes, counts = np.unique(self.regime_code, return_counts=True)
        return [(REGIMES[code], int(count)) for code, count in zip(codes, counts)]

    def __repr__(self) -> str:
        kinds = ", ".join(f"{count} {name}" for name, count in self._counts())
        shape = " x ".join(str(each) for each in self.response.shape)
        return f"{type(self).__name__}({shape} points: {kinds})"

    def _repr_html_(self) -> str:
        return html_table(["regime", "points"], self._counts(), repr(self))


class DescribingFunction(_Points):
    """Describing function N of two masses with backlash; ``omega, response = ...`` takes it apart.

    Attributes
    ----------
    omega : ndarray
        rad/s.
    response : ndarray of complex
        N, m/N; one row per scene where several were asked for.
    uncertainty : ndarray
        Of ``|N|``.
    regime, period, impacts_per_period : ndarray
        Kind of the motion, force periods until it repeats (0 where averaged), and impacts per period.
    third_harmonic_ratio, even_harmonic_ratio : ndarray
        Of the output, to its fundamental.
    energy_defect, lyapunov_exponent : ndarray
        Work that is not accounted for, as a share, and growth of disturbances per force period.
    transient_possible : ndarray
        Whether a mean may be of a transient.
    """

    def __iter__(self) -> Any:
        return iter((self.omega, self.response))

    def data(self) -> FrequencyResponse:
        """The curve as data for a fit; of several the first dimension has to be chosen before."""
        response = self.response
        if response.ndim != 1:
            raise ValueError(f"there are curves of the shape {response.shape[:-1]}; take one of `response`")
        return FrequencyResponse(self.omega, response, unit="m/N", metadata=_COMPUTED)

    def plot(self, *, kind: str = "bode", ax: Any = None, **options: Any) -> Any:
        """A picture of one curve with matplotlib, see `FrequencyResponse.plot`."""
        return self.data().plot(kind=kind, ax=ax, **options)

    @property
    def minus_inverse(self) -> Array:
        """-1/N, N/m; nan where N is 0."""
        response = self.response
        found, _ = _core.minus_inverse(response.reshape(-1), np.zeros(response.size))
        return found.reshape(response.shape)


class RegimeMap(_Points):
    """Describing function over restitution (rows) and frequency (columns); attributes as `DescribingFunction`.

    Where contacts take time `restitution` is that of free ones.
    """

    restitution: Array


@named
def describing_function(
    omega: Any,
    *,
    restitution: Any = None,
    force: Any = 1.0,
    clearance: Any = 1.0,
    mass1: Any = 1.0,
    mass2: Any = 1.0,
    contact_stiffness: Any = None,
    contact_damping: Any = None,
    friction1: Any = None,
    friction2: Any = None,
    load_receptance: Model | str | None = None,
    drive_receptance: Model | str | None = None,
    protocol: str | None = None,
    body: str = "x1",
    tolerance: float = 1e-10,
    mean_tolerance: float = 0.0,
    threads: int = 0,
    progress: Any = None,
) -> DescribingFunction:
    """Describing function of two masses with backlash under a sine force, on a grid of frequencies.

    Parameters
    ----------
    omega : array_like
        rad/s, rising.
    restitution, force, clearance, mass1, mass2 : float or array_like
        Coefficient of restitution, force amplitude (N), clearance (m), masses (kg).  Arrays are broadcast against each
        other and give one curve for each entry.
    contact_stiffness, contact_damping : float or array_like
        In place of a restitution: contacts that take time, N/m and N s/m; see `contact_of_frequency`.
    friction1, friction2 : float or array_like
        With them, dry friction on the masses, N.
    load_receptance, drive_receptance : Model or str, optional
        Displacement per force of body 1 and 2, m/N, instead of free masses; their masses are those in them.
    protocol : {"sweep-up", "sweep-down", "contact-at-rest", "mid-gap-at-rest", "two-impact"}
        Where the motion starts; "sweep-up" if not given, "two-impact" with receptances or contacts that take time.
    body : {"x1", "x2"}
        Mass whose position is read.
    tolerance, mean_tolerance : float
        Closure of an orbit over the clearance; share of ``|N|`` at which a long-time mean ends, 0 for a thousand periods.
    threads : int
        0 for one per core; no influence on results.
    progress : bool or function of (done, total), optional
        True draws a bar on a terminal.

    Examples
    --------
    >>> import fracfit
    >>> curve = fracfit.describing_function([20, 25, 30], restitution=0.8, force=50, clearance=0.3)
    >>> curve
    DescribingFunction(3 points: 1 symmetric, 2 periodic)
    >>> omega, response = curve
    >>> bool(abs(response[0]) > abs(response[1]))
    True
    """
    omega = real_array(omega, "omega")
    scene = {"mass1": mass1, "mass2": mass2, "clearance": clearance}
    contact = contact_or_none(restitution, contact_stiffness, contact_damping, friction1, friction2)
    takes_time = contact is not None
    scene |= {"restitution": restitution} if contact is None else contact
    scene["force"] = force
    receptances = []
    for name, given, mass, value in (("load_receptance", load_receptance, "mass1", mass1), ("drive_receptance", drive_receptance, "mass2", mass2)):
        if given is not None and not np.all(np.asarray(value) == 1.0):
            raise ValueError(f"{mass} does not go with {name}: the mass is that in it")
        receptances.append(None if given is None else _model(given)._tf)
    has_receptances = any(each is not None for each in receptances)
    if protocol is None:
        protocol = "two-impact" if takes_time or has_receptances else "sweep-up"
    shape = shape_of(scene)
    lists = [
        np.ascontiguousarray(np.broadcast_to(real_array(value, name, ()).reshape(np.shape(value)), shape)).reshape(-1)
        for name, value in scene.items()
    ]
    options = _options(protocol, body, tolerance, mean_tolerance, threads)
    report = reporter(progress, "describing function")
    if takes_time:
        found = _core.compliant_describing_functions(lists, *receptances, omega, options, report)
    elif has_receptances:
        found = _core.bodies_describing_functions(lists, *receptances, omega, options)
    else:
        found = _core.describing_functions(*lists, omega, options, report)
    found = {name: value.reshape(shape + (omega.size,)) for name, value in found.items()}
    found["regime_code"] = found.pop("regime")
    return DescribingFunction({"omega": omega, **found})


def free_contact(*, stiffness: float, damping: float, mass1: float = 1.0, mass2: float = 1.0) -> dict[str, float]:
    """What a contact does to two bodies that meet and on which nothing else acts.

    Returns
    -------
    dict
        frequency (rad/s), damping_ratio, restitution, and duration (s), the time until the contact presses no more.

    Examples
    --------
    >>> import fracfit
    >>> round(fracfit.free_contact(stiffness=2e4, damping=50)["restitution"], 6)
    0.506277
    """
    return _core.free_contact(
        number(stiffness, "stiffness"), number(damping, "damping"), number(mass1, "mass1"), number(mass2, "mass2")
    )


@named
def contact_of_frequency(
    frequency: float, *, restitution: float | None = None, ratio: float | None = None, mass1: float = 1.0, mass2: float = 1.0
) -> dict[str, float]:
    """Stiffness and damping of the contact with that frequency sqrt(k (1/M1 + 1/M2)), rad/s, and restitution, in (0, 1],
    or damping ratio c/(2 sqrt(k m)), m = M1 M2/(M1 + M2), from 0.

    Examples
    --------
    >>> import fracfit
    >>> contact = fracfit.contact_of_frequency(600, restitution=0.6)
    >>> contact["contact_stiffness"]
    180000.0
    >>> scene = {"force": 40, "clearance": 0.3}
    >>> fracfit.describing_function([19, 20], protocol="two-impact", **scene, **contact)
    DescribingFunction(2 points: 2 symmetric)
    """
    frequency, mass1, mass2 = number(frequency, "frequency"), number(mass1, "mass1"), number(mass2, "mass2")
    mass = mass1 * mass2 / (mass1 + mass2)
    if (restitution is None) == (ratio is None):
        raise ValueError("give either restitution or ratio, of the damping of the contact")
    damping = number(ratio, "ratio") if restitution is None else _core.damping_ratio_of_restitution(number(restitution, "restitution"))
    return {"contact_stiffness": mass * frequency**2, "contact_damping": 2 * damping * mass * frequency}


@named
def drive(
    *,
    inertia1: float = 1.0,
    inertia2: float = 1.0,
    gear_ratio: float = 1.0,
    gap_degrees: float | None = None,
    torque: Any = None,
    torque_limit: float | None = None,
    friction_torque1: float | None = None,
    friction_torque2: float | None = None,
    load_torque: float | None = None,
    step_degrees: float | None = None,
) -> dict[str, Any]:
    """A rotating drive as two masses, seen from the shaft of its load: words for the functions that take such a scene.

    Positions are then angles in rad and forces torques in N m; x2 is the angle of the motor over the gear ratio, and a force the
    torque of the motor times it.

    Parameters
    ----------
    inertia1, inertia2 : float
        Of the load and of the motor, each at its own shaft, kg m^2.
    gear_ratio : float
        Turns of the motor per turn of the load.
    gap_degrees : float, optional
        Backlash at the shaft of the load, degrees.
    torque, torque_limit : float, optional
        Of the motor, N m: amplitude, or several, and largest one of the actuator.
    friction_torque1, friction_torque2 : float, optional
        Dry friction of the load and of the motor, N m.
    load_torque : float, optional
        Constant torque on the load, N m.
    step_degrees : float, optional
        Step of the set-point at the shaft of the load, degrees.

    Examples
    --------
    >>> import fracfit
    >>> fracfit.drive(inertia1=0.2, inertia2=0.01, gear_ratio=5, torque=[2, 4])
    {'mass1': 0.2, 'mass2': 0.25, 'force': [10.0, 20.0]}
    """
    ratio = number(gear_ratio, "gear_ratio")
    if not ratio > 0:
        raise ValueError(f"gear_ratio is {ratio:g}; allowed is above 0")
    values = {
        "mass1": (inertia1, "inertia1", 1.0),
        "mass2": (inertia2, "inertia2", ratio**2),
        "clearance": (gap_degrees, "gap_degrees", math.pi / 180),
        "force_limit": (torque_limit, "torque_limit", ratio),
        "friction1": (friction_torque1, "friction_torque1", 1.0),
        "friction2": (friction_torque2, "friction_torque2", ratio),
        "disturbance1": (load_torque, "load_torque", 1.0),
        "setpoint_step": (step_degrees, "step_degrees", math.pi / 180),
    }
    scene: dict[str, Any] = {name: number(value, word) * factor for name, (value, word, factor) in values.items() if value is not None}
    if torque is not None:
        scene["force"] = number(torque, "torque") * ratio if np.ndim(torque) == 0 else (real_array(torque, "torque") * ratio).tolist()
    return scene


@named
def static_describing_function(
    omega: Any, *, force: float = 1.0, clearance: float = 1.0, mass1: float = 1.0, mass2: float = 1.0
) -> FrequencyResponse:
    """The static model of backlash as a describing function of the two masses, m/N: without impacts, in closed form.

    Examples
    --------
    >>> import fracfit
    >>> rigid = fracfit.static_describing_function([1.0, 2.0], clearance=0.0)  # -1/((M1 + M2) omega^2)
    >>> rigid.response.real
    array([-0.5  , -0.125])
    """
    omega = real_array(omega, "omega")
    scene = (number(mass1, "mass1"), number(mass2, "mass2"), number(clearance, "clearance"), number(force, "force"))
    return FrequencyResponse(omega, _core.static_describing_function(*scene, omega), unit="m/N", metadata=_COMPUTED)


def symmetric_loss_factor(restitution: float) -> float:
    """Im(-1/N)/((M1 + M2) omega^2) of x1 where two impacts per period lie half a period apart: (pi/4) (1-e)/(1+e).

    It holds whatever force, clearance and masses, so that Im(-1/N) rises with omega^2 there, exactly.

    Examples
    --------
    >>> import fracfit
    >>> curve = fracfit.describing_function([20.0, 30.0], restitution=0.6, force=40, clearance=0.3)
    >>> loss = curve.minus_inverse.imag / (2 * curve.omega**2)
    >>> bool(abs(loss / fracfit.symmetric_loss_factor(0.6) - 1).max() < 1e-12)
    True
    """
    return _core.symmetric_loss_factor(number(restitution, "restitution"))


def restitution_from_loss_factor(loss_factor: float) -> float | None:
    """The restitution at which `symmetric_loss_factor` is this: what one point of a curve tells; None where there is none.

    Examples
    --------
    >>> import fracfit
    >>> round(fracfit.restitution_from_loss_factor(fracfit.symmetric_loss_factor(0.6)), 12)
    0.6
    """
    return _core.restitution_from_loss_factor(number(loss_factor, "loss_factor"))


@named
def regime_map(
    omega: Any,
    restitution: Any = None,
    *,
    force: float = 1.0,
    clearance: float = 1.0,
    mass1: float = 1.0,
    mass2: float = 1.0,
    contact_stiffness: Any = None,
    contact_damping: Any = None,
    friction1: float | None = None,
    friction2: float | None = None,
    protocol: str | None = None,
    body: str = "x1",
    tolerance: float = 1e-10,
    mean_tolerance: float = 0.01,
    threads: int = 0,
    progress: Any = None,
) -> RegimeMap:
    """Describing function and kind of motion over restitution and frequency; arguments as `describing_function`.

    Examples
    --------
    >>> import fracfit
    >>> fracfit.regime_map([1.0, 2.0, 3.0], [0.2, 0.8])
    RegimeMap(2 x 3 points: 2 symmetric, 1 periodic, 2 chatter, 1 averaged)
    >>> fracfit.regime_map([1.5, 2.0], contact_stiffness=[50.0, 200.0], contact_damping=1.0, protocol="two-impact")
    RegimeMap(2 x 2 points: 3 symmetric, 1 periodic)
    """
    if contact_stiffness is not None:
        dampings = np.nan if contact_damping is None else contact_damping
        pairs = np.broadcast_arrays(np.atleast_1d(contact_stiffness), dampings)
        curves = describing_function(
            omega, restitution=restitution, force=number(force, "force"), clearance=number(clearance, "clearance"),
            mass1=number(mass1, "mass1"), mass2=number(mass2, "mass2"), contact_stiffness=pairs[0],
            contact_damping=None if contact_damping is None else pairs[1],
            friction1=None if friction1 is None else number(friction1, "friction1"),
            friction2=None if friction2 is None else number(friction2, "friction2"), protocol=protocol, body=body,
            tolerance=tolerance, mean_tolerance=mean_tolerance, threads=threads, progress=progress,
        )  # fmt: skip
        free = [free_contact(stiffness=k, damping=c, mass1=mass1, mass2=mass2) for k, c in zip(*pairs)]
        return RegimeMap({**curves._values(), "restitution": np.array([each["restitution"] for each in free])})
    contact_or_none(restitution, contact_stiffness, contact_damping, friction1, friction2)
    omega = real_array(omega, "omega")
    restitution = real_array(restitution, "restitution")
    options = _options("sweep-up" if protocol is None else protocol, body, tolerance, mean_tolerance, threads)
    scene = (number(mass1, "mass1"), number(mass2, "mass2"), number(clearance, "clearance"), number(force, "force"))
    found = _core.regime_map(*scene, restitution, omega, options, reporter(progress, "map"))
    found["regime_code"] = found.pop("regime")
    return RegimeMap({"omega": omega, "restitution": restitution, **found})


class OrbitBranch(_Record, Table):
    """Periodic orbits of one pattern along a parameter.

    Attributes
    ----------
    period, impacts : int
        Force periods and impacts of each orbit.
    symmetric : bool
        Each half of the period mirrors the other.
    parameter, omega, response, stable, multipliers : ndarray
        Of each orbit.
    bifurcations : list of dict
        With kind, parameter, response, and the index of the orbit before.
    begin, end : str
        Why the branch ends there.
    """

    period: int
    impacts: int
    symmetric: bool
    parameter: Array
    omega: Array
    response: Array
    stable: Array
    multipliers: Array
    bifurcations: list[dict[str, Any]]
    begin: str
    end: str

    def _columns(self) -> dict[str, Any]:
        values = {"parameter": self.parameter, "omega_rad_s": self.omega, "re_m_per_n": self.response.real, "im_m_per_n": self.response.imag}
        return {**values, "stable": self.stable}

    def __repr__(self) -> str:
        name = f"{self.impacts} impacts in {self.period} periods"
        low, high = self.parameter.min(), self.parameter.max()
        stable = int(self.stable.sum())
        return f"OrbitBranch({name}, {low:.5g} to {high:.5g}, {stable} of {len(self.stable)} orbits stable)"


@named
def orbits(
    start: float,
    stop: float,
    *,
    parameter: str = "omega",
    omega: float | None = None,
    restitution: float | None = None,
    force: float = 1.0,
    clearance: float = 1.0,
    mass1: float = 1.0,
    mass2: float = 1.0,
    body: str = "x1",
    longest_period: int = 4,
    most_impacts: int = 16,
    basins_at: Any = (),
    contact_stiffness: float | None = None,
    contact_damping: float | None = None,
    friction1: float | None = None,
    friction2: float | None = None,
    threads: int = 0,
    progress: Any = None,
) -> list[OrbitBranch]:
    """Branches of periodic orbits, stable and unstable, between two values of a parameter.

    Parameters
    ----------
    start, stop : float
        Range of the parameter.
    parameter : {"omega", "force", "clearance", "restitution", "contact-frequency"}
        What changes; the others are held.  "restitution" is of contacts that take no time; "contact-frequency", rad/s, of the
        others, at the damping ratio of `contact_stiffness` and `contact_damping`.
    longest_period, most_impacts : int
        Force periods and impacts of the longest orbits kept.
    basins_at : float or array_like
        Values within the range at which every orbit is followed that `basins` finds from its usual starts.
    contact_stiffness, contact_damping, friction1, friction2 : float, optional
        In place of a restitution: contacts that take time, N/m and N s/m, see `contact_of_frequency`, and dry friction, N.

    Examples
    --------
    >>> import fracfit
    >>> branch = fracfit.orbits(1.9, 2.5, restitution=0.6)[0]
    >>> branch.symmetric, branch.impacts, bool(branch.stable.all())
    (True, 2, True)
    """
    one_of(parameter, "parameter", ("omega", "force", "clearance", "restitution", "contact-frequency"))
    given = (contact_stiffness, contact_damping, friction1, friction2)
    is_hard = parameter == "restitution" and all(each is None for each in given)
    contact = None if is_hard else contacts_of(restitution, *given)
    if not number(start, "start") < number(stop, "stop"):
        raise ValueError(f"start is {start:g}; it must be less than stop, {stop:g}")
    if omega is None and parameter != "omega":
        raise ValueError(f"omega has no value; it is needed where {parameter} changes")
    looked_at = real_array(np.atleast_1d(np.asarray(basins_at, dtype=float) if np.size(basins_at) == 0 else basins_at), "basins_at")
    for value in looked_at:
        if not start <= value <= stop:
            raise ValueError(f"basins_at {value:g} lies outside of start to stop, {start:g} to {stop:g}")
    found = _core.orbits(
        number(mass1, "mass1"),
        number(mass2, "mass2"),
        number(clearance, "clearance"),
        0.0 if restitution is None else number(restitution, "restitution"),
        number(force, "force"),
        number(start, "start") if omega is None else number(omega, "omega"),
        text(parameter, "parameter"),
        number(start, "start"),
        number(stop, "stop"),
        body_of(body),
        count(longest_period, "longest_period"),
        count(most_impacts, "most_impacts"),
        looked_at,
        count(threads, "threads"),
        contact,
        reporter(progress, "orbits"),
    )
    return [OrbitBranch(each) for each in found]


class LimitCycles(_Record, Table):
    """Limit cycles of a loop.

    Attributes
    ----------
    cycles : list of dict
        Exact: symmetric ones of two impacts by rising frequency, then others that motions have settled on.  Each with
        omega (rad/s), symmetric, impacts_per_period, admissible with the reason, stable, impact_speed (m/s),
        dominant_multiplier (per half period of the former, per period of the latter), and harmonics as tuples of order and the phasors of x1, x2 (m) and the force (N).
    predicted : list of dict
        What the describing function predicts on the orbits with two impacts, symmetric or not.
    motions : list of str
        What became of each motion from a seeded start: cycle, quiet, irregular or diverged.
    searched : (float, float)
        rad/s, where symmetric cycles of two impacts were looked for.
    certain : bool
        None of them in that range can be missing.
    any_frequency : bool
        Every frequency is that of a cycle.
    rests : (float, float) or None
        m: where dry friction can hold the measured body, of contacts that take time.  `searched` and `certain` tell nothing then.
    """

    cycles: list[dict[str, Any]]
    predicted: list[dict[str, Any]]
    motions: list[str]
    searched: tuple[float, float]
    certain: bool
    any_frequency: bool
    rests: tuple[float, float] | None

    def _columns(self) -> dict[str, Any]:
        names = ("omega", "symmetric", "impacts_per_period", "impact_speed", "admissible", "stable")
        return {name: [cycle[name] for cycle in self.cycles] for name in names}

    def __repr__(self) -> str:
        found = sum(cycle["admissible"] for cycle in self.cycles)
        lines = [f"LimitCycles({found} found, {len(self.predicted)} predicted)"]
        for cycle in self.cycles:
            kind = "stable" if cycle["stable"] else "unstable"
            if cycle["impacts_per_period"] != 2 or not cycle["symmetric"]:
                kind += f", {cycle['impacts_per_period']} impacts"
            lines.append(f"  {cycle['omega']:.6g} rad/s, " + (kind if cycle["admissible"] else f"no motion: {cycle['reason']}"))
        return "\n".join(lines)


@named
def limit_cycles(
    controller: Model | str,
    *,
    restitution: float | None = None,
    clearance: float = 1.0,
    mass1: float | None = None,
    mass2: float | None = None,
    load_receptance: Model | str | None = None,
    drive_receptance: Model | str | None = None,
    contact_stiffness: float | None = None,
    contact_damping: float | None = None,
    friction1: float | None = None,
    friction2: float | None = None,
    body: str = "x1",
    band: tuple[float, float] | None = None,
    harmonics: int = 5,
    starts: int = 3,
    branches: bool = False,
) -> LimitCycles:
    """Limit cycles of two bodies with backlash under the force ``-C(s) x`` on body 2.

    All symmetric ones with two impacts in a period, and others that motions from seeded starts settle on.

    Parameters
    ----------
    controller : Model or str
        C, N per m.
    mass1, mass2 : float, optional
        1 kg unless a receptance stands for it.
    load_receptance, drive_receptance : Model or str, optional
        Displacement per force of body 1 and 2, m/N, instead of free masses.
    contact_stiffness, contact_damping, friction1, friction2 : float, optional
        In place of a restitution: contacts that take time, N/m and N s/m, see `contact_of_frequency`; with them dry friction
        on the bodies, N.
    body : {"x1", "x2"}
        Body whose position is measured.
    band : (float, float), optional
        Where to look for symmetric cycles, rad/s.
    starts : int
        Motions simulated, 0 or more; none where the driven body is measured with dead time.
    branches : bool
        Predict on the orbits of more impacts under a sine force too; of free masses, some seconds.

    Examples
    --------
    >>> import fracfit
    >>> fracfit.limit_cycles("1 + s^0.5", restitution=0.6)
    LimitCycles(1 found, 2 predicted)
      1.58132 rad/s, stable
    """
    contact = contacts_of(restitution, contact_stiffness, contact_damping, friction1, friction2)
    if contact is not None and branches:
        raise ValueError("branches has no meaning with contact_stiffness, whose predictions stand on the orbit next to each cycle")
    found = _core.limit_cycles(
        _model(controller)._tf,
        _bodies(restitution, clearance, mass1, mass2, load_receptance, drive_receptance, body, contact),
        None if band is None else pair(band, "band"),
        count(harmonics, "harmonics"),
        count(starts, "starts"),
        flag(branches, "branches"),
    )
    return LimitCycles(found)


@named
def jump_frequency(
    *,
    restitution: float,
    force: float = 1.0,
    clearance: float = 1.0,
    mass1: float = 1.0,
    mass2: float = 1.0,
    criterion: str = "sweep-up",
) -> float | None:
    """Frequency at which the describing function jumps, rad/s; None where there is no jump.

    The command ``fracfit jump-law`` takes "two-impact-loss" unless told otherwise.

    Parameters
    ----------
    criterion : {"two-impact-loss", "symmetry-loss", "saddle-node", "contact-at-rest", "mid-gap-at-rest", "sweep-up", "sweep-down"}
        What is taken for the jump.

    Examples
    --------
    >>> import fracfit
    >>> round(fracfit.jump_frequency(restitution=0.5, criterion="contact-at-rest"), 6)  # sqrt(2)
    1.414214
    """
    scene = (mass1, mass2, clearance, restitution, force)
    return _core.jump_frequency(*(number(each, "scene") for each in scene), text(criterion, "criterion"))


def contact_or_none(restitution: Any, stiffness: Any, damping: Any, friction1: Any, friction2: Any) -> dict[str, Any] | None:
    """Contacts that take time, and dry friction, as they were given; None where a restitution was given instead."""
    if (stiffness is None) == (restitution is None):
        raise ValueError("give either restitution or contact_stiffness with contact_damping")
    if stiffness is not None:
        if damping is None:
            raise ValueError("contact_stiffness needs contact_damping")
        friction = {"friction1": friction1, "friction2": friction2}
        return {"contact_stiffness": stiffness, "contact_damping": damping, **{name: 0.0 if value is None else value for name, value in friction.items()}}
    for name, value in (("contact_damping", damping), ("friction1", friction1), ("friction2", friction2)):
        if value is not None:
            raise ValueError(f"{name} has no meaning with restitution, whose contacts take no time")
    return None


def contacts_of(restitution: Any, contact_stiffness: Any, contact_damping: Any, friction1: Any, friction2: Any) -> tuple[float, ...] | None:
    """The same as numbers: stiffness, damping, and the friction of both bodies."""
    contact = contact_or_none(restitution, contact_stiffness, contact_damping, friction1, friction2)
    return None if contact is None else tuple(number(value, name) for name, value in contact.items())


def _model(given: Model | str) -> Model:
    return given if isinstance(given, Model) else Model(given)


def _bodies(
    restitution: Any, clearance: Any, mass1: Any, mass2: Any, load_receptance: Any, drive_receptance: Any, body: Any, contact: Any
) -> dict[str, Any]:
    """Two bodies with clearance, as the compiled part takes them; `contact` of contacts_of(), or None with a restitution."""
    return {
        "mass1": None if mass1 is None else number(mass1, "mass1"),
        "mass2": None if mass2 is None else number(mass2, "mass2"),
        "load_receptance": None if load_receptance is None else _model(load_receptance)._tf,
        "drive_receptance": None if drive_receptance is None else _model(drive_receptance)._tf,
        "clearance": number(clearance, "clearance"),
        "restitution": 1.0 if contact is not None else number(restitution, "restitution"),
        "contact": contact,
        "body": body_of(body),
    }


def _options(protocol: str, body: str, tolerance: float, mean_tolerance: float, threads: int) -> dict[str, Any]:
    return {
        "protocol": text(protocol, "protocol"),
        "body": body_of(body),
        "tolerance": number(tolerance, "tolerance"),
        "mean_tolerance": number(mean_tolerance, "mean_tolerance"),
        "threads": count(threads, "threads"),
    }
