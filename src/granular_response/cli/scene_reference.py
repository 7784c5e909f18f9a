"""The keys of a scene file, read from the descriptions themselves: key, default, what is allowed, unit, meaning.

What is allowed is not written down a second time either: it is what the message says when a key has a wrong value.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple, get_args

from .. import scene
from ..scene import text as yaml_text
from ..scene.base import Description, unit_of
from ..scene.lattice import LatticePacking
from ..scene.material import KNOWN_LAWS

#: No key accepts this.
_WRONG: Any = [[]]


class Key(NamedTuple):
    """One key of a scene file; all texts are for people."""

    path: str  #: contact.friction, loads[].force
    default: str  #: as YAML; empty where the key must be given
    allowed: str
    unit: str  #: empty without one
    meaning: str


class Section(NamedTuple):
    """The keys of one part of a scene."""

    title: str
    place: str  #: of the part in a scene
    model: type[Description]
    given: Mapping[str, Any] = MappingProxyType({})  #: keys that must be there, with values that are allowed
    left_out: frozenset[str] = frozenset()  #: keys that another section has

    def listed(self) -> Iterator[Key]:
        for name, info in self.model.model_fields.items():
            if name in self.left_out:
                continue
            if info.description is None:
                raise TypeError(f"{self.model.__name__}.{name} has no description")
            required = info.is_required() or name == "kind"
            default = "" if required else _spelled(info.get_default(call_default_factory=True))
            yield Key(f"{self.place}.{name}", default, self._allowed(name), unit_of(name, info), info.description)

    def _allowed(self, name: str) -> str:
        """What the message about a wrong value says."""
        try:
            self.model(**{**self.given, name: _WRONG})
        except scene.SceneError as error:
            rule = str(error).split(": ", 1)[1].removeprefix("must be ")
        else:
            raise TypeError(f"{self.model.__name__}.{name} takes anything")
        return f"{rule}, or null" if type(None) in get_args(self.model.model_fields[name].annotation) else rule


_BOTH = frozenset(LatticePacking.model_fields) - {"kind", "layers"}
SECTIONS = (
    Section("Slab", "packing", scene.SlabPacking, left_out=_BOTH),
    Section("Pile", "packing", scene.PilePacking, left_out=_BOTH),
    Section("Slab or pile", "packing", scene.SlabPacking, left_out=frozenset(scene.SlabPacking.model_fields) - _BOTH),
    Section("Poured disks", "packing", scene.PouredPacking),
    Section("Packing from a file", "packing", scene.FilePacking, {"path": "disks.csv", "width": 1.0}),
    Section("Packing from arrays", "packing", scene.ArrayPacking, {"x": [1.0], "z": [1.0], "radius": [1.0]}),
    Section("Contacts between disks", "contact", scene.Contact),
    Section("Floor and side walls", "wall", scene.Wall),
    Section("Loads", "loads[]", scene.Load, {"disk": "top-centre", "force": (0.0, 0.0)}),
    Section("A disk by its row", "loads[].disk", scene.RowSelector, {"row": "top"}),
    Section("A disk on top by its place", "loads[].disk", scene.TopSelector, {"x": 0.0}),
    Section("Preparation", "preparation", scene.Preparation),
    Section("Taps", "preparation.taps", scene.Taps),
    Section("Protocol", "protocol", scene.Protocol),
    Section("Motion at the start", "motion", scene.Motion),
)


def sections() -> list[Section]:
    """All sections, with those of laws that have parameters."""
    own = [
        Section(f"Parameters of the law {name}", "contact.parameters", known.parameters)
        for name, known in KNOWN_LAWS.items()
        if known.parameters.model_fields
    ]
    return [*SECTIONS, *own]


def plain(part: str = "") -> str:
    """The keys whose path begins with ``part``, for a terminal. Raises SceneError if there is none."""
    if text := "\n".join(line for section in sections() for line in _paragraphs(section, part)):
        return text
    raise scene.SceneError(f"no key of a scene begins with {part}, parts are {', '.join(scene.Scene.model_fields)}")


def _paragraphs(section: Section, part: str) -> Iterator[str]:
    chosen = [key for key in section.listed() if key.path.startswith(part)]
    if chosen:
        yield f"{section.title}:"
    for key in chosen:
        unit = f" [{key.unit}]" if key.unit else ""
        default = f"default {key.default}" if key.default else "must be given"
        yield f"  {key.path}{unit}: {default}\n    {key.allowed}\n    {key.meaning}"


def _spelled(value: Any) -> str:
    plain = value.model_dump() if isinstance(value, Description) else value
    return yaml_text.write(plain).removesuffix("...\n").strip()
