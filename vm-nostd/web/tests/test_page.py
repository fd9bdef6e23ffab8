"""What the page does, and that its numbers are those of `vm run`."""

import json
import pathlib
import re
import subprocess
import time

import pytest
from conftest import OUTPUTS, ROOT
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

NAMES = ["continuous", "fes", "discrete", "discrete-leff"]
ARITHMETICS = ["f32", "fixed", "f64"]


def assert_same(rows, expected):
    """The same outputs, row by row, to the nine digits that `vm run` writes: of f32, all bits."""
    assert len(rows) == len(expected)
    for row, other in zip(rows, expected):
        nine = [float(f"{float(row[name]):.8e}") for name in OUTPUTS]
        assert nine == [float(other[name]) for name in OUTPUTS]
        assert row["status"] == other["status"]


def named(page, name):
    options = page.element("muscle").find_elements("tag name", "option")
    page.choose("muscle", [option.text for option in options].index(name))


@pytest.mark.parametrize("mode", NAMES)
@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_a_run_has_the_bits_of_vm_run(page, vm_run, tmp_path, mode, arithmetic):
    page.choose("mode", mode)
    page.choose("arithmetic", arithmetic)
    page.choose("pattern", "gait")
    page.slide("slow", 35)
    page.slide("activation", 0.83)
    page.advance(4)
    page.slide("path", 15.21)
    page.slide("frequency", 41)
    page.advance(4)
    muscle = tmp_path / "muscle.toml"
    muscle.write_text(page.copied("copy-toml"))
    rows = page.rows()
    assert max(float(row["force_n"]) for row in rows) > 10
    assert_same(rows, vm_run(muscle, rows, mode, arithmetic, "standard"))


@pytest.mark.parametrize("accuracy", ["economy", "fine"])
def test_classes_and_fibre_types_are_those_of_vm_run(page, vm_run, tmp_path, accuracy):
    named(page, "soleus")
    page.choose("class", accuracy)
    page.choose("coefficients", "feline-vm4")
    page.advance(5)
    muscle = tmp_path / "muscle.toml"
    muscle.write_text(page.copied("copy-toml"))
    rows = page.rows()
    assert_same(rows, vm_run(muscle, rows, "fes", "f32", accuracy))


def test_every_muscle_is_that_of_its_name(page, vm_run):
    options = page.element("muscle").find_elements("tag name", "option")
    names = [option.text for option in options]
    assert len(names) == 21
    for name in names[1:]:
        named(page, name)
        page.advance(1)
        rows = page.rows()
        assert_same(rows, vm_run(name.replace(" ", "_"), rows, "fes", "f32", "standard"))


def test_a_slider_changes_the_trace(page):
    def picture():
        # Two frames: what was asked for is drawn in the next.
        return page.driver.execute_async_script(
            "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => "
            "done(document.getElementById('scope').toDataURL())));"
        )

    page.advance(5)
    before, force = picture(), float(page.rows()[-1]["force_n"])
    page.slide("activation", 1)
    page.advance(5)
    assert float(page.rows()[-1]["force_n"]) > 1.3 * force
    assert picture() != before
    assert "1.00" in page.text("activation-value")


def test_rust_that_is_copied_compiles_and_gives_the_force_of_the_page(page, tmp_path):
    programs = []
    for mode, arithmetic, pattern in [
        ("fes", "f32", "hold"),
        ("fes", "f32", "ramp"),
        ("fes", "fixed", "train"),
        ("discrete", "fixed", "ramp"),
        ("continuous", "f64", "gait"),
    ]:
        page.choose("mode", mode)
        page.choose("arithmetic", arithmetic)
        page.choose("pattern", pattern)
        page.slide("slow", 99)
        page.advance(10)
        force = float(page.rows()[-1]["force_n"])
        text = page.copied("copy-rust")
        assert len(text.splitlines()) == 10 and "(0.01, FAST)" in text
        assert "fraction = 0.01\n" in page.copied("copy-toml")
        programs.append((f"{mode}-{pattern}-{arithmetic}", text, force))
    # The library is that which the page was built with.
    command = ["cargo", "build", "--release", "--package", "vm-nostd", "--message-format", "json"]
    build = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    messages = [json.loads(line) for line in build.stdout.splitlines()]
    (library,) = [
        pathlib.Path(message["filenames"][0])
        for message in messages
        if message["reason"] == "compiler-artifact" and message["target"]["name"] == "vm_nostd"
    ]
    found = [f"--extern=vm_nostd={library}", f"-Ldependency={library.parent / 'deps'}"]
    for name, text, _ in programs:
        (tmp_path / f"{name}.rs").write_text(text)
        command = ["rustc", "--edition=2024", "--crate-name=copied", *found, f"-o{tmp_path / name}"]
        compiled = subprocess.run(
            [*command, tmp_path / f"{name}.rs"], cwd=ROOT, capture_output=True, text=True
        )
        # No warning either.
        assert (compiled.returncode, compiled.stderr) == (0, ""), name
    for name, _, force in programs:
        output = subprocess.run([tmp_path / name], capture_output=True, text=True, check=True)
        last = output.stdout.splitlines()[-1]
        # Fixed point prints the force of the tick, in mN.
        within = 5.1e-4 if name.endswith("fixed") else 1e-8 * force
        assert force > 0.5 and abs(float(last.removesuffix(" N")) - force) <= within, name


def test_ten_muscles_run_in_real_time(page):
    for _ in range(9):
        page.click("keep")
    assert len(page.element("kept").find_elements("tag name", "li")) == 9
    page.click("keep")
    assert "at most 10" in page.text("refusal")
    milliseconds = page.driver.execute_script(
        "const start = performance.now(); advance(5000); return performance.now() - start;"
    )
    print(f"ten muscles, 5 s: {milliseconds:.0f} ms")
    # Real time: 5,000 ticks of 1 ms.
    assert milliseconds < 5000
    rows = page.driver.execute_script("return run.tracks.map((kept) => kept.rings[0][run.tick])")
    assert len(set(rows)) == 1 and rows[0] > 10
    page.driver.find_element("css selector", "#kept button").click()
    assert len(page.element("kept").find_elements("tag name", "li")) == 8


def test_the_run_keeps_to_the_clock(page):
    page.click("run")
    before, start = page.driver.execute_script("return run.tick"), time.monotonic()
    time.sleep(2)
    ticks, passed = page.driver.execute_script("return run.tick") - before, time.monotonic() - start
    page.pause()
    # Frames that come late are made up for, up to a tenth of a second each.
    assert 0 < ticks <= 1000 * passed + 200


def test_cycles_are_those_of_the_generated_table(page):
    table = (ROOT / "host-sim/docs/cycles.md").read_text().splitlines()
    names, row = (
        [cell.strip() for cell in next(line for line in table if line.startswith(start)).split("|")]
        for start in ("| core | case |", "| cortex-m4f | fes-f32 |")
    )
    mean, most = (row[names.index(name)] for name in ("typ mean", "pess max"))
    assert page.text("cycles").startswith(f"{mean} cycles per tick, at most {most} ")
    page.choose("core", "cortex-m0plus")
    assert page.text("cycles").startswith("Not counted")
    page.choose("arithmetic", "fixed")
    page.choose("class", "economy")
    assert "cycles per tick" in page.text("cycles")


def test_curves_pass_where_they_must(page):
    isometric, passive, velocity = page.driver.execute_script("return run.curves")

    def near(curve, x):
        return min(curve, key=lambda point: abs(point[0] - x))[1]

    # FL is 1 at L_ce0, where F_pe1 is less than 0.1 % of F0; FV is 1 at V = 0, falls and rises.
    assert abs(near(isometric, 1) - 1) < 2e-3
    assert near(passive, 0.8) < 1e-3 < near(passive, 1.4)
    assert abs(near(velocity, 0) - 1) < 2e-3
    assert near(velocity, -3) < 0.6 and near(velocity, 2) > 1.2


def test_activations_of_the_types_are_the_force_of_a_held_muscle(page):
    page.slide("activation", 1)
    page.advance(20)
    force, length, velocity, slow, fast = page.driver.execute_script(
        "return run.tracks[0].rings.map((ring) => ring[run.tick])"
    )
    relative = force / page.driver.execute_script("return run.quantities.force")
    # At rest FV is 1, and near L_ce0 passive forces are less than 0.2 % of F0.
    assert abs(velocity) < 1e-3 and abs(length - 1) < 0.05
    assert slow > fast > 0.1
    assert abs(slow + fast - relative) < 2e-3


def test_a_screen_reader_is_told_the_force_of_a_run_and_all_numbers_at_its_end(page):
    def wait_for(pattern):
        WebDriverWait(page.driver, 10).until(lambda _: re.fullmatch(pattern, page.text("spoken")))

    all_numbers = r"Time .* s, .*Force .* N, .*Fascicle velocity 0\.0000 L0/s, .*Status ok"
    wait_for(all_numbers)
    page.slide("activation", 1)
    page.click("run")
    # What takes longer to read than the next takes to come is never heard.
    wait_for(r"Force [1-9]\d+\.\d N")
    page.pause()
    wait_for(all_numbers)
    # A path that no muscle can follow: the flag is told with the force.
    page.driver.execute_script("run.path = 1; run.running = true")
    wait_for(r"Force \d+\.\d N, PATH_LENGTH_CLIPPED.*")


def test_every_control_has_a_name_and_moves_by_keys(page):
    unnamed = page.driver.execute_script(
        "return [...document.querySelectorAll('input, select, button, canvas, textarea')].filter("
        "(item) => !(item.labels?.length || item.textContent.trim() || item.ariaLabel)).map("
        "(item) => item.id)"
    )
    assert unnamed == []
    slider = page.element("activation")
    before = float(slider.get_property("value"))
    slider.send_keys(Keys.ARROW_RIGHT)
    assert float(slider.get_property("value")) > before


def test_a_muscle_that_cannot_be_is_refused_with_field_value_and_limit(page):
    text = page.driver.execute_script(
        "return model.define(9, {...run.tracks[0].muscle, tendon_length_cm: -2}, 0.15)"
    )
    assert "tendon_length = -0.02" in text and "must be between" in text


def test_less_motion_is_wanted(page):
    media = [{"name": "prefers-reduced-motion", "value": "reduce"}]
    page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": media})
    page.driver.get(page.driver.current_url)
    page.driver.find_element("css selector", "#numbers tr")
    time.sleep(0.3)
    stands, button = page.driver.execute_script("return run.tick"), page.text("run")
    page.click("run")
    assert page.text("run") == "Pause"
    page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    assert (stands, button) == (0, "Run")


def test_what_stands_still_is_not_drawn_again(page):
    page.advance(1)
    drawn = page.driver.execute_async_script(
        "const [done, drawing] = [arguments[0], CanvasRenderingContext2D.prototype];"
        "const fill = drawing.fillText; let drawn = 0;"
        "setTimeout(() => { drawing.fillText = function (...all) {"
        " drawn += 1; fill.apply(this, all); }; }, 300);"
        "setTimeout(() => { drawing.fillText = fill; done(drawn); }, 600);"
    )
    assert drawn == 0
    before = page.element("scope").get_property("width")
    page.driver.set_window_size(700, 1400)
    WebDriverWait(page.driver, 5).until(
        lambda _: page.element("scope").get_property("width") != before
    )


def test_a_run_that_is_too_long_leaves_no_other_text(page):
    assert "mass_g" in page.copied("copy-toml")
    page.driver.execute_script("advance(60000)")
    page.click("copy-run")
    assert page.text("copied").startswith("Only 60 s")
    assert not page.element("text").is_displayed()
    page.click("restart")
    assert len(page.rows()) == 1 and page.element("text").is_displayed()


@pytest.mark.parametrize("width, height", [(320, 640), (390, 844), (1280, 900)])
def test_nothing_is_wider_than_the_window(page, width, height):
    page.driver.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500},
    )
    wide = page.driver.execute_script("return document.documentElement.scrollWidth")
    # Texts of the charts that do not fit into their canvas.
    cut = page.driver.execute_async_script("""
        const done = arguments[0];
        const cut = [];
        const drawing = CanvasRenderingContext2D.prototype;
        const fill = drawing.fillText;
        drawing.fillText = function (text, x, y) {
          const width = this.measureText(text).width;
          const from = { left: x, center: x - width / 2, right: x - width }[this.textAlign];
          if (from < 0 || from + width > this.canvas.clientWidth) cut.push(text);
          fill.call(this, text, x, y);
        };
        advance(100);
        requestAnimationFrame(() => requestAnimationFrame(() => {
          drawing.fillText = fill;
          done(cut);
        }));
    """)
    page.driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    assert wide <= width and cut == []
