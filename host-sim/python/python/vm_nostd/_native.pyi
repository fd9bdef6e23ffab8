"""What is written in Rust. Units are in the names, and in the docstrings of the classes."""

import os
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias, final, overload

from numpy import float64, floating, integer, uint16, uint64
from numpy.typing import NDArray

from ._results import (
    Envelope,
    Estimate,
    FatigueParams,
    FesCommand,
    GainEstimate,
    Output,
    Posture,
    ProsthesisCommand,
    Trace,
    TrialFit,
)

__all__ = [
    "Curves",
    "Fatigue",
    "FesController",
    "Fit",
    "Joint",
    "JointPath",
    "Muscle",
    "Prosthesis",
    "RecruitmentCurve",
    "State",
    "Steady",
    "fit_list",
    "flags",
    "muscle_names",
    "numbers",
]

_Mode: TypeAlias = Literal["continuous", "fes", "discrete", "discrete-leff"]
_ModelArithmetic: TypeAlias = Literal["f32", "fixed", "f64"]
_Arithmetic: TypeAlias = Literal["f32", "fixed", "f64", "reference"]
_AccuracyClass: TypeAlias = Literal["economy", "standard", "fine"]
_Array: TypeAlias = NDArray[floating[Any]] | NDArray[integer[Any]] | Sequence[float]
_Numbers: TypeAlias = float | _Array
_Words: TypeAlias = NDArray[uint64]
_Values: TypeAlias = NDArray[float64]
_Flags: TypeAlias = NDArray[uint16]

@final
class Muscle:
    def __new__(
        cls,
        muscle: str | os.PathLike[str] | dict[str, Any],
        *,
        mode: _Mode = "continuous",
        arithmetic: _Arithmetic = "f32",
        accuracy_class: _AccuracyClass | None = None,
        time_step_s: float = 0.001,
    ) -> Muscle: ...
    @classmethod
    def from_toml(
        cls,
        text: str,
        *,
        mode: _Mode = "continuous",
        arithmetic: _Arithmetic = "f32",
        accuracy_class: _AccuracyClass | None = None,
        time_step_s: float = 0.001,
    ) -> Muscle: ...
    def replace(
        self,
        *,
        mode: _Mode | None = None,
        arithmetic: _Arithmetic | None = None,
        accuracy_class: _AccuracyClass | None = None,
        time_step_s: float | None = None,
    ) -> Muscle: ...
    def at_rest(self, path_length_m: float) -> State: ...
    def run(
        self,
        activation: _Numbers,
        path_length_m: _Numbers,
        stimulation_frequency_pps: _Numbers | None = None,
    ) -> Trace: ...
    def curves(self) -> Curves: ...
    def steady(self) -> Steady: ...
    def to_toml(self) -> str: ...
    def __getnewargs_ex__(self) -> tuple[tuple[dict[str, Any]], dict[str, Any]]: ...
    @property
    def recruitment_curve(self) -> RecruitmentCurve | None: ...
    @property
    def name(self) -> str: ...
    @property
    def mode(self) -> _Mode: ...
    @property
    def arithmetic(self) -> _Arithmetic: ...
    @property
    def accuracy_class(self) -> _AccuracyClass: ...
    @property
    def time_step_s(self) -> float: ...
    @property
    def max_isometric_force_n(self) -> float: ...
    @property
    def mass_kg(self) -> float: ...
    @property
    def fascicle_length_m(self) -> float: ...
    @property
    def tendon_length_m(self) -> float: ...
    @property
    def path_domain_m(self) -> tuple[float, float]: ...
    @property
    def fractions(self) -> list[float]: ...

@final
class State:
    @property
    def output(self) -> Output: ...
    def step(
        self,
        activation: float,
        path_length_m: float,
        stimulation_frequency_pps: float | None = None,
    ) -> Output: ...
    def run(
        self,
        activation: _Numbers,
        path_length_m: _Numbers,
        stimulation_frequency_pps: _Numbers | None = None,
    ) -> Trace: ...
    def stiffness_n_per_m(self) -> float: ...
    def save(self) -> _Words: ...
    def restore(self, words: _Words) -> None: ...
    def copy(self) -> State: ...
    def __copy__(self) -> State: ...
    def __deepcopy__(self, _memo: Any) -> State: ...

@final
class Curves:
    @overload
    def force_length(self, fiber: int, fascicle_length_l0: float) -> float: ...
    @overload
    def force_length(self, fiber: int, fascicle_length_l0: _Array) -> _Values: ...
    @overload
    def force_velocity(
        self, fiber: int, fascicle_length_l0: float, fascicle_velocity_l0_per_s: float
    ) -> float: ...
    @overload
    def force_velocity(
        self, fiber: int, fascicle_length_l0: _Numbers, fascicle_velocity_l0_per_s: _Numbers
    ) -> _Values: ...
    @overload
    def activation_frequency(
        self, fiber: int, fascicle_length_l0: float, frequency_f05: float
    ) -> float: ...
    @overload
    def activation_frequency(
        self, fiber: int, fascicle_length_l0: _Numbers, frequency_f05: _Numbers
    ) -> _Values: ...
    @overload
    def passive(self, fascicle_length_l0: float) -> float: ...
    @overload
    def passive(self, fascicle_length_l0: _Array) -> _Values: ...
    @overload
    def compression(self, fascicle_length_l0: float) -> float: ...
    @overload
    def compression(self, fascicle_length_l0: _Array) -> _Values: ...
    @overload
    def tendon(self, fascicle_length_l0: float, path_length_m: float) -> float: ...
    @overload
    def tendon(self, fascicle_length_l0: _Numbers, path_length_m: _Numbers) -> _Values: ...

@final
class Steady:
    @overload
    def activation_for(
        self,
        force_n: float,
        path_length_m: float,
        stimulation_frequency_pps: float | None = None,
    ) -> tuple[float, int]: ...
    @overload
    def activation_for(
        self,
        force_n: _Numbers,
        path_length_m: _Numbers,
        stimulation_frequency_pps: _Numbers | None = None,
    ) -> tuple[_Values, _Flags]: ...
    @overload
    def force(
        self, activation: float, path_length_m: float, stimulation_frequency_pps: float
    ) -> tuple[float, int]: ...
    @overload
    def force(
        self, activation: _Numbers, path_length_m: _Numbers, stimulation_frequency_pps: _Numbers
    ) -> tuple[_Values, _Flags]: ...

@final
class Fatigue:
    def __new__(
        cls,
        fatigue_time_s: float,
        recovery_time_s: float,
        least_fitness: float,
        frequency_dependence: float,
        *,
        time_step_s: float = 0.001,
        arithmetic: _ModelArithmetic = "f32",
    ) -> Fatigue: ...
    @classmethod
    def quadriceps(
        cls, *, time_step_s: float = 0.001, arithmetic: _ModelArithmetic = "f32"
    ) -> Fatigue: ...
    @property
    def fitness(self) -> float: ...
    def rest(self) -> None: ...
    def advance(self, activation: float, stimulation_frequency_pps: float = 100.0) -> float: ...
    def run(
        self, activation: _Numbers, stimulation_frequency_pps: _Numbers | None = None
    ) -> _Values: ...
    def save(self) -> _Words: ...
    def restore(self, words: _Words) -> None: ...

@final
class RecruitmentCurve:
    def __new__(
        cls,
        threshold_ma: float,
        saturation_ma: float,
        chronaxie_us: float,
        slope: float,
        *,
        arithmetic: _ModelArithmetic = "f32",
    ) -> RecruitmentCurve: ...
    @overload
    def activation(self, amplitude_ma: float, width_us: float) -> tuple[float, int]: ...
    @overload
    def activation(self, amplitude_ma: _Numbers, width_us: _Numbers) -> tuple[_Values, _Flags]: ...
    @overload
    def amplitude_for(self, activation: float, width_us: float) -> tuple[float, int]: ...
    @overload
    def amplitude_for(self, activation: _Numbers, width_us: _Numbers) -> tuple[_Values, _Flags]: ...
    @overload
    def width_for(self, activation: float, amplitude_ma: float) -> tuple[float, int]: ...
    @overload
    def width_for(self, activation: _Numbers, amplitude_ma: _Numbers) -> tuple[_Values, _Flags]: ...

@final
class Fit:
    @property
    def estimates(self) -> list[Estimate]: ...
    @property
    def trials(self) -> list[TrialFit]: ...
    @property
    def pairs(self) -> list[tuple[str, str, float]]: ...
    @property
    def noise_ratio(self) -> float: ...
    def to_toml(self) -> str: ...

def fit_list(
    muscle: Muscle,
    trials: Mapping[str, Any] | os.PathLike[str],
    folder: str | os.PathLike[str],
    starts: int,
    seed: int,
) -> Fit: ...

@final
class JointPath:
    def __new__(
        cls,
        length_m: float,
        reference_rad: Sequence[float],
        terms_m_per_rad: Sequence[Sequence[float]],
        action: Sequence[Literal["flexes", "extends", "none", "either"]],
        product_m_per_rad2: float = 0.0,
    ) -> JointPath: ...

@final
class Joint:
    def __new__(
        cls,
        angle_ranges_rad: Sequence[tuple[float, float]],
        muscles: Sequence[Muscle],
        paths: Sequence[JointPath],
        *,
        arithmetic: _ModelArithmetic = "f32",
    ) -> Joint: ...
    @classmethod
    def named(
        cls,
        name: Literal["ankle", "knee", "elbow"],
        *,
        mode: _Mode = "fes",
        arithmetic: _ModelArithmetic = "f32",
    ) -> Joint: ...
    @property
    def muscles(self) -> list[Muscle]: ...
    @property
    def angle_ranges_rad(self) -> list[tuple[float, float]]: ...
    def posture(self, angles_rad: Sequence[float]) -> Posture: ...
    def torques_nm(self, angles_rad: Sequence[float], forces_n: Sequence[float]) -> _Values: ...
    def stiffnesses_nm_per_rad(
        self,
        angles_rad: Sequence[float],
        forces_n: Sequence[float],
        stiffnesses_n_per_m: Sequence[float],
    ) -> _Values: ...

@final
class FesController:
    def __new__(
        cls,
        joint: Joint,
        electrodes: tuple[RecruitmentCurve, RecruitmentCurve],
        *,
        pulse_amplitude_ma: float | None = None,
        pulse_width_us: float | None = None,
        inertia_kg_m2: float,
        damping_nm_s_per_rad: float,
        gravity_nm: float,
        hanging_angle_rad: float,
        proportional_nm_per_rad: float,
        integral_nm_per_rad_s: float,
        derivative_nm_s_per_rad: float = 0.0,
        derivative_filter_s: float = 0.02,
        most_integral_nm: float = 20.0,
        stimulation_frequency_pps: float = 40.0,
        cocontraction_nm: float = 1.0,
        measured: Literal["angle", "torque"] = "angle",
        expected_lag_s: float = 0.06,
        lead_filter_s: float = 0.025,
        least_fitness: float = 0.3,
        torque_range_nm: tuple[float, float] = ...,
        fatigue: tuple[FatigueParams, FatigueParams] | None = None,
        gain: GainEstimate | None = None,
        time_step_s: float = 0.001,
        arithmetic: _ModelArithmetic = "f32",
    ) -> FesController: ...
    def start(self, angle_rad: float) -> None: ...
    def step(
        self,
        wanted_rad: float,
        measured_rad: float,
        *,
        wanted_rad_per_s: float = 0.0,
        wanted_rad_per_s2: float = 0.0,
        wanted_torque_nm: float = 0.0,
        measured_torque_nm: float = 0.0,
    ) -> FesCommand: ...
    def save(self) -> _Words: ...
    def restore(self, words: _Words) -> None: ...

@final
class Prosthesis:
    def __new__(
        cls,
        joint: Joint,
        envelopes: tuple[Envelope, Envelope],
        angle_rad: float,
        *,
        torque_limits: tuple[float, float, float] = ...,
        stiffness_limits: tuple[float, float, float] = ...,
        time_step_s: float = 0.001,
        arithmetic: _ModelArithmetic = "f32",
    ) -> Prosthesis: ...
    def step(self, emg_mv: tuple[float, float], angle_rad: float) -> ProsthesisCommand: ...
    def save(self) -> _Words: ...
    def restore(self, words: _Words) -> None: ...

def muscle_names() -> list[str]: ...
def numbers(name: str, value: _Array) -> _Values: ...
def flags() -> dict[str, list[tuple[str, int]]]: ...
