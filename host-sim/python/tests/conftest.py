"""`vm run` for comparison, and the repository's muscles and inputs."""

import csv
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]
DATA = ROOT / "host-sim/data"
PAPER = DATA / "muscles/deltoid_posterior.toml"
INPUTS = ["activation", "path_length_m", "stim_hz"]
OUTPUTS = ["force_n", "fascicle_length_l0", "fascicle_velocity_l0_per_s"]
MODES = ["continuous", "fes", "discrete", "discrete-leff"]
ARITHMETICS = ["f32", "fixed", "f64", "reference"]


def vector(name):
    """Activation, path (m) and stimulation frequency (pps) of one of the repository's traces."""
    with (DATA / f"vectors/{name}.csv").open() as file:
        rows = list(csv.DictReader(file))
    return [np.array([float(row[column]) for row in rows]) for column in INPUTS]


def bits(values):
    """To the nine digits that `vm run` writes: of f32, all bits."""
    return [float(f"{value:.8e}") for value in values]


@pytest.fixture(scope="session")
def vm_run(tmp_path_factory):
    """Runs `vm run`: columns of outputs, and the names of the flags of each row."""
    # .ci/python builds it and says where it is.
    program = os.environ.get("VM", ROOT / "target/release/vm")
    folder = tmp_path_factory.mktemp("vm")

    def run(muscle, columns, mode, arithmetic, accuracy_class="standard", time_step_s=1e-3):
        inputs, outputs = folder / "inputs.csv", folder / "outputs.csv"
        with inputs.open("w") as file:
            file.write("t_s,activation,path_length_m,stim_hz\n")
            for row, values in enumerate(zip(*columns)):
                file.write(",".join(repr(float(x)) for x in [row * time_step_s, *values]) + "\n")
        command = [program, "run", "--muscle", muscle, "--input", inputs, "--output", outputs]
        command += ["--mode", mode, "--arithmetic", arithmetic, "--class", accuracy_class]
        subprocess.run(command, check=True, capture_output=True, text=True, timeout=120)
        with outputs.open() as file:
            rows = list(csv.DictReader(file))
        return [[float(row[name]) for row in rows] for name in OUTPUTS], [
            row["status"] for row in rows
        ]

    return run


@pytest.fixture
def paper():
    """The paper's muscle under FES, in f32."""
    import vm_nostd

    return vm_nostd.Muscle(PAPER, mode="fes")
