"""Links the archive that was built for the board's core: lib/NAME/libvm_nostd.a."""

import os

Import("env")  # noqa: F821, PlatformIO gives it

CORES = {
    "cortex-m0plus": "thumbv6m-none-eabi",
    "cortex-m0": "thumbv6m-none-eabi",
    "cortex-m3": "thumbv7m-none-eabi",
    "cortex-m4": "thumbv7em-none-eabihf",
    "cortex-m7": "thumbv7em-none-eabihf",
    "cortex-m33": "thumbv8m.main-none-eabihf",
}


def name():
    board = env.BoardConfig() if env.get("BOARD") else None  # noqa: F821
    core = board.get("build.cpu", "") if board else ""
    return CORES.get(core, "host")


# PlatformIO runs this in the library's folder.
folder = os.path.realpath(os.path.join("lib", name()))
if not os.path.exists(os.path.join(folder, "libvm_nostd.a")):
    raise SystemExit("%s: no libvm_nostd.a; see README.md, PlatformIO" % folder)
env.Append(LIBPATH=[folder], LIBS=["vm_nostd"], LINKFLAGS=["-Wl,--gc-sections"])  # noqa: F821
if name() == "host":
    env.Append(LIBS=["m", "pthread", "dl"])  # noqa: F821
