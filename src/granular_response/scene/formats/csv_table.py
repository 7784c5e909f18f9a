"""CSV with a header that names x, z and radius, and mass or density if disks differ in material.

Columns are separated by commas or, where the header has more of them, by semicolons; numbers have decimal points. Names
may be written in any case, with a unit in brackets or, as ``x_mm``, after an underscore: lengths have one unit. Cameras
and programs that track disks have other names for the same: y for the height where there is no z, r for the radius, or
a diameter; ``columns`` of a scene says which column is meant where a table has others. Further columns are ignored, and
so are empty lines and lines that begin with ``#``, but for the mark of our own tables. Each disk has a line of its own.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..errors import suggestion
from .table import NO_BOX, FormatError, Mark, Once, Table, lines_of, number, numbers, radii, shown, upward

#: What is read of a disk, and the names of columns that have it.
LENGTHS, MATERIAL = ("x", "y", "z", "radius", "diameter"), ("mass", "density")
NAMES = {name: (name,) for name in LENGTHS + MATERIAL} | {"radius": ("radius", "r"), "diameter": ("diameter", "d")}
#: What ``columns`` of a scene may name.
NAMED = ("x", "z", "radius", "diameter", *MATERIAL)
#: Units of length in metres; pixels may be of any size.
METRES = {"m": 1.0, "dm": 1e-1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}
#: Names with a unit after an underscore.
_WITH_UNIT = re.compile(
    rf"(x|y|z|radius|r|diameter|d)_({'|'.join(METRES)}|μm|px)|mass_(kg|g|mg|ug|μg)|density_(kg_m3|g_cm3)"
)
#: Components of the motion of a disk: columns that are read where they are and have no unit, and taken where the keys
#: of ``motion`` ask for them.
MOTION = ("vx", "vz", "spin")
#: Columns that look as if they were heeded, and cannot be: contacts have one law.
REFUSED = {
    **dict.fromkeys(("friction", "mu", "µ", "μ", "friction_coefficient"), "contact.friction"),
    **dict.fromkeys(("stiffness", "kn", "k_n", "young", "youngs_modulus", "young_modulus"), "contact.normal_stiffness"),
    "cohesion": "contact.law",
}
_SIZES = frozenset({"radius", "diameter"})
#: Other words for mass and density.
_OTHER_WORDS = {"m": "mass", "rmass": "mass", "weight": "mass", "rho": "density", "ρ": "density"}

#: Of what a scene names one of, the other is not looked for.
_ONE_OF = (_SIZES, frozenset(MATERIAL))


def read(path: Path, columns: Mapping[str, str] | None = None) -> Table:
    """The disks of a table; errors name the line. ``columns`` says in which column x, z, radius, ... stand."""
    rows: list[list[float]] = []
    moved: list[list[float]] = []
    places: list[str] = []
    header: list[str] = []
    chosen: dict[str, int] = {}
    motion: dict[str, int] = {}
    unit, between = "", ","
    mark: Mark | None = None
    once = Once()
    lines, whole = lines_of(path)
    for place, line in lines:
        if line.lstrip().startswith("#"):
            if found := Mark.found(line, place):
                once.add("mark of granular-response", place)
                mark = found
            continue
        if not header:
            between = ";" if line.count(";") > line.count(",") else ","
        try:  # line by line: a quote that is not closed takes no further disk with it
            cells = next(csv.reader([line], delimiter=between, skipinitialspace=True, strict=True), [])
        except csv.Error as error:
            unclosed = "a quote that is not closed in its line" if "unexpected end" in str(error) else str(error)
            raise FormatError(f"is not CSV: {unclosed}", place) from None
        if not any(cell.strip() for cell in cells):
            continue
        if not header or cells == header:
            once.add("header", place)
            header = cells
            titles = _titles(header)
            chosen = _chosen(header, titles, columns or {})
            unit = titles[chosen["x"]][1]
            for name in MOTION:
                if (times := titles.count((name, ""))) > 1:
                    raise FormatError(f"column {name} is given {times} times, must be given once", place)
            motion = {name: titles.index((name, "")) for name in MOTION if (name, "") in titles}
            continue
        if len(cells) != len(header):
            raise FormatError(f"has {len(cells)} values, must have {len(header)} as the header", place)
        rows.append(numbers([cells[column] for column in chosen.values()], tuple(chosen), place))
        moved.append([_or_nan(cells[column]) for column in motion.values()])
        places.append(place)
    if not rows:
        raise FormatError("has no disks, must have a header x,z,radius and a line for each disk")
    if mark is not None:
        mark.check(len(rows), whole)
        if "mass" not in chosen:
            raise FormatError("column mass is missing, which tables of granular-response have")
    values = dict(zip(chosen, np.array(rows).T, strict=True))
    if "density" in values and not (values["density"] > 0.0).all():
        bad = int(np.argmin(values["density"] > 0.0))
        raise FormatError(f"density = {float(values['density'][bad])!r}: must be greater than 0", places[bad])
    up = "z" if "z" in values else "y"
    if "y" in values and "z" in values:
        up = upward(values["y"], values["z"])
    radius = radii(values, places)
    mass = values["mass"] if "mass" in values else values["density"] * radius**2 if "density" in values else None
    velocities = dict(zip(motion, np.array(moved).T, strict=True))
    box = NO_BOX if mark is None else mark.box
    return Table(values["x"], values[up], radius, places, mass, box, columns=velocities or None, unit=unit)


def _or_nan(cell: str) -> float:
    try:
        return number(cell, "", "")
    except FormatError:
        return float("nan")


def _titles(header: list[str]) -> list[tuple[str, str]]:
    """The name of each column, in small letters, and its unit: ``Radius [mm]`` and ``radius_mm`` are radius and mm.

    The latter is a name of its own where another column is called radius.
    """
    found = []
    for cell in header:
        match = re.fullmatch(r"\s*([^(\[]*?)\s*(?:[(\[]([^)\]]*)[)\]])?\s*", cell)
        found.append((match[1].casefold(), match[2] or "") if match else (cell.strip(), ""))
    known = {name for name, _ in found}
    for k, (name, _) in enumerate(found):
        short, _, ending = name.partition("_")
        if _WITH_UNIT.fullmatch(name) and short not in known:
            found[k] = short, ending
    return [(name, unit.strip().replace("µ", "u").replace("μ", "u")) for name, unit in found]


def _chosen(header: list[str], titles: Sequence[tuple[str, str]], columns: Mapping[str, str]) -> dict[str, int]:
    """The column of each quantity that is read. Raises FormatError for a header that does not say what they are.

    What stands in the header is quoted only where it is one of a table of disks: the file may be another one.
    """
    names, units = zip(*titles, strict=True)
    chosen: dict[str, int] = {}
    for name, wanted in columns.items():
        exact = [k for k, cell in enumerate(header) if cell.strip() == wanted.strip()]
        folded = wanted.strip().casefold()
        places = exact or [k for k, cell in enumerate(header) if folded in (names[k], cell.strip().casefold())]
        if len(places) != 1:
            problem = "there is no such column" if not places else f"is given {len(places)} times"
            raise FormatError(f"columns.{name} = {shown(wanted)}: {problem}{_there(header, names)}")
        chosen[name] = places[0]
    taken = set(chosen.values())
    for name, words in NAMES.items():
        instead = next((group for group in _ONE_OF if name in group), frozenset())
        if name in chosen or (name == "y" and "z" in chosen) or instead & columns.keys():
            continue
        found = [k for k, one in enumerate(names) if one in words and k not in taken]
        if len(found) > 1:
            several = " and ".join(shown(header[k])[1:-1] for k in found)
            said = f"is given {len(found)} times" if len({names[k] for k in found}) == 1 else f"stands in {several}"
            raise FormatError(f"column {name} {said}, header must name x, z and radius")
        if found:
            chosen[name] = found[0]
    needed = {"x": {"x"}, "z": {"y", "z"}, "radius": _SIZES}
    missing = [name for name, instead in needed.items() if not instead & chosen.keys()]
    if missing:
        most = f"{', '.join(missing[:-1])} and {missing[-1]}"
        several = f"columns {most} are" if len(missing) > 1 else f"column {missing[0]} is"
        raise FormatError(f"{several} missing, header must name x, z and radius{_there(header, names)}")
    given = [name for name in LENGTHS if name in chosen]
    if len({units[chosen[name]] for name in given}) > 1:
        lengths = f"{', '.join(given[:-1])} and {given[-1]}"
        there = ", ".join(units[chosen[name]] or "none" for name in given)
        rule = f"must have the same unit of length, not {there}; convert them in the table"
        raise FormatError(f"columns {lengths}: {rule}")
    ignored = [one for k, one in enumerate(names) if k not in chosen.values()]
    for column, key in REFUSED.items():
        if column in ignored:
            raise FormatError(f"column {column}: must be left out, {key} is that of all disks")
    if all(name in chosen for name in MATERIAL):
        raise FormatError("columns mass and density: must have one of them, once")
    if not any(name in chosen for name in MATERIAL):
        for column in ignored:
            if (meant := _OTHER_WORDS.get(column)) or (meant := suggestion(column, MATERIAL)):
                rule = meant if meant.startswith(",") else f", did you mean {meant}?"
                raise FormatError(f"column {column}: unknown{rule} (mass or density, or neither)")
    return {name: chosen[name] for name in NAMES if name in chosen}


def _there(header: list[str], names: Sequence[str]) -> str:
    """The names of a header that has a column of disks, and how a scene says what others are."""
    if not any(name in words for name in names for words in NAMES.values()):
        return ""
    there = ", ".join(shown(cell)[1:-1] for cell in header[:12]) + (", ..." if len(header) > 12 else "")
    return f"; there are {there}; packing.columns says which are meant, as {{z: Y, radius: R}}"
