"""The page in headless Chromium, and `vm`, with which it is compared."""

import csv
import os
import pathlib
import shutil
import subprocess

import pytest
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import Select

ROOT = pathlib.Path(__file__).parents[3]
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
VM = pathlib.Path(os.environ.get("VM", ROOT / "target/release/vm"))
PAGE = pathlib.Path(os.environ.get("PAGE", TARGET / "web/index.html"))
INPUTS = ["t_s", "activation", "path_length_m", "stim_hz"]
OUTPUTS = ["force_n", "fascicle_length_l0", "fascicle_velocity_l0_per_s"]


class Page:
    """The page, with what is done on it by name."""

    def __init__(self, driver):
        self.driver = driver

    def element(self, name):
        return self.driver.find_element("id", name)

    def text(self, name):
        return self.element(name).get_property("textContent")

    def choose(self, name, value):
        Select(self.element(name)).select_by_value(str(value))

    def slide(self, name, value):
        """Moves a slider, as a hand does: its value, and the event that follows."""
        self.driver.execute_script(
            "arguments[0].value = arguments[1];"
            "arguments[0].dispatchEvent(new Event('input', {bubbles: true}));",
            self.element(name),
            value,
        )

    def click(self, name):
        self.driver.execute_script("arguments[0].click()", self.element(name))

    def pause(self):
        if self.text("run") == "Pause":
            self.click("run")

    def advance(self, tenths):
        for _ in range(tenths):
            self.click("advance")

    def copied(self, button):
        self.click(button)
        return self.element("text").get_property("value")

    def rows(self):
        """The run as its rows, by column."""
        return list(csv.DictReader(self.copied("copy-run").splitlines()))

    def errors(self):
        return [entry for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]


@pytest.fixture(scope="session")
def driver():
    for needed in [PAGE, VM]:
        assert needed.exists(), f"{needed}: build it first"
    options = Options()
    options.binary_location = shutil.which("chromium")
    for argument in ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]:
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
    yield driver
    driver.quit()


@pytest.fixture
def page(driver):
    """A fresh page that stands still; no error may have come to its console at the end."""
    driver.set_window_size(1280, 1400)
    driver.get(PAGE.as_uri())
    driver.implicitly_wait(20)
    driver.find_element("css selector", "#numbers tr")
    page = Page(driver)
    page.pause()
    page.click("restart")
    yield page
    assert page.errors() == []


@pytest.fixture
def vm_run(tmp_path):
    """Runs `vm run` on the inputs of rows; the rows of its outputs."""

    def run(muscle, rows, mode, arithmetic, accuracy):
        inputs, outputs = tmp_path / "inputs.csv", tmp_path / "outputs.csv"
        with inputs.open("w", newline="") as file:
            writer = csv.DictWriter(file, INPUTS, extrasaction="ignore")
            writer.writeheader()
            writer.writerows(rows)
        command = [VM, "run", "--muscle", muscle, "--input", inputs, "--output", outputs]
        command += ["--mode", mode, "--arithmetic", arithmetic, "--class", accuracy]
        subprocess.run(command, check=True, capture_output=True, text=True, timeout=60)
        with outputs.open() as file:
            return list(csv.DictReader(file))

    return run
