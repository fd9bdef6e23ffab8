"""FMPy's verdict on the FMUs, and their outputs against those of `vm run`.

check.py FOLDER VM: FOLDER has the FMUs of build.py, VM is the program `vm`.
"""

import csv
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

ROOT = Path(__file__).resolve().parents[3]
MUSCLE = ROOT / "host-sim/data/muscles/deltoid_posterior.toml"
ARITHMETICS = ["f32", "fixed", "f64"]
MODES = ["continuous", "fes"]
ROWS = 400


class Unit:
    """A unit of either version, by names of variables; `log` has its messages."""

    def __init__(self, path, **parameters):
        self.log = []
        self.description = read_model_description(str(path))
        self.three = self.description.fmiVersion.startswith("3")
        self.by_name = {v.name: v for v in self.description.modelVariables}
        arguments = dict(
            guid=self.description.guid,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            unzipDirectory=extract(str(path)),
            instanceName="muscle",
        )
        if self.three:
            self.fmu = FMU3Slave(**arguments)
            self.fmu.instantiate(loggingOn=True, logMessage=lambda *said: self.log.append(said[-1].decode()))
        else:
            self.fmu = FMU2Slave(**arguments)
            callbacks = self.callbacks()
            self.fmu.instantiate(callbacks=callbacks, loggingOn=True)
            self.fmu.setupExperiment(startTime=0.0)
        self.set(**parameters)

    def callbacks(self):
        from fmpy import fmi2

        def logger(environment, name, status, category, message):
            self.log.append(message.decode())

        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(logger)
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmi2.calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmi2.free)
        self.kept = callbacks
        return callbacks

    def set(self, **values):
        for name, value in values.items():
            self.put(name, value)

    def put(self, name, value):
        variable = self.by_name[name]
        real = variable.type in ("Real", "Float64")
        setter = {
            (False, True): "setReal",
            (False, False): "setInteger",
            (True, True): "setFloat64",
            (True, False): "setInt32",
        }[(self.three, real)]
        getattr(self.fmu, setter)([variable.valueReference], [value])

    def get(self, name):
        variable = self.by_name[name]
        real = variable.type in ("Real", "Float64")
        getter = {
            (False, True): "getReal",
            (False, False): "getInteger",
            (True, True): "getFloat64",
            (True, False): "getInt32",
        }[(self.three, real)]
        return getattr(self.fmu, getter)([variable.valueReference])[0]

    def initialize(self):
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.time = 0.0

    def step(self, duration=1e-3):
        self.fmu.doStep(currentCommunicationPoint=self.time, communicationStepSize=duration)
        self.time += duration

    def end(self):
        self.fmu.terminate()
        self.fmu.freeInstance()


def refused(action, unit):
    """Message of an action that the unit refuses."""
    try:
        action()
    except Exception:
        return unit.log[-1] if unit.log else "nothing was logged"
    sys.exit("an action that must be refused was not")


def inputs():
    """Rows of inputs that every arithmetic takes exactly: steps, ramps, moving paths, one out of range."""
    rows = []
    for tick in range(ROWS):
        activation = [0.0, 0.4, 1.0, 0.25][tick // 100]
        path = round(0.16 + 0.01 * math.sin(tick / 30.0), 6)
        frequency = [20.0, 35.5, 10.0, 60.0][tick // 100]
        rows.append((tick / 1000.0, 1.5 if tick == 350 else activation, path, frequency))
    return rows


def digits(value):
    """As `vm run` writes numbers: nine significant digits, which tell every float."""
    return f"{value:.9g}"


def equal_to_vm_run(path, vm, folder):
    rows = inputs()
    file = Path(folder) / "inputs.csv"
    with open(file, "w", newline="") as out:
        writer = csv.writer(out)
        writer.writerow(["t_s", "activation", "path_length_m", "stim_hz"])
        writer.writerows(rows)
    for mode, mode_name in enumerate(MODES):
        for arithmetic, arithmetic_name in enumerate(ARITHMETICS):
            output = Path(folder) / "outputs.csv"
            command = [vm, "run", "--muscle", MUSCLE, "--input", file, "--output", output]
            command += ["--mode", mode_name, "--arithmetic", arithmetic_name]
            subprocess.run(command, check=True, capture_output=True)
            with open(output, newline="") as lines:
                expected = list(csv.DictReader(lines))
            unit = Unit(path, mode=mode, arithmetic=arithmetic, path_length_m=rows[0][2])
            unit.initialize()
            flagged = 0
            for index, (_, activation, length, frequency) in enumerate(rows):
                if index:
                    unit.set(activation=activation, path_length_m=length, stimulation_frequency_pps=frequency)
                    unit.step()
                want = expected[index]
                for name, column in (
                    ("force_n", "force_n"),
                    ("fascicle_length", "fascicle_length_l0"),
                    ("fascicle_velocity", "fascicle_velocity_l0_per_s"),
                ):
                    have, wanted = unit.get(name), float(want[column])
                    same = np.float32(have) == np.float32(wanted) if arithmetic == 0 else digits(have) == digits(wanted)
                    if not same:
                        sys.exit(f"{mode_name} {arithmetic_name} row {index} {name}: {have!r}, vm run {wanted!r}")
                status = unit.get("status")
                flagged += status != 0
                if (status == 0) != (want["status"] == "ok"):
                    sys.exit(f"{mode_name} {arithmetic_name} row {index}: status {status}, vm run {want['status']}")
            if not flagged:
                sys.exit("no row was flagged")
            unit.end()
            print(f"    {mode_name} {arithmetic_name}: {ROWS} rows equal to vm run")


def state_comes_back(path):
    unit = Unit(path, mode=1)
    unit.initialize()
    unit.set(activation=0.7)
    for _ in range(50):
        unit.step()
    getter, setter, freer = (
        (unit.fmu.getFMUState, unit.fmu.setFMUState, unit.fmu.freeFMUState)
        if unit.three
        else (unit.fmu.getFMUstate, unit.fmu.setFMUstate, unit.fmu.freeFMUstate)
    )
    state, then = getter(), unit.time
    first = []
    for _ in range(50):
        unit.step()
        first.append(unit.get("force_n"))
    # The host, too, goes back in time.
    setter(state)
    unit.time = then
    again = []
    for _ in range(50):
        unit.step()
        again.append(unit.get("force_n"))
    if first != again or len(set(first)) < 10:
        sys.exit("a state that was set back goes on otherwise")
    serialized = unit.fmu.serializeFMUState(state) if unit.three else unit.fmu.serializeFMUstate(state)
    restore = unit.fmu.deserializeFMUState if unit.three else unit.fmu.deSerializeFMUstate
    setter(restore(serialized))
    unit.time = then
    unit.step()
    if unit.get("force_n") != first[0]:
        sys.exit("a state that was read back goes on otherwise")
    message = refused(lambda: restore(serialized[:-1]), unit)
    if "no state of this unit" not in message:
        sys.exit(f"too few bytes: {message}")
    freer(state)
    unit.end()


def wrong_values_are_named(path):
    cases = [
        ({"mass_kg": -1.0}, "mass_kg = -1: must be between 1e-05 and 30"),
        ({"fibers[1].rise_s": 5.0}, "fibers[1].rise_s = 5: must be between"),
        ({"density": 1.0}, "density = 1: must be between 500 and 2000"),
        ({"time_step_s": 1.0}, "time_step_s = 1: must be between 0.0001 and 0.002"),
        ({"mode": 7}, "mode = 7: must be between 0 and"),
        ({"arithmetic": 3}, "arithmetic = 3: must be between 0 and 2"),
        ({"path_length_m": 1.0}, "path_length_m = 1: must be between"),
        ({"fiber_count": 6}, "fiber_count = 6: must be between"),
    ]
    for values, expected in cases:
        unit = Unit(path, **values)
        message = refused(unit.initialize, unit)
        if not message.startswith(expected):
            sys.exit(f"{values}: {message!r} does not start with {expected!r}")
        unit.fmu.freeInstance()
    unit = Unit(path)
    unit.initialize()
    message = refused(lambda: unit.step(1.5e-3), unit)
    if not message.startswith("communication step size = 0.0015: must be a whole multiple"):
        sys.exit(message)
    message = refused(lambda: unit.set(mass_kg=0.1), unit)
    if message != "mass_kg cannot be set after initialization":
        sys.exit(message)
    unit.fmu.freeInstance()


def antagonists(path):
    """Two muscles turn a pulley on a spring: the stronger shortens, and the other is stretched."""
    arm, inertia, stiffness, damping, middle, step = 0.02, 0.02, 4.0, 0.2, 0.16, 1e-3
    muscles = [Unit(path), Unit(path)]
    for muscle in muscles:
        muscle.initialize()
    angle, speed = 0.0, 0.0
    angles = []
    for tick in range(1000):
        for muscle, side in zip(muscles, (1.0, -1.0)):
            muscle.set(activation=[0.6, 0.2][muscle is muscles[1]], path_length_m=middle - side * arm * angle)
            muscle.step(step)
        torque = arm * (muscles[0].get("force_n") - muscles[1].get("force_n"))
        torque -= stiffness * angle + damping * speed
        speed += step * torque / inertia
        angle += step * speed
        angles.append(angle)
    lengths = [muscle.get("fascicle_length") for muscle in muscles]
    if not (0.05 < angle < 0.6 and lengths[0] < lengths[1] and max(angles) < 0.8):
        sys.exit(f"antagonists: angle {angle} rad, lengths {lengths}")
    for muscle in muscles:
        muscle.end()
    print(f"    two antagonists settle at {angle:.3f} rad")


def main(folder, vm):
    for version in (2, 3):
        path = Path(folder) / f"virtual_muscle_fmi{version}.fmu"
        findings = validate_fmu(str(path))
        if findings:
            sys.exit("\n".join(findings))
        print(f"FMI {version}.0: validated without a finding")
        result = simulate_fmu(str(path), stop_time=0.5, start_values={"activation": 0.5, "mode": 1}, output=["force_n"])
        if not result["force_n"][-1] > 10.0:
            sys.exit(f"simulate_fmu: {result['force_n'][-1]} N")
        print(f"    simulated by FMPy: {result['force_n'][-1]:.3f} N")
        with tempfile.TemporaryDirectory() as room:
            equal_to_vm_run(path, vm, room)
        state_comes_back(path)
        wrong_values_are_named(path)
        antagonists(path)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
