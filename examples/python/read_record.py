#!/usr/bin/python3
"""Prints the sampling rate of a record in CSV and the range of each column: python3 read_record.py record.csv"""
import csv
import sys

with open(sys.argv[1], newline="") as file:
    rows = csv.reader(file)
    names = next(rows)  # quantity and unit, such as t_s, V_pu, theta_rad, f_pu, P_pu, Q_pu
    columns = dict(zip(names, zip(*((float(cell) for cell in row) for row in rows))))
t = columns["t_s"]
print(f"{len(t)} samples at {(len(t) - 1) / (t[-1] - t[0]):.2f}/s")
for name, values in columns.items():
    print(f"{name}: {min(values):g} to {max(values):g}")
