# SPDX-License-Identifier: BSD-3-Clause
"""The fractional PID as it runs in a loop."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from . import _core
from ._arrays import Array, count, number, pair, real_array, text
from ._data import FrequencyResponse
from ._text import html_table
from ._words import named


class FractionalPid:
    """A fractional PID, sample by sample: ``u = kp (b r - y) + ki s^-lambda (r - y) + kd s^mu F(s) (c r - y)``.

    Parameters
    ----------
    kp, ki, kd : float
        Gains.
    lambda_, mu : float
        Orders of integration and differentiation, within (0, 2).
    sample_time : float
        In seconds.
    band : (float, float), optional
        On which the orders hold, rad/s; needed unless they are 1.
    tolerance : float
        Largest relative error on the band; or
    poles : int, optional
        Number of poles.
    minimum, maximum : float
        Limits of the output.
    anti_windup : {"back-calculation", "conditional-integration", "none"}
        What keeps the integral from running on while the output is cut.
    tracking_time : float
        Of back-calculation, s; 0 takes ``(kp/ki)^(1/lambda)``.
    derivative_filter_time : float
        Of ``F = 1/(1 + T s)``, s.
    setpoint_weight, derivative_setpoint_weight : float
        b and c.
    discretisation : {"direct", "tustin", "tustin-prewarped", "al-alaoui"}
        How the recursion in the samples is made.
    most_swing : float
        How far the derivative's answer to a step may rise again after its peak.

    Examples
    --------
    >>> from fracfit import FractionalPid
    >>> pid = FractionalPid(ki=1, lambda_=0.5, sample_time=0.01, band=(1e-4, 100))
    >>> pid.run(1.0, [0.0] * 100)[-1].round(2)  # half-order integral of 1 after 1 s, 2/sqrt(pi)
    1.13
    >>> "controller_step" in pid.c_header("controller")
    True
    """

    @named
    def __init__(
        self,
        kp: float = 0.0,
        ki: float = 0.0,
        kd: float = 0.0,
        *,
        sample_time: float,
        lambda_: float = 1.0,
        mu: float = 1.0,
        band: tuple[float, float] | None = None,
        tolerance: float = 1e-3,
        poles: int | None = None,
        minimum: float = -math.inf,
        maximum: float = math.inf,
        anti_windup: str = "back-calculation",
        tracking_time: float = 0.0,
        derivative_filter_time: float = 0.0,
        setpoint_weight: float = 1.0,
        derivative_setpoint_weight: float = 1.0,
        discretisation: str = "direct",
        most_swing: float = 0.15,
    ) -> None:
        self._config = {
            "kp": number(kp, "kp"),
            "ki": number(ki, "ki"),
            "kd": number(kd, "kd"),
            "lambda_": number(lambda_, "lambda_"),
            "mu": number(mu, "mu"),
            "sample_time": number(sample_time, "sample_time"),
            "band": None if band is None else pair(band, "band"),
            "tolerance": number(tolerance, "tolerance"),
            "poles": None if poles is None else count(poles, "poles"),
            "minimum": number(minimum, "minimum"),
            "maximum": number(maximum, "maximum"),
            "anti_windup": text(anti_windup, "anti_windup"),
            "tracking_time": number(tracking_time, "tracking_time"),
            "derivative_filter_time": number(derivative_filter_time, "derivative_filter_time"),
            "setpoint_weight": number(setpoint_weight, "setpoint_weight"),
            "derivative_setpoint_weight": number(derivative_setpoint_weight, "derivative_setpoint_weight"),
            "discretisation": text(discretisation, "discretisation"),
            "most_swing": number(most_swing, "most_swing"),
        }
        self._controller = _core.Controller(self._config)

    def step(self, setpoint: float, measured: float) -> float:
        """Output for the next sample; the last one where an input is not finite, see `bad_input`."""
        return self._controller.step(number(setpoint, "setpoint"), number(measured, "measured"))

    def run(self, setpoint: Any, measured: Any) -> Array:
        """Outputs for many samples, from where the last call ended.

        Parameters
        ----------
        setpoint : float or array_like
            One for all samples, or one for each.
        measured : array_like
            One for each sample.
        """
        measured = real_array(measured, "measured")
        setpoint = real_array(setpoint, "setpoint", () if np.ndim(setpoint) == 0 else measured.shape)
        return self._controller.run(setpoint, measured)

    def track(self, output: float) -> None:
        """The next output is this one: for a bumpless takeover, before every step while another source drives."""
        self._controller.track(number(output, "output"))

    def reset(self, setpoint: float | None = None, measured: float | None = None) -> None:
        """At rest; with values, at rest after signals that had been constant at them."""
        if setpoint is None and measured is None:
            self._controller.reset()
        else:
            self._controller.reset_at(number(setpoint, "setpoint"), number(measured, "measured"))

    def frequency_response(self, omega: Any) -> FrequencyResponse:
        """From control error to output, limits and weights aside; rad/s, below ``pi/sample_time``."""
        omega = real_array(omega, "omega")
        return FrequencyResponse(omega, self._controller.response(omega))

    def c_header(self, name: str = "controller", precision: str = "double") -> str:
        """The controller as a self-contained C99 header; its outputs are those of `step`, bit for bit."""
        how = {"name": text(name, "name"), "precision": text(precision, "precision"), "comment": "", "fixed_point": None}
        return self._controller.exported("c99", how)  # type: ignore[no-any-return]

    @property
    def output(self) -> float:
        """Last output."""
        return self._controller.output

    @property
    def saturated(self) -> bool:
        """The last output was cut at a limit."""
        return self._controller.saturated

    @property
    def bad_input(self) -> bool:
        """The last input was refused, as it was not finite."""
        return self._controller.bad_input

    @property
    def error(self) -> float:
        """Largest ``|C_running/C - 1|`` on the band, measured."""
        return self._controller.error

    @property
    def omega_at_error(self) -> float:
        """Where that is reached, rad/s."""
        return self._controller.omega_at_error

    @property
    def note(self) -> str:
        """What differs from what was asked; empty if nothing does."""
        return self._controller.note

    def __copy__(self) -> FractionalPid:
        other = FractionalPid.__new__(FractionalPid)
        other._config = dict(self._config)
        other._controller = self._controller.copy()
        return other

    def __deepcopy__(self, memo: dict[int, Any]) -> FractionalPid:
        return self.__copy__()

    def __getstate__(self) -> dict[str, Any]:
        return {"config": self._config, "state": self._controller.state(), "version": _core.version}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        if kept["version"] != _core.version:
            raise ValueError(f"the pickle is of fracfit {kept['version']}; this is {_core.version}")
        self._config = kept["config"]
        self._controller = _core.Controller(self._config)
        self._controller.set_state(kept["state"])

    def __repr__(self) -> str:
        shown = ("kp", "ki", "kd", "lambda_", "mu", "sample_time", "band")
        return "FractionalPid(" + ", ".join(f"{name}={self._config[name]}" for name in shown) + ")"

    def _repr_html_(self) -> str:
        return html_table(["", ""], [(name, str(value)) for name, value in self._config.items()], "FractionalPid")
