#!/usr/bin/env python3
"""Twelve events of a unit at bus 32 of the IEEE 39-bus grid, as a phasor measurement unit on the high side of its
transformer would record them at 30/s: four faults, three losses of generation, three load steps, two lines tripped.

    benchmark_units.py SWINGBANK RAW DYR FOLDER {sharp,class-m}

Writes FOLDER/event1.csv to event12.csv (V in kV, angle in degrees, P in MW, Q in Mvar). Noise: 0.01 % on V, 0.005
degrees, 0.05 % of the unit's 800 MVA on P and Q. class-m: behind PMUFILTER of class M for 30/s, which is 0.32 s long; at
the terminal, for it and the transformer are linear in voltage and current.
"""
import cmath
import math
import random
import subprocess
import sys

FINE, RATE = 960, 30  # samples/s of the simulation and of the record
MVA, KV, RATIO, REACTANCE = 8.0, 345.0, 1.07, 0.02j  # machine [100 MVA], grid side, transformer 10-32 [pu on 100 MVA]
EDGE = 160  # five reports, in samples at FINE, left out at either end: half of the filter is 153 long
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


def main():
    program, raw, dyr, folder, instrument = sys.argv[1:]
    measure = ["--measure", "PMUFILTER:class=1,reports=30"] if instrument == "class-m" else []
    for k, (event, seconds) in enumerate(EVENTS, 1):
        t, voltage, current = simulated(program, raw, dyr, event, seconds, folder, measure)
        noise = random.Random(k)
        with open(f"{folder}/event{k}.csv", "w") as file:
            file.write("t_s,V_kV,angle_deg,P_MW,Q_Mvar\n")
            for j in range(EDGE if measure else 0, len(t) - (EDGE if measure else 0), FINE // RATE):
                v, i = voltage[j], current[j]
                power = 100 * v * i.conjugate()
                file.write(f"{t[j]:.4f},{abs(v) * KV * (1 + 1e-4 * noise.gauss(0, 1)):.4f},"
                           f"{math.degrees(cmath.phase(v)) + 0.005 * noise.gauss(0, 1):.5f},"
                           f"{power.real + 0.4 * noise.gauss(0, 1):.4f},{power.imag + 0.4 * noise.gauss(0, 1):.4f}\n")


main()
