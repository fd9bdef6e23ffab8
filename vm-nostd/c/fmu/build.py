"""Builds the FMUs of a muscle for this platform.

build.py LIBRARY FOLDER: LIBRARY is a libvm_nostd.a with the feature `f64`; FOLDER receives
virtual_muscle_fmi2.fmu and virtual_muscle_fmi3.fmu. FMI's headers are taken from the installed
Python package fmpy, which has them under the 2-clause BSD licence; nothing of them is kept here.
"""

import os
import platform
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

import fmpy

HERE = Path(__file__).resolve().parent
HEADERS = Path(fmpy.__file__).parent / "c-code"
TOKEN = "{b0e0a3a2-8d5c-4c8e-9f37-56495254554c}"
NAME = "virtual_muscle"
DESCRIPTION = "Virtual Muscle 4.0: a human muscle, stepped tick by tick"
# Base units: exponents of kg, m, s.
UNITS = {
    "1": "",
    "m": 'm="1"',
    "s": 's="1"',
    "kg": 'kg="1"',
    "N": 'kg="1" m="1" s="-2"',
    "Hz": 's="-1"',
    "1/s": 's="-1"',
    "N/m2": 'kg="1" m="-1" s="-2"',
    "kg/m3": 'kg="1" m="-3"',
}
CAUSALITIES = ["parameter", "input", "output"]
# Platform of the binary: name in FMI 2.0, in FMI 3.0, suffix.
PLATFORMS = {
    ("Linux", "x86_64"): ("linux64", "x86_64-linux", ".so"),
    ("Linux", "aarch64"): (None, "aarch64-linux", ".so"),
    ("Darwin", "x86_64"): ("darwin64", "x86_64-darwin", ".dylib"),
    ("Darwin", "arm64"): (None, "aarch64-darwin", ".dylib"),
    ("Windows", "AMD64"): ("win64", "x86_64-windows", ".dll"),
}


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def compile_unit(library, output, sources, *arguments):
    includes = ["-I", str(HERE.parent / "include"), "-I", str(HEADERS), "-I", str(HERE)]
    flags = ["-std=c11", "-O2", "-Wall", "-Wextra", "-Werror"]
    files = [str(HERE / source) for source in sources]
    compiler = os.environ.get("CC", "cc")
    run(compiler, *flags, *includes, *files, str(library), *arguments, "-lm", "-lpthread", "-ldl", "-o", str(output))


def variables(library, folder):
    """Rows of the table in muscle.c."""
    program = Path(folder) / "describe"
    compile_unit(library, program, ["muscle.c", "variables.c", "describe.c"])
    keys = ["reference", "name", "unit", "description", "causality", "bytes", "start"]
    rows = [dict(zip(keys, line.split("\t"))) for line in run(str(program)).splitlines()]
    for row in rows:
        row["causality"] = CAUSALITIES[int(row["causality"])]
        row["real"] = row["bytes"] == "8"
    return rows


def common(row):
    """Attributes of both versions, and whether the variable has a start value."""
    variability = {"parameter": "fixed"}.get(row["causality"], "continuous" if row["real"] else "discrete")
    text = f'name={quoteattr(row["name"])} valueReference="{row["reference"]}" description={quoteattr(row["description"])}'
    text += f' causality="{row["causality"]}" variability="{variability}"'
    if row["causality"] == "parameter":
        text += ' initial="exact"'
    elif row["causality"] == "output":
        text += ' initial="calculated"'
    return text, row["causality"] != "output"


def units(element):
    base = {name: f"<BaseUnit {exponents}/>" for name, exponents in UNITS.items()}
    inner = "".join(f'<Unit name="{name}">{text}</Unit>' for name, text in base.items())
    return f"<{element}>{inner}</{element}>"


def outputs(rows):
    return [(index, row) for index, row in enumerate(rows, 1) if row["causality"] == "output"]


def fmi2(rows):
    text = ""
    for row in rows:
        attributes, started = common(row)
        start = f' start="{row["start"]}"' if started else ""
        kind = f'<Real unit="{row["unit"]}"{start}/>' if row["real"] else f"<Integer{start}/>"
        text += f"<ScalarVariable {attributes}>{kind}</ScalarVariable>\n"
    unknowns = "".join(f'<Unknown index="{index}"/>' for index, _ in outputs(rows))
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="{NAME}" guid="{TOKEN}" description="{DESCRIPTION}"
  version="{VERSION}" license="MIT OR Apache-2.0" generationTool="vm-nostd" variableNamingConvention="structured">
<CoSimulation modelIdentifier="{NAME}" canHandleVariableCommunicationStepSize="true"
  canGetAndSetFMUstate="true" canSerializeFMUstate="true"/>
{units("UnitDefinitions")}
<LogCategories><Category name="logStatusError"/></LogCategories>
<DefaultExperiment startTime="0" stopTime="1" stepSize="0.001"/>
<ModelVariables>
{text}</ModelVariables>
<ModelStructure><Outputs>{unknowns}</Outputs><InitialUnknowns>{unknowns}</InitialUnknowns></ModelStructure>
</fmiModelDescription>
"""


def fmi3(rows):
    text = '<Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>\n'
    for row in rows:
        attributes, started = common(row)
        start = f' start="{row["start"]}"' if started else ""
        unit = f' unit="{row["unit"]}"' if row["real"] else ""
        text += f'<{"Float64" if row["real"] else "Int32"} {attributes}{unit}{start}/>\n'
    def unknowns(element):
        return "".join(f'<{element} valueReference="{row["reference"]}"/>' for _, row in outputs(rows))
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="{NAME}" instantiationToken="{TOKEN}" description="{DESCRIPTION}"
  version="{VERSION}" license="MIT OR Apache-2.0" generationTool="vm-nostd" variableNamingConvention="structured">
<CoSimulation modelIdentifier="{NAME}" canHandleVariableCommunicationStepSize="true"
  canGetAndSetFMUState="true" canSerializeFMUState="true"/>
{units("UnitDefinitions")}
<LogCategories><Category name="logStatusError"/></LogCategories>
<DefaultExperiment startTime="0" stopTime="1" stepSize="0.001"/>
<ModelVariables>
{text}</ModelVariables>
<ModelStructure>{unknowns("Output")}{unknowns("InitialUnknown")}</ModelStructure>
</fmiModelDescription>
"""


def licences():
    root = HERE.parent
    return [path for path in (root / "LICENSE-MIT", root / "LICENSE-APACHE") if path.exists()]


def pack(path, description, binary, place):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", description)
        archive.write(binary, place)
        archive.write(HERE / "README.md", "documentation/README.md")
        for licence in licences():
            archive.write(licence, f"documentation/licenses/{licence.name}")


def main(library, folder):
    names = PLATFORMS.get((platform.system(), platform.machine()))
    if names is None:
        sys.exit(f"{platform.system()} {platform.machine()}: not among {list(PLATFORMS)}; README.md says what to add")
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as room:
        rows = variables(library, room)
        for version, describe, directory in ((2, fmi2, names[0]), (3, fmi3, names[1])):
            if directory is None:
                print(f"FMI {version}.0 has no name for this platform")
                continue
            binary = Path(room) / f"{NAME}{version}{names[2]}"
            compile_unit(library, binary, ["muscle.c", "variables.c", f"fmi{version}.c"], "-shared", "-fPIC")
            place = f"binaries/{directory}/{NAME}{names[2]}"
            pack(folder / f"{NAME}_fmi{version}.fmu", describe(rows), binary, place)
            print(folder / f"{NAME}_fmi{version}.fmu")


def version():
    """That of the header: major, minor and patch, two digits each."""
    header = (HERE.parent / "include" / "vm_nostd.h").read_text()
    number = int(header.split("#define VM_VERSION ")[1].split()[0])
    return f"{number // 10000}.{number // 100 % 100}.{number % 100}"


VERSION = version()

if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(Path(sys.argv[1]).resolve(), sys.argv[2])
