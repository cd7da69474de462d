"""Drives the live page of `swingbank serve` in Chromium as a person would: drag, diagnose, add, undo, hold out, save.

  serve_browser.py URL FOLDER    screenshots go into FOLDER; prints what was measured
"""
import sys
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

url, folder = sys.argv[1:]
options = webdriver.ChromeOptions()
for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--window-size=1280,900"):
    options.add_argument(word)
options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
page = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)


def size(width, height):
    page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                         {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})


def until(what, condition, limit=300.0):
    end = time.monotonic() + limit
    while time.monotonic() < end:
        result = condition()
        if result:
            return result
        time.sleep(0.05)
    page.save_screenshot(f"{folder}/failed.png")
    sys.exit(f"not within {limit} s: {what}; the page says: {text('verdict')} / {text('said')} / {text('failure')}")


def one(name):
    return page.find_element(By.ID, name)


def text(name):
    return one(name).get_attribute("textContent").strip()


def chips():
    """(event, channel) -> class, ratio and title of its chip, the label with its error."""
    return {(e, c): rest for e, c, *rest in page.execute_script(
        "return [...document.querySelectorAll('.chip')].map((c) => [Number(c.dataset.event), Number(c.dataset.channel), "
        "c.className, c.querySelector('.ratio').textContent, c.title])")}


def rms(event, channel):
    return chips()[event, channel][2].split("RMS error ")[1].split(",")[0]


def idle():
    return one("stop").get_attribute("hidden")


size(1280, 900)
page.get(url)
until("the page", lambda: page.execute_script("return document.body.dataset.ready"), 60)
until("the comparison", lambda: page.execute_script("return document.body.dataset.compared"), 60)
assert text("verdict") == "Model does not match the records", text("verdict")
assert all("bad" in c[0] for at, c in chips().items() if at[1] == 1), chips()
page.save_screenshot(f"{folder}/first.png")
assert page.execute_script("return document.getElementById('charts').getBoundingClientRect().bottom <= innerHeight"), \
    "the curves of P and Q are not on the first screen"

# a click on a bin of the error map enlarges its channel: Q was selected, the first bin belongs to P
event = next(at[0] for at, c in chips().items() if "chosen" in c[0])
page.execute_script("document.querySelector('#bins button').click()")
until("the channel of the cell", lambda: "chosen" in chips()[event, 0][0], 20)

# drag a slider with the mouse: the chips of this event follow; after the release, the error equals that of compare
slider = one("slider-GENROU.H")
before = rms(event, 0)
page.execute_script("document.getElementById('slider-GENROU.H').scrollIntoView({block: 'center'})")
drag = ActionChains(page).move_to_element(slider).click_and_hold()
for _ in range(10):
    drag = drag.move_by_offset(-2, 0)
drag.perform()
until("a preview", lambda: "moving" in chips()[event, 0][0], 20)
ActionChains(page).release().perform()
until("the comparison of the changed model", lambda: "Trying" not in text("verdict") and rms(event, 0) != before, 30)
print("dragged:", one("slider-GENROU.H").get_attribute("aria-valuetext"), "->", rms(event, 0))
print("value", page.execute_script("return document.querySelector('[aria-label=\"GENROU.H as a number\"]').value"))
print("rms", rms(event, 0))
ActionChains(page).send_keys("z").perform()  # undo
until("undo", lambda: rms(event, 0) == before, 20)
ActionChains(page).send_keys("y").perform()  # redo
until("redo", lambda: rms(event, 0) != before, 20)
ActionChains(page).send_keys("z").perform()
until("undo again", lambda: rms(event, 0) == before, 20)

# the keyboard suffices: select event 4, hold it out, diagnose, add the first candidate
ActionChains(page).send_keys("4").send_keys("h").perform()
until("event 4", lambda: "Event 4" in text("title"), 20)
time.sleep(1)  # the curves of the previous step must not appear in this event's charts
first_samples = page.execute_script("return charts_of_test().map((d) => [d[2], d[3]].map((s) => Array.from(s)))")
assert all(ghost == model for ghost, model in first_samples), "the curves of another event are shown"
assert one("hold").is_selected(), "event 4 is not held out"
start = time.monotonic()
ActionChains(page).send_keys("d").perform()
until("the progress", lambda: "%" in text("progress") or "of" in text("progress"), 60)
until("the side", lambda: one("inputs").find_elements(By.CSS_SELECTOR, "canvas"), 300)
until("the diagnosis", idle, 900)
print(f"diagnosis: {time.monotonic() - start:.1f} s")
first = one("candidates").find_element(By.TAG_NAME, "li").text
assert "SEXS" in first, first
page.save_screenshot(f"{folder}/diagnosed.png")
start = time.monotonic()
ActionChains(page).send_keys("a").perform()
until("the fit to begin", lambda: not idle(), 20)
until("the fit", idle, 300)
until("the verdict", lambda: "only noise remains" in text("verdict"), 20)
print(f"add and fit: {time.monotonic() - start:.2f} s")
time.sleep(1)
page.save_screenshot(f"{folder}/added.png")
assert all("good" in c[0] for c in chips().values()), chips()
# the 95 % band encloses the curve of the completed model, on the held-out event too
shown = page.execute_script("return bands_of_test().map((b, k) => b && [charts_of_test()[k][3], ...b].map((s) => Array.from(s)))")
assert all(shown), "a fitted model has no 95 % band"
assert "Q ± " in text("band-size") and "Mvar" in text("band-size"), text("band-size")
assert all(low < model < high for channel in shown for model, low, high in zip(*channel)), "the band does not enclose the curve"
assert "(verification)" in text("chips"), text("chips")
assert "swingbank add SEXS" in text("command") and "--hold-out avr_ev4.csv" in text("command"), text("command")

# the candidates stay: another one can be tried from the diagnosed model
assert "SEXS" in text("candidates"), "the candidates are gone"

# a key pressed while the comparison with a changed value runs acts on the model with that value
page.execute_script("const s = document.getElementById('slider-SEXS.K'); s.value = 900;"
                    "for (const e of ['input', 'change']) s.dispatchEvent(new Event(e));")
ActionChains(page).send_keys("s").perform()
until("saving", lambda: "model.toml" in text("saved"), 60)
assert "SEXS.K" in text("saved") and "SEXS.K" in text("now"), text("saved")
page.execute_script("const s = document.getElementById('slider-SEXS.K'); s.value = 400;"
                    "for (const e of ['input', 'change']) s.dispatchEvent(new Event(e));")
ActionChains(page).send_keys("z").perform()
until("undo of the value", lambda: "SEXS.K" in text("now") and "Trying" not in text("verdict"), 30)
ActionChains(page).send_keys("z").perform()
until("undo of both values", lambda: text("now") == "this model: + SEXS", 30)

# a value outside the usual range is marked
def set_box(name, value):
    page.execute_script("const b = document.querySelector(`[aria-label='${arguments[0]} as a number']`);"
                        "b.value = arguments[1]; b.dispatchEvent(new Event('change'));", name, value)
    until("the value", lambda: "Trying" not in text("verdict") and name in text("now"), 30)
    return page.execute_script("return document.querySelector(`[aria-label='${arguments[0]} as a number']`)"
                               ".closest('.slider').classList.contains('unusual')", name)
assert not set_box("GENROU.H", "6.4") and set_box("GENROU.H", "1e6"), "an unusual H is not marked"
ActionChains(page).send_keys("z").send_keys("z").perform()
until("undo of H", lambda: text("now") == "this model: + SEXS", 30)

# a reload keeps the steps, the present one and the held-out event
page.refresh()
until("the page again", lambda: page.execute_script("return document.body.dataset.compared"), 60)
until("the step again", lambda: text("now") == "this model: + SEXS", 20)
assert "submitted model" in text("steps") and "(verification)" in text("chips"), text("steps")
ActionChains(page).send_keys("4").perform()
until("the held-out event", lambda: one("hold").is_selected(), 20)

# save; the page states the saved files and their folder
ActionChains(page).send_keys("s").perform()
until("saving", lambda: "model.toml" in text("saved"), 60)
assert "“+ SEXS”" in text("saved") and "replacing the existing files" in text("saved"), text("saved")

# a stopped fit is a step with the values until then; before the first values it leaves the model as it is
ActionChains(page).send_keys("f").perform()
until("the fit to begin", lambda: not idle(), 20)
ActionChains(page).send_keys(Keys.ESCAPE).perform()
until("the stop", idle, 60)
until("the word of it", lambda: "Stopped" in text("said") or "fitted" in text("said"), 10)

# a phone: nothing is wider than the screen
size(400, 850)
time.sleep(0.5)
assert page.execute_script("return document.documentElement.scrollWidth") <= 400, "wider than 400 px"
page.save_screenshot(f"{folder}/phone.png")
errors = [m for m in page.get_log("browser") if m["level"] == "SEVERE"]
assert not errors, errors
page.quit()
