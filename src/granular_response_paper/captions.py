"""Captions of the pictures, complete as the paper's are, made from the parameters that their dataset was made with.

A group's ``draw.py`` has ``captions(datasets, parameters) -> dict[str, Caption]``: one for each picture by file stem,
from the datasets that it is drawn from and the validated parameters that their file stores. Their texts stand beside it
as templates, in ``captions.yaml``, which :func:`of_group` fills in. Templates say what is drawn and are true of any
data. What the data show is a sentence that ``draw.py`` makes of them, a finding; the caption begins with it. The draw
stage writes the captions as ``captions.json`` beside the pictures (:func:`document`); the page reads that file.

Texts are plain, as ``report.typeset`` sets them: ``F_ext``, ``k_T/k_N``, ``1e-13``, ``sqrt(R/g)``. They cite the panels
by the letters that :func:`letters` gives: those of a figure of several pictures run on.
"""

from __future__ import annotations

import math
import re
import string
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Any

from granular_response.scene import text as yaml

from .registry import group_path

if TYPE_CHECKING:
    import xarray as xr

    from granular_response.scene import Scene

#: Of a figure group, by name.
Datasets = Mapping[str, "xr.Dataset"]

#: Name of the file beside the pictures, and of the templates beside their ``draw.py``.
FILE, TEMPLATES = "captions.json", "captions.yaml"

#: Units of force and length in a text: mean disk weights, mean radii.
WEIGHT, RADIUS = "m\u0304g", "R\u0304"

#: First panel of a picture that goes on with a figure begun by another one; all others begin at (a).
FIRST_LETTERS: Mapping[str, str] = {
    "fig01b_slab_comparison": "c",
    "fig05b_stiffness": "e",
    "fig05c_depth": "h",
    "fig16s_symmetry_breaking": "c",
    "fig24b_superposition_error": "e",
}

Value = float | int | str | Sequence[float] | Sequence[str]

#: What a caption says of each parameter, in this order; {} is the value or the list of them.
SAID: Mapping[str, str] = {
    "force": f"F_ext = {{}} {WEIGHT}",
    "angle": "at {}° to the horizontal",
    "torque": f"torque {{}} {WEIGHT}{RADIUS} clockwise",
    "distance": f"d = {{}} {RADIUS}",
    "friction": "µ = {}",
    "wall_friction": "µ_wall = {}",
    "stiffness_ratio": "k_T/k_N = {}",
    "normal_stiffness": f"k_N = {{}} {WEIGHT}/{RADIUS}",
    "polydispersity": "δ = {}",
    "realizations": "{} realizations",
    "width": f"w = {{}} {RADIUS}",
    "packing": "{}",
}


@dataclass(frozen=True)
class Caption:
    """What stands below a picture, and what stands for it where it cannot be seen.

    ``title`` names the picture for people. ``parameters`` are keys of :data:`SAID` with a value or several; they end
    the caption as a sentence.
    """

    text: str
    alternative: str
    parameters: Mapping[str, Value] = field(default_factory=dict)
    title: str = ""

    @property
    def whole(self) -> str:
        """The text with the parameters."""
        given = dict(self.parameters)
        if "friction" in given and given["friction"] == given.get("wall_friction"):
            given["friction"] = f"µ_wall = {values(given.pop('wall_friction'))}"
        said = [SAID[key].format(values(given[key])) for key in sorted(given, key=list(SAID).index)]
        return f"{self.text} {', '.join(said)}." if said else self.text


class _Fields(string.Formatter):
    """Those of ``str.format``; ``{name!v}`` for one value or several in words."""

    def convert_field(self, value: Any, conversion: str | None) -> Any:
        return values(value) if conversion == "v" else super().convert_field(value, conversion)


@cache
def _templates(group: str) -> dict[str, Any]:
    return dict(yaml.read((group_path(group) / TEMPLATES).read_text("utf-8")))


def of_group(
    group: str, parameters: Mapping[str, Mapping[str, Value]], findings: Mapping[str, str] | None = None, **fields: Any
) -> dict[str, Caption]:
    """The captions of those pictures of a group that have ``parameters``, by file stem, from the group's templates.

    ``findings`` are sentences on what the data of a picture show: they begin its caption and end its alternative text.
    Fields of a template are ``fields``, and the parameters of its picture. Raises KeyError for a picture without a
    template, or a field that is not given.
    """
    told: dict[str, Caption] = {}
    for stem, of in parameters.items():
        template, finding = _templates(group)[stem], (findings or {}).get(stem, "")
        text, alternative = (
            _Fields().vformat(template[name], (), {**of, **fields}) for name in ("text", "alternative")
        )
        title = str(template.get("title", ""))
        told[stem] = Caption(f"{finding} {text}".strip(), f"{alternative} {finding}".strip(), of, title)
    return told


def question(group: str) -> str:
    """The question that the figures of a group answer, as its ``captions.yaml`` says. Raises KeyError without one."""
    return str(_templates(group)["question"])


def of_scene(scene: Scene, *, frictions: Value | None = None, **others: Value | None) -> dict[str, Value]:
    """The parameters that every caption has, of a group's base scene; ``others`` replace or add, None leaves out.

    ``frictions`` are those of disks and walls alike. Without friction there is no k_T/k_N.
    """
    alike = {} if frictions is None else {"friction": frictions, "wall_friction": frictions}
    packing = scene.packing.model_dump()
    found: dict[str, Value | None] = {
        "friction": scene.contact.friction,
        "wall_friction": scene.wall.friction,
        "stiffness_ratio": scene.contact.stiffness_ratio,
        "normal_stiffness": scene.contact.normal_stiffness,
        "polydispersity": packing["polydispersity"],
        "packing": rows(scene.packing.build().row_count.tolist(), kind=packing["kind"]),
        **alike,
        **others,
    }
    if found["friction"] == 0.0 and "stiffness_ratio" not in others:
        del found["stiffness_ratio"]
    return {key: value for key, value in found.items() if value is not None}


def rows(counts: Sequence[int], *, kind: str = "slab") -> str:
    """A lattice in words, of the number of disks in each row from the bottom."""
    layers, disks = len(counts), [*dict.fromkeys(counts)]
    if kind == "pile":
        return f"pile of {layers} layers, {disks[0]} disks in the lowest"
    each = f"{disks[0]}" if len(disks) == 1 else f"alternately {values(disks)}"
    return f"{layers} layers of {each} disks"


def values(given: Value) -> str:
    """One value or several in words: ``4, 10 and 20``; of many the number and the ends, ``none`` of none."""
    if isinstance(given, str):
        return given
    many: list[float | str] = [given] if isinstance(given, float | int) else list(given)
    if not many:
        return "none"
    texts = [value if isinstance(value, str) else _number(value) for value in many]
    if len(texts) > 8:
        return f"{texts[0]} to {texts[-1]} ({len(texts)} values)"
    return " and ".join([", ".join(texts[:-1]), texts[-1]]) if len(texts) > 1 else texts[0]


def _number(value: float) -> str:
    exponent = round(math.log10(value)) if value >= 1e5 else 0
    return f"1e{exponent}" if exponent and value == 10.0**exponent else f"{value:g}"


def letters(stem: str) -> Iterator[str]:
    """The letters of the panels of a picture, in reading order."""
    first = FIRST_LETTERS.get(stem, "a")
    return (chr(code) for code in range(ord(first), ord("z") + 1))


def bracket(low: float, high: float, unit: str = WEIGHT) -> str:
    """A bracket in words: one value where both ends agree to three digits."""
    ends = f"{low:.3g}", f"{high:.3g}"
    return f"{ends[0]} {unit}" if ends[0] == ends[1] else f"{ends[0]} to {ends[1]} {unit}"


def peaks(number: int) -> str:
    """How many peaks a response has, as in pictures of packings."""
    return f"{number} peak{'s' if number != 1 else ''}"


def number(stem: str) -> int | None:
    """The paper's figure that a picture belongs to: NN of ``figNN...``."""
    match = re.match(r"fig(\d+)", stem)
    return int(match[1]) if match else None


def document(
    captions: Mapping[str, Caption], panels: Mapping[str, Sequence[str]], question: str = ""
) -> dict[str, dict[str, Any]]:
    """What ``captions.json`` holds: by file stem the paper's figure, a title, the question that it answers, the letters
    drawn, the texts, the parameters.

    ``panels`` are the letters of each picture. Raises KeyError for a picture without a caption.
    """
    return {
        stem: {
            "figure": number(stem),
            "title": captions[stem].title,
            "question": question,
            "panels": list(panels[stem]),
            "caption": captions[stem].whole,
            "alternative": captions[stem].alternative,
            "parameters": {key: _plain(value) for key, value in captions[stem].parameters.items()},
        }
        for stem in sorted(panels)
    }


def _plain(value: Value) -> Any:
    return value if isinstance(value, str | float | int) else [float(one) for one in value]
