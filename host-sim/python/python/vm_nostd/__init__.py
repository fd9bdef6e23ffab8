"""Virtual Muscle 4.0: a model of human muscle, with the bits of the firmware's.

Names have units. `activation` is U of the paper: what OpenSim and MuJoCo call excitation or
control. L_ce0 is the optimal fascicle length, F0 the maximal isometric force.
"""

from ._errors import ParameterError
from ._fit import fit
from ._native import (
    Curves,
    Fatigue,
    FesController,
    Fit,
    Joint,
    JointPath,
    Muscle,
    Prosthesis,
    RecruitmentCurve,
    State,
    Steady,
    muscle_names,
)
from ._results import (
    ControlStatus,
    Envelope,
    Estimate,
    FatigueParams,
    FesCommand,
    GainEstimate,
    JointStatus,
    Output,
    Posture,
    ProsthesisCommand,
    ProsthesisStatus,
    PulseStatus,
    Status,
    Trace,
    TrialFit,
)

__all__ = [
    "ControlStatus",
    "Curves",
    "Envelope",
    "Estimate",
    "Fatigue",
    "FatigueParams",
    "FesCommand",
    "FesController",
    "Fit",
    "GainEstimate",
    "Joint",
    "JointPath",
    "JointStatus",
    "Muscle",
    "Output",
    "ParameterError",
    "Posture",
    "Prosthesis",
    "ProsthesisCommand",
    "ProsthesisStatus",
    "PulseStatus",
    "RecruitmentCurve",
    "State",
    "Status",
    "Steady",
    "Trace",
    "TrialFit",
    "fit",
    "muscle_names",
]
