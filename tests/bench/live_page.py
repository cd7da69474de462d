#!/usr/bin/env python3
"""Measures the live page: first screen, request to response, slider to pixels, addition with fit.

  SWINGBANK_BIN=build/release/bin /usr/bin/python3 tests/bench/live_page.py [DRAGS]

The plant is GENROU with ESST4B, PSS2B and IEEEG1 at default values; the records are the four events of 15 s of
configs/records/record-example, and those of a simulation of this plant where IEEEG1 is added. Needs chromium-driver and
python3-selenium. Prints medians and the 95th percentile.
"""
import http.client
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.parse

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent
SWINGBANK = pathlib.Path(os.environ["SWINGBANK_BIN"]).resolve() / "swingbank"
DRAGS = int(sys.argv[1]) if len(sys.argv) > 1 else 100
RECORDS = sorted((SOURCE / "configs/records/record-example").glob("avr_ev*.csv"))


def plant(folder, *controls, machine=SOURCE / "configs/plants/ieee14_bus2.toml"):
    text = machine.read_text()
    for control in controls:
        text += "\n" + subprocess.run([SWINGBANK, "effects", control, "--toml"], check=True, capture_output=True, text=True).stdout
    file = pathlib.Path(folder) / ("-".join(["GENROU", *controls]) + ".toml")
    file.write_text(text)
    return file


def simulated(folder, *controls):
    """Returns the plant file of the machine at bus 2, and four records of 15 s with these controls and PMU noise."""
    case = SOURCE / "configs/networks/ieee14_genrou"
    records = []
    for event in ("--fault 5:2.007:2.107", "--load-step 4:30:10:2.007:10.007", "--fault 4:2.007:2.087",
                  "--load-step 9:-20:-5:2.007:10.007"):
        records.append(pathlib.Path(folder) / f"event{len(records) + 1}.csv")
        attached = [word for control in controls for word in ("--attach", f"2:{control}")]
        subprocess.run([SWINGBANK, "simulate", "--raw", f"{case}.raw", "--dyr", f"{case}.dyr", *attached, *event.split(),
                        "--t-end", "15", "--rate", "60", "--plants", "2", "--channels", "P,Q", "--buses", "2", "--measure",
                        "NOISE:relative=0.0002,angle=0.0002,I=0.001", "--measure-seed", str(len(records)), "--out", records[-1]],
                       check=True, capture_output=True)
    machine = pathlib.Path(folder) / "machine.toml"
    subprocess.run([SWINGBANK, "plant", "--raw", f"{case}.raw", "--dyr", f"{case}.dyr", "--bus", "2", "--out", machine], check=True,
                   capture_output=True)
    return machine, records


def serve(model, records=RECORDS):
    start = time.monotonic()
    server = subprocess.Popen([SWINGBANK, "serve", "--model", model, "--records", *records, "--power-only", "--quiet"],
                              stdout=subprocess.PIPE, text=True)
    return server, server.stdout.readline().strip(), start


def shown(name, milliseconds, bar):
    ordered = sorted(milliseconds)
    print(f"{name}: median {statistics.median(ordered):.1f} ms, 95 % below {ordered[int(0.95 * (len(ordered) - 1))]:.1f} ms, "
          f"bar {bar} ms, n = {len(ordered)}", flush=True)


def requests(url):
    """Returns the times of preview requests over one connection [ms]."""
    parts = urllib.parse.urlsplit(url)
    connection = http.client.HTTPConnection(parts.hostname, parts.port)
    connection.request("POST", parts.path + "api/open", "{}")
    session = json.loads(connection.getresponse().read())["session"]
    taken = []
    for k in range(DRAGS):
        body = json.dumps({"seq": k + 1, "step": 0, "event": k % 4, "values": {"GENROU.H": 5 + 0.01 * (k % 100)}})
        start = time.perf_counter()
        connection.request("POST", f"{parts.path}api/preview?s={session}", body)
        connection.getresponse().read()
        taken.append(1e3 * (time.perf_counter() - start))
    return taken


def browser():
    options = webdriver.ChromeOptions()
    for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--window-size=1280,900"):
        options.add_argument(word)
    return webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)


def memory(process):
    """Resident memory of the server [MB]."""
    pid = process.pid
    text = pathlib.Path(f"/proc/{pid}/status").read_text()
    return int(next(line for line in text.splitlines() if line.startswith("VmRSS")).split()[1]) / 1024


DRAG = """
const done = arguments[arguments.length - 1], count = arguments[0], taken = [];
const slider = document.getElementById('slider-GENROU.H'), charts = document.getElementById('charts');
const painted = new MutationObserver(() => requestAnimationFrame(() => setTimeout(() => {
  taken.push(performance.now() - start);
  if (taken.length === count) { painted.disconnect(); done(taken); } else next();
})));
painted.observe(charts, { attributes: true, attributeFilter: ['data-answered'] });
let start = 0;
const next = () => { start = performance.now(); slider.value = 500 + (taken.length % 60); charts.dataset.answered = '';
  painted.takeRecords(); slider.dispatchEvent(new Event('input')); };
next();
"""

with tempfile.TemporaryDirectory() as folder:
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    full = plant(folder, "ESST4B", "PSS2B", "IEEEG1")
    page = browser()  # a browser that is open already
    page.set_script_timeout(600)
    server, url, start = serve(full)
    page.get(url)
    while not page.execute_script("return document.body.dataset.ready"):
        time.sleep(0.01)
    print(f"first screen after the start of serve: {time.monotonic() - start:.2f} s, bar 0.5 s")
    while not page.execute_script("return document.body.dataset.compared"):
        time.sleep(0.01)
    print(f"comparison with fitted switching times: {time.monotonic() - start:.2f} s")
    before = memory(server)
    shown("request to response", requests(url), 15)
    shown("slider to pixels", page.execute_async_script(DRAG, DRAGS), 50)
    print(f"memory: {before:.0f} MB before, {memory(server):.0f} MB after {2 * DRAGS} drags; bar + 50 MB")
    server.terminate()
    server.wait()
    machine, four = simulated(folder, "ESST4B", "PSS2B", "IEEEG1")
    for model, effect, records in ((plant(folder), "SEXS", RECORDS),
                                   (plant(folder, "ESST4B", "PSS2B", machine=machine), "IEEEG1", four)):
        server, url, _ = serve(model, records)
        page.get(url)
        while not page.execute_script("return document.body.dataset.ready"):
            time.sleep(0.01)
        while not page.execute_script("return document.body.dataset.compared"):
            time.sleep(0.01)
        fitted = None
        start = time.monotonic()
        page.execute_script("document.getElementById('effect').value = arguments[0];"
                            "document.querySelector('#any button').click()", effect)
        while "+ " + effect not in page.execute_script("return document.getElementById('steps').textContent"):
            text = page.execute_script("return document.getElementById('failure').textContent + document.getElementById('said').textContent")
            if "swingbank" in text or time.monotonic() - start > 120:
                print("no result:", text)
                break
            if fitted is None and page.execute_script("return document.querySelector('#fall svg') !== null"):
                fitted = time.monotonic() - start
            time.sleep(0.01)
        print(f"first fitted curves after {fitted or float('nan'):.2f} s")
        print(f"{model.stem}, add and fit {effect}: {time.monotonic() - start:.2f} s, bar 2 s", flush=True)
        server.terminate()
        server.wait()
    page.quit()
