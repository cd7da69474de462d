"""Takes pictures of the first screens of the gallery's reports, which lie in the current folder.

  pictures.py FOLDER    writes the PNG files of README.md in this folder, and the narrow ones of the top README.md, into FOLDER
"""
import base64
import pathlib
import sys
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

WIDE, NARROW = 1000, 420  # [pixels]
CURVES = "document.querySelector('.large').getBoundingClientRect().bottom"
BARS = "document.querySelector('svg .before').closest('figure').getBoundingClientRect().bottom"
PAGES = {  # folder, width, bottom edge of the picture
    "exciter-compare": ("exciter/comparison", WIDE, CURVES),
    "exciter-diagnose": ("exciter/diagnosis", WIDE, CURVES),
    "exciter-add": ("exciter/added", WIDE, BARS),
    "governor-diagnose": ("governor/diagnosis", WIDE, CURVES),
    "governor-add": ("governor/added", WIDE, BARS),
    "values-diagnose": ("values/diagnosis", WIDE, CURVES),
    "values-calibrate": ("values/calibrated", WIDE, BARS),
    "1-compare": ("exciter/comparison", NARROW, CURVES),
    "2-diagnose": ("exciter/diagnosis", NARROW, CURVES),
    "3-add": ("exciter/added", NARROW, CURVES),
}
LIMIT = 150_000  # bytes of a picture

options = webdriver.ChromeOptions()
for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars"):
    options.add_argument(word)
page = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
for name, (folder, width, last) in PAGES.items():
    page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                         {"width": width, "height": 1300, "deviceScaleFactor": 1, "mobile": False})
    page.get((pathlib.Path(folder) / "report.html").resolve().as_uri())
    time.sleep(1)  # for the charts
    clip = {"x": 0, "y": 0, "width": width, "height": page.execute_script("return " + last) + 8, "scale": 1}
    png = base64.b64decode(page.execute_cdp_cmd("Page.captureScreenshot", {"clip": clip})["data"])
    if len(png) > LIMIT:
        sys.exit(f"the picture {name} is too large at {folder} ({len(png)} bytes): choose a smaller width")
    (pathlib.Path(sys.argv[1]) / f"{name}.png").write_bytes(png)
page.quit()
