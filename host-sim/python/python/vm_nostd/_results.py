"""What the model returns: tuples whose fields have units in their names."""

from enum import IntFlag
from typing import NamedTuple

from numpy import float64, uint16
from numpy.typing import NDArray


class Status(IntFlag):
    """Flags of a tick: what was clipped or limited; 0 if nothing was. The reference has none."""

    ACTIVATION_CLIPPED = 1 << 0
    ACTIVATION_NOT_FINITE = 1 << 1
    FREQUENCY_CLIPPED = 1 << 2
    FREQUENCY_NOT_FINITE = 1 << 3
    PATH_LENGTH_CLIPPED = 1 << 4
    PATH_LENGTH_NOT_FINITE = 1 << 5
    FASCICLE_OUTSIDE_DOMAIN = 1 << 6
    FASCICLE_LENGTH_LIMITED = 1 << 7
    FASCICLE_VELOCITY_LIMITED = 1 << 8
    MECHANICS_UNSETTLED = 1 << 9
    TENDON_FORCE_LIMITED = 1 << 10
    FORCE_UNREACHABLE = 1 << 11


class Output(NamedTuple):
    """A tick of a muscle: tendon force (N), fascicle length (L_ce0), fascicle velocity (L_ce0/s,
    positive when lengthening), flags."""

    force_n: float
    fascicle_length_l0: float
    fascicle_velocity_l0_per_s: float
    status: Status


class Trace(NamedTuple):
    """A run of a muscle: the columns of `Output`, one number per row."""

    force_n: NDArray[float64]
    fascicle_length_l0: NDArray[float64]
    fascicle_velocity_l0_per_s: NDArray[float64]
    status: NDArray[uint16]


class Estimate(NamedTuple):
    """A fitted parameter in the unit of its name; no error or interval where it is not known."""

    name: str
    value: float
    standard_error: float | None
    interval: tuple[float, float] | None
    note: str


class TrialFit(NamedTuple):
    """A recording and the fitted muscle: forces in N at times in s, errors in % of F0."""

    name: str
    role: str
    time_s: NDArray[float64]
    measured_n: NDArray[float64]
    model_n: NDArray[float64]
    mean_absolute_error_pct: float
    rms_error_pct: float
    mean_error_pct: float


class JointStatus(IntFlag):
    """What was wrong with a joint's angles."""

    ANGLE_CLIPPED = 1 << 0
    ANGLE_NOT_FINITE = 1 << 1


class Posture(NamedTuple):
    """Muscles of a joint: path of each (m), moment arms (m, a row per muscle and a column per
    joint, positive where the muscle flexes), flags."""

    path_lengths_m: NDArray[float64]
    moment_arms_m: NDArray[float64]
    status: JointStatus


class PulseStatus(IntFlag):
    """Flags of a pulse, or of the inverse of a recruitment curve."""

    AMPLITUDE_CLIPPED = 1 << 0
    AMPLITUDE_NOT_FINITE = 1 << 1
    WIDTH_CLIPPED = 1 << 2
    WIDTH_NOT_FINITE = 1 << 3
    ACTIVATION_CLIPPED = 1 << 4
    ACTIVATION_NOT_FINITE = 1 << 5
    UNREACHABLE = 1 << 6


class ControlStatus(IntFlag):
    """What a tick of the FES controller had to saturate."""

    MEASURED_NOT_FINITE = 1 << 0
    TARGET_INVALID = 1 << 1
    MEASURED_CLIPPED = 1 << 2
    TORQUE_LIMITED = 1 << 3
    UNREACHABLE = 1 << 4
    LEAD_CLIPPED = 1 << 5
    GAIN_REFUSED = 1 << 6
    GAIN_FROZEN = 1 << 7
    PULSE_UNREACHABLE = 1 << 8


class FesCommand(NamedTuple):
    """Command of a tick; pairs are flexor and extensor: stimulation (0 to 1), the pulses that
    recruit it (mA, µs), the torque asked of the model (N m), the estimated gain, flags."""

    activations: tuple[float, float]
    amplitudes_ma: tuple[float, float]
    widths_us: tuple[float, float]
    torque_nm: float
    gain: float
    muscles: tuple[Status, Status]
    status: ControlStatus


class GainEstimate(NamedTuple):
    """On-line estimate of the muscles' gain: time constant (s, 0.1 to 1000), least and greatest
    gain, and the torque (N m) below which nothing is learnt."""

    time_s: float
    least: float
    most: float
    excitation_nm: float


class FatigueParams(NamedTuple):
    """Fatigue that a controller makes up for; as of `Fatigue`."""

    fatigue_time_s: float
    recovery_time_s: float
    least_fitness: float
    frequency_dependence: float


class ProsthesisStatus(IntFlag):
    """What a tick of a prosthesis had to saturate."""

    EMG_INVALID = 1 << 0
    ANGLE_CLIPPED = 1 << 1
    ANGLE_NOT_FINITE = 1 << 2
    TORQUE_LIMITED = 1 << 3
    TORQUE_RATE_LIMITED = 1 << 4
    STIFFNESS_LIMITED = 1 << 5
    STIFFNESS_RATE_LIMITED = 1 << 6
    MUSCLE = 1 << 7


class ProsthesisCommand(NamedTuple):
    """Command of a tick: torque (N m, flexion is positive), stiffness (N m/rad), activations of
    flexor and extensor (0 to 1), flags."""

    torque_nm: float
    stiffness_nm_per_rad: float
    activations: tuple[float, float]
    muscles: tuple[Status, Status]
    status: ProsthesisStatus


class Envelope(NamedTuple):
    """Envelope of an EMG: mean rectified EMG at rest and at maximal voluntary contraction (mV),
    cutoff (Hz, 0.5 to 20), electromechanical delay (s, at most 100 time steps), shape (-3 to 0)."""

    rest_mv: float
    maximal_mv: float
    cutoff_frequency_hz: float
    delay_s: float
    shape: float
