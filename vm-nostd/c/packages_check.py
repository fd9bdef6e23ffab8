"""Checks of package files by their own rules, as far as the registries reach.

packages_check.py files ARCHIVE FOLDER   Arduino's layout, Zephyr's module, ESP-IDF's component
packages_check.py links FOLDER           links of the READMEs in unpacked crates
packages_check.py rust VERSION           what dependencies declare to need
"""

import json
import re
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
checks = 0


def check(holds, message):
    global checks
    checks += 1
    if not holds:
        sys.exit(message)


def run(*command, **more):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **more)
    check(done.returncode == 0, f"{command}:\n{done.stdout}{done.stderr}")
    return done.stdout


# https://arduino.github.io/arduino-cli/latest/library-specification/
ARDUINO_KEYS = "name version author maintainer sentence paragraph category url architectures".split()
ARDUINO_CATEGORIES = [
    "Display", "Communication", "Signal Input/Output", "Sensors", "Device Control", "Timing", "Data Storage",
    "Data Processing", "Other",
]
# What Arduino gives a sketch.
ARDUINO = """
#include <cstdio>
static unsigned long now;
static unsigned long millis() { return now; }
static struct { void begin(long) {} void println(long v) { std::printf("%ld\\n", v); }
  void println(const char *v) { std::printf("%s\\n", v); } } Serial;
#include "step.ino"
int main() {
  setup();
  for (now = 0; now <= 600; now++) loop();
  return output.force_mn > 20000 && output.force_mn < 266000 ? 0 : 1;
}
"""


def version():
    number = int(re.search(r"#define VM_VERSION (\d+)", (HERE / "include/vm_nostd.h").read_text())[1])
    return f"{number // 10000}.{number // 100 % 100}.{number % 100}"


def arduino(archive, folder):
    run(sys.executable, HERE / "arduino/pack.py", folder, f"host={archive}")
    library = Path(folder) / "vm_nostd"
    properties = dict(line.split("=", 1) for line in (library / "library.properties").read_text().splitlines())
    for key in ARDUINO_KEYS:
        check(properties.get(key), f"library.properties: {key} is missing")
    check(properties["category"] in ARDUINO_CATEGORIES, properties["category"])
    check(properties["version"] == version(), properties["version"])
    check((library / "src" / properties["includes"]).exists(), "the header is not in src")
    sketch = library / "examples/step"
    program = Path(folder) / "sketch"
    (Path(folder) / "sketch.cpp").write_text(ARDUINO)
    run("c++", "-std=c++11", "-Wall", "-Wextra", "-Werror", "-I", library / "src", "-I", sketch, Path(folder) / "sketch.cpp",
        library / "src/host/libvm_nostd.a", "-lm", "-lpthread", "-ldl", "-o", program)
    run(program)


# What Zephyr and ESP-IDF give a CMakeLists.txt, as far as ours uses it.
STUBS = """
cmake_minimum_required(VERSION 3.16)
project(stubs LANGUAGES C)
set(VM_LIBRARY "{archive}" CACHE FILEPATH "")
set(CONFIG_VM_NOSTD y)
set(CONFIG_VM_NOSTD_RUST_TARGET thumbv7em-none-eabihf)
set(CONFIG_IDF_TARGET esp32c6)
add_library(app INTERFACE)
set(COMPONENT_LIB app)
function(zephyr_include_directories)
  target_include_directories(app INTERFACE ${{ARGV}})
endfunction()
function(zephyr_link_libraries)
  target_link_libraries(app INTERFACE ${{ARGV}})
endfunction()
function(idf_component_register)
endfunction()
add_subdirectory("{folder}" module)
get_target_property(linked app INTERFACE_LINK_LIBRARIES)
if(NOT linked MATCHES "vm_nostd::vm_nostd")
  message(FATAL_ERROR "linked: ${{linked}}")
endif()
"""


def configured(name, folder, archive, room):
    source = Path(room) / f"{name}_project"
    source.mkdir(parents=True, exist_ok=True)
    (source / "CMakeLists.txt").write_text(STUBS.format(folder=folder, archive=archive))
    run("cmake", "-S", source, "-B", source / "build")


def zephyr(archive, folder):
    import kconfiglib
    import yaml

    module = yaml.safe_load((HERE / "zephyr/module.yml").read_text())
    check(set(module) <= {"name", "build", "samples", "tests", "boards", "blobs", "security", "package-managers"}, str(module))
    check(set(module["build"]) <= {"cmake", "kconfig", "depends", "settings"}, str(module["build"]))
    check((HERE / module["build"]["cmake"] / "CMakeLists.txt").exists(), "no CMakeLists.txt")
    parsed = kconfiglib.Kconfig(str(HERE / module["build"]["kconfig"]), warn_to_stderr=False)
    check(not parsed.warnings and "VM_NOSTD" in parsed.syms, str(parsed.warnings))
    configured("zephyr", HERE / "zephyr", archive, folder)


def esp_idf(archive, folder):
    from idf_component_tools.manager import ManifestManager

    manifest = ManifestManager(str(HERE / "esp-idf"), "vm_nostd").load()
    check(str(manifest.version) == version(), str(manifest.version))
    configured("esp_idf", HERE / "esp-idf", archive, folder)


def platformio():
    manifest = json.loads((HERE / "library.json").read_text())
    check(manifest["version"] == version(), "library.json: version")


def files(archive, folder):
    arduino(archive, folder)
    zephyr(archive, folder)
    esp_idf(archive, folder)
    platformio()


def links(folder):
    """Links of each README lead to a file of the same crate."""
    for name in ("vm-nostd", "vm-nostd-c"):
        crate = next(Path(folder).glob(f"{name}-[0-9]*.crate"))
        names = run("tar", "-tzf", crate).splitlines()
        root = names[0].split("/")[0]
        text = run("tar", "-xzOf", crate, f"{root}/README.md")
        for target in re.findall(r"\]\(([^)]+)\)", "".join(text.split("```")[::2])):
            path = target.split("#")[0]
            if path and not path.startswith("http"):
                check(f"{root}/{path}" in names, f"{name}: README.md: {target} is not in the package")
        for licence in ("LICENSE-MIT", "LICENSE-APACHE"):
            check(f"{root}/{licence}" in names, f"{name}: {licence} is missing")
        check(run("tar", "-xzOf", crate, f"{root}/Cargo.toml").count("docs.rs") or name != "vm-nostd", "docs.rs")


def rust(wanted):
    """Some version of each dependency that the manifest admits can be built by this Rust."""
    limit = tuple(map(int, wanted.split(".")))
    metadata = json.loads(run("cargo", "metadata", "--offline", "--format-version", "1", "--filter-platform",
                              "thumbv7em-none-eabihf", cwd=ROOT))
    by_id = {package["id"]: package for package in metadata["packages"]}
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    ours = [p for p in metadata["packages"] if p["name"] in ("vm-nostd", "vm-nostd-c")]
    for package in ours:
        check(package["rust_version"].startswith(wanted), f"{package['name']}: {package['rust_version']}")
    optional = {d["name"] for p in ours for d in p["dependencies"] if d["optional"]}
    seen, queue = set(), [p["id"] for p in ours]
    while queue:
        node = nodes[queue.pop()]
        for dependency in node["deps"]:
            kinds = {kind["kind"] for kind in dependency["dep_kinds"]}
            package = by_id[dependency["pkg"]]
            if "dev" in kinds and len(kinds) == 1 or package["id"] in seen or package["name"] in optional:
                continue
            seen.add(package["id"])
            queue.append(package["id"])
            needs = tuple(map(int, (package["rust_version"] or "1.0").split(".")))[:2]
            if needs > limit:
                # The lock file has a newer one than the manifest asks for.
                check(package["name"] in NEWER, f"{package['name']} {package['version']} needs Rust {needs}")
                print(f"{package['name']} {package['version']} needs Rust {package['rust_version']}; {NEWER[package['name']]}")
    check(len(seen) > 5, "too few dependencies")


# Locked versions that need a newer Rust, and what older Rust resolves to.
NEWER = {"fixed": "1.30.0, which the manifest admits, declares 1.85"}

if __name__ == "__main__":
    commands = {"files": files, "links": links, "rust": rust}
    if len(sys.argv) < 3 or sys.argv[1] not in commands:
        sys.exit(__doc__)
    commands[sys.argv[1]](*sys.argv[2:])
    print(f"{checks} checks passed")
