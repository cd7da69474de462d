#!/usr/bin/env python3
"""Measures the live page: first screen, request to response, slider to pixels, addition with fit.

  SWINGBANK_BIN=build/release/bin /usr/bin/python3 tests/bench/live_page.py [DRAGS]

The plant is GENROU with ESST4B, PSS2B and IEEEG1 at default values; the records are the four events of 15 s of
configs/records/record-example. Needs chromium-driver and python3-selenium. Prints medians and the 95th percentile.
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


def plant(folder, *controls):
    text = (SOURCE / "configs/plants/ieee14_bus2.toml").read_text()
    for control in controls:
        text += "\n" + subprocess.run([SWINGBANK, "effects", control, "--toml"], check=True, capture_output=True, text=True).stdout
    file = pathlib.Path(folder) / ("-".join(["GENROU", *controls]) + ".toml")
    file.write_text(text)
    return file


def serve(model):
    start = time.monotonic()
    server = subprocess.Popen([SWINGBANK, "serve", "--model", model, "--records", *RECORDS, "--power-only", "--quiet"],
                              stdout=subprocess.PIPE, text=True)
    return server, server.stdout.readline().strip(), start


def shown(name, milliseconds, bar):
    ordered = sorted(milliseconds)
    print(f"{name}: median {statistics.median(ordered):.1f} ms, 95 % below {ordered[int(0.95 * (len(ordered) - 1))]:.1f} ms, "
          f"bar {bar} ms, n = {len(ordered)}", flush=True)


def requests(url):
    """Previews over one connection, and the memory of the server."""
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
    for controls, effect in (((), "SEXS"), (("ESST4B", "PSS2B"), "IEEEG1")):
        server, url, _ = serve(plant(folder, *controls))
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
        print(f"{'+'.join(['GENROU', *controls])}, add and fit {effect}: {time.monotonic() - start:.2f} s, bar 2 s", flush=True)
        server.terminate()
        server.wait()
    page.quit()
