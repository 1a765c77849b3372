#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How far N of contacts whose force is k d^(3/2) (1 + chi d') (Hunt and Crossley) is from that of k d + c d' without
tension, where one free contact at the speed of the orbit has the same restitution and the same duration in both.

Two free masses of 1 kg, gap 1 m, forces of 1 and 2 N, 2 rad/s times the root of the force: the similarity of the hard
contact, so that only the contact tells the second column from the first.  Fourth-order Runge-Kutta in fixed steps, all
cases at once; the last column is what halving the step changes.

Usage: hunt_crossley.py [STEPS]   per period, 3000 if not given
"""

import sys

import numpy as np

REDUCED = 0.5  # kg
TRANSIENT, AVERAGED = 30, 4


def damping_ratio(restitution):
    low, high = 0.0, 0.99999
    for _ in range(80):
        zeta = (low + high) / 2
        e = np.exp(-2 * zeta * np.arccos(zeta) / np.sqrt(1 - zeta**2))
        low, high = (zeta, high) if e > restitution else (low, zeta)
    return low


def loss_of(restitution):
    """chi v with chi v (1 + e) = ln((1 + chi v)/(1 - e chi v))."""
    low, high = 1e-9, (1 - 1e-12) / restitution
    for _ in range(200):
        x = (low + high) / 2
        low, high = (x, high) if x * (1 + restitution) > np.log((1 + x) / (1 - restitution * x)) else (low, x)
    return low


def duration_of(loss):
    """Of the contact with m = k = v = 1."""
    d, v, t, h = 0.0, 1.0, 0.0, 1e-4
    f = lambda d, v: -max(d, 0.0) ** 1.5 * (1 + loss * v)
    while d >= 0:
        a1 = f(d, v)
        a2 = f(d + h / 2 * v, v + h / 2 * a1)
        a3 = f(d + h / 2 * (v + h / 2 * a1), v + h / 2 * a2)
        a4 = f(d + h * (v + h / 2 * a2), v + h * a3)
        d, v, t = d + h * v + h * h / 6 * (a1 + a2 + a3), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4), t + h
    return t


def orbit(press, force, omega, steps):
    """Phasor of x1 over the force, and the speed of contacts as they begin; arrays over the cases."""
    y, v = np.full(force.shape, 0.0), np.full(force.shape, 0.4) * np.sqrt(force)
    h = 2 * np.pi / omega / steps
    total, speed = np.zeros(force.shape, complex), np.zeros(force.shape)

    def push(y, v):
        side = np.sign(y)
        return side * press(np.maximum(side * y - 0.5, 0.0), side * v)

    for step in range((TRANSIENT + AVERAGED) * steps):
        angle = 2 * np.pi * np.array([step, step + 0.5, step + 1]) / steps
        drive = [force * np.cos(a) for a in angle]
        p = push(y, v)
        if step >= TRANSIENT * steps:
            total += p * np.exp(-1j * angle[0])
            begins = (np.abs(y) < 0.5) & (np.abs(y + h * v) >= 0.5)
            speed = np.where(begins, np.abs(v), speed)
        a1 = drive[0] - p / REDUCED
        a2 = drive[1] - push(y + h / 2 * v, v + h / 2 * a1) / REDUCED
        a3 = drive[1] - push(y + h / 2 * (v + h / 2 * a1), v + h / 2 * a2) / REDUCED
        a4 = drive[2] - push(y + h * (v + h / 2 * a2), v + h * a3) / REDUCED
        y, v = y + h * v + h * h / 6 * (a1 + a2 + a3), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return -2 * total / (AVERAGED * steps) / omega**2 / force, speed


def differences(steps):
    cases = [(e, ratio) for e in (0.3, 0.6, 0.8) for ratio in (8, 16)]
    e, ratio = np.array(cases).T
    zeta = np.array([damping_ratio(each) for each in e])
    loss = np.array([loss_of(each) for each in e])
    unit = np.array([duration_of(each) for each in loss])
    one = np.ones(len(cases))
    frequency = ratio * 2.0
    linear = lambda d, v: np.where(d > 0, np.maximum(REDUCED * (frequency**2 * d + 2 * zeta * frequency * v), 0.0), 0.0)
    duration = 2 * np.arccos(zeta) / np.sqrt(1 - zeta**2) / frequency
    first, speed = orbit(linear, one, 2.0, steps)
    stiffness = REDUCED * (unit / duration) ** 2.5 / np.sqrt(speed)
    hertz = lambda d, v: stiffness * d**1.5 * np.maximum(1 + loss / speed * v, 0.0)
    found = [np.abs(orbit(hertz, one, 2.0, steps)[0] / first - 1)]
    other = 2.0 * np.sqrt(2.0)
    found.append(np.abs(orbit(hertz, 2 * one, other, steps)[0] / orbit(linear, 2 * one, other, steps)[0] - 1))
    return cases, np.array(found)


def main():
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 3000
    cases, fine = differences(steps)
    coarse = differences(steps // 2)[1]
    print("restitution,contact frequency over that of the force,difference of N,at twice the force,error")
    for i, (e, ratio) in enumerate(cases):
        print(f"{e},{ratio:.0f},{fine[0, i]:.2e},{fine[1, i]:.2e},{np.abs(fine - coarse)[:, i].max():.0e}")


main()
