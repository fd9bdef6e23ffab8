"""Speed beside scipy's solvers, which solve the same equations in the same run, at stated errors.

`pytest -s tests/test_speed.py` prints the table.
"""

import time

import numpy as np
from conftest import PAPER
from equations import Fes

import vm_nostd as vm

TICKS = 2000
TIME_STEP_S = 1e-3
# Method, relative and absolute tolerance (in L_ce0, L_ce0/s, ...): scipy's defaults, and finer.
SOLVERS = [
    ("RK45", 1e-3, 1e-6),
    ("LSODA", 1e-3, 1e-6),
    ("LSODA", 1e-6, 1e-9),
    ("BDF", 1e-3, 1e-6),
]


def inputs():
    """Two trains of 0.6 s, the second while the path is stretched by 1 cm and let go."""
    seconds = np.arange(TICKS + 1) * TIME_STEP_S
    activation = np.where(((seconds > 0.1) & (seconds < 0.7)) | (seconds > 1.2), 1.0, 0.0)
    activation[seconds > 1.8] = 0.0
    path = np.interp(seconds, [0, 1.3, 1.5, 1.7, 2], [0.16, 0.16, 0.17, 0.16, 0.16])
    return activation, path, np.where(seconds > 1.0, 40.0, 25.0)


def timed(of, least_s=0.2):
    """Seconds of the processor for a call, as a mean over at least so many, and its result."""
    calls, start = 0, time.process_time()
    while calls == 0 or time.process_time() - start < least_s:
        result = of()
        calls += 1
    return (time.process_time() - start) / calls, result


def test_faster_than_scipys_solvers_at_a_smaller_error():
    columns = inputs()
    muscle = vm.Muscle(PAPER, mode="fes", time_step_s=TIME_STEP_S)
    f0 = muscle.max_isometric_force_n
    expected = muscle.replace(arithmetic="reference").run(*columns).force_n
    assert expected.max() > 0.4 * f0

    def error(force):
        return 100 * np.abs(force - expected).max() / f0

    rows = []
    for accuracy_class in ["economy", "standard", "fine"]:
        chosen = muscle.replace(accuracy_class=accuracy_class)
        seconds, trace = timed(lambda: chosen.run(*columns))
        rows.append((f"f32, {accuracy_class}", seconds, error(trace.force_n)))
    seconds, error_of_ours = rows[1][1:]
    for method, rtol, atol in SOLVERS:
        options = {"method": method, "rtol": rtol, "atol": atol}
        theirs, force = timed(lambda: Fes().run(*columns, TIME_STEP_S, **options), 0)
        rows.append((f"scipy {method}, rtol {rtol:g}", theirs, error(force)))
    print(f"\n{TICKS} ticks; ratio to f32, standard; error: largest, % of F0, from the reference")
    for name, time_of_it, error_of_it in rows:
        each = 1e9 * time_of_it / TICKS
        print(f"{name:24} {each:12.0f} ns/tick {time_of_it / seconds:8.1f} x {error_of_it:8.4f} %")
    assert error_of_ours < 0.1
    # The equations are the same: the finest is near the reference.
    assert min(row[2] for row in rows[3:]) < 0.01
    for _, theirs, _ in rows[3:]:
        assert theirs > 20 * seconds
