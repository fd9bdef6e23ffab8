"""The paper's equations under intramuscular FES for scipy's solvers, as a Python user would write
them: one function of time and state, without NumPy, which is slower for so few numbers.

Source: Song, Raphael, Lan & Loeb, J. Neural Eng. 5 (2008) 175-184, with the coefficients of
host-sim/data. The state: L, V, then Y, f_int, f_eff and S of each type.
"""

import csv
import tomllib
from math import exp, log1p

import numpy as np
from conftest import DATA, PAPER
from scipy.integrate import solve_ivp

PER_TYPE = 4


def softplus(x):
    return max(x, 0.0) + log1p(exp(-abs(x)))


def row(table, *labels):
    """Numbers of a row of a table, by column."""
    with (DATA / table).open() as file:
        for cells in csv.DictReader(file):
            if tuple(cells.values())[: len(labels)] == labels:
                numbers = list(cells.items())[len(labels) :]
                return {name: float(text) for name, text in numbers if text}
    raise KeyError(labels)


class Fes:
    """The paper's muscle under FES."""

    def __init__(self):
        muscle = tomllib.loads(PAPER.read_text())
        self.e = e = row("elements.csv", "paper-table-1")
        types = [fiber["preset"].split("/") for fiber in muscle["fiber"]]
        self.types = [row("fibers.csv", *name) for name in types]
        self.fractions = [fiber["fraction"] for fiber in muscle["fiber"]]
        mass, self.l_ce0 = muscle["mass_g"] * 1e-3, muscle["fascicle_length_cm"] * 1e-2
        self.l_se0 = muscle["tendon_length_cm"] * 1e-2
        pcsa = mass / (e["density_g_per_cm3"] * 1e3 * self.l_ce0)
        self.f0 = e["specific_tension_n_per_cm2"] * 1e4 * pcsa
        self.acceleration = self.f0 / (0.5 * mass * self.l_ce0)
        passive = e["c1"] * e["k1"] * softplus((1 - e["Lr1"]) / e["k1"])
        # The tendon's length with that force, by bisection.
        low, high = 0.5, 1.5
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.tendon(middle) < passive else (low, middle)
        self.l_max = (muscle["max_path_length_cm"] * 1e-2 - self.l_se0 * low) / self.l_ce0

    def tendon(self, length):
        return self.e["cT"] * self.e["kT"] * softplus((length - self.e["LrT"]) / self.e["kT"])

    def force(self, path, length):
        """Tendon force, N."""
        return self.f0 * self.tendon((path - length * self.l_ce0) / self.l_se0)

    def rest(self, path):
        low, high = 0.4, path / self.l_ce0
        for _ in range(60):
            middle = 0.5 * (low + high)
            pull = self.force(path, middle) / self.f0
            low, high = (middle, high) if pull > self.parallel(middle, 0.0) else (low, middle)
        state = [low, 0.0]
        for t in self.types:
            state += [1.0, 0.0, 0.0, t.get("aS1", 1.0)]
        return state

    def parallel(self, length, velocity):
        e = self.e
        stretch = (length / self.l_max - e["Lr1"]) / e["k1"]
        return e["c1"] * e["k1"] * softplus(stretch) + e["eta"] * velocity

    def rates(self, time, state, activation, frequency, path, path_rate):
        """The right-hand side while the input is held and the path moves evenly."""
        e, state = self.e, state.tolist()
        length, velocity = state[:2]
        filaments, compression, rates = 0.0, 0.0, [velocity, 0.0]
        # A stage that a solver will reject may be anywhere: the equations end where the model's do.
        inside = min(max(length, 0.4), 1.8)
        for index, (t, fraction) in enumerate(zip(self.types, self.fractions)):
            at = 2 + PER_TYPE * index
            y, f_int, f_eff, s = state[at : at + PER_TYPE]
            f_env = frequency / t["f05_pps"]
            n_f = max(0.2, t["nf0"] + t["nf1"] * (1 / inside - 1))
            af = 1 - exp(-((max(0.0, y * s * f_env) / (t["af"] * n_f)) ** n_f))
            if f_int >= f_eff:
                lag = t["Tf1_ms"] * inside**2 + t["Tf2_ms"] * f_env
            else:
                lag = (t["Tf3_ms"] + t["Tf4_ms"] * (activation > 0)) / inside
            overlap = exp(-(abs((inside ** t["beta"] - 1) / t["omega"]) ** t["rho"]))
            if velocity <= 0:
                slope = t["cV0"] + t["cV1"] * inside
                fast = velocity < t["Vmax"]
                speed = 0 if fast else (t["Vmax"] - velocity) / (t["Vmax"] + slope * velocity)
            else:
                slope = t["aV0"] + t["aV1"] * inside + t["aV2"] * inside**2
                speed = (t["bV"] - slope * velocity) / (t["bV"] + velocity)
            filaments += f_eff * fraction * af * overlap * speed
            compression += fraction * af
            yields, sags = "cY" in t, "aS1" in t
            steady_y = 1 - t["cY"] * (1 - exp(-abs(velocity) / t["VY"])) if yields else 1.0
            steady_s = (t["aS2"] if f_env > 0.1 else t["aS1"]) if sags else 1.0
            rates += [
                (steady_y - y) / (t["TY_ms"] * 1e-3) if yields else 0.0,
                (activation - f_int) / (lag * 1e-3),
                (f_int - f_eff) / (lag * 1e-3),
                (steady_s - s) / (t["TS_ms"] * 1e-3) if sags else 0.0,
            ]
        squeezed = min(0.0, e["c2"] * (exp(e["k2"] * (inside - e["Lr2"])) - 1))
        passive = max(0.0, self.parallel(length, velocity) + compression * squeezed)
        pull = self.force(path + path_rate * time, length) / self.f0
        rates[1] = self.acceleration * (pull - passive - filaments)
        return rates

    def run(self, activation, path, frequency, time_step, **options):
        """Tendon force (N) of every row from rest, solved from jump to jump of the inputs."""
        travel = np.diff(path)
        changes = np.diff(activation[1:]) != 0
        changes |= (np.diff(frequency[1:]) != 0) | (np.abs(np.diff(travel)) > 1e-12)
        starts = [0, *(1 + np.flatnonzero(changes)), len(path) - 1]
        state = self.rest(path[0])
        lengths = [state[0]]
        for start, end in zip(starts, starts[1:]):
            span = (end - start) * time_step
            held = (activation[end], frequency[end], path[start], travel[start] / time_step)
            times = np.linspace(0, span, end - start + 1)
            found = solve_ivp(
                self.rates, (0, span), state, t_eval=times, args=list(map(float, held)), **options
            )
            if not found.success:
                raise ArithmeticError(found.message)
            lengths.extend(found.y[0][1:])
            state = list(found.y[:, -1])
        return np.array([self.force(p, length) for p, length in zip(path, lengths)])
