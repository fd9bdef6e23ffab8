"""Lays out an Arduino library: pack.py FOLDER CPU=LIBRARY ...

CPU is Arduino's build.mcu, as cortex-m4; LIBRARY is a libvm_nostd.a for it with the float ABI of the board's core.
"""

import shutil
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent


def main(folder, archives):
    folder = Path(folder) / "vm_nostd"
    shutil.rmtree(folder, ignore_errors=True)
    sources = folder / "src"
    sources.mkdir(parents=True)
    shutil.copy(HERE / "library.properties", folder)
    shutil.copytree(HERE / "examples", folder / "examples")
    shutil.copy(HERE.parent / "include" / "vm_nostd.h", sources)
    for licence in ("LICENSE-MIT", "LICENSE-APACHE"):
        shutil.copy(HERE.parent / licence, folder)
    for pair in archives:
        cpu, archive = pair.split("=", 1)
        (sources / cpu).mkdir()
        shutil.copy(archive, sources / cpu / "libvm_nostd.a")
    print(folder)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
