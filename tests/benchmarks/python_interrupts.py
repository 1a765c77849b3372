#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How soon after Ctrl-C each long call of the Python module ends: 20 interrupts each, at seeded random times.

PYTHONPATH=build/tools/python tests/benchmarks/python_interrupts.py [--count N] [name...]
The calls are those of tests/python/interrupt_test.py.  On a machine with other work the times include waiting for a
core.
"""

import argparse
import os
import pathlib
import random
import signal
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "python"))
import interrupt_test


def seconds_to_end(work, delay):
    """From the signal to the KeyboardInterrupt; NaN where the work had ended before."""
    sent = []

    def interrupt():
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(delay, interrupt)
    timer.start()
    try:
        work()
        return float("nan")
    except KeyboardInterrupt:
        return time.monotonic() - sent[0]
    finally:
        timer.join()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("names", nargs="*", metavar="name")
    given = parser.parse_args()
    chosen = random.Random(11)
    print("call,median_ms,worst_ms")
    for name in given.names or interrupt_test.LONG:
        times = sorted(
            1000 * seconds_to_end(interrupt_test.LONG[name], 0.15 + 0.85 * chosen.random()) for _ in range(given.count)
        )
        print(f"{name},{times[len(times) // 2]:.0f},{times[-1]:.0f}", flush=True)


main()
