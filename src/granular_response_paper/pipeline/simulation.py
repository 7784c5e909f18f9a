"""From parameters to datasets."""

from __future__ import annotations

import shutil
from copy import deepcopy
from functools import lru_cache
from pathlib import Path
from typing import Any

from granular_response.inputs import read_text, unreadable
from granular_response.scene import SceneError, text
from granular_response.scene.base import Description
from granular_response.store import files as store
from granular_response.sweeps.errors import SweepError
from granular_response.sweeps.resources import Progress, using
from granular_response_paper import PACKAGE, TOO_LITTLE
from granular_response_paper.parameters import Common
from granular_response_paper.pipeline import data_path
from granular_response_paper.registry import GroupError, collection_of, group_member

PARAMETERS = Path("params.yaml")

#: Beside the datasets: rest states that later groups need again.
REST_STATES = ".rest_states"


def parameters(group: str, path: Path = PARAMETERS) -> tuple[dict[str, Any], Description]:
    """The section of a group in a parameter file with what it takes of the section ``common``: as written, validated.

    Its own section has precedence.

    Raises GroupError if there is no such group, or the file or a section is missing; SceneError if the file is not
    YAML, or a parameter is missing, unknown or not what it must be: one line with its key.
    """
    kind: type[Description] = group_member(group, "parameters", "Parameters")
    try:
        sections = deepcopy(_read(read_text(path)))
        of = collection_of(group)
        hint = f"; {group} is a figure group of {of.title}, run it in the folder {of.folder}"
        common, own = _section(sections, "common", path), _section(sections, group, path, hint)
        _describe(Common, common, "common")
        taken = {key: value for key, value in common.items() if key in kind.model_fields}
        return taken | own, _describe(kind, taken | own, group)
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from None
    except UnicodeDecodeError as error:
        raise GroupError(f"{path}: {unreadable(error)}") from None
    except OSError as error:
        raise GroupError(f"{path}: cannot be read: {error.strerror}") from None


@lru_cache(maxsize=4)  # the report and tests ask for one group after another
def _read(content: str) -> Any:
    return text.read(content)


def _section(sections: Any, name: str, path: Path, hint: str = "") -> dict[str, Any]:
    section = sections.get(name) if isinstance(sections, dict) else None
    if not isinstance(section, dict):
        raise GroupError(f"{path}: section {name} is missing, must be a mapping ({{}} for no parameters){hint}")
    return section


def _describe(kind: type[Description], section: dict[str, Any], name: str) -> Description:
    try:
        return kind(**{str(key): value for key, value in section.items()})
    except SceneError as error:
        raise SceneError(f"{name}.{error}") from None


def simulate(
    group: str,
    output: Path | None = None,
    *,
    parameter_file: Path = PARAMETERS,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Path:
    """Run the simulations of a group and store its datasets; returns the path of the file.

    Finished tasks of its sweeps are kept beside the output until it is whole, so a run that was interrupted
    continues; rest states are kept there for other groups.

    Raises what ``parameters`` raises, and GroupError where its parameters leave nothing to be measured or were edited
    meanwhile.
    """
    function = group_member(group, "simulate", "simulate")
    given, described = parameters(group, parameter_file)
    output = output or data_path(group)
    store.check_writable(output, [parameter_file])
    kept = _checkpoint(output)
    folders = {"checkpoint": kept, "rest_states": output.parent.absolute() / REST_STATES}
    packages = dict.fromkeys((PACKAGE, collection_of(group).package.partition(".")[0]))
    with using(workers=workers, progress=progress, packages=(*packages,), **folders):
        try:
            datasets = function(described)
        except SceneError as error:
            raise SceneError(f"{parameter_file}: section {group}: {error}") from error
        except (*TOO_LITTLE, SweepError) as error:
            if isinstance(error, SweepError) and not isinstance(error.__cause__, TOO_LITTLE):
                raise SweepError(f"{parameter_file}: section {group}: {error}") from error.__cause__
            problem = " ".join(str(error).split())
            raise GroupError(f"{parameter_file}: section {group} cannot be measured: {problem}") from error
        if parameters(group, parameter_file)[0] != given:  # DVC would record the new ones
            raise GroupError(f"{parameter_file}: section {group} changed while it ran; run the stage again")
        store.write(output, datasets, {"group": group, "parameters": text.write(given)}, keep=True)
        shutil.rmtree(kept, ignore_errors=True)
    return output


def finished(group: str, output: Path | None = None) -> int:
    """How many tasks a run that ended early has left finished, which the next one takes over if nothing has changed."""
    return sum(path.is_file() for path in _checkpoint(output or data_path(group)).rglob("*.kept"))


def _checkpoint(output: Path) -> Path:
    return output.parent / f".{output.stem}.checkpoint"
