"""`docs/benchmarks.md`, its pictures, `summary.json` with its goals, and the table of costs of the user guide.

`python benchmarks/document.py` makes them from the stored JSON files alone. What is missing there is "not measured".
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pictures
from pictures import pick
from timing import write

from granular_response.plot import style
from granular_response.store import atomic

HERE = Path(__file__).resolve().parent
Stored = dict[str, dict[str, Any]]

#: What the page calls the packings and the losses of equilibrium of ``exactness.json``.
NAMED = {
    "nine points": "ordered slabs (3 frictions, 3 loads)",
    "small": "small random scenes",
    "slabs": "disordered slabs",
    "jump": "dynamic jump",
    "increments: jump": "dynamic jump of the increments only",
    "stepped over": "passed with a fixed friction bound",
}

#: Disks at least, and methods, of the large systems.
SIZES = ((900, "path"), (14_000, "path"), (57_000, "path"), (100_000, "path"), (1_000_000, "minimise"))


def read() -> Stored:
    """All stored benchmarks by name."""
    files = sorted({*HERE.glob("*.json"), *HERE.glob("peers/*.json")} - {HERE / "summary.json"})
    return {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in files}


def cell(value: Any) -> str:
    """Three digits of a number."""
    if isinstance(value, float):
        return f"{value:.0f}" if 1000 <= abs(value) < 1e6 else f"{value:.3g}"
    return "–" if value is None else NAMED.get(value, str(value))


def seconds(value: float) -> str:
    return f"{value / 60:.1f} min" if value >= 100 else f"{value:.2g} s" if value < 10 else f"{value:.0f} s"


def times(value: float) -> str:
    return f"{value:,.0f} times" if value >= 20 else f"{value:.1f} times"


def table(rows: list[dict[str, Any]], **columns: str) -> str:
    """Some keys of the records under their headings."""
    lines = [columns.values(), ["---"] * len(columns), *([cell(row.get(key)) for key in columns] for row in rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def of_size(found: Stored, disks: int, method: str) -> dict[str, Any]:
    """The smallest large system of at least so many disks."""
    runs = [row for row in pick(found["scale"]["runs"], method=method) if row["disks"] >= disks]
    return min(runs, key=lambda row: row["disks"])


def goals(found: Stored) -> list[dict[str, Any]]:
    """Goals that the project set itself, beside what was measured."""

    def first(benchmark: str, part: str, **values: Any) -> dict[str, Any]:
        return pick(found[benchmark][part], **values)[0]

    def lammps(scene: str) -> tuple[float, str]:
        """Where no run of LAMMPS reaches the error, its longest one is a lower bound."""
        row = first("precision", "comparison", scene=scene)
        if (value := row["times_faster_than_lammps"]) is not None:
            return value, ""
        theirs = max(run["seconds"] for run in pick(found["precision"]["runs"], scene=scene, method="lammps"))
        return theirs / row["statics_seconds"], "over "

    def large(disks: int, method: str, key: str) -> float:
        return of_size(found, disks, method)[key]

    def exponent(method: str) -> float:
        return first("scale", "exponents", method=method)["exponent_of_cpu_seconds"]

    def over(disks: int) -> float:
        return next(row for row in pick(found["kernel"]["runs"], disks=disks) if row["friction"] > 0)["over_lammps"]

    gib, plain, tiny = "{:.2g} GiB".format, "{:.2f}".format, "{:.1g}".format
    path, least = "path", "minimise"
    wall = "wall time on two threads"
    statics = [row["force_residual"] for row in found["scale"]["runs"] if row["method"] != "dynamics"]
    exact = [row["error"] for row in found["exactness"]["groups"] if row["equilibria"] == "none lost"]
    total = first("pipeline", "totals", collection="paper")["seconds"]
    process = found["startup"]["runs"]
    slab = first("exactness", "runs", kind="nine points", friction=0.2, load=15.0)["seconds"]
    rows: list[tuple[str, str, Any, float, Callable[[Any], str]]] = [
        ("Speed of a step over LAMMPS, friction, 908 disks", "least", over(908), 10.0, times),
        ("Speed of a step over LAMMPS, friction, 99,950 disks", "least", over(99_950), 4.0, times),
        ("Speed over LAMMPS to a response: friction 0.2, force 15, error 1e-5", "least", lammps("friction"), 50, times),
        ("Speed over LAMMPS to a response: no friction, force 4, error 1e-6", "least", lammps("frictionless"), 1e3,
         times),
        ("Processor time of a path to 15 mg, friction 0.2, 908 disks", "most", slab, 0.15, "{:.2g} s".format),
        ("Error of paths that lose no equilibrium", "most", max(exact), 1e-8, tiny),
        (f"Response of 100,000 disks with friction, prepared without, {wall}", "most",
         large(100_000, path, "seconds"), 60, seconds),
        ("Memory of it", "most", large(100_000, path, "peak_gibibytes"), 16, gib),
        (f"Response of 1,000,000 disks without friction, {wall}", "most", large(10**6, least, "seconds"), 480, seconds),
        ("Memory of it", "most", large(10**6, least, "peak_gibibytes"), 16, gib),
        (f"Response of 1,000,000 disks with friction, prepared without, {wall}", "most",
         large(10**6, path, "seconds"), 3600, seconds),
        ("Memory of it", "most", large(10**6, path, "peak_gibibytes"), 16, gib),
        ("Exponent of processor time in the number of disks, without friction", "most", exponent(least), 1.5, plain),
        ("Exponent of processor time in the number of disks, with friction", "most", exponent(path), 1.5, plain),
        ("Largest unbalanced force of static results of large systems", "most", max(statics), 1e-9, "{:.1g} mg".format),
        ("The paper from nothing (`make reproduce`), 2 cores", "most", total, 300, seconds),
        ("Every kernel compiled and cached", "most", process[0]["seconds"], 40, seconds),
        ("`granular-response run`, default scene, as a whole process", "most", process[2]["seconds"], 1.2, seconds),
    ]  # fmt: skip
    made = []
    for what, bound, value, goal, form in rows:
        number, said = value if isinstance(value, tuple) else (value, "")
        met = number >= goal if bound == "least" else number <= goal
        made.append({"what": what, "goal": f"at {bound} {form(goal)}", "measured": said + form(number), "met": met})
    return made


def page(found: Stored) -> str:
    """The template with its tables."""
    machine = found["machine"]
    versions = {f"{row['code'].partition(', ')[0]} {row['version']}": None for row in found["arena"]["runs"]}
    named = {"friction": "friction 0.2, 15 mg", "frictionless": "no friction, 4 mg"}
    reached = [{**row, "scene": named[row["scene"]]} for row in found["responses"]["reached"]]
    filled = {
        "processor": found["kernel"]["measured_on"],
        "software": f"{machine['cores']} cores, Python {machine['python']}, Numba {machine['numba']}",
        "versions": ", ".join(name.replace("granular_response", "this package") for name in versions),
        "steps": steps(found["arena"]["runs"]),
        "reached": table(reached, scene="scene", code="code", **{"0.01": "1e-2", "0.001": "1e-3", "0.0001": "1e-4",
                         "1e-05": "1e-5", "least_error": "smallest error reached"}),
        "exactness": table(found["exactness"]["groups"], kind="packings", equilibria="equilibrium lost by",
                           scenes="scenes", events="events", exact="error at most 1e-8", error="largest error"),
        "costs": large(found),
    }  # fmt: skip
    text = (HERE / "benchmarks.md.in").read_text(encoding="utf-8")
    for name, value in filled.items():
        text = text.replace("{" + name + "}", value)
    return text


def steps(runs: list[dict[str, Any]]) -> str:
    """Processor time of a step of each code by number of disks, and how many times ours that is."""
    rows: dict[str, dict[str, Any]] = {}
    for run in runs:
        row = rows.setdefault(run["code"], {"code": run["code"], "version": run["version"]})
        row[f"{run['disks']:,} disks"] = f"{cell(run['processor_microseconds'])} ({run['times_ours']:.3g})"
    (first, *_) = made = list(rows.values())
    return table(made, **{key: key for key in first})


def large(found: Stored) -> str:
    """Time and memory of large systems."""
    rows = [of_size(found, *size) for size in SIZES]
    rows = [{**row, "disks": f"{row['disks']:,}", "wall": seconds(row["seconds"]),
             "memory": f"{row['peak_gibibytes']:.2g} GiB"} for row in rows]  # fmt: skip
    head = {"disks": "disks", "friction": "friction", "wall": "wall time, two threads", "memory": "memory"}
    return table(rows, **head, measured_on="processor")


def costs(found: Stored) -> str:
    """The table of costs of the user guide: whole solutions, and where a default fall ends beside the paper's step."""
    slabs = [row for row in found["fall"]["scenes"] if row["scene"].startswith("slab, ")]
    errors = {row["disks"]: row.get("floor_error") for row in slabs}
    whole = found["fall"]["whole"]
    known = {row["disks"] for row in whole}  # of larger ones only the fall was measured
    alone = [row | {"scene": "default, without the load", "changes": {}} for row in slabs if row["disks"] not in known]
    default = [row for row in whole if not row["changes"]]
    rows: list[dict[str, Any]] = []
    for row in [*default, *alone, *(row for row in whole if row["changes"])]:
        key = ", ".join(f"`{name}: {value}`" for name, value in row["changes"].items())
        error = None if key or not errors.get(row["disks"]) else f"{errors[row['disks']]:.2g}"
        made = {**row, "key": key or None, "error": error, "size": f"{row['disks']:,}", "time": seconds(row["seconds"]),
                "memory": f"{row['peak_gibibytes']:.2g} GiB"}  # fmt: skip
        if rows and rows[-1]["scene"] == row["scene"]:
            growth, more = row["seconds"] / rows[-1]["seconds"], row["disks"] / rows[-1]["disks"]
            made["exponent"] = math.log(growth) / math.log(more)
        rows.append(made)
    return table(rows, scene="scene", key="key that differs", size="disks", time="processor time, one thread",
                 memory="memory", exponent="exponent of the time in disks",
                 error="largest change of a floor force against the paper's step [mg]")  # fmt: skip


def main() -> None:
    found = read()
    for benchmark, draw in pictures.DRAWN.items():
        style.save(draw(found[benchmark]), benchmark, HERE / "figures", formats=("png",))
    write(str(HERE / "summary.json"), {"goals": goals(found)}, measured=False)
    atomic.write_bytes(HERE.parent / "docs" / "benchmarks.md", page(found).encode())
    atomic.write_bytes(HERE.parent / "docs" / "_generated" / "costs.md", f"{costs(found)}\n".encode())


if __name__ == "__main__":
    main()
