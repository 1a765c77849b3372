# SPDX-License-Identifier: BSD-3-Clause
"""Ctrl-C in the middle of computations that would take minutes: they end, at once and with all their threads.

How soon is printed, and judged where the machine has nothing else to do, see `PATIENCE`.  Without the flag they would run into
the time limit of the test.
"""

import os
import signal
import tempfile
import threading
import time

import numpy as np
import pytest

import fracfit

RANDOM = np.random.default_rng(7)
OMEGA = np.logspace(-2, 3, 4000)
NOISE = np.random.default_rng(8).normal(size=200_000)
CIRCUIT = "R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)"
CELL = fracfit.Model(CIRCUIT, R0=0.02, R1=0.03, Q1=0.05, n1=0.85, R2=0.06, Q2=4, n2=0.75)


def noisy(omega):
    response = CELL.frequency_response(omega).response
    noise = RANDOM.normal(size=(2, omega.size))
    return fracfit.FrequencyResponse(omega, response * (1 + 0.01 * (noise[0] + 1j * noise[1])))


def measured_plant():
    omega = np.logspace(-1, 2, 30)
    response = fracfit.Model("2/(0.5 s^1.2 + 1)").frequency_response(omega).response
    return fracfit.fit(fracfit.FrequencyResponse(omega, response * (1 + 0.02 * RANDOM.normal(size=30))), "K/(T s^a + 1)", outliers="keep")


def sampled():
    time = np.arange(20_000) * 0.01
    samples = RANDOM.normal(size=time.size)
    output = fracfit.Model("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)").respond(time, samples).output
    return fracfit.TimeSeries(time, samples, output + 0.01 * RANDOM.normal(size=time.size))


def table(rows=400_000):
    """A file with a long table, which goes with the process."""
    global TABLE
    if TABLE is None:
        TABLE = tempfile.NamedTemporaryFile("w", suffix=".csv")
        TABLE.write("f_Hz,re_ohm,im_ohm\n")
        TABLE.writelines(f"{1 + i * 1e-3:.6f},{1 / (1 + i * 1e-3):.9f},-0.123456789\n" for i in range(rows))
        TABLE.flush()
    return TABLE.name


TABLE = None
PLANT = measured_plant()
# s; a tenth where nothing else runs (FRACFIT_PATIENCE=0.1).  The flag is looked at every few milliseconds of work, which are more
# where others have the cores.
PATIENCE = float(os.environ.get("FRACFIT_PATIENCE", "5"))
LONG = {
    "read": lambda: [fracfit.read(table()) for _ in range(1000)],
    "jump_frequency": lambda: [fracfit.jump_frequency(restitution=0.9, criterion="sweep-up") for _ in range(1000)],
    "profile": lambda: [fracfit.fit(noisy(OMEGA), CIRCUIT).profile("n2") for _ in range(1000)],
    "controller": lambda: [
        fracfit.FractionalPid(kp=1, ki=2, lambda_=0.3 + 1e-4 * i, sample_time=1e-3, band=(1e-3, 1e3)) for i in range(1000)
    ],
    "margins": lambda: [
        (model.margins(), model.hinf_norm(), model.poles())
        for i in range(1000)
        for model in [fracfit.Model(f"exp(-s)/(s^2.3 + 0.{i + 1:04d} s^1.17 + 0.1 s^0.31 + 1)")]
    ],
    "respond": lambda: [
        CELL.respond(np.arange(200_000) * 0.01, RANDOM.normal(size=200_000)) for _ in range(1000)
    ],
    "describing_function": lambda: fracfit.describing_function(np.linspace(0.9, 1.6, 100_000), restitution=0.85),
    "independent points": lambda: fracfit.describing_function(
        np.linspace(0.9, 1.6, 100_000), restitution=0.85, protocol="contact-at-rest"
    ),
    "regime_map": lambda: fracfit.regime_map(np.linspace(0.9, 1.6, 1000), np.linspace(0.7, 0.95, 300), mean_tolerance=0),
    "orbits": lambda: [fracfit.orbits(0.4, 6, restitution=0.9, longest_period=30, most_impacts=60) for _ in range(50)],
    "validate": lambda: [fracfit.validate(noisy(OMEGA[::10])) for _ in range(1000)],
    "drt": lambda: [fracfit.drt(noisy(OMEGA[::10])) for _ in range(1000)],
    "drt of a fit": lambda: [
        fracfit.drt(CELL, tau=np.logspace(-6, 2, 100_000)) for _ in range(1000)
    ],
    "joint_fit": lambda: [
        fracfit.joint_fit([noisy(OMEGA[::10]) for _ in range(5)], CIRCUIT, shared=["R1", "n1"]) for _ in range(1000)
    ],
    "jump_law": lambda: [
        fracfit.jump_law(criterion="largest-discontinuity", restitution=[0.5, 0.9], threads=1) for _ in range(100)
    ],
    "history": lambda: [fracfit.history(1.41, restitution=0.9, periods=20_000, samples=100) for _ in range(100)],
    "multisine": lambda: fracfit.multisine((1, 1000), period=100, sample_time=1e-3, rounds=1_000_000),
    "response": lambda: [fracfit.response(input=NOISE, output=np.roll(NOISE, 3), sample_time=1e-3) for _ in range(1000)],
    "response of a periodic record": lambda: [
        fracfit.response(input=np.tile(NOISE[:50_000], 4), output=NOISE, sample_time=1e-3, excitation="periodic") for _ in range(1000)
    ],
    "basins": lambda: fracfit.basins(1.41, restitution=0.9, position=np.linspace(0, 1, 1000), velocity=np.linspace(-1, 1, 1000)),
    "loop": lambda: [fracfit.loop("1 + s^0.5", restitution=0.9, velocity2=1, duration=1e4, every=0.01, impacts=5_000_000) for _ in range(100)],
    "loop with the whole memory": lambda: [
        fracfit.loop("1 + s^0.5", restitution=0.9, velocity2=1, duration=1e5, whole_memory=True, impacts=1_000_000) for _ in range(100)
    ],
    "sampled loop": lambda: [
        fracfit.loop("2 + s^0.5", restitution=0.6, velocity2=1, duration=1000, sample_time=2e-4) for _ in range(100)
    ],
    "limit_cycles from starts": lambda: [
        fracfit.limit_cycles("0.5 + s^0.7 + 0.3/s^0.6", restitution=0.9, starts=50) for _ in range(50)
    ],
    "limit_cycles of receptances": lambda: [
        fracfit.limit_cycles("2 + s^0.5", restitution=0.6, load_receptance="1/(s^2 + 0.3 s^0.7)", starts=5) for _ in range(50)
    ],
    "tune with backlash": lambda: [
        fracfit.tune(clearance=0.01, restitution=0.5, load_receptance="1/(s^2 + 0.8 s)", crossover=2, phase_margin=0.9) for _ in range(10)
    ],
    "tune for a region": lambda: [
        fracfit.tune(PLANT, crossover=1, phase_margin=1, max_sensitivity=1.6, structure="pi")
        for _ in range(100)
    ],
    "export_spice": lambda: [
        fracfit.export_spice("s^-0.5", kind="impedance", band=(1e-6, 1e6), tolerance=1e-8) for _ in range(1000)
    ],
    "limit_cycles": lambda: [
        fracfit.limit_cycles("exp(-20 s) (1 + s^0.5)", restitution=0.6, band=(0.001, 100)) for _ in range(50)
    ],
    "fit": lambda: [fracfit.fit(noisy(OMEGA), CIRCUIT) for _ in range(1000)],
    "fit over time": lambda: [fracfit.fit(sampled(), "K exp(-L s)/(T2 s^a + T1 s^b + 1)") for _ in range(100)],
    "identify": lambda: fracfit.identify(noisy(OMEGA)),
    "batch": lambda: fracfit.batch([noisy(OMEGA[::10])] * 5000, CIRCUIT),
    "bootstrap": lambda: fracfit.fit(noisy(OMEGA[::10]), CIRCUIT).bootstrap(100_000),
    "tune": lambda: [
        fracfit.tune("exp(-0.1 s)/(s + 1)", minimise="iae", horizon=10, max_sensitivity=1.6) for _ in range(100)
    ],
    "mittag_leffler": lambda: [fracfit.mittag_leffler(0.7, 1, np.full(1_000_000, -1 + 1j)) for _ in range(100)],
    "mittag_leffler on the axis": lambda: [fracfit.mittag_leffler(0.7, 1, np.full(3_000_000, -1.0)) for _ in range(1000)],
    "frequency_response": lambda: [CELL._structure.response(CELL._values(), np.linspace(1, 2, 5_000_000), {"name": "exact"}) for _ in range(100)],
    "step by the reference": lambda: CELL.step(np.linspace(0, 100, 1_000_000), method="reference"),
    "step": lambda: [CELL.step(np.linspace(0, 1000, 1_000_000)) for _ in range(100)],
    "step by bdf2": lambda: CELL.step(np.linspace(0, 1000, 300_000), method="bdf2"),
    "derivative": lambda: [fracfit.derivative(np.ones(3_000_000), 0.5, 1.0) for _ in range(100)],
    "realise": lambda: [CELL.realise((1e-6, 1e6), 1e-8) for _ in range(100)],
    "approximate": lambda: [fracfit.approximate(0.5, (1e-12, 1e11), tolerance=1e-6) for _ in range(1000)],
    "identify_scene": lambda: [
        fracfit.identify_scene(
            [fracfit.describing_function(np.linspace(8, 35, 300), restitution=0.6, force=f, clearance=0.3).data() for f in (20, 40)],
            [20, 40],
            fixed={"mass1": 1},
        )
        for _ in range(100)
    ],
}


def threads():
    return len(os.listdir("/proc/self/task"))


def threads_left(before):
    """How many more threads there are; one that waits for more work goes within some hundredths of a second."""
    end = time.monotonic() + 10
    while threads() > before and time.monotonic() < end:
        time.sleep(0.01)
    return threads() - before


@pytest.mark.parametrize("name", LONG)
def test_control_c_ends_it(name):
    fracfit.describing_function([1.0], restitution=0.5)  # what numpy and the loader start once is there
    time.sleep(0.2)
    before = threads()
    sent = []

    def interrupt():
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(0.7, interrupt)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            LONG[name]()
        ended = time.monotonic()
    finally:
        timer.cancel()
        timer.join()
    print(f"\n{name}: ended {1e3 * (ended - sent[0]):.0f} ms after the signal")
    assert ended - sent[0] < PATIENCE
    assert threads_left(before) <= 0


def test_an_exception_of_the_callers_handler_ends_it_too():
    class Enough(Exception):
        pass

    def handler(number, frame):
        raise Enough

    old = signal.signal(signal.SIGUSR1, handler)
    timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGUSR1))
    timer.start()
    try:
        with pytest.raises(Enough):
            fracfit.describing_function(np.linspace(0.9, 1.6, 100_000), restitution=0.85)
    finally:
        timer.join()
        signal.signal(signal.SIGUSR1, old)


def test_a_forked_child_computes():
    """The thread that waits for more work is not there in the child."""
    fracfit.describing_function([1.0], restitution=0.5)
    child = os.fork()
    if child == 0:
        try:
            os._exit(0 if fracfit.describing_function([1.0], restitution=0.5).response.size == 1 else 2)
        finally:
            os._exit(1)
    signal.alarm(60)
    try:
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    finally:
        signal.alarm(0)


def test_other_threads_run_meanwhile():
    counted = []
    stop = threading.Event()

    def count():
        while not stop.is_set():
            counted.append(1)
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    fracfit.describing_function(np.linspace(0.9, 1.6, 1000), restitution=0.85)
    stop.set()
    thread.join()
    # Without the lock released the counter would stand still for the whole sweep.
    assert len(counted) > 5
