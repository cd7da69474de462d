"""python_bench.py BUILD MODEL RECORD ROUNDS: cost of the Python package, in one run.

Prints the time of `import swingbank` and of the first curve after the start of Python [s, wall clock, median], and the
processor time of Plant.play relative to the same comparison in C++ (bench_compare), measured in alternation.
"""
import os
import pathlib
import statistics
import subprocess
import sys
import time

BUILD, MODEL, RECORD, ROUNDS = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3], int(sys.argv[4])
PYTHON = ["/usr/bin/python3", "-c"]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(BUILD / "python"), "SWINGBANK_BIN": str(BUILD / "bin")}
REPEATS = 5  # playbacks in each process; the first warms the caches

IMPORT = "import time; t = time.perf_counter(); import swingbank; print(time.perf_counter() - t)"
CURVE = f"import swingbank; len(swingbank.Plant({MODEL!r}).play({RECORD!r})._repr_html_())"
PLAY = f"""
import time, swingbank
plant = swingbank.Plant({MODEL!r})
record = swingbank.Record({RECORD!r}, plant)
for _ in range({REPEATS}):
    t = time.process_time()
    plant.play(record)
    print(time.process_time() - t)
"""


def said(words):
    done = subprocess.run(words, capture_output=True, text=True, check=True, env=ENVIRONMENT)
    return [float(line) for line in done.stdout.split()]


def first_curve():
    begin = time.perf_counter()
    subprocess.run([*PYTHON, CURVE], check=True, env=ENVIRONMENT)
    return time.perf_counter() - begin


def main():
    imports, curves, ratios, plays = [], [], [], []
    for _ in range(ROUNDS):
        imports += said([*PYTHON, IMPORT])
        curves.append(first_curve())
        native = min(said([BUILD / "bin/bench_compare", MODEL, RECORD, str(REPEATS)]))
        plays.append(min(said([*PYTHON, PLAY])))
        ratios.append(plays[-1] / native)
    for name, values, unit in (("import swingbank", imports, "s"), ("first curve after start of Python", curves, "s"),
                               ("Plant.play, processor time", plays, "s"), ("Plant.play / C++", ratios, "")):
        print(f"{name}: median {statistics.median(values):.3f} {unit}, {min(values):.3f} to {max(values):.3f}")


if __name__ == "__main__":
    main()
