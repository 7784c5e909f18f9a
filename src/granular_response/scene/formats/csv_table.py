"""CSV with a header that names x, z and radius, and mass or density if disks differ in material.

Columns are separated by commas or, where the header has more of them, by semicolons; numbers have decimal points. Names
may be written in any case, with a unit in brackets or, as ``x_mm``, after an underscore: lengths have one unit. Cameras
and programs that track disks have other names for the same: y for the height where there is no z, r for the radius, or
a diameter; ``columns`` of a scene says which column is meant where a table has others, and ``-y`` that it points down.
Further columns are ignored, and so are empty lines and lines that begin with ``#``, but for the mark of our own tables.
Each disk has a line of its own.

Programs that track disks write all frames to one table, where a column numbers them; as of a dump, the last frame is
read, of several runs that of the last one. Beside such columns ``mass`` is a brightness, unless it has a unit or
``columns`` names it.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..errors import suggestion
from ..names import MOTION
from .table import NO_BOX, FormatError, Mark, Once, Table, lines_of, listed, must, number, numbers, radii, shown, upward

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
#: Columns that look as if they were heeded, and cannot be: contacts have one law.
REFUSED = {
    **dict.fromkeys(("friction", "mu", "µ", "μ", "friction_coefficient"), "contact.friction"),
    **dict.fromkeys(("stiffness", "kn", "k_n", "young", "youngs_modulus", "young_modulus"), "contact.normal_stiffness"),
    "cohesion": "contact.law",
}
_NUMBER = "(_?(no|nr|number|id|index))?"
#: Columns that number experiments, frames, the first of which a table has counts, and disks.
RUNS = (re.compile(f"(run|trial|movie|sample|experiment|config(uration)?|reali[sz]ation){_NUMBER}"),)
FRAMES = (
    re.compile(f"((video_)?frames?|image|img|slice|snap(shot)?|pic(ture)?|photo){_NUMBER}"),
    re.compile(f"((time_?)?step|time_?(point|frame|stamp)|iteration|tap){_NUMBER}"),
    re.compile("(position_)?t(_?(s|ms|sec))?|time(_?(s|ms|sec))?"),
)
TRACKS = (re.compile(f"(particle|track|trajectory|traj){_NUMBER}"), re.compile("id"))
#: Columns by which a table is known as one of tracked disks, beside those of frames and tracks; and any of light.
_OF_TRACKERS = {"ecc", "ep", "signal", "raw_mass", "quality", "snr", "rg", "npscore", "circularity"}
_PIXELS = ("px", "pix", "pxl", "pixel", "pixels")
_SIZES = frozenset({"radius", "diameter"})
#: Other words for mass and density.
_OTHER_WORDS = {"m": "mass", "rmass": "mass", "weight": "mass", "rho": "density", "ρ": "density"}

#: Of what a scene names one of, the other is not looked for.
_ONE_OF = (_SIZES, frozenset(MATERIAL))


def read(path: Path, columns: Mapping[str, str] | None = None) -> Table:
    """The disks of a table; errors name the line. ``columns`` says in which column x, z, radius, ... stand."""
    rows: list[list[float]] = []
    places: list[str] = []
    header: list[str] = []
    cells_of: list[list[str]] = []
    titles: list[tuple[str, str]] = []
    chosen: dict[str, int] = {}
    motion: dict[str, int] = {}
    turned: set[str] = set()
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
            chosen, turned = _chosen(header, titles, columns or {})
            unit = titles[chosen["x"]][1]
            others = [title for k, title in enumerate(titles) if k not in chosen.values()]
            for name in (*MOTION, *_like((*RUNS, *FRAMES, *TRACKS), others)):
                if (times := [one for one, _ in titles].count(name)) > 1:
                    raise FormatError(f"column {name} is given {times} times, must be given once", place)
            motion = {name: titles.index((name, "")) for name in MOTION if (name, "") in titles}
            continue
        must(len(cells) == len(header), f"has {len(cells)} values, must have {len(header)} as the header", place)
        rows.append(numbers([cells[column] for column in chosen.values()], tuple(chosen), place))
        cells_of.append(cells)
        places.append(place)
    must(rows, "has no disks, must have a header x,z,radius and a line for each disk")
    if mark is not None:
        mark.check(len(rows), whole)
        must("mass" in chosen, "column mass is missing, which tables of granular-response have")
    others = [("", "") if k in chosen.values() else title for k, title in enumerate(titles)]
    kept, frame = _last_frame(others, cells_of, places)
    rows, places, cells_of = [rows[k] for k in kept], [places[k] for k in kept], [cells_of[k] for k in kept]
    values = dict(zip(chosen, np.array(rows).T, strict=True))
    for name in turned:
        values[name] = -values[name]
    if "density" in values and not (values["density"] > 0.0).all():
        bad = int(np.argmin(values["density"] > 0.0))
        raise FormatError(f"density = {float(values['density'][bad])!r}: must be greater than 0", places[bad])
    up = "z" if "z" in values else "y"
    if "y" in values and "z" in values:
        up = upward(values["y"], values["z"])
    radius = radii(values, places)
    mass = values["mass"] if "mass" in values else values["density"] * radius**2 if "density" in values else None
    velocities = {name: np.array([_or_nan(cells[at]) for cells in cells_of]) for name, at in motion.items()}
    box = NO_BOX if mark is None else mark.box
    notes = [f"has several frames; taken is {frame}"] if frame else []
    if up == "y" and (unit in _PIXELS or _tracker(titles, chosen)):
        points = "where it points down, as in pictures, packing.columns = {z: -y} and packing.origin say so"
        notes.append(f"column y is taken as the height; {points}")
    return Table(
        values["x"], values[up], radius, places, mass, box, columns=velocities or None, frame=frame, unit=unit,
        notes=notes,
    )  # fmt: skip


def _like(patterns: Sequence[re.Pattern[str]], titles: Sequence[tuple[str, str]]) -> list[str]:
    """The names of columns that are spelled so, those of the first pattern first."""
    words = {name: re.sub(r"[\s.#\-]+", "_", name).strip("_") for name, _ in titles}
    return [name for pattern in patterns for name, word in words.items() if pattern.fullmatch(word)]


def _tracker(titles: Sequence[tuple[str, str]], chosen: Mapping[str, int]) -> str:
    """A column by which a table is known as one of tracked disks; nothing where it has none."""
    known = {*_like((*FRAMES, *TRACKS), titles), *_OF_TRACKERS} - {"id"}
    others = [name for k, (name, _) in enumerate(titles) if k not in chosen.values()]
    light = re.compile("intensity|brightness|contrast")
    return next((name for name in others if name in known or light.search(name)), "")


def _last_frame(
    titles: Sequence[tuple[str, str]], rows: Sequence[Sequence[str]], places: Sequence[str]
) -> tuple[list[int], str]:
    """The rows of the last frame, and which one it is; all rows, and nothing, of a table of one frame.

    Raises FormatError where frames have no order, or one disk each, and for a disk that a frame has twice.
    """
    names = [name for name, _ in titles]
    kept, frame = list(range(len(rows))), ""
    runs = _like(RUNS, titles)
    for name in (*runs, *_like(FRAMES, titles)[:1]):
        cells = {k: rows[k][names.index(name)].strip() for k in kept}
        if 1 < len(set(cells.values())) < len(kept) + (name not in runs):
            numbered = {k: number(cell, name, places[k]) for k, cell in cells.items()}
            several = sorted(set(numbered.values()))
            rule = f"column {name}: each disk has another one; a table must have the disks of one frame"
            must(len(several) != len(kept), rule)
            kept = [k for k in kept if numbered[k] == several[-1]]
            if len(several) > 1:
                said = f"{len(several)} of {len(several)}, {name} {cells[kept[0]]}"
                frame = f"{frame}; of these {said}" if frame else said
    for name in _like(TRACKS, titles):
        once = Once()
        for k in kept:
            if cell := rows[k][names.index(name)].strip():
                once.add(f"{name} {shown(cell)}", places[k])
    return kept, frame


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


def _chosen(
    header: list[str], titles: Sequence[tuple[str, str]], columns: Mapping[str, str]
) -> tuple[dict[str, int], set[str]]:
    """The column of each quantity that is read, and those of which the sign is turned round.

    Raises FormatError for a header that does not say what they are. What stands in it is quoted only where it looks as
    one of a table of disks: the file may be another one.
    """
    rule = "columns are separated by blanks or tabs, must be separated by commas or semicolons"
    must(len(header) != 1 or len(header[0].split()) < len(_NEEDED), rule)
    rule = "the first line has numbers alone, must be a header that names x, z and radius"
    must(any(_words(cell) for cell in header), rule)
    names, units = zip(*titles, strict=True)
    chosen: dict[str, int] = {}
    turned: set[str] = set()
    for name, wanted in columns.items():
        places = _named(header, names, wanted)
        if not places and name in ("x", "z") and wanted.strip().startswith("-"):
            places = _named(header, names, wanted.strip().removeprefix("-"))
            turned.add(name)
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
    missing = [name for name, instead in _NEEDED.items() if not instead & chosen.keys()]
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
    assumed = "mass" in chosen and "mass" not in columns and not units[chosen["mass"]]
    if assumed and (beside := _tracker(titles, chosen)):
        rule = "must have a unit, as mass [g], or packing.columns = {mass: mass} says that it is one"
        raise FormatError(f"column mass: is a brightness where disks are tracked, as column {beside} shows; {rule}")
    must(not all(name in chosen for name in MATERIAL), "columns mass and density: must have one of them, once")
    if not any(name in chosen for name in MATERIAL):
        for column in ignored:
            if (meant := _OTHER_WORDS.get(column)) or (meant := suggestion(column, MATERIAL)):
                rule = meant if meant.startswith(",") else f", did you mean {meant}?"
                raise FormatError(f"column {column}: unknown{rule} (mass or density, or neither)")
    return {name: chosen[name] for name in NAMES if name in chosen}, turned


#: What a table must have, and the quantities that give it.
_NEEDED: dict[str, set[str] | frozenset[str]] = {"x": {"x"}, "z": {"y", "z"}, "radius": _SIZES}


def _named(header: list[str], names: Sequence[str], wanted: str) -> list[int]:
    """Where the columns are that a key of ``columns`` means: as they are written, else in any case, without unit."""
    exact = [k for k, cell in enumerate(header) if cell.strip() == wanted.strip()]
    folded = wanted.strip().casefold()
    return exact or [k for k, cell in enumerate(header) if folded in (names[k], cell.strip().casefold())]


def _words(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return bool(cell.strip())
    return False


def _there(header: list[str], names: Sequence[str]) -> str:
    """The names of a header that has a column of disks, and how a scene says what others are."""
    known = any(name in words for name in names for words in NAMES.values())
    short = len(header) >= len(_NEEDED) and all(len(cell) <= 40 and _words(cell) for cell in header)
    if not known and not short:
        return ""
    return f"; there are {listed(header)}; packing.columns says which are meant, as {{z: Y, radius: R}}"
