"""Figure groups at reduced size: the parameters of their notebooks."""

from pathlib import Path
from typing import Any

from granular_response.paper.pipeline import simulation

PATH = Path(__file__).parents[2] / "notebooks" / "reduced.yaml"


def parameters(group: str) -> dict[str, Any]:
    """The section of a group with what it takes of the section ``common``, as keyword arguments of its Parameters."""
    return simulation.parameters(group, PATH)[0]
