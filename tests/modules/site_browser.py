"""Opens every page of a built documentation site from the disk in Chromium, and searches.

  site_browser.py SITE [PICTURES]    pictures of some pages go into PICTURES"""
import pathlib
import sys
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By

site, wrong = pathlib.Path(sys.argv[1]).resolve(), []
options = webdriver.ChromeOptions()
for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"):
    options.add_argument(word)
options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
browser = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)


def open_page(name, width):
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                            {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 500})
    browser.get((site / name).as_uri())


try:
    for path in sorted(site.rglob("*.html")):
        if path.name == "404.html":
            continue
        open_page(path.relative_to(site), 400)
        width, outside = browser.execute_script(
            "return [document.documentElement.scrollWidth, "
            "performance.getEntriesByType('resource').map((e) => e.name).filter((n) => !n.startsWith('file:'))]")
        if width > 400 or outside:
            wrong.append(f"{path}: {width} px wide on a screen of 400 px; from outside: {outside}")
    open_page("index.html", 1280)
    field = browser.find_element(By.CSS_SELECTOR, "[data-md-component=search-query]")
    field.click()
    field.send_keys("field current")
    found, end = [], time.monotonic() + 60
    while not found and time.monotonic() < end:
        time.sleep(0.1)
        results = browser.find_elements(By.CSS_SELECTOR, ".md-search-result__link")
        found = [link.get_attribute("href") for link in results]
    if not any(link.startswith(site.as_uri() + "/docs/") for link in found):
        wrong.append(f"search for 'field current' from the disk: {found}")
    wrong += [entry["message"] for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    for name in ("index", "docs/gallery/index", "docs/reference/formats") if len(sys.argv) > 2 else ():
        for width in (1280, 400):
            open_page(name + ".html", width)
            browser.save_screenshot(f"{sys.argv[2]}/{name.replace('/', '-')}-{width}.png")
finally:
    browser.quit()
sys.exit("\n".join(wrong) or None)
