# SPDX-License-Identifier: BSD-3-Clause
"""Every formula that a page of a method displays, at random points, against what the module computes or by quadrature.

A formula that is changed, or a new one, has to be entered here: the text of each stands beside its check."""

import pathlib
import re

import command_line
import numpy as np
import pytest
from scipy import integrate, special

import fracfit

PAGES = pathlib.Path(command_line.DATA).parent / "tools/docs/methods"


def shown():
    found = []
    for page in sorted(PAGES.glob("*.md")):
        for tex in re.findall(r"^\$\$\n(.*?)\n\$\$$", page.read_text(), re.DOTALL | re.MULTILINE):
            found.append((page.stem, " ".join(tex.split())))
    return found


def close(value, exact, tolerance):
    assert np.all(np.abs(np.asarray(value) - exact) <= tolerance * np.abs(exact)), (value, exact)


@pytest.fixture
def random():
    return np.random.default_rng(2026)


class Scene:
    """A settled motion of two free masses of 1.5 and 1 kg and what follows from it."""

    def __init__(self, restitution, omega, force=40.0, clearance=0.3, mass1=1.5, mass2=1.0):
        scene = dict(restitution=restitution, force=force, clearance=clearance, mass1=mass1, mass2=mass2)
        self.e, self.w, self.F, self.gap, self.M1, self.M2 = restitution, omega, force, clearance, mass1, mass2
        curve = fracfit.describing_function([omega], **scene)
        assert curve.regime[0] == "symmetric"
        self.N = curve.response[0]
        self.stiffness = curve.minus_inverse[0]
        motion = fracfit.history(omega, **scene, skip=400, periods=1, samples=4000)
        before, after = motion.event == "before-impact", motion.event == "after-impact"
        # In units of clearance and phase; the sign is that of the change of the velocity.
        self.v = -(motion.v2 - motion.v1)[before] / (clearance * omega)
        self.phase = omega * motion.time[before]
        self.impulse = np.abs(mass1 * (motion.v1[after] - motion.v1[before]))
        sample = motion.event == "sample"
        self.samples = motion.time[sample][:-1], motion.x1[sample][:-1]
        self.gamma = force / (mass2 * clearance * omega**2)
        self.y = self.stiffness.imag / ((mass1 + mass2) * omega**2)


@pytest.fixture
def scene(random):
    return Scene(restitution=random.uniform(0.5, 0.8), omega=random.uniform(19.5, 24))


# Closed orbits are closed to 1e-11 of the clearance; some digits are lost in differences.
ORBIT = 1e-8


def scale_and_energy(scene, random):
    one_plus = -(1 + scene.e) / (np.pi * scene.gamma) * np.sum(scene.v * np.exp(-1j * scene.phase))
    close((scene.M1 + scene.M2) * scene.w**2 / one_plus, scene.stiffness, ORBIT)
    close((1 / one_plus).imag, scene.y, ORBIT)
    U = scene.gamma * (one_plus - 1)
    close(-(U / scene.gamma).imag / abs(1 + U / scene.gamma) ** 2, scene.y, ORBIT)


def harmonics(scene, random):
    # Samples at equal steps of a motion whose lines fall as 1/k^2: 4000 of them fold back 1/4000^2 or so of the first.
    time, x1 = scene.samples
    h1 = -(scene.M1 + scene.M2) * scene.w**2 * scene.N
    for k in (1, 3, 5):
        Nk = 2 * np.mean(x1 * np.exp(-1j * k * scene.w * time)) / scene.F
        hk = -(scene.M1 + scene.M2) * scene.w**2 * Nk
        close(hk, abs(h1) / k**2 * np.exp(1j * k * np.angle(h1)), 25 * 1e-6)


def loss_factor(scene, random):
    ratio = np.sum(scene.v**2) / abs(np.sum(scene.v * np.exp(-1j * scene.phase))) ** 2
    close(np.pi / 2 * (1 - scene.e) / (1 + scene.e) * ratio, scene.y, ORBIT)


def two_points(scene, random):
    a = (1 + scene.e) / (1 - scene.e)
    M, P = scene.M1 + scene.M2, scene.M2 * scene.gap
    close(np.pi / 4 * M / a, scene.stiffness.imag / scene.w**2, ORBIT)
    line = 2 * P * a / (np.pi * M) / (scene.F * abs(scene.N)) - np.pi / 2 * a
    close(line, scene.N.real / scene.N.imag, ORBIT)


def fundamental(scene, random):
    t, x = scene.samples
    # The trapezoidal rule over a period, with two kinks: (2 pi/4000)^2/12 of a jump in the slope of some amplitudes.
    close(2 * np.mean(x * np.exp(-1j * scene.w * t)) / scene.F, scene.N, 1e-5)


def forced_orbit(scene, random):
    h1 = 1 / scene.M1 + 1 / scene.M2
    S = -h1 * np.pi**2 / (8 * scene.w**2)  # the sum of 1/k^2 over odd k is pi^2/8
    I0 = scene.impulse[0]
    cosine = scene.gap / 2 + 2 * scene.w / np.pi * S * I0
    sine = h1 * (1 - scene.e) / (2 * (1 + scene.e)) * I0 / scene.w
    close(np.hypot(cosine, sine), scene.F / (scene.M2 * scene.w**2), ORBIT)


def cycle(random):
    found = fracfit.limit_cycles("20 + 8 s^0.9", clearance=0.3, restitution=0.6, starts=0).cycles[0]
    return found, found["omega"], 0.6


def cycle_equations(scene, random):
    found, w, e = cycle(random)
    k = np.arange(1, 2_000_001, 2.0)
    s = 1j * k * w
    G = 1 / s**2
    h = 2 * G + (20 + 8 * s**0.9) * G**2
    # Terms beyond 2e6 fall as k^-2.1 and k^-2: 1e-7 and 5e-7 of the sums.
    close(2 * w / np.pi * np.sum(k * w * h.imag), 2 * (1 - e) / (2 * (1 + e)), 1e-6)
    S, I0 = np.sum(h.real), found["impact_speed"] * (1 + e) / 2
    close(-np.pi * 0.3 / (4 * w * S), I0, 1e-6)
    amplitudes = [abs(harmonic[1]) for harmonic in found["harmonics"]]
    close(2 * w / np.pi * I0 * abs(G[:5]), amplitudes, 1e-10)


def cycle_frequency(scene, random):
    _, w, e = cycle(random)
    k = np.arange(1, 2_000_001, 2.0)
    close(np.sum((20 + 8 * (1j * k * w) ** 0.9).imag / k**3), np.pi / 4 * (1 - e) / (1 + e) * 2 * w**2, 1e-6)


def cycle_by_zeta(scene, random):
    found, w, e = cycle(random)
    odd = lambda p: (1 - 2.0**-p) * special.zeta(p)
    terms = ((0, 20.0), (0.9, 8.0))
    left = sum(c * w**p * np.sin(p * np.pi / 2) * odd(3 - p) for p, c in terms)
    close(left, np.pi / 4 * (1 - e) / (1 + e) * 2 * w**2, 1e-10)
    S = -2 * np.pi**2 / (8 * w**2) + sum(c * w ** (p - 4) * np.cos(p * np.pi / 2) * odd(4 - p) for p, c in terms)
    close(-np.pi * 0.3 / (4 * w * S), found["impact_speed"] * (1 + e) / 2, 1e-10)


def contact(scene, random):
    for e in (*random.uniform(0.15, 0.95, 3), 0.03):
        given = fracfit.contact_of_frequency(600, restitution=e)
        zeta = given["contact_damping"] / (2 * np.sqrt(given["contact_stiffness"] * 0.5))
        if zeta < 1:
            told = np.exp(-2 * zeta * np.arccos(zeta) / np.sqrt(1 - zeta**2))
        else:
            told = np.exp(-2 * zeta * np.arccosh(zeta) / np.sqrt(zeta**2 - 1))
        close(told, e, 1e-10)
        # A free contact, until the force has gone.
        force = lambda t, d: d[0] + 2 * zeta * d[1]
        force.terminal, force.direction = True, -1
        flight = integrate.solve_ivp(lambda t, d: (d[1], -force(t, d)), (0, 50), (0, 1), events=force, rtol=1e-10, atol=1e-13)
        close(-flight.y[1, -1], e, 1e-7)


def contact_energy(scene, random):
    w, F, gap, m = 20.0, 40.0, 0.3, 0.5
    given = fracfit.contact_of_frequency(random.uniform(150, 300), restitution=0.6)
    k, c = given["contact_stiffness"], given["contact_damping"]
    curve = fracfit.describing_function([w], force=F, clearance=gap, **given)
    # Of contacts that take time the command line has the motion.
    scene = ("--force", F, "--clearance", gap, "--contact-stiffness", repr(k), "--contact-damping", repr(c), "--omega", w)
    text = command_line.run("history", *scene, "--skip", 400, "--periods", 1, "--samples", 20_000, "--format", "csv", "--quiet")
    header, *rows = (line.split(",") for line in text.splitlines() if not line.startswith("#"))
    motion = np.array([row[:5] for row in rows if row[header.index("event")] == "sample"], dtype=float)[:-1].T
    t, y, v = motion[0], motion[3] - motion[1] - gap / 2, motion[4] - motion[2]
    wall = np.sign(y)
    d, rate = wall * y - gap / 2, wall * v
    p = np.where(d > 0, np.maximum(0, k * d + c * rate), 0)
    T = 2 * np.pi / w
    # The force jumps by c v where a contact begins at the speed v, which the sum meets to half a sample h: c h/((1-e^2) m) of
    # E and c h/((1+e) m) of P^2 and I^2, together no more than 4e-3.
    E = T * np.mean(p * rate)
    P = 2 * np.mean(wall * p * np.exp(-1j * w * t))
    loss = curve.minus_inverse[0].imag
    close(w**4 * E / (np.pi * abs(P) ** 2), loss, 4e-3)
    close(m * w**2 * E / (np.pi * abs(P) ** 2), loss / (2 * w**2), 4e-3)
    far = wall > 0
    I = T * np.mean(p * far)
    kappa = abs(T * np.mean(p * far * np.exp(-1j * w * t))) / I
    close(np.pi / 4 * m * E / (I**2 * kappa**2), loss / (2 * w**2), 4e-3)


def noise_of_a_ratio(scene, random):
    y, u = random.normal(size=(2, 50)) + 1j * random.normal(size=(2, 50))
    G, U = complex(*random.normal(size=2)), complex(*random.normal(size=2))
    mean = lambda a, b: np.mean(a * b.conj())
    told = (mean(y, y) - 2 * (G.conjugate() * mean(y, u)).real + abs(G) ** 2 * mean(u, u)) / abs(U) ** 2
    error = (y - G * u) / U
    close(told, mean(error, error), 1e-13)


def passages(scene, random):
    F, L, T, s = (complex(*random.normal(size=2)) for _ in range(4))
    delay, n = np.exp(-T * s), 4
    told = sum(F * (-L) ** k * delay**k for k in range(n)) + F * (-L) ** n * delay**n / (1 + L * delay)
    close(told, F / (1 + L * delay), 1e-12)


def cut_and_poles(scene, random):
    a = random.uniform(1.2, 1.8)
    H = lambda s: 1 / (s**a + 1)
    poles = [np.exp(sign * 1j * np.pi / a) for sign in (1, -1)]
    instants = random.uniform(0.5, 10, 3)
    exact = fracfit.Model(f"1/(s^{a!r} + 1)").step(np.sort(instants)).output
    for t, y in zip(np.sort(instants), exact):
        # r = e^u; s^a on the upper side of the cut.
        image = lambda u: (1 / (np.exp(a * (u + 1j * np.pi)) + 1)).imag * np.exp(-np.exp(u) * t)
        cut = integrate.quad(image, -40, 10, epsabs=1e-12, limit=500)[0] / np.pi
        residues = sum(np.exp(p * t) / (a * p ** (a - 1) * p) for p in poles).real
        close(H(0) + residues + cut, y, 1e-9)


def ray_before_the_axis(scene, random):
    # Gerischer's 1/sqrt(1 + T s) answers a step with erf(sqrt(t/T)).
    T = random.uniform(0.5, 2)
    H = lambda s: 1 / np.sqrt(1 + T * s)
    turn = np.exp(0.75j * np.pi)
    for t in random.uniform(0.5, 10, 3):
        image = lambda u: (H(np.exp(u) * turn) * np.exp(np.exp(u) * turn * t)).imag
        ray = integrate.quad(image, -60, 10, epsabs=1e-12, limit=500)[0] / np.pi
        close(0.75 * H(0) + ray, special.erf(np.sqrt(t / T)), 1e-9)


def relaxation(scene, random):
    n = random.uniform(0.4, 0.9)
    density = lambda u: -(1 / (1 + np.exp(n * (1j * np.pi - u)))).imag / np.pi  # tau = e^u, T = 1
    s = 1j * random.uniform(0.1, 10)
    part = lambda which: integrate.quad(lambda u: which(density(u) / (1 + s * np.exp(u))), -60, 60, epsabs=1e-12, limit=500)[0]
    close(part(np.real) + 1j * part(np.imag), 1 / (1 + s**n), 1e-9)


def series(scene, random):
    alpha, beta, z = random.uniform(0.5, 2), random.uniform(0.5, 2), complex(*random.uniform(-1, 1, 2))
    k = np.arange(150)
    close(fracfit.mittag_leffler(alpha, beta, z), np.sum(z**k * special.rgamma(alpha * k + beta)), 1e-12)


def ladder(scene, random):
    a, w = random.uniform(0.2, 0.8), 10 ** random.uniform(-2, 2, 50)
    found = fracfit.approximate(a, band=(0.01, 100), tolerance=1e-3)
    s = 1j * w[:, None]
    close(found.gain * np.prod((s - found.zeros) / (s - found.poles), axis=1), (1j * w) ** a, 1e-3)
    z, p = np.sort(found.zeros.real)[::-1], np.sort(found.poles.real)[::-1]
    assert np.all(z < 0) and np.all(p < z) and np.all(z[1:] < p[:-1])


def crossover_and_phase(scene, random):
    plant = fracfit.Model("3 exp(-s)/(10 s + 1)")
    w, phi = random.uniform(0.2, 0.4), np.pi / 3
    found = fracfit.tune(plant, crossover=w, phase_margin=phi, flat_phase=True)
    s = 1j * w
    C = found.kp + found.ki * s**-found.lambda_ + found.kd * s**found.mu
    slope = -found.ki * found.lambda_ * s ** (-found.lambda_ - 1) + found.kd * found.mu * s ** (found.mu - 1)
    close(C, np.exp(1j * (phi - np.pi)) / plant(s), 1e-9)
    # P'/P of 3 exp(-s)/(10 s + 1) is -1 - 10/(10 s + 1).
    close((slope / C).real, -(-1 - 10 / (10 * s + 1)).real, 1e-9)


# Beside a text a check, or the tests that hold it in C++.
FORMULAS = {
    ("loss-factor", r"-\frac{1}{N} ="): scale_and_energy,
    ("loss-factor", r"1 + \frac{U}{\gamma} ="): scale_and_energy,
    ("loss-factor", r"y = \frac{\pi}{2}"): loss_factor,
    ("loss-factor", r"\frac{\operatorname{Re}N}"): two_points,
    ("scene", r"\frac{\operatorname{Im}(-1/N)}"): two_points,
    ("scene", r"h_k = \frac{|h_1|}"): harmonics,
    ("describing-function", r"N(F, \omega) ="): fundamental,
    ("limit-cycles", r"\begin{aligned} F\,|G_2"): forced_orbit,
    ("limit-cycles", r"\begin{aligned} \frac{2\omega}{\pi}"): cycle_equations,
    ("limit-cycles", r"\begin{aligned} x_1 \text"): cycle_equations,
    ("limit-cycles", r"y' = q I"): cycle_equations,
    ("limit-cycles", r"\sum_k \frac{\operatorname{Im} C"): cycle_frequency,
    ("limit-cycles", r"\begin{aligned} \sum c"): cycle_by_zeta,
    ("compliant-contact", r"e = \begin{cases}"): contact,
    ("compliant-contact", r"p = \begin{cases}"): contact_energy,
    ("compliant-contact", r"\operatorname{Im}(-1/N) ="): contact_energy,
    ("compliant-contact", r"y = \frac{\pi}{4}"): contact_energy,
    ("response", r"G = \frac{Y}{U}"): noise_of_a_ratio,
    ("time-response", r"\frac{F}{1 + L"): passages,
    ("time-response", r"y(t) = H(0)"): cut_and_poles,
    ("time-response", r"y(t) = \frac{3}{4} H(0)"): ray_before_the_axis,
    ("drt", r"Z(s) ="): relaxation,
    ("mittag-leffler", r"E_{\alpha,\beta}(z) ="): series,
    ("realisation", r"s^a \approx"): ladder,
    ("tune", r"C(j\omega_c) ="): crossover_and_phase,
}
HELD_ELSEWHERE = {
    ("fit", r"\sigma^2 \left["): "tests/identification/uncertainty_test.cpp",
    ("fit", r"\ln L(h, \ell)"): "tests/identification/uncertainty_test.cpp",
    ("compliant-contact", r"K_2 \left(1"): "tests/tools/cli_drive_test.cpp",
    ("scene", r"f = k d + c d'"): "tests/tools/cli_drive_test.cpp",
    ("limit-cycles", r"y(t_a) ="): "tests/backlash/impact_cycles_test.cpp",
    ("limit-cycles", r"\begin{aligned} (q + \Gamma_1"): "tests/backlash/limit_cycles_test.cpp",
    ("limit-cycles", r"D(z) ="): "tests/backlash/limit_cycles_test.cpp",
}


def test_every_formula_shown_is_known():
    known = [*FORMULAS, *HELD_ELSEWHERE]
    for page, tex in shown():
        fitting = [start for name, start in known if name == page and tex.startswith(start)]
        assert len(fitting) == 1, (page, tex, fitting)
    for file in HELD_ELSEWHERE.values():
        assert (PAGES.parents[2] / file).exists()
    for page, start in known:
        assert any(name == page and tex.startswith(start) for name, tex in shown()), (page, start)


@pytest.mark.parametrize("check", list(dict.fromkeys(FORMULAS.values())), ids=lambda each: each.__name__)
def test_a_formula_holds(check, scene, random):
    check(scene, random)
