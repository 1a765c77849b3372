# SPDX-License-Identifier: BSD-3-Clause
"""One structure fitted to many curves together, and the law of the jump over many scenes."""

from __future__ import annotations

from typing import Any, Literal, Mapping, Sequence, overload

import numpy as np

from ._arrays import Array, count, flag, mapping, number, real_array, seed_number, text, texts
from ._data import FrequencyResponse, TimeSeries
from ._doors import data_of
from ._fit import Known, Limits, Priors, _described, _fitted_part, _fitting, _known, _one_of, _structure, weight_of, without_noise
from ._model import Model, _Record, realisation_of
from ._numbers import JointFitNumbers, JumpLawNumbers
from ._tables import Table
from ._text import html_table, reporter, short
from ._words import named


@_described("JointFit")
class JointFit(_Record, JointFitNumbers, Table):
    """One structure fitted to many curves, with shared parameters and parameters of each curve.

    ``result["K"]`` is the value of a shared parameter; of one that each curve has of its own an array over the curves.

    Attributes
    ----------
    priors : list of dict
        What became of the priors of shared parameters.
    usable : bool
    summary : str
    """

    priors: list[dict[str, Any]]
    usable: bool
    summary: str
    _data: list[Any]
    _shift: str | None
    _realisation: Mapping[str, Any] | None

    @property
    def parameters(self) -> dict[str, float]:
        """Value of each shared parameter, and of those of the laws."""
        return {each["name"]: each["value"] for each in self.shared}

    @property
    def ci95(self) -> dict[str, tuple[float, float]]:
        """Their intervals of 95 %."""
        return {each["name"]: (each["ci95_lower"], each["ci95_upper"]) for each in self.shared}

    @property
    def names(self) -> list[str]:
        """Names of the curves."""
        return [each["name"] for each in self.curves]

    @property
    def each(self) -> dict[str, Array]:
        """Values of the parameters that are not shared, over the curves."""
        shared = self.parameters
        names = [each["name"] for each in self.curves[0]["parameters"]] if self.curves else []
        return {name: self._over_curves(name, "value") for name in names if name not in shared}

    def master_curve(self) -> MasterCurve:
        """Every point of all curves moved onto the master curve, with what the fit says there; of fits with `shift`.

        Examples
        --------
        >>> import fracfit, numpy as np
        >>> omega, lag = np.logspace(-1, 1, 9), "K/(T s^a + 1)"
        >>> curves = [fracfit.Model(lag, K=1, T=T, a=0.7).frequency_response(omega) for T in (1, 3)]
        >>> master = fracfit.joint_fit(curves, lag, shift="horizontal").master_curve()
        >>> bool(np.allclose(master.response, master.model, atol=1e-6)), bool((np.diff(master.omega) >= 0).all())
        (True, True)
        """
        if self._shift is None:
            raise ValueError("the curves lie on no master curve: fit them with shift='horizontal' or 'both'")
        parts: dict[str, list[Any]] = {name: [] for name in ("omega", "response", "curve", "omega_measured", "model")}
        for name, data, curve in zip(self.names, self._data, self.curves):
            values = {each["name"]: each["value"] for each in curve["parameters"]}
            omega = data.omega * values.get("aT", 1.0)
            formula = Model(self.model)
            still = {each: 1.0 if each in ("aT", "bT") else values[each] for each in formula.parameter_names}
            model = Model(self.model, **still).frequency_response(omega, realisation=self._realisation).response
            for key, column in zip(parts, (omega, data.response / values.get("bT", 1.0), [name] * data.size, data.omega, model)):
                parts[key].extend(column)
        order = np.argsort(parts["omega"], kind="stable")
        return MasterCurve({key: np.array(column)[order] for key, column in parts.items()})

    def _over_curves(self, name: str, key: str) -> Array:
        return np.array([next(p[key] for p in curve["parameters"] if p["name"] == name) for curve in self.curves])

    def __getitem__(self, name: str) -> Any:
        found: dict[str, Any] = {**self.each, **self.parameters}
        if name not in found:
            raise KeyError(f"the fit has no parameter {name!r}; it has {', '.join(found)}")
        return found[name]

    def _columns(self) -> dict[str, Any]:
        columns: dict[str, Any] = {"curve": self.names}
        for name in self.each:
            columns[name] = self._over_curves(name, "value")
            columns[f"{name}_standard_error"] = self._over_curves(name, "standard_error")
        for i, derived in enumerate(self.curves[0]["derived"] if self.curves else ()):
            columns[derived["name"]] = [curve["derived"][i]["value"] for curve in self.curves]
            columns[f"{derived['name']}_standard_error"] = [curve["derived"][i]["standard_error"] for curve in self.curves]
        return {**columns, "rms": [curve["rms"] for curve in self.curves], "rms_alone": [curve["rms_alone"] for curve in self.curves]}

    def __repr__(self) -> str:
        own = [f"  {name}: {', '.join(short(float(value)) for value in values)}" for name, values in self.each.items()]
        return "\n".join([self.summary, *own])

    def _repr_html_(self) -> str:
        columns = self._columns()
        rows = [tuple(column[i] for column in columns.values()) for i in range(len(self.curves))]
        shown = 2 if self.without_noise else 5
        shared = html_table(
            ["shared", "value", "standard error", "from", "to (95 %)"][:shown],
            [(p["name"], p["value"], p["standard_error"], p["ci95_lower"], p["ci95_upper"])[:shown] for p in self.shared],
            f"{self.model}, {len(self.curves)} curves",
        )
        return shared + html_table(list(columns), [[float(cell) if isinstance(cell, np.floating) else cell for cell in row] for row in rows])


class MasterCurve(_Record, Table):
    """All curves of a joint fit moved onto one.

    Attributes
    ----------
    omega, response : ndarray
        Frequency times aT, rad/s, rising, and value over bT.
    curve : ndarray of str
        Name of the curve that each point is of.
    omega_measured : ndarray
        Where it was measured, rad/s.
    model : ndarray of complex
        What the fit says there.
    """

    omega: Array
    response: Array
    curve: Array
    omega_measured: Array
    model: Array

    def _columns(self) -> dict[str, Any]:
        columns = {"omega": self.omega, "re": self.response.real, "im": self.response.imag, "curve": self.curve}
        return {**columns, "omega_measured": self.omega_measured, "model_re": self.model.real, "model_im": self.model.imag}

    def __repr__(self) -> str:
        return f"MasterCurve({self.omega.size} points of {len(set(self.curve))} curves, {self.omega[0]:.6g} to {self.omega[-1]:.6g} rad/s)"


@named
def joint_fit(
    data: Any,
    model: Model | str,
    *,
    shared: str | Sequence[str] = (),
    each: str | Sequence[str] = (),
    law: str | Sequence[str] = (),
    covariates: Sequence[Mapping[str, float]] | None = None,
    shift: str | None = None,
    reference: int | str = 0,
    names: Sequence[str] | None = None,
    component: str = "both",
    weight: str | None = None,
    loss: str = "none",
    fixed: Known = None,
    bounds: Limits = None,
    start: Known = None,
    prior: Priors = None,
    constraint: str | Sequence[str] = (),
    derive: str | Sequence[str] = (),
    realisation: Mapping[str, Any] | None = None,
    offset: float | None = None,
    trend: bool = False,
    earlier_input: bool = False,
    noise: str | None = None,
    seed: int = 1,
    threads: int = 0,
    fix: Known = None,
    bound: Limits = None,
) -> JointFit:
    """Fits one structure to many curves at once, with parameters in common.

    Parameters
    ----------
    data : sequence, or mapping by name
        Frequency responses and records over time, side by side, each as of `fit`.
    model : Model or str
        As of `fit`.
    shared, each : str or sequence of str
        Parameters that all curves have in common, or the other way round those that each has of its own.
    law : str or sequence of str
        ``"T = T0 exp(E/(8.314 temperature))"``: a parameter as a law of what is known of each curve; other names are fitted.
    covariates : sequence of mapping, optional
        What is known of each curve; numbers in the metadata of the data are known besides.
    shift : {"horizontal", "both"}, optional
        Lays the curves on one master curve, by factors aT of the frequency and with both bT of the value.
    reference : int or str
        Curve that is not moved, by index or name.
    names : sequence of str, optional
        Of the curves.
    derive : str or sequence of str
        Quantities computed from the parameters of each curve, see ``curves[i]["derived"]``.
    component, weight, ...
        As of `fit`; offset, trend, earlier_input and noise are of records over time.

    Examples
    --------
    >>> import fracfit, numpy as np
    >>> omega = np.logspace(-1, 2, 20)
    >>> curves = [fracfit.Model("K/(0.5 s^0.7 + 1)", K=k).frequency_response(omega) for k in (1, 2)]
    >>> result = fracfit.joint_fit(curves, "K/(T s^a + 1)", shared=["T", "a"])
    >>> round(result["a"], 6), result["K"].round(6)
    (0.7, array([1., 2.]))
    """
    if isinstance(data, Mapping) and names is None:
        names, data = list(data), list(data.values())
    if isinstance(data, (str, FrequencyResponse, TimeSeries)) or not hasattr(data, "__iter__") or hasattr(data, "columns"):
        raise ValueError(f"data are of the type {type(data).__name__}; expected a sequence of FrequencyResponse and TimeSeries")
    curves = [data_of(curve, name=f"data[{i}]") for i, curve in enumerate(data)]
    labels = [f"curve {i + 1}" for i in range(len(curves))] if names is None else texts(list(names) if isinstance(names, tuple) else names, "names")
    if len(labels) != len(curves):
        raise ValueError(f"names are {names!r}; expected one for each of the {len(curves)} curves")
    parts = [_fitted_part(curve, component) for curve in curves]
    curves = [curve for curve, _ in parts]
    component = next((part for curve, part in parts if isinstance(curve, FrequencyResponse)), component)
    formula, starts = _structure(model)
    known = _covariates(curves, covariates)
    beforehand = _known(starts, _one_of(fixed, fix, "fixed", "fix"), _one_of(bounds, bound, "bounds", "bound"), start, prior, constraint)
    laws = texts(law, "law")
    common = _shared(formula, _words(shared, "shared"), _words(each, "each"), beforehand["fixed"], laws, shift)
    if shift is not None and shift not in ("horizontal", "both"):
        raise ValueError(f"shift is {shift!r}; expected horizontal or both")
    options = {
        "component": component,
        "weight": weight_of(weight, curves),
        "without_noise": without_noise(curves),
        "loss": loss,
        "realisation": realisation_of(realisation),
        "offset": None if offset is None else number(offset, "offset"),
        "trend": flag(trend, "trend"),
        "earlier_input": flag(earlier_input, "earlier_input"),
        "noise": noise,
        "seed": seed_number(seed),
        "shared": common,
        "law": laws,
        "shift": shift,
        "reference": _index(reference, labels),
        "threads": count(threads, "threads"),
        **beforehand,
    }
    found = _fitting.joint_fit([curve._arrays() for curve in curves], labels, known, formula, options, texts(derive, "derive"))
    return JointFit({**found, "_data": curves, "_shift": shift, "_realisation": realisation})


def _words(given: str | Sequence[str], name: str) -> list[str]:
    listed = given.split(",") if isinstance(given, str) else given
    if not isinstance(listed, (list, tuple)):
        raise ValueError(f"{name} is {given!r}; expected names of parameters")
    return [text(word, name).strip() for word in listed if not isinstance(word, str) or word.strip()]


def _shared(formula: str, shared: list[str], each: list[str], fixed: Mapping[str, float], laws: list[str], shift: str | None) -> list[str]:
    if shared and each:
        raise ValueError("shared and each say the same the other way round; give one of them")
    if not shared and not each and not laws and shift is None:
        raise ValueError("shared, each, law or shift is needed: which parameters the curves have in common")
    names = Model(_fitting.formula_of(formula)).parameter_names
    for name in (*shared, *each):
        if name not in names:
            raise ValueError(f"{name!r} is no parameter of {formula}; its parameters: {', '.join(names)}")
    if shared:
        return shared
    of_laws = {law.partition("=")[0].strip() for law in laws}
    return [name for name in names if name not in each and name not in fixed and name not in of_laws]


def _covariates(curves: Sequence[Any], given: Sequence[Mapping[str, float]] | None) -> list[list[tuple[str, float]]]:
    if given is not None and (not isinstance(given, (list, tuple)) or len(given) != len(curves)):
        raise ValueError(f"covariates are {given!r}; expected a mapping for each of the {len(curves)} curves")
    found = []
    for i, curve in enumerate(curves):
        known: dict[str, float] = {}
        for key, value in curve.metadata.items():
            try:
                known[key] = float(value)
            except (TypeError, ValueError):
                continue
        if given is not None:
            known.update({name: number(value, f"covariates {name}") for name, value in mapping(given[i], "covariates").items()})
        found.append(list(known.items()))
    return found


def _index(reference: int | str, labels: list[str]) -> int:
    if isinstance(reference, str):
        if reference not in labels:
            raise ValueError(f"reference {reference!r} is no curve; there are {', '.join(labels)}")
        return labels.index(reference)
    index = count(reference, "reference")
    if index >= len(labels):
        raise ValueError(f"reference is {index}; expected an index below {len(labels)}")
    return index


@_described("JumpLaw")
class JumpLaw(_Record, JumpLawNumbers, Table):
    """Jump frequencies over force and clearance, and their power laws ``w_J = a F^b``.

    Attributes
    ----------
    usable : bool
    summary : str
    """

    usable: bool
    summary: str

    def _columns(self) -> dict[str, Any]:
        unit = {"force": "force_n", "clearance": "clearance_m", "omega_jump": "omega_jump_rad_s"}
        names = ("force", "clearance", "restitution", "omega_jump")
        return {unit.get(name, name): np.array([point[name] for point in self.points], dtype=float) for name in names}

    def __repr__(self) -> str:
        return self.summary

    def _repr_html_(self) -> str:
        rows = [(each["clearance"], each["law"]["coefficient"], each["law"]["exponent"]) for each in self.laws]
        return html_table(["clearance, m", "a", "b"], rows, self.summary)


class JumpConstants(_Record, Table):
    """Constants ``c = w_J/sqrt(F/(M2 Delta))`` of the jump.

    Attributes
    ----------
    rows : list of dict
        Each with similarity_constant (None where there is no jump) and message, what happens at the jump or why there is none;
        and restitution, or of contacts that take time force (N), clearance (m), contact_stiffness (N/m), contact_damping
        (N s/m), stiffness_group ``K Delta M2/(m F)``, exponent and clearance_exponent, of force and clearance near by.
    """

    rows: list[dict[str, Any]]

    def _columns(self) -> dict[str, Any]:
        unit = {"force": "force_n", "clearance": "clearance_m", "contact_stiffness": "contact_stiffness_n_m", "contact_damping": "contact_damping_n_s_m", "message": "meaning"}
        names = list(self.rows[0]) if self.rows else []
        columns = {unit.get(name, name): [row[name] for row in self.rows] for name in names}
        return {name: values if name == "meaning" else np.array(values, dtype=float) for name, values in columns.items()}

    def __repr__(self) -> str:
        return f"JumpConstants({len(self.rows)} rows, {sum(row['similarity_constant'] is not None for row in self.rows)} with a jump)"


@overload
def jump_law(
    *,
    constants: Literal[False] = False,
    restitution: Any = None,
    force: Any = ...,
    clearance: Any = ...,
    mass1: float = 1.0,
    mass2: float = 1.0,
    contact_stiffness: Any = None,
    contact_damping: Any = None,
    friction1: float = 0.0,
    friction2: float = 0.0,
    criterion: str | None = None,
    threads: int = 0,
    progress: Any = None,
) -> JumpLaw: ...
@overload
def jump_law(
    *,
    constants: Literal[True],
    restitution: Any = None,
    force: Any = ...,
    clearance: Any = ...,
    mass1: float = 1.0,
    mass2: float = 1.0,
    contact_stiffness: Any = None,
    contact_damping: Any = None,
    friction1: float = 0.0,
    friction2: float = 0.0,
    criterion: str | None = None,
    threads: int = 0,
    progress: Any = None,
) -> JumpConstants: ...
@named
def jump_law(
    *,
    constants: bool = False,
    restitution: Any = None,
    force: Any = (10.0, 20.0, 30.0, 40.0, 50.0),
    clearance: Any = (0.01, 0.025, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5),
    mass1: float = 1.0,
    mass2: float = 1.0,
    contact_stiffness: Any = None,
    contact_damping: Any = None,
    friction1: float = 0.0,
    friction2: float = 0.0,
    criterion: str | None = None,
    threads: int = 0,
    progress: Any = None,
) -> JumpLaw | JumpConstants:
    """Jump frequency over force and clearance, and its power laws.

    Parameters
    ----------
    constants : bool
        Instead of the laws the constants ``w_J/sqrt(F/(M2 Delta))`` over restitution, with what happens at each jump: a
        `JumpConstants`.  Where contacts take time there is one for each force, clearance and contact.
    restitution, force, clearance : array_like
        Coefficients of restitution that are averaged over, force amplitudes (N) and clearances (m), two or more different
        ones of the latter two; by default the grid of the paper.
    contact_stiffness, contact_damping : float or array_like
        In place of restitutions: contacts that take time, N/m and N s/m.
    friction1, friction2 : float
        With them: dry friction on the masses, N.
    criterion : str
        As of `jump_frequency`; "two-impact-loss" unless given, where contacts take time "symmetry-loss" or "saddle-node".

    Examples
    --------
    Similarity has the exponent 1/2 of the force.

    >>> import fracfit
    >>> law = fracfit.jump_law(restitution=[0.5], force=[10, 20], clearance=[0.1, 0.2])
    >>> round(law.laws[0]["law"]["exponent"], 9)
    0.5
    >>> soft = fracfit.jump_law(contact_stiffness=1e5, contact_damping=80.0)
    >>> round(soft.laws[0]["law"]["exponent"], 6)
    0.420702
    """
    takes_time = contact_stiffness is not None
    if takes_time and (restitution is not None or contact_damping is None):
        raise ValueError("contact_stiffness needs contact_damping" if restitution is None else "give either restitution or contact_stiffness with contact_damping")
    if not takes_time and contact_damping is not None:
        raise ValueError("contact_damping has no meaning without contact_stiffness")
    friction = number(friction1, "friction1"), number(friction2, "friction2")
    if not takes_time and any(friction):
        raise ValueError("friction1 and friction2 need contact_stiffness with contact_damping")
    if restitution is None:
        restitution = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
    if criterion is None:
        criterion = "symmetry-loss" if takes_time else "two-impact-loss"
    lists = [real_array(np.atleast_1d(value), name) for name, value in (("force", force), ("clearance", clearance), ("restitution", restitution))]
    masses = number(mass1, "mass1"), number(mass2, "mass2")
    if takes_time:
        contacts = [np.ascontiguousarray(each, dtype=float) for each in np.broadcast_arrays(
            *(real_array(np.atleast_1d(value), name) for name, value in (("contact_stiffness", contact_stiffness), ("contact_damping", contact_damping)))
        )]  # fmt: skip
        if flag(constants, "constants"):
            return JumpConstants({"rows": _fitting.contact_jump_constants(*masses, *lists[:2], *contacts, text(criterion, "criterion"), *friction)})
        return JumpLaw(_fitting.contact_jump_law(*masses, *lists[:2], *contacts, text(criterion, "criterion"), *friction, count(threads, "threads"), reporter(progress, "jump-law")))
    request = (*masses, *lists, text(criterion, "criterion"), count(threads, "threads"), reporter(progress, "jump-law"))
    if flag(constants, "constants"):
        return JumpConstants({"rows": _fitting.jump_constants(*request)})
    return JumpLaw(_fitting.jump_law(*request))
