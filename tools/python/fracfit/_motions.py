# SPDX-License-Identifier: BSD-3-Clause
"""Motions of two masses with a clearance over time, and which of them each start leads to."""

from __future__ import annotations

import math
from typing import Any, Literal, overload

import numpy as np

from . import _core
from ._arrays import Array, body_of, count, flag, number, pair, real_array, seed_number
from ._backlash import contacts_of
from ._data import TimeSeries
from ._model import Model, _Record
from ._tables import Table
from ._text import reporter
from ._words import named


class _Motion(_Record, Table):
    """Positions and velocities of two masses over time."""

    time: Array
    x1: Array
    v1: Array
    x2: Array
    v2: Array
    event_code: Array
    _words: tuple[str, ...] = ()

    @property
    def event(self) -> Array:
        """What each row shows."""
        return np.array(self._words)[self.event_code]

    @property
    def size(self) -> int:
        """Number of rows."""
        return len(self.time)

    def _columns(self) -> dict[str, Any]:
        columns = {name: getattr(self, name) for name in ("time", "x1", "v1", "x2", "v2", "force") if name in self.__dict__}
        columns["event"] = self.event
        unit = {"time": "_s", "x1": "_m", "x2": "_m", "v1": "_m_s", "v2": "_m_s", "force": "_n"}
        return {name + unit.get(name, ""): column for name, column in columns.items()}

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.size} rows, 0 to {self.time[-1] if self.size else 0:g} s)"

    def _repr_html_(self) -> str:
        return f"<p><strong>{self!r}</strong></p>"


class _OfContacts(_Motion):
    """With the force of contacts, where these take time."""

    contact_code: Array | None
    contact_force: Array | None
    _hard_words: tuple[str, ...] = ()

    @property
    def _words(self) -> tuple[str, ...]:  # type: ignore[override]
        return self._hard_words if self.contact_force is None else _core.compliant_events

    @property
    def contact(self) -> Array | None:
        """Wall that the bodies are at in each row: none, near or far; None where it is not told."""
        return None if self.contact_code is None else np.array(["none", "near", "far"])[self.contact_code]

    def _columns(self) -> dict[str, Any]:
        columns = super()._columns()
        if self.contact_code is not None:
            columns["contact"] = self.contact
        return columns if self.contact_force is None else {**columns, "contact_force_n": self.contact_force}


class History(_OfContacts):
    """Positions and velocities of two masses with backlash over time, exact at every impact.

    Attributes
    ----------
    time, x1, v1, x2, v2 : ndarray
        s, m and m/s; the force is at its peak at time 0.
    event : ndarray of str
        sample, before-impact, after-impact, rest-begin or release; with contacts that take time sample, contact, separation
        (the wall presses no more), parting (the overlap has ended), and of each mass with friction stick-1, slide-1, reversal-1.
    contact_force : ndarray or None
        N, between the masses; None of contacts that take no time.
    complete : bool
        False where the millionth impact ended it early, or contacts that take time had 10^5 events in a period.
    usable : bool
        False where the periods to skip held more impacts than can be followed.
    """

    _hard_words = _core.history_events
    complete: bool
    usable: bool


class LoopMotion(_OfContacts):
    """Motion of a loop around two bodies with backlash.

    Attributes
    ----------
    time, x1, v1, x2, v2, force : ndarray
        s, m, m/s, and the controller's force on body 2 in N.
    event : ndarray of str
        sample, before-impact, after-impact, contact (the bodies stay together from there on) or release; with contacts that
        take time as of `History`.
    contact_force : ndarray or None
        N, between the bodies; None of contacts that take no time.
    impacts : int
        Their number, of contacts that take time that of those begun.
    end : str
        duration, rest, most-impacts, most-flights or diverged: why it ended.
    end_time : float
        In seconds.
    realisation_error : float
        Largest relative error of fractional powers as sums of exponentials.
    note : str
        Of a sampled controller what differs from what was asked.
    """

    force: Array
    _hard_words = _core.loop_events
    impacts: int
    end: str
    end_time: float
    realisation_error: float
    note: str


class RigRecord(_Record, Table):
    """What a rig writes down of two masses with backlash, as its sensors read it; `response` takes it.

    Attributes
    ----------
    time : ndarray
        s, at equal steps, as the clock gives it.
    force, x1, x2 : ndarray
        N, m.
    set_point : ndarray
        m, of a loop that a sine or a series of set-points drives; else empty.
    sample_time : float
        s
    complete : bool
        False where the motion could not be followed to its end: of `history` nothing is left then.
    """

    time: Array
    force: Array
    x1: Array
    x2: Array
    set_point: Array
    sample_time: float
    complete: bool

    @property
    def size(self) -> int:
        """Number of samples."""
        return self.time.size

    def series(self, body: str = "x1") -> TimeSeries:
        """Force and position of one body, as fits over time take them."""
        return TimeSeries(self.time, self.force, getattr(self, body_of(body)))

    def _columns(self) -> dict[str, Any]:
        columns = {"time_s": self.time, "force_n": self.force, "x1_m": self.x1, "x2_m": self.x2}
        return columns | ({"reference_m": self.set_point} if self.set_point.size else {})

    def __repr__(self) -> str:
        return f"RigRecord({self.size} samples, every {self.sample_time:g} s{'' if self.complete else ', not complete'})"

    def _repr_html_(self) -> str:
        return f"<p><strong>{self!r}</strong></p>"


class Basins(_Record, Table):
    """Which long-run motion each start leads to.

    Attributes
    ----------
    position, velocity : ndarray
        Of the starts, of x2 - x1: m, m/s.
    attractor : ndarray of int
        Index into `attractors` for each position (row) and velocity (column).
    attractors : list of dict
        Those of many starts first: regime, period, impacts_per_period, symmetric, response (m/N), uncertainty, starts.
    attracts : bool
        False at restitution 1, where nothing attracts and the motions of the starts are listed.
    """

    position: Array
    velocity: Array
    attractor: Array
    attractors: list[dict[str, Any]]
    attracts: bool

    @property
    def shares(self) -> Array:
        """Share of the starts that lead to each of them."""
        return np.array([each["starts"] for each in self.attractors]) / self.attractor.size

    def _columns(self) -> dict[str, Any]:
        position, velocity = np.meshgrid(self.position, self.velocity, indexing="ij")
        return {"position_m": position.reshape(-1), "velocity_m_s": velocity.reshape(-1), "attractor": self.attractor.reshape(-1)}

    def __repr__(self) -> str:
        lines = [f"Basins({self.attractor.shape[0]} x {self.attractor.shape[1]} starts, {len(self.attractors)} motions)"]
        for share, each in zip(self.shares, self.attractors):
            period = f", period {each['period']}" if each["period"] else ""
            lines.append(f"  {100 * share:.3g} %: {each['regime']}{period}, {each['impacts_per_period']:g} impacts per period")
        return "\n".join(lines)


@overload
def history(
    omega: float, *, restitution: float | None = None, force: float = 1.0, clearance: float = 1.0, mass1: float = 1.0,
    mass2: float = 1.0, contact_stiffness: float | None = None, contact_damping: float | None = None,
    friction1: float | None = None, friction2: float | None = None, position: float | None = None, velocity: float = 0.0,
    skip: int = 0, periods: int = 5, samples: int | None = None, sample_time: None = None,
) -> History: ...  # fmt: skip
@overload
def history(
    omega: Any, *, restitution: float | None = None, force: float = 1.0, clearance: float = 1.0, mass1: float = 1.0,
    mass2: float = 1.0, contact_stiffness: float | None = None, contact_damping: float | None = None,
    friction1: float | None = None, friction2: float | None = None, position: float | None = None, velocity: float = 0.0,
    skip: int = 0, periods: int = 5, samples: None = None, sample_time: float, sensor_noise: float = 0.0, force_noise: float = 0.0, quantisation: float = 0.0, clip: float = math.inf,
    sensor_delay: float = 0.0, clock_jitter: float = 0.0, seed: int = 1,
) -> RigRecord: ...  # fmt: skip
@named
def history(
    omega: Any,
    *,
    restitution: float | None = None,
    force: float = 1.0,
    clearance: float = 1.0,
    mass1: float = 1.0,
    mass2: float = 1.0,
    contact_stiffness: float | None = None,
    contact_damping: float | None = None,
    friction1: float | None = None,
    friction2: float | None = None,
    position: float | None = None,
    velocity: float = 0.0,
    skip: int = 0,
    periods: int = 5,
    samples: int | None = None,
    sample_time: float | None = None,
    sensor_noise: float = 0.0,
    force_noise: float = 0.0,
    quantisation: float = 0.0,
    clip: float = math.inf,
    sensor_delay: float = 0.0,
    clock_jitter: float = 0.0,
    seed: int = 1,
) -> History | RigRecord:
    """Positions and velocities of two masses with backlash under a sine force, exact at every impact.

    Parameters
    ----------
    omega : float
        rad/s, of the force, which is at its peak at time 0; in a record several, one after the other.
    contact_stiffness, contact_damping, friction1, friction2 : float, optional
        In place of a restitution: contacts that take time, N/m and N s/m, see `contact_of_frequency`; with them dry friction
        on the masses, N.
    position, velocity : float
        Of x2 - x1 at the start, m (mid-gap if not given) and m/s.
    skip, periods, samples : int
        Force periods before the first row, and to follow from there; rows per period, besides two per impact, 100 if not given.
    sample_time : float, optional
        s: gives the record of a rig instead, a `RigRecord`, of so many periods at each frequency.
    sensor_noise, force_noise : float
        Of a record: standard deviations of the white noise of both positions (m) and of the force (N).
    quantisation, clip, sensor_delay : float
        Of its positions: step of the converter (m), largest that is read (m), and by how much readings are late (s).
    clock_jitter, seed : float, int
        Standard deviation of each instant, s, at most a tenth of the time between samples; of the noise and the jitter.

    Examples
    --------
    >>> import fracfit
    >>> motion = fracfit.history(20.0, restitution=0.6, force=40, clearance=0.3, skip=200, periods=2)
    >>> int((motion.event == "before-impact").sum())  # two in each period
    4
    >>> rig = fracfit.history([20, 25, 30], restitution=0.6, force=40, clearance=0.3, periods=40, sample_time=1e-3, sensor_noise=1e-3)
    >>> found = fracfit.response(rig, output="x1")
    >>> scene = fracfit.identify_scene(found.frequency_response(), 40, fixed={"mass1": 1})
    >>> bool(abs(scene["clearance"] - 0.3) < 0.002)
    True
    """
    start = None if position is None else number(position, "position")
    contacts = contacts_of(restitution, contact_stiffness, contact_damping, friction1, friction2)
    followed = (start, number(velocity, "velocity"), count(skip, "skip"), count(periods, "periods"))
    sensors = _sensors(sample_time, "sample_time", sensor_noise, force_noise, quantisation, clip, sensor_delay, clock_jitter, seed)
    held = (mass1, mass2, clearance, 1.0 if restitution is None else restitution, force)
    if sensors is not None:
        if samples is not None:
            raise ValueError("samples has no meaning with sample_time, which is the time between rows")
        omegas = real_array(np.atleast_1d(omega), "omega")
        if not omegas.size:
            raise ValueError("omega is empty; expected one frequency or several")
        return RigRecord(_core.history_record(_scene(*held, omegas[0]), contacts, omegas, *followed, sensors))
    if np.size(omega) != 1:
        raise ValueError(f"omega names {np.size(omega)} frequencies; expected one, or sample_time for a record of a stepped sine")
    rows = 100 if samples is None else count(samples, "samples")
    if contacts is None:
        return History({**_core.history(_scene(*held, omega), *followed, rows), "contact_force": None})
    return History(_core.compliant_history(_scene(*held, omega), contacts, *followed, rows))


@named
def basins(
    omega: float,
    *,
    restitution: float | None = None,
    force: float = 1.0,
    clearance: float = 1.0,
    mass1: float = 1.0,
    mass2: float = 1.0,
    contact_stiffness: float | None = None,
    contact_damping: float | None = None,
    friction1: float | None = None,
    friction2: float | None = None,
    position: Any = None,
    velocity: Any = None,
    body: str = "x1",
    threads: int = 0,
    progress: Any = None,
) -> Basins:
    """Which long-run motion of two masses with backlash each start leads to, at one frequency.

    Parameters
    ----------
    omega : float
        rad/s, of the force, which is at its peak at the start.
    contact_stiffness, contact_damping, friction1, friction2 : float, optional
        As of `history`.
    position, velocity : array_like, optional
        Of x2 - x1, m and m/s; 41 from wall to wall, and 41 up to clearance times omega either way, if not given.
    progress : bool or function of (done, total), optional
        As of `describing_function`.

    Examples
    --------
    >>> import fracfit
    >>> found = fracfit.basins(1.41, restitution=0.6, position=[0.2, 0.5, 0.8], velocity=[-1, 0, 1])
    >>> found.attractor.shape, int(sum(each["starts"] for each in found.attractors))
    ((3, 3), 9)
    """
    contact = contacts_of(restitution, contact_stiffness, contact_damping, friction1, friction2)
    scene = _scene(mass1, mass2, clearance, 1.0 if contact is not None else restitution, force, omega)
    per_side = 41
    width, speed = scene[2], scene[2] * scene[5]
    positions = np.linspace(0, width, per_side) if position is None else real_array(np.atleast_1d(position), "position")
    velocities = np.linspace(-speed, speed, per_side) if velocity is None else real_array(np.atleast_1d(velocity), "velocity")
    return Basins(
        _core.basins(scene, contact, positions, velocities, body_of(body), count(threads, "threads"), reporter(progress, "basins"))
    )


@overload
def loop(
    controller: Model | str, *, restitution: float | None = None, clearance: float = 1.0, mass1: float | None = None,
    mass2: float | None = None, load_receptance: Model | str | None = None, drive_receptance: Model | str | None = None,
    contact_stiffness: float | None = None, contact_damping: float | None = None, friction1: float | None = None, friction2: float | None = None,
    body: str = "x1", velocity1: float = 0.0, velocity2: float = 0.0, setpoint_step: float = 0.0, setpoint_ramp: float = 0.0,
    setpoint_sine: tuple[float, float] | None = None, setpoint: TimeSeries | tuple[Any, Any] | None = None,
    setpoint_lag: float = 0.0, disturbance1: float = 0.0, disturbance2: float = 0.0,
    duration: float = 100.0, every: float = 0.0, sample_time: float | None = None, encoder_step: float = 0.0, force_limit: float = math.inf,
    tolerance: float = 1e-8, whole_memory: bool = False, impacts: int = 2000,
    record: Literal[False] = False,
) -> LoopMotion: ...  # fmt: skip
@overload
def loop(
    controller: Model | str, *, restitution: float | None = None, clearance: float = 1.0, mass1: float | None = None,
    mass2: float | None = None, load_receptance: Model | str | None = None, drive_receptance: Model | str | None = None,
    contact_stiffness: float | None = None, contact_damping: float | None = None, friction1: float | None = None, friction2: float | None = None,
    body: str = "x1", velocity1: float = 0.0, velocity2: float = 0.0, setpoint_step: float = 0.0, setpoint_ramp: float = 0.0,
    setpoint_sine: tuple[float, float] | None = None, setpoint: TimeSeries | tuple[Any, Any] | None = None,
    setpoint_lag: float = 0.0, disturbance1: float = 0.0, disturbance2: float = 0.0,
    duration: float = 100.0, every: float = 0.0, sample_time: float | None = None, encoder_step: float = 0.0, force_limit: float = math.inf,
    tolerance: float = 1e-8, whole_memory: bool = False, impacts: int = 2000,
    record: Literal[True], sensor_noise: float = 0.0, force_noise: float = 0.0, quantisation: float = 0.0, clip: float = math.inf,
    sensor_delay: float = 0.0, clock_jitter: float = 0.0, seed: int = 1,
) -> RigRecord: ...  # fmt: skip
@named
def loop(
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
    velocity1: float = 0.0,
    velocity2: float = 0.0,
    setpoint_step: float = 0.0,
    setpoint_ramp: float = 0.0,
    setpoint_sine: tuple[float, float] | None = None,
    setpoint: TimeSeries | tuple[Any, Any] | None = None,
    setpoint_lag: float = 0.0,
    disturbance1: float = 0.0,
    disturbance2: float = 0.0,
    duration: float = 100.0,
    every: float = 0.0,
    sample_time: float | None = None,
    encoder_step: float = 0.0,
    force_limit: float = math.inf,
    tolerance: float = 1e-8,
    whole_memory: bool = False,
    impacts: int = 2000,
    record: bool = False,
    sensor_noise: float = 0.0,
    force_noise: float = 0.0,
    quantisation: float = 0.0,
    clip: float = math.inf,
    sensor_delay: float = 0.0,
    clock_jitter: float = 0.0,
    seed: int = 1,
) -> LoopMotion | RigRecord:
    """Motion of a loop around two bodies with backlash: impacts, rests in contact, limits of the actuator.

    Parameters
    ----------
    controller, restitution, clearance, mass1, mass2, load_receptance, drive_receptance, body
        As of `limit_cycles`.
    contact_stiffness, contact_damping, friction1, friction2
        As of `limit_cycles`.
    velocity1, velocity2 : float
        m/s at the start; both bodies have rested at 0, in the middle of the clearance, until then.
    setpoint_step, setpoint_ramp : float
        m, m/s: what the measured position should be from time 0 on.
    setpoint_sine : (float, float), optional
        Amplitude (m) and frequency (rad/s) of a sine in it.
    setpoint : (array_like, array_like) or TimeSeries, optional
        Instants (s, from 0 on) and values (m) of a further part, straight between them; of a record its input.
    setpoint_lag : float
        s: the set-point passes 1/(setpoint_lag s + 1) first. A position controller K1 around a speed controller K2 (1 + 1/(T s)) is the
        controller ``(K1 + s) (K2 + K2/(T s))`` with the lag 1/K1.
    disturbance1, disturbance2 : float
        N: constant forces on the bodies from time 0 on; with sample_time on the first where contacts take time.
    duration, every : float
        s: time to follow, and between rows besides two per impact (0: none).
    sample_time : float, optional
        s: the controller runs in a computer as kp + ki/s^lambda + kd s^mu, its force held between samples.
    encoder_step : float
        m: with sample_time, step of the position that the computer reads; 0: none.
    force_limit : float
        N, of the actuator.
    tolerance : float
        Of fractional powers of s as sums of exponentials.
    whole_memory : bool
        Sums over all earlier impacts instead, exact; the work grows as their square.
    impacts : int
        To follow at most.
    record : bool
        What a rig writes down every `every` seconds instead, a `RigRecord`.
    sensor_noise, force_noise : float
        Of a record: standard deviations of the white noise of both positions (m) and of the force (N).
    quantisation, clip, sensor_delay : float
        Of its positions: step of the converter (m), largest that is read (m), and by how much readings are late (s).
    clock_jitter, seed : float, int
        Standard deviation of each instant, s, at most a tenth of the time between samples; of the noise and the jitter.

    Examples
    --------
    >>> import fracfit
    >>> motion = fracfit.loop("1 + s^0.5", restitution=0.6, velocity2=1, duration=60)
    >>> motion.end, motion.impacts == (motion.event == "before-impact").sum()
    ('duration', True)
    """
    from ._backlash import _bodies, _model

    instants: Any = None
    values: Any = None
    if isinstance(setpoint, TimeSeries):
        instants, values = setpoint.time, setpoint.input
    elif setpoint is not None:
        try:
            instants, values = setpoint
        except (TypeError, ValueError):
            raise ValueError(f"setpoint is {setpoint!r}; expected instants and values, or a TimeSeries") from None
        instants = real_array(instants, "instants of setpoint")
        values = real_array(values, "values of setpoint", instants.shape)
    if sample_time is not None and (setpoint_sine is not None or setpoint is not None or whole_memory):
        wrong = "whole_memory" if whole_memory else "setpoint_sine" if setpoint_sine is not None else "setpoint"
        raise ValueError(f"{wrong} has no meaning with sample_time, a controller in a computer")
    if sample_time is None and encoder_step != 0:
        raise ValueError("encoder_step has no meaning without sample_time, whose computer reads an encoder")
    contact = contacts_of(restitution, contact_stiffness, contact_damping, friction1, friction2)
    if contact is not None and whole_memory:
        raise ValueError("whole_memory has no meaning with contact_stiffness, whose contacts take time")
    if flag(record, "record") and sample_time is not None:
        raise ValueError("record has no meaning with sample_time, whose rows are the samples of its computer")
    if record and not number(every, "every") > 0:
        raise ValueError(f"every is {every:g}; a record needs the time between its samples, above 0")
    sensors = _sensors(every if record else None, "record", sensor_noise, force_noise, quantisation, clip, sensor_delay, clock_jitter, seed)
    given = {
        "sensors": sensors,
        "velocity1": number(velocity1, "velocity1"),
        "velocity2": number(velocity2, "velocity2"),
        "setpoint_step": number(setpoint_step, "setpoint_step"),
        "setpoint_ramp": number(setpoint_ramp, "setpoint_ramp"),
        "setpoint_sine": None if setpoint_sine is None else pair(setpoint_sine, "setpoint_sine"),
        "setpoint_time": instants,
        "setpoint_value": values,
        "setpoint_lag": number(setpoint_lag, "setpoint_lag"),
        "disturbance": (number(disturbance1, "disturbance1"), number(disturbance2, "disturbance2")),
        "duration": number(duration, "duration"),
        "every": number(every, "every"),
        "sample_time": None if sample_time is None else number(sample_time, "sample_time"),
        "encoder_step": number(encoder_step, "encoder_step"),
        "force_limit": number(force_limit, "force_limit"),
        "tolerance": number(tolerance, "tolerance"),
        "whole_memory": flag(whole_memory, "whole_memory"),
        "impacts": count(impacts, "impacts"),
    }
    bodies = _bodies(restitution, clearance, mass1, mass2, load_receptance, drive_receptance, body, contact)
    found = _core.loop(_model(controller)._tf, bodies, given)
    return LoopMotion(found) if sensors is None else RigRecord(found)


def _sensors(sample_time: float | None, record: str, *errors: Any) -> tuple[Any, ...] | None:
    """Errors of the sensors of a record; None where `record`, the word that asks for one, is not given."""
    names = ("sensor_noise", "force_noise", "quantisation", "clip", "sensor_delay", "clock_jitter", "seed")
    if sample_time is None:
        for name, value, default in zip(names, errors, (0, 0, 0, math.inf, 0, 0, 1)):
            if value != default:
                raise ValueError(f"{name} has no meaning without {record}, which makes the result a record")
        return None
    numbers = [number(value, name) for name, value in zip(names[:-1], errors)]
    for name, value in zip(names, numbers):
        if name == "clip" and not value > 0:
            raise ValueError(f"clip is {value:g}; allowed is above 0")
        if name != "clip" and not 0 <= value < math.inf:
            raise ValueError(f"{name} is {value:g}; allowed is a finite number from 0")
    return (number(sample_time, record), *numbers, seed_number(errors[-1]))


def _scene(*values: Any) -> tuple[float, ...]:
    return tuple(number(value, name) for value, name in zip(values, ("mass1", "mass2", "clearance", "restitution", "force", "omega")))
