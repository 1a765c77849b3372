# SPDX-License-Identifier: BSD-3-Clause
"""Types of the numbers in results; written by tools/python/src/make_numbers, not by hand."""

from __future__ import annotations

from typing import Any


class EconomyNumbers:
    """Numbers of Economy."""

    component: str
    most_parameters: int
    rounding: float
    errors: list[float]
    verdict: str
    sentence: str
    curves: list[dict[str, Any]]


class FitResultNumbers:
    """Numbers of FitResult."""

    formula: str
    cost: float
    rms: float
    relative_rms: float
    gain_factor: float
    max_residual: float
    aicc: float
    bic: float
    termination: str
    residual_count: int
    free_parameters: int
    starts: int
    starts_at_best: int
    distinct_minima: int
    confidence_of_optimum: float
    condition: float
    noise_correlation: float
    smooth_error: float
    noise_floor: float
    seconds: float
    centre_omega: float
    loss_cost: float
    loss_scale: float
    loss_unit: float
    effective_parameters: float
    without_noise: bool
    outliers: list[int]
    earlier_input: list[float]
    priors: list[dict[str, Any]]


class IdentificationNumbers:
    """Numbers of Identification."""

    ranking: list[dict[str, Any]]
    skipped: list[str]
    verdict: str
    evidence: float
    departure_evidence: float
    evidence_beside_smooth_error: float
    departure_beside_smooth_error: float
    verdict_sentence: str
    notes: list[str]
    log10_odds: float
    model_error: bool
    noise_correlation: float
    noise_floor: float


class JointFitNumbers:
    """Numbers of JointFit."""

    model: str
    shared: list[dict[str, Any]]
    curves: list[dict[str, Any]]
    cost: float
    residuals: int
    free_parameters: int
    starts: int
    starts_at_best: int
    sharing_p_value: float
    condition: float
    termination: str
    message: str
    seconds: float
    loss_cost: float
    without_noise: bool
    effective_parameters: float


class JumpLawNumbers:
    """Numbers of JumpLaw."""

    criterion: str
    points: list[dict[str, Any]]
    constants: list[dict[str, Any]]
    mean_similarity_constant: float
    message: str
    laws: list[dict[str, Any]]
    a_of_clearance: dict[str, Any]
    b_of_clearance: dict[str, Any]


class RelaxationTimesNumbers:
    """Numbers of RelaxationTimes."""

    kernel: str
    lines: list[dict[str, Any]]
    peaks: list[dict[str, Any]]
    lines_left_off: int
    constant: float
    constant_lower: float
    constant_upper: float
    inductance: float
    inductance_lower: float
    inductance_upper: float
    elastance: float
    elastance_lower: float
    elastance_upper: float
    smoothness: float
    misfit: float
    misfit_in_noise: float


class SceneIdentificationNumbers:
    """Numbers of SceneIdentification."""

    parameters: list[dict[str, Any]]
    combinations: list[dict[str, Any]]
    contact: list[dict[str, Any]]
    contact_verdict: str
    contact_evidence: float
    friction: list[dict[str, Any]]
    friction_verdict: str
    friction_evidence: float
    free_directions: list[str]
    misfits: list[str]
    residual_correlation: float
    rivals: list[dict[str, Any]]
    cost: float
    rms: float
    max_residual: float
    termination: str
    message: str
    residuals: int
    free_parameters: int
    condition: float
    starts: int
    starts_at_best: int
    seconds: float
    points_used: int
    points: list[dict[str, Any]]
    covariance: list[list[float]]


class TuningNumbers:
    """Numbers of Tuning."""

    kp: float
    ki: float
    kd: float
    lambda_: float
    mu: float
    derivative_filter_time: float
    status: str
    message: str
    mu_limit: float
    mu_at_limit: bool
    nearby: dict[str, Any]
    closed_loop: str
    crossover: float
    phase_margin: float
    other_crossovers: list[dict[str, Any]]
    phase_slope: float
    gain_margin: float
    max_sensitivity: float
    omega_max_sensitivity: float
    max_complementary_sensitivity: float
    omega_max_complementary_sensitivity: float
    iae: float
    itae: float
    evaluations: int


class ValidationNumbers:
    """Numbers of Validation."""

    validity: str
    level: float
    accuracy: float
    tolerance: float
    findings: list[dict[str, Any]]
    departs: bool
    consistent_to: float
    largest_residual: float
    every: int
    real_poles: int
    pole_pairs: int
    dead_time: float
    noise: float
    noise_floor: float
    noise_slope: float
    correlation: float
    drift: float
    drift_deviation: float
    drift_law: str
    drift_explains: bool
    detectable_drift: float
    step: float
    step_deviation: float
    step_below: float
    step_above: float
    step_explains: bool
    drift_share: float
    step_share: float
    reversed_sign: bool
    freedom: float
    outliers: list[int]
    mains: list[int]
    frequency_unit: str
