"""A scene: all that is simulated, as one validated value, from and to YAML."""

from __future__ import annotations

import html
import re
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, ClassVar, get_args

import numpy as np
from numpy.typing import ArrayLike
from pydantic import BeforeValidator, Field, ValidationError, model_validator

from ..errors import require
from ..inputs import read_text, unreadable
from . import text as yaml_text
from .arrays import ArrayPacking, listed, shortened
from .base import MOST_STIFFNESS, PLACES, Description, PackingDescription, packing_kinds, refused
from .errors import SceneError, SceneFileError, must, show, show_key, suggestion
from .lattice import LatticePacking, PilePacking, SlabPacking
from .load import TOP_CENTRE, Load, TopSelector, check_disk
from .material import Contact, Wall
from .names import MOTION
from .poured import PouredPacking
from .protocol import COLUMN, Motion, Preparation, Protocol, Taps
from .table import FilePacking

#: The rule for what only friction can do.
_SMOOTH = "must be 0 without friction and tangential springs (contact and wall: friction, stiffness_ratio)"


#: All packings, by their key ``kind``.
AnyPacking = SlabPacking | PilePacking | PouredPacking | FilePacking | ArrayPacking


def _check_kind(value: Any) -> Any:
    """Say what is wrong with the kind before pydantic's tagged union looks at it."""
    if isinstance(value, PackingDescription):
        return value
    kinds = packing_kinds()
    choices = " or ".join(kinds)
    must(isinstance(value, Mapping), f"must be a mapping with the key kind ({choices})")
    must("kind" in value, f"key kind is missing, must be {choices}")
    kind = value["kind"]
    must(kind in kinds, f"must be {choices}{suggestion(kind, kinds)}", key=("kind",), value=kind)
    return dict(value)


def _check_list(value: Any) -> Any:
    must(isinstance(value, (list, tuple)), "must be a list of loads, [] for gravity alone")
    return tuple(value)


class Scene(Description):
    """What is simulated. ``Scene()`` is the paper's: 15 rows of 61 and 60 disks, friction 0.2, F = 15.

    Every way to make a scene, the constructor included, raises SceneError with a message of one line that
    names the key, the value and what is allowed.

    Examples
    --------
    >>> scene = gr.Scene(packing=gr.Slab(layers=10), contact=gr.Contact(friction=0.5))
    >>> scene.updated({"loads.0.force": [0.0, -4.0]}).loads[0].force
    (0.0, -4.0)
    """

    sparse: ClassVar[tuple[str, ...]] = ("motion",)

    packing: Annotated[Annotated[AnyPacking, Field(discriminator="kind")], BeforeValidator(_check_kind)] = Field(
        default_factory=SlabPacking, description="The disks before gravity acts, and the box."
    )
    contact: Contact = Field(default_factory=Contact, description="Contact law between disks.")
    wall: Wall = Field(default_factory=Wall, description="Contact law at the floor and the side walls.")
    loads: Annotated[tuple[Load, ...], BeforeValidator(_check_list)] = Field(
        default_factory=lambda: (Load(disk=TOP_CENTRE, force=(0.0, -15.0)),),
        description="Forces, torques or prescribed displacements of disks, besides gravity; [] for none.",
    )
    preparation: Preparation = Field(default_factory=Preparation, description="How gravity is applied.")
    protocol: Protocol = Field(default_factory=Protocol, description="How equilibrium is reached.")
    motion: Motion = Field(default_factory=Motion, description="How disks move at the start of ``gr.motion``.")

    @model_validator(mode="after")
    def _check_contacts(self) -> Scene:
        own, key = self.contact.normal_stiffness, ("contact", "normal_stiffness")
        rule = "must be at most 5e11 where wall.normal_stiffness, twice as much, is left open"
        must(self.wall.normal_stiffness is not None or own <= 0.5 * MOST_STIFFNESS, rule, key=key, value=own)
        for name, contact in (("contact", self.contact), ("wall", self.resolved_wall)):
            rule = f"must be 0 unless {name}.friction, stiffness_ratio and rolling_stiffness_ratio are greater than 0"
            springs = contact.rubs and contact.rolling_stiffness_ratio > 0
            must(springs or not contact.rolls, rule, key=(name, "rolling_friction"), value=contact.rolling_friction)
        return self

    @model_validator(mode="after")
    def _check_loads(self) -> Scene:
        rough_floor = self.resolved_wall.rubs
        for place, load in enumerate(self.loads):
            rule, turns = f"{_SMOOTH}, which alone can balance it", self.contact.rubs or rough_floor
            must(load.torque == 0 or turns, rule, key=("loads", place, "torque"), value=load.torque)
        sideways = sum(load.force[0] for load in self.loads)
        held = any(load.displacement and load.displacement[0] is not None for load in self.loads)
        rounding = 1e-12 * sum(abs(load.force[0]) for load in self.loads)
        rule = "is the sum of the forces along x, must be 0 with periodic sides on a smooth floor, which hold nothing"
        free = self.packing.periodic and not rough_floor and not held
        must(not free or abs(sideways) <= rounding, rule, key=("loads",), value=sideways)
        if total := self.packing.disk_count:  # 0: only the file knows
            count = self.packing.row_count() if isinstance(self.packing, LatticePacking) else np.zeros(0, np.int64)
            for place, load in enumerate(self.loads):
                if load.disk != TOP_CENTRE and not isinstance(load.disk, TopSelector):  # chosen by positions
                    check_disk(load.disk, total, count, ("loads", place, "disk"))
        return self

    @model_validator(mode="after")
    def _check_start(self) -> Scene:
        given, gravity = getattr(self.packing, "springs", None), self.preparation.gravity
        rule = "must be at-once with packing.springs, which bear the weights"
        must(given is None or gravity == "at-once", rule, key=("preparation", "gravity"), value=gravity)
        motion, total = self.motion, self.packing.disk_count
        still = not np.any(np.asarray(motion.spin) != 0.0) or self.contact.rubs or self.resolved_wall.rubs
        must(still, f"{_SMOOTH}, which alone turn disks", key=("motion", "spin"), value=motion.spin)
        for name in MOTION:
            given = getattr(motion, name)
            rule = "must be numbers, the packing is not from a file"
            must(given != COLUMN or isinstance(self.packing, FilePacking), rule, key=("motion", name), value=given)
            if isinstance(given, tuple) and total:
                rule = f"must have one number for each of the {total} disks, has {len(given)}"
                must(len(given) == total, rule, key=("motion", name), value=list(given))
        return self

    def __repr__(self) -> str:
        """The packing, friction and loads, and what else differs from the paper's scene."""
        named, whole = self.model_dump(mode="json", exclude_defaults=True), self.to_dict()
        main = {key: whole["packing"][key] for key in ("kind", "layers", "disks_per_row") if key in whole["packing"]}
        loads = [load.model_dump(mode="json", exclude_defaults=True) for load in self.loads]
        named["packing"] = {**main, **named.get("packing", {})}
        named["contact"] = {"friction": self.contact.friction, **named.get("contact", {})}
        return f"Scene.from_dict({shortened({**named, 'loads': loads})})"

    def _repr_html_(self) -> str:
        """All keys, folded up, for a notebook."""
        keys = html.escape(yaml_text.write(shortened(self.to_dict())))
        return f"<details><summary><code>{html.escape(repr(self))}</code></summary><pre>{keys}</pre></details>"

    @property
    def resolved_wall(self) -> Contact:
        """Contact law at the floor and the side walls, with what the scene leaves open filled in."""
        return self.wall.resolved(self.contact)

    @property
    def folder(self) -> str | None:
        """Folder at which the path of a packing from a file starts; None for the current one."""
        return self.packing.folder if isinstance(self.packing, FilePacking) else None

    @property
    def files(self) -> list[Path]:
        """Files that the scene is read from, besides its own."""
        return self.packing.files if isinstance(self.packing, FilePacking) else []

    @property
    def small_disks_gather(self) -> bool:
        """Whether the smallest disks of the packing may touch each other: poured ones, and those of own packings."""
        return not isinstance(self.packing, LatticePacking)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any], *, folder: str | PathLike[str] | None = None) -> Scene:
        """A scene from nested mappings; what is left out has its default.

        Examples
        --------
        >>> gr.Scene.from_dict({"packing": {"kind": "pile", "layers": 5}, "loads": []}).packing.disk_count
        35
        """
        try:
            return cls.model_validate(data, context={"folder": folder})
        except ValidationError as error:
            raise refused(error) from None

    @classmethod
    def from_arrays(  # noqa: PLR0913, one keyword for each column
        cls,
        x: ArrayLike,
        z: ArrayLike,
        radius: ArrayLike,
        *,
        mass: ArrayLike | None = None,
        width: float | None = None,
        origin: tuple[float, float] = (0.0, 0.0),
        sides: str = "walls",
        overlaps: str = "kept",
        vx: ArrayLike | None = None,
        vz: ArrayLike | None = None,
        spin: ArrayLike | None = None,
        scene: Scene | Mapping[str, Any] | None = None,
    ) -> Scene:
        """A scene with a packing of one's own. The disks need not be in equilibrium: they fall first.

        The scene holds the numbers themselves, so it is stored and read again without a further file.

        Parameters
        ----------
        x, z : (n,) centres, z upwards, in any unit of length.
        radius : (n,) radii in the same unit, or one for all disks.
        mass : (n,) masses in any unit, or one for all; in proportion to the square of the radius if left out.
        width : distance of the side walls, or the period of periodic sides, where it must be given; if left out, the
            right wall touches the disk that reaches farthest.
        origin : x of the left wall and z of the floor.
        sides : "walls" or "periodic".
        overlaps : "kept", or "removed" for measured disks: those that overlap are pushed apart before gravity acts.
        vx, vz, spin : (n,) motion at the start, or one for all, for :func:`granular_response.motion`; in reduced units.
        scene : all else, as a scene, whose packing is left out, or nested mappings with its other keys; that of
            ``Scene()`` if left out.

        Raises SceneError where a number is not allowed, as ``packing.x[3] = -1.0``, or the columns differ in length.

        Examples
        --------
        >>> scene = gr.Scene.from_arrays(x=[1, 3, 5, 2, 4], z=[1, 1, 1, 2.74, 2.74], radius=1.0)
        >>> scene.packing.build()
        Packing(5 disks, radii from 1 to 1, box 6 wide)
        """
        columns = {"x": listed(x), "z": listed(z)}
        count = len(columns["x"]) if isinstance(columns["x"], list) else None
        columns |= {"radius": listed(radius, count), "mass": None if mass is None else listed(mass, count)}
        if not isinstance(scene, (Scene, Mapping, type(None))):
            raise SceneError(f"scene = {show(scene)}: must be a scene, or a mapping with its keys")
        if isinstance(scene, Mapping) and "packing" in scene:
            raise SceneError("scene.packing: must be left out, the packing is that of the arrays")
        rest = scene.to_dict() if isinstance(scene, Scene) else scene or {}
        packing = {"kind": "arrays", **columns, "width": width, "origin": origin, "sides": sides, "overlaps": overlaps}
        motion = {name: listed(one) for name, one in (("vx", vx), ("vz", vz), ("spin", spin)) if one is not None}
        own = {"motion": {**rest.get("motion", {}), **motion}} if motion else {}
        return cls.from_dict({**rest, **own, "packing": packing})

    @classmethod
    def from_text(cls, text: str, *, folder: str | PathLike[str] | None = None) -> Scene:
        """A scene from YAML text.

        Examples
        --------
        >>> gr.Scene.from_text("contact: {friction: 0.5}").contact.friction
        0.5
        """
        data = yaml_text.read(text)
        require(data is not None, "the scene is empty, must be a mapping ({} is the paper's scene)", SceneError)
        return cls.from_dict(data, folder=folder)

    @classmethod
    def from_yaml(cls, path: str | PathLike[str]) -> Scene:
        """A scene from a YAML file; the messages of errors begin with its name.

        Raises SceneFileError if the file cannot be read, SceneError for what it holds.

        Examples
        --------
        >>> scene = gr.Scene.from_yaml("examples/slab.yaml")
        """
        path = Path(path)
        try:
            return cls.from_text(read_text(path), folder=path.parent.absolute())
        except SceneError as error:
            raise SceneError(f"{path}: {error}") from None
        except (OSError, UnicodeDecodeError) as error:
            raise SceneFileError(f"{path}: {unreadable(error)}") from None
        except ValueError as error:  # no name of a file
            raise SceneFileError(f"{str(path)!r}: {unreadable(error)}") from None

    def to_dict(self) -> dict[str, Any]:
        """All keys as nested dicts, lists, numbers and text.

        Examples
        --------
        >>> gr.Scene().to_dict()["contact"]["stiffness_ratio"]
        0.8
        """
        return self.model_dump(mode="json")

    def to_yaml(self) -> str:
        """All keys in a fixed order; ``from_text`` makes an equal scene of it.

        The path of a packing from a file is kept as it was given, so such a scene is read in ``folder``.

        Examples
        --------
        >>> gr.Scene.from_text(gr.Scene().to_yaml()) == gr.Scene()
        True
        """
        return yaml_text.write(self.to_dict())

    def updated(self, changes: Mapping[str, Any]) -> Scene:
        """A copy with some values replaced: ``updated({"contact.friction": 1.0, "loads.0.force": [0, -4]})``.

        A key is the path of a value or of a section; paths into loads have the number of the load (``loads.0`` or
        ``loads[0]``). A section given as a mapping, dotted or nested, keeps every value that is not named, with one
        exception: a packing of another ``kind`` takes the place of the packing, with its own defaults. A description
        (``Wall(friction=0.5)``) and a list are whole and replace what is there. The order of the keys means nothing.

        Raises SceneError if a value is named twice, in different spellings, or is not allowed: the copy is validated.

        Examples
        --------
        >>> gr.Scene().updated({"packing.layers": 8, "wall": gr.Wall(friction=0.5)}).packing.layers
        8
        """
        rule = f"changes = {show(changes)}: must be a mapping from keys to values"
        require(isinstance(changes, Mapping), rule, SceneError)
        folders = [value.folder for value in changes.values() if isinstance(value, FilePacking)]
        return type(self).from_dict(self.merged(changes), folder=(folders or [self.folder])[0])

    def merged(self, changes: Mapping[str, Any]) -> dict[str, Any]:
        """The data of ``updated`` as nested mappings, not validated yet.

        Examples
        --------
        >>> gr.Scene().merged({"contact.friction": 0.5})["contact"]["friction"]
        0.5
        """
        named: dict[str, Any] = {}
        # Descriptions first, so that paths lead into them.
        for key, value in sorted(changes.items(), key=lambda item: not isinstance(item[1], Description)):
            parts = [part for part in re.split(r"[.\[\]]+", key) if part] if isinstance(key, str) else []
            require(parts, f"{show(key)}: must be the path of a key, such as contact.friction", SceneError)
            nested = _as_data(value)
            for part in reversed(parts):
                nested = {str(int(part)) if part.isdecimal() else part: nested}
            _name(named, nested, key)
        return _merged(self.to_dict(), named, ())


PLACES |= {
    "packing": get_args(AnyPacking),
    "contact": (Contact,),
    "wall": (Wall,),
    "loads.0": (Load,),
    "preparation": (Preparation,),
    "preparation.taps": (Taps,),
    "protocol": (Protocol,),
    "motion": (Motion,),
}


class _Whole(dict[str, Any]):
    """The data of a description, and which of its keys its maker named."""

    named: frozenset[str] = frozenset()


def _as_data(value: Any) -> Any:
    """Changes as plain data; a description stays whole."""
    if isinstance(value, Description):
        whole = _Whole(value.model_dump(mode="json"))
        whole.named = frozenset(value.model_fields_set)
        return whole
    if isinstance(value, Mapping):
        return {str(key): _as_data(part) for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_as_data(part) for part in value]
    return value


def _name(named: dict[str, Any], more: dict[str, Any], key: str) -> None:
    """Add ``more`` values to those ``named`` already; ``key`` is what the caller called them."""
    for name, value in more.items():
        if name not in named or (isinstance(named, _Whole) and name not in named.named):
            named[name] = value
        elif isinstance(named[name], dict) and isinstance(value, dict):
            _name(named[name], value, key)
        else:
            raise SceneError(f"{key}: {show(name)} is named twice, in different spellings; must be named once")


def _merged(old: Any, change: Any, path: tuple[str, ...]) -> Any:
    """``old`` with the values that ``change`` names."""
    if isinstance(change, _Whole) or not isinstance(change, dict):
        return change
    if isinstance(old, list):
        new = list(old)
        for part, value in change.items():
            if not str(part).isdecimal() or int(part) >= len(old):
                key = show_key(path)
                meant = f", did you mean {key}.0.{part}?" if old and part in Load.model_fields else ""
                raise SceneError(f"{show_key((*path, part))}: {key} has {len(old)} items, no item {show(part)}{meant}")
            new[int(part)] = _merged(old[int(part)], value, (*path, part))
        return new
    if not isinstance(old, dict) or ("kind" in change and change["kind"] != old.get("kind")):
        return change
    merged = {
        key: _merged(old[key], value, (*path, str(key))) if key in old else value for key, value in change.items()
    }
    return {**old, **merged}
