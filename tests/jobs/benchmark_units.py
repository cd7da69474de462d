#!/usr/bin/env python3
"""Twelve events of a unit at bus 32 of the IEEE 39-bus grid, as a phasor measurement unit on the high side of its
transformer would record them at 30/s: four faults, three losses of generation, three load steps, two line trips.

    benchmark_units.py SWINGBANK RAW DYR FOLDER {sharp,class-m,jumpless-f,meter-f}

Writes FOLDER/event1.csv to event12.csv (V in kV, angle in degrees, P in MW, Q in Mvar). Noise: 0.01 % on V, 0.005
degrees, 0.05 % of the unit's 800 MVA on P and Q. sharp: without filter. class-m: with PMUFILTER of class M for 30/s,
0.32 s long. It may act at the terminal, because filter and transformer are linear in voltage and current. jumpless-f: f
instead of the angle, with 1 mHz of noise and without the angle's steps. meter-f: as jumpless-f, but f is the mean over
two reports, in which the steps appear as peaks.
"""
import cmath
import math
import random
import subprocess
import sys

FINE, RATE = 960, 30  # samples/s of the simulation and of the record
MVA, KV, RATIO, REACTANCE = 8.0, 345.0, 1.07, 0.02j  # machine [100 MVA], grid side, transformer 10-32 [pu on 100 MVA]
EDGE = 160  # samples at FINE (five reports) omitted at each end, because half of the filter is 153 samples long
EVENTS = [
    ("--fault 14:2:2.08", 12), ("--fault 4:2:2.1", 12), ("--fault 21:2:2.07", 12), ("--fault 26:2:2.1:0:0.05", 12),
    ("--trip-generator 38:2", 30), ("--trip-generator 35:2:0.5", 30), ("--trip-generator 30:2", 30),
    ("--load-step 12:300:80:2", 20), ("--load-step 20:-350:-100:2", 20), ("--load-step 15:200:150:2", 20),
    ("--trip 13:14:1:2", 12), ("--trip 10:11:1:2", 12),
]


def simulated(program, raw, dyr, event, seconds, folder, measure):
    """Times [s], voltage [pu] and current [pu on 100 MVA] on the grid side."""
    out = f"{folder}/run.csv"
    subprocess.run([program, "simulate", "--raw", raw, "--dyr", dyr, "--widen-limits", *event.split(), "--rate", str(FINE),
                    "--t-end", str(seconds), "--plants", "32", "--channels", "V,theta,P,Q", "--loads", "raw", *measure,
                    "--out", out], check=True, capture_output=True)
    t, voltage, current = [], [], []
    with open(out) as file:
        next(file)
        for line in file:
            time, v, theta, p, q = (float(x) for x in line.split(",")[:5])  # an instrument adds f
            terminal = cmath.rect(v, theta)
            i = (complex(p, q) * MVA / terminal).conjugate()
            t.append(time)
            voltage.append((terminal - REACTANCE * i) * RATIO)
            current.append(i / RATIO)
    return t, voltage, current


def frequency(voltage, instrument):
    """Returns the frequency [Hz] of voltages sampled at FINE."""
    phase = [cmath.phase(v) for v in voltage]
    f = [math.remainder(b - a, math.tau) * FINE / math.tau for a, b in zip(phase, phase[1:])]
    f.append(f[-1])
    if instrument == "jumpless-f":
        for k in range(2, len(f) - 2):
            if min(abs(f[k] - f[k - 1]), abs(f[k] - f[k + 1])) > 0.3:
                f[k] = f[k - 1]
        return [60 + x for x in f]
    total, width = [0.0], FINE // RATE
    for x in f:
        total.append(total[-1] + x)
    ends = [(max(0, k - width), min(len(f), k + width)) for k in range(len(f))]
    return [60 + (total[b] - total[a]) / (b - a) for a, b in ends]


def main():
    program, raw, dyr, folder, instrument = sys.argv[1:]
    measure = ["--measure", "PMUFILTER:class=1,reports=30"] if instrument == "class-m" else []
    for k, (event, seconds) in enumerate(EVENTS, 1):
        t, voltage, current = simulated(program, raw, dyr, event, seconds, folder, measure)
        noise = random.Random(k)
        f = frequency(voltage, instrument) if instrument.endswith("-f") else None
        with open(f"{folder}/event{k}.csv", "w") as file:
            file.write(f"t_s,V_kV,{'f_Hz' if f else 'angle_deg'},P_MW,Q_Mvar\n")
            for j in range(EDGE if measure else 0, len(t) - (EDGE if measure else 0), FINE // RATE):
                v, i = voltage[j], current[j]
                power = 100 * v * i.conjugate()
                volts = abs(v) * KV * (1 + 1e-4 * noise.gauss(0, 1))
                angle = f[j] + 1e-3 * noise.gauss(0, 1) if f else math.degrees(cmath.phase(v)) + 0.005 * noise.gauss(0, 1)
                file.write(f"{t[j]:.4f},{volts:.4f},{angle:.6f},"
                           f"{power.real + 0.4 * noise.gauss(0, 1):.4f},{power.imag + 0.4 * noise.gauss(0, 1):.4f}\n")


main()
