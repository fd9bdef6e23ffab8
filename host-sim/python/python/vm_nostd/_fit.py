"""`fit`, with arrays in place of files."""

import os
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from ._errors import ParameterError
from ._native import Fit, Muscle, fit_list, numbers


def fit(
    muscle: Muscle,
    trials: dict[str, Any] | str | os.PathLike[str],
    *,
    folder: str | os.PathLike[str] | None = None,
    starts: int = 8,
    seed: int = 1,
) -> Fit:
    """Fits numbers of a muscle file to recordings of force, as `vm fit` does.

    trials: the path of a list of recordings (host-sim/docs/trials.md), or its keys as a dict. In a
    dict a signal may be {"time_s": array, "value": array} with the keys "scale" and "offset". Files
    are looked for in `folder`, by default that of the list. The same seed gives the same fit.
    """
    if not isinstance(trials, dict):
        path = Path(trials)
        return fit_list(muscle, path, folder or path.parent, starts, seed)
    with TemporaryDirectory() as written:
        listed = {
            key: [_in_files(trial, index, Path(written)) for index, trial in enumerate(value)]
            if key == "trial" and isinstance(value, list | tuple)
            else value
            for key, value in trials.items()
        }
        return fit_list(muscle, listed, folder or ".", starts, seed)


def _in_files(trial: Any, index: int, folder: Path) -> Any:
    """A trial whose arrays are in files."""
    if not isinstance(trial, dict):
        return trial

    def signal(key: str, value: Any) -> Any:
        if not (isinstance(value, dict) and "time_s" in value):
            return value
        field = f"trial[{index}].{key}"
        if "value" not in value:
            raise ParameterError(field, "time_s alone", "must have time_s and value")
        columns = [numbers(f"{field}.{name}", value[name]) for name in ("time_s", "value")]
        lengths = [len(column) for column in columns]
        if lengths[0] != lengths[1]:
            raise ParameterError(field, f"{lengths}", "time_s and value must be equally long")
        file = folder.resolve() / f"{index}_{key}.csv"
        np.savetxt(file, np.column_stack(columns), "%.17g", ",")
        kept = {name: value[name] for name in value if name not in ("time_s", "value")}
        return {"file": str(file), "time": 1, "value": 2, **kept}

    return {key: signal(key, value) for key, value in trial.items()}
