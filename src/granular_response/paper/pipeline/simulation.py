"""From parameters to datasets."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

from granular_response.paper.pipeline import GroupError, data_path, group_function
from granular_response.scene import SceneError, text
from granular_response.store import files as store
from granular_response.sweeps.resources import using
from granular_response.sweeps.tasks import Progress

PARAMETERS = Path("params.yaml")

#: Beside the datasets: rest states that later groups need again.
REST_STATES = ".rest_states"


def parameters(group: str, path: Path = PARAMETERS) -> dict[str, Any]:
    """The section ``common`` of a parameter file together with the group's own, which has precedence.

    Raises
    ------
    GroupError
        If the file or a section is missing.
    granular_response.scene.SceneError
        If the file is not YAML.
    """
    try:
        sections = text.read(path.read_text(encoding="utf-8"))
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from None
    except UnicodeDecodeError:
        raise GroupError(f"{path}: is not a text file in UTF-8") from None
    except OSError as error:
        raise GroupError(f"{path}: cannot be read: {error.strerror}") from None
    merged: dict[str, Any] = {}
    for name in ("common", group):
        section = sections.get(name) if isinstance(sections, dict) else None
        if not isinstance(section, dict):
            raise GroupError(f"{path}: section {name} is missing, must be a mapping ({{}} for no parameters)")
        merged |= section
    return merged


def simulate(
    group: str,
    output: Path | None = None,
    *,
    parameter_file: Path = PARAMETERS,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> Path:
    """Run the simulations of a group and store its datasets; returns the path of the file.

    Finished tasks of its sweeps are kept beside the output until it is whole, so a run that was interrupted
    continues; rest states are kept there for other groups.
    """
    function = group_function("simulate", group)
    given = parameters(group, parameter_file)
    output = output or data_path(group)
    store.check_writable(output, [parameter_file])
    kept = output.parent / f".{output.stem}.checkpoint"
    with using(scheduler=scheduler, checkpoint=kept, rest_states=output.parent.absolute() / REST_STATES):
        try:
            datasets = function(given, workers=workers, progress=progress)
        except _PARAMETER_ERRORS as error:
            raise GroupError(f"{parameter_file}: section {group}: {_said(error, given)}") from error
    store.write(output, datasets, {"group": group, "parameters": text.write(given)})
    shutil.rmtree(kept, ignore_errors=True)
    return output


#: What studies raise on parameters that are missing or not what they must be.
_PARAMETER_ERRORS = (KeyError, TypeError, ValueError, ZeroDivisionError)


def _said(error: Exception, given: dict[str, Any]) -> str:
    """One line; a missing key with those that are there, so that a misspelt one shows."""
    if isinstance(error, KeyError):
        return f"key {error} is missing; there are {', '.join(map(str, given))} (with those of common)"
    return " ".join(str(error).split()) or type(error).__name__
