#!/usr/bin/python3
"""Prints every parameter of a plant file: python3 read_plant.py configs/plants/ieee14_bus2.toml"""
import sys
import tomllib

with open(sys.argv[1], "rb") as file:
    plant = tomllib.load(file)
print(plant["plant"]["name"], "on a base of", plant["plant"]["base_mva"], "MVA")
# A component is a table with an effect: [machine] or [converter], [exciter], [governor], [[limiter]], [[measurement]].
for section in plant.values():
    for block in section if isinstance(section, list) else [section]:
        if isinstance(block, dict) and "effect" in block:
            for name, value in block.items():
                if name != "effect":
                    print(f"{block['effect']}.{name} = {value}")
