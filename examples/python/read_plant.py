#!/usr/bin/python3
"""Prints every parameter of a plant file: python3 read_plant.py configs/plants/ieee14_bus2.toml"""
import sys
import tomllib

with open(sys.argv[1], "rb") as file:
    plant = tomllib.load(file)
print(plant["plant"]["name"], "on a base of", plant["plant"]["base_mva"], "MVA")
blocks = [plant["machine"]] + [plant[key] for key in ("transformer",) if key in plant] + plant.get("control", [])
for block in blocks:
    for name, value in block.items():
        if name != "effect":
            print(f"{block['effect']}.{name} = {value}")
