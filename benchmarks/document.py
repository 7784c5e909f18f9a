"""`docs/benchmarks.md`, its pictures, `summary.json` with its goals, and the table of costs of the user guide.

The README quotes them by hand (:func:`quoted`); a test compares. Tables and pictures come from the other JSON files
alone.

`python benchmarks/document.py` from anywhere in the repository. A benchmark whose file is missing is named as not
measured.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import pictures
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from pictures import Metrics, pick
from timing import write

from granular_response.plot import style
from granular_response.store import atomic

HERE = Path(__file__).resolve().parent

TEXTS = {
    "precision": (
        "Run time against error",
        "The error is the largest difference of the normalized floor response from the quasi-static limit. Times "
        "include the fall under gravity, which ends at a kinetic energy of 1e-13 to 1e-7 per disk. With friction the "
        "equilibrium depends on this energy.",
    ),
    "exactness": (
        "Accuracy of the path",
        "The path is compared with increments that use the return map. These end at each event of the path, and "
        "every 0.001 mg, or 1/250 of the load if that is longer (1/1000 for the ordered slabs with friction 0.2 and "
        "1). The error is the largest difference of a force on the floor or a wall, relative to the load. After a loss "
        "of equilibrium inertia decides which one follows, so the two methods may end in different ones.",
    ),
    "shares": (
        "Where the time of a solution goes",
        "Processor time from scene to states under load, with kernels loaded. Shares are percent of it. Motion leads "
        "on where an equilibrium is lost and none is found beside it; searches look for one there. Kernels and Python "
        "are those of the path between two events.",
    ),
    "convergence": (
        "Convergence of dynamics to the path",
        "Dynamics approaches the path as the load ramp becomes slower. Lines are the symmetric part of the "
        "difference, which is inversely proportional to the ramp time. Dotted lines are the whole difference.",
    ),
    "trajectory": (
        "Order of the integrators",
        "Each integrator has its formal order in smooth motion. In a fall, contacts that open, close or begin to slide "
        "limit the order to one.",
    ),
    "kernel": (
        "Time of a step",
        "Slabs in equilibrium, with the time step and dashpots of `pair_style gran/hooke/history`.",
    ),
    "arena": (
        "Comparison with other codes: a step",
        "Friction 0.2. All codes have the same initial state, contact law and time step. Runs are interleaved; "
        "processor time on one core. LIGGGHTS runs `gran model hooke/stiffness tangential history`, YADE "
        "`Law2_ScGeom_ViscElPhys_Basic`.",
    ),
    "responses": (
        "Comparison with other codes: a response",
        "Scenes and errors are those of *Run time against error*. Errors below 1e-7 are drawn at 1e-7. The other codes "
        "ramp the load between two equilibria. Processor time on one core.",
    ),
    "bounces": (
        "Single collisions with a frictional wall",
        "Friction 0.5. The dotted line is the closed form of a disk that slides throughout. `fix wall/gran "
        "hooke/history` of LAMMPS of 2025 deviates from it "
        "([lammps/lammps#5007](https://github.com/lammps/lammps/pull/5007)). With the paper's dashpots YADE excludes "
        "tensile contact forces, and YADE and LIGGGHTS dissipate more energy of a grazing disk.",
    ),
    "limits": (
        "Roofline",
        "Kernels of a step of 908 disks are compared with a loop of independent operations of the same mix, and "
        "factorisations with LAPACK's matrix product (`limits.json`).",
    ),
    "linear": (
        "Factorisations of the tangent stiffness",
        "Numerical factorisations by band and by fronts are compared with LAPACK, SuperLU and PARDISO (`linear.json`).",
    ),
    "neighbours": (
        "Lists of close disks",
        "A sweep along the longer side of a packing is compared with a tree of scipy, from positions to sorted pairs "
        "(`neighbours.json`).",
    ),
    "skipping": (
        "Cost of work that is skipped",
        "A step skips rotations without friction, neighbour searches in an unchanged network, and wall tests for disks "
        "far from a wall. The picture shows the cost of each.",
    ),
    "scale": (
        "Large systems",
        "`granular-response run` from scene file to stored result; wall time on two threads. Slabs are four times as "
        "wide as deep, and stiffness is proportional to their size. Slabs of a million disks: older code.",
    ),
    "depth": (
        "The teardrop in deep slabs",
        "The region of open contacts without friction (Fig. 5); stiffness is proportional to the size. Open symbols: "
        "the region has reached the floor.",
    ),
    "startup": (
        "Start-up",
        "Whole processes, with and without cached kernels (`startup.json`).",
    ),
    "pipeline": (
        "The pipeline",
        "Every group from nothing, with compiled kernels, on all cores.",
    ),
}

#: How the page names what the files call otherwise.
NAMED = {
    "nine points": "ordered slabs (3 frictions, 3 loads)",
    "small": "small random scenes",
    "slabs": "disordered slabs",
    "jump": "dynamic jump",
    "increments: jump": "dynamic jump of the increments only",
    "stepped over": "passed with a fixed friction bound",
}


def read() -> dict[str, Metrics]:
    """All stored benchmarks by name."""
    files = sorted(set(HERE.glob("*.json")) - {HERE / "summary.json"})
    return {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in files}


def cell(value: Any) -> str:
    """Three digits of a number, a word for a truth value."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.0f}" if 1000 <= abs(value) < 1e6 else f"{value:.3g}"
    return str(value)


def seconds(value: float) -> str:
    return f"{value / 60:.1f} min" if value >= 100 else f"{value:.2g} s" if value < 10 else f"{value:.0f} s"


def table(rows: list[dict[str, Any]], columns: dict[str, str], title: str = "") -> dict[str, Any]:
    """A table of some keys of the records, with headings."""
    cells = [[cell(row.get(key)) for key in columns] for row in rows]
    return {"title": title, "columns": list(columns.values()), "rows": cells}


def versions(metrics: Metrics) -> str:
    """Of the other codes."""
    names = {f"{family(run['code'])} {run['version']}": None for run in metrics["runs"] if run["code"] != OURS}
    return (f" Versions: {', '.join(names)}." if names else "") + left_out(metrics)


def left_out(metrics: Metrics) -> str:
    """What could not be run, or was not."""
    said = f" Skipped: {'; '.join(metrics['skipped'])}." if metrics["skipped"] else ""
    if metrics.get("not_run"):
        theirs = sum("steps" in row for row in metrics["runs"])
        count = f"{len(metrics['not_run'])} of {theirs + len(metrics['not_run'])}"
        said += f" {count} runs were not made (`responses.json` names them)."
    return said


def tables(benchmark: str, metrics: Metrics) -> list[dict[str, Any]]:
    """The tables of a benchmark."""
    if benchmark == "exactness":
        columns = {
            "kind": "packings", "equilibria": "equilibrium lost by", "scenes": "scenes", "events": "events",
            "exact": "error at most 1e-8", "error": "largest error",
        }  # fmt: skip
        done = {kind: len(pick(metrics["runs"], kind=kind)) for kind in metrics["planned"]}
        words = ", ".join(
            f"{done[kind]} of {planned} {NAMED.get(kind, kind)}" for kind, planned in metrics["planned"].items()
        )
        words += "; times beside other computations" if metrics["busy"] else ""
        rows = [{**row, **{key: NAMED.get(row[key], row[key]) for key in ("kind", "equilibria")}}
                for row in metrics["groups"]]  # fmt: skip
        return [table(rows, columns, f"Measured: {words}.")]
    if benchmark == "neighbours":
        columns = {
            "disks": "disks", "sweep_milliseconds": "sweep [ms]", "tree_milliseconds": "tree [ms]", "ratio": "ratio",
        }  # fmt: skip
        return [table(metrics["runs"], columns)]
    if benchmark == "shares":
        parts = {part: part for part in ("fall", "motion", "searches", "stability", "kernels")}
        parts |= {"python": "Python", "set-up": "set-up"}
        columns = {"what": "slab of 908 disks", "seconds": "time [s]", "events": "events",
                   "per_event": "without the fall, an event [ms]", **parts}  # fmt: skip
        rows = [{**row, **{part: f"{100 * row[part]:.0f}" for part in parts}} for row in metrics["runs"]]
        return [table(rows, columns)]
    if benchmark == "depth":
        columns = {
            "layers": "layers", "from_force": "from force [mg]", "to_force": "to force [mg]",
            "exponent_of_depth": "exponent of depth in force", "exponent_of_width": "of width",
        }  # fmt: skip
        return [table(metrics["growth"], columns)]
    return []


def groups(metrics: Metrics) -> str:
    """Seconds of each collection of figure groups."""
    return "".join(f" {row['collection'].capitalize()}: {row['seconds']:.0f} s." for row in metrics["totals"])


#: What a section says after its text.
ADDED = {"arena": versions, "responses": left_out, "pipeline": groups}


def out_of_reach(runs: list[dict[str, Any]], scene: str, comparison: dict[str, Any]) -> float | None:
    """How much longer than statics the longest run of LAMMPS is, where none of its runs reaches the error."""
    theirs = [row["seconds"] for row in pick(runs, scene=scene, method="lammps")]
    ours = comparison.get("statics_seconds")
    return max(theirs) / ours if theirs and ours else None


def goals(found: dict[str, Metrics]) -> list[dict[str, Any]]:
    """Goals that the project set itself, beside what was measured."""
    rows: list[dict[str, Any]] = []

    def add(
        benchmark: str, what: str, value: float | None, least: float | None, most: float | None, form: Any,
        above: str = "", runs: Sequence[Metrics] = (),
    ) -> None:  # fmt: skip
        """``above``: why ``value`` is a lower bound, which can show that a goal is met but not that it is missed.

        ``runs``: those of the benchmark that the value is from, if not all.
        """
        if benchmark not in found:
            value = None
        goal = f"at least {form(least)}" if least is not None else f"at most {form(most)}"
        if value is None:
            rows.append({"what": what, "goal": goal, "measured": "not measured", "met": None, "on": ""})
        else:
            met = value >= least if least is not None else value <= most  # type: ignore[operator]
            said = f"over {form(value)} ({above})" if above else form(value)
            known = None if above and not met else bool(met)
            on = measured_on({**found[benchmark], "runs": [*runs]} if runs else found[benchmark])
            rows.append({"what": what, "goal": goal, "measured": said, "met": known, "on": on})

    def times(value: float | None) -> str:
        return f"{value:,.0f} times" if value is not None and value >= 20 else f"{value:.1f} times"

    kernel = found.get("kernel", {}).get("runs", [])
    for disks, least in ((908, 10.0), (99_950, 4.0)):
        row = next((row for row in kernel if row["friction"] > 0 and row["disks"] == disks), {})
        what = f"Speed of a step over LAMMPS, friction, {disks:,} disks"
        add("kernel", what, row.get("over_lammps"), least, None, times)
    for scene, least, what in (
        ("friction", 50.0, "friction 0.2, force 15, error 1e-5"),
        ("frictionless", 1000.0, "no friction, force 4, error 1e-6"),
    ):
        row = next(iter(pick(found.get("precision", {}).get("comparison", []), scene=scene)), {})
        value = row.get("times_faster_than_lammps")
        bound = None if value is not None else out_of_reach(found.get("precision", {}).get("runs", []), scene, row)
        above = "" if bound is None else "LAMMPS stays above"
        what = f"Speed over LAMMPS to a response: {what}"
        add("precision", what, value or bound, least, None, times, above)
    points = pick(found.get("exactness", {}).get("runs", []), kind="nine points")
    row = next(iter(pick(points, friction=0.2, load=15.0)), {})
    what = "Processor time of a path to 15 mg, friction 0.2, 908 disks"
    add("exactness", what, row.get("seconds"), None, 0.15, lambda v: f"{v:.2g} s")
    those = found.get("exactness", {}).get("groups", [])
    error = max((row["error"] for row in those if row["equilibria"] == "none lost"), default=None)
    add("exactness", "Error of paths that lose no equilibrium", error, None, 1e-8, lambda v: f"{v:.1g}")
    runs = found.get("scale", {}).get("runs", [])
    for method, disks, limit, what in (
        ("path", 100_000, 60.0, "100,000 disks with friction"),
        ("minimise", 1_000_000, 480.0, "1,000,000 disks without friction"),
        ("path", 1_000_000, 3600.0, "1,000,000 disks with friction, prepared without"),
    ):
        row = next((row for row in runs if row["method"] == method and row["disks"] >= disks), {})
        named = f"Response of {what}, wall time on two threads"
        add("scale", named, row.get("seconds"), None, limit, seconds, runs=[row])
        memory = row.get("peak_gibibytes")
        add("scale", f"Memory of the response of {what}", memory, None, 16.0, lambda v: f"{v:.2g} GiB", runs=[row])
    for method, what in (("minimise", "without friction"), ("path", "with friction")):
        row = next(iter(pick(found.get("scale", {}).get("exponents", []), method=method)), {})
        extent = f", {row['from_disks']:,} to {row['to_disks']:,}" if row else ""
        what = f"Exponent of processor time in the number of disks, {what}{extent}"
        fitted = [one for one in runs if row and row["from_disks"] <= one["disks"] <= row["to_disks"]]
        add("scale", what, row.get("exponent_of_cpu_seconds"), None, 1.5, lambda v: f"{v:.2f}", runs=fitted)
    residuals = [row["force_residual"] for row in runs if row["method"] != "dynamics"]
    what = "Largest unbalanced force of static results of the benchmark of large systems"
    add("scale", what, max(residuals, default=None), None, 1e-9, lambda v: f"{v:.1g} mg")
    totals = {row["collection"]: row["seconds"] for row in found.get("pipeline", {}).get("totals", [])}
    add("pipeline", "The paper from nothing (`make reproduce`), 2 cores", totals.get("paper"), None, 300.0, seconds)
    startup = found.get("startup", {}).get("runs", [])
    add("startup", "Every kernel compiled and cached", startup[0]["seconds"] if startup else None, None, 40.0, seconds)
    what = "`granular-response run`, default scene, as a whole process"
    add("startup", what, startup[2]["seconds"] if startup else None, None, 1.2, seconds)
    return rows


def limits(found: dict[str, Metrics]) -> list[dict[str, str]]:
    """Speeds that end where they do for a known reason, as far as they were measured."""
    rows: list[dict[str, str]] = []

    def add(benchmark: str, what: str, measured: str, reason: str) -> None:
        rows.append({"what": what, "measured": measured, "reason": reason, "on": measured_on(found[benchmark])})

    def extent(values: Iterable[float], form: str) -> str:
        ends = [*values]
        return f"{min(ends):{form}} to {max(ends):{form}}"

    if kernels := found.get("limits", {}).get("runs", []):
        row = min(kernels, key=lambda row: row["ratio"])
        chain = row["chain_microseconds"] / row["microseconds"]
        reason = (
            f"a force is a chain of operations; a loop in which each waits for the last takes {chain:.1f} times as long"
        )
        what = "Speed of the slowest kernel of a step over a loop of the same mix of independent operations"
        add("limits", what, f"{row['ratio']:.2f} times", reason)
    points = pick(found.get("exactness", {}).get("runs", []), kind="nine points")
    if points := [row for row in points if "dynamics_seconds" in row]:
        ratios = extent((row["seconds"] / row["dynamics_seconds"] for row in points), ".2g")
        errors = extent((row["dynamics_error"] for row in points), ".1g")
        reason = f"such dynamics errs by {errors}; the paths have up to {max(row['events'] for row in points):,} events"
        what = "Processor time of a path over that of dynamics with a ramp of 1 sqrt(R/g), nine slabs"
        add("exactness", what, f"{ratios} times", reason)
    solved = next(iter(pick(found.get("shares", {}).get("runs", []), what="ordered, friction 0.2, 15 mg")), {})
    if solved:
        reason = (
            f"the fall with the paper's time step {solved['fall']:.0%}, kernels of the path {solved['kernels']:.0%}"
        )
        reason = reason.replace("%", " %")
        add("shares", "Solution of the ordered slab, friction 0.2, 15 mg", f"{solved['seconds']:.2f} s", reason)
    if factorisations := found.get("limits", {}).get("factorisations", []):
        widths = extent((row["size"] for row in factorisations), "d")
        reason = f"bands and fronts are {widths} unknowns wide; wider bands are faster"
        add("limits", "Speed of factorisations over LAPACK's matrix product",
            extent((row["ratio"] for row in factorisations), ".2f"), reason)  # fmt: skip
    return rows


def measured_on(metrics: Metrics) -> str:
    """Kinds of processors of a benchmark: those of its rows where they say one, else that of the file."""
    each = [row.get("measured_on") for row in metrics.get("runs", [])]
    found = each if any(each) else [metrics.get("measured_on")]
    return " and ".join(dict.fromkeys(name or "a processor that was not recorded" for name in found))


def part(benchmark: str, metrics: Metrics) -> dict[str, Any]:
    """The section of a benchmark."""
    title, words = TEXTS[benchmark]
    return {
        "title": title,
        "text": words + ADDED.get(benchmark, lambda _: "")(metrics),
        "measured_on": measured_on(metrics),
        "picture": benchmark if benchmark in pictures.DRAWN else None,
        "tables": tables(benchmark, metrics),
    }


def text(found: dict[str, Metrics]) -> str:
    """The page."""
    parts = [part(benchmark, found[benchmark]) for benchmark in TEXTS if benchmark in found]
    missing = [title for benchmark, (title, _) in TEXTS.items() if benchmark not in found]
    machines = [one["measured_on"] for one in parts]
    usual = max(machines, key=machines.count, default="")
    environment = Environment(
        loader=FileSystemLoader(HERE),
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
        autoescape=False,
        keep_trailing_newline=True,
    )
    page = environment.get_template("benchmarks.md.j2")
    return page.render(
        goals=goals(found),
        limits=limits(found),
        parts=parts,
        usual=usual,
        missing=missing,
        machine=found.get("machine"),
    )


#: Disks and methods of the large systems that the README and the user guide name.
LARGE = ((100_000, "path", "with friction"), (1_000_000, "minimise", "without friction"))
SIZES = ((900, "path"), (14_000, "path"), (57_000, "path"), (100_000, "path"), (1_000_000, "minimise"))

#: Errors of responses at which the README compares, by scene.
COMPARED = {
    "friction": ("0.0001", "friction 0.2, 15 mg, error below 1e-4"),
    "frictionless": ("0.01", "no friction, 4 mg, error below 1e-2"),
}


def over_others(found: dict[str, Metrics]) -> list[dict[str, str]]:
    """Times of other codes over those of this one, for a step and a response; the fastest run of each code counts."""
    times: dict[str, float] = {}
    for row in pick(found.get("arena", {}).get("runs", []), disks=908):
        code = family(row["code"])
        times[code] = min(times.get(code, float("inf")), row["times_ours"])
    responses = []
    for scene, (error, words) in COMPARED.items():
        least: dict[str, float] = {}
        for row in pick(found.get("responses", {}).get("reached", []), scene=scene):
            if row[error] is not None:
                code = family(row["code"])
                least[code] = min(least.get(code, float("inf")), row[error])
        if said := ratios({code: value / least[OURS] for code, value in least.items()}):
            responses.append(f"{words}: {said}")
    rows = [
        {"what": "One time step, friction 0.2; this package = 1", "measured": ratios(times)},
        {"what": "One response; this package = 1", "measured": "; ".join(responses)},
    ]
    return [row for row in rows if row["measured"]]


def ratios(times: dict[str, float]) -> str:
    return ", ".join(
        f"{code} {f'{value:,.0f}' if value >= 100 else f'{value:.3g}'}" for code, value in times.items() if code != OURS
    )


def of_size(found: dict[str, Metrics], disks: int, method: str) -> dict[str, Any]:
    """The smallest large system of at least so many disks, empty if there is none."""
    runs = pick(found.get("scale", {}).get("runs", []), method=method)
    return min((row for row in runs if row["disks"] >= disks), key=lambda row: row["disks"], default={})


def costs(found: dict[str, Metrics]) -> str:
    """The table of costs of the user guide."""
    lines = ["| disks | friction | wall time, two threads | memory | processor |", "|---|---|---|---|---|"]
    for row in filter(None, (of_size(found, *size) for size in SIZES)):
        lines.append(
            f"| {row['disks']:,} | {row['friction']:g} | {seconds(row['seconds'])} | {row['peak_gibibytes']:.2g} GiB "
            f"| {row['measured_on']} |"
        )
    return "\n".join(lines)


#: The name of this package among the codes.
OURS = "granular_response"


def family(code: str) -> str:
    """A code whatever its version and style."""
    return code.partition(", ")[0].removeprefix("newest ")


def quoted(found: dict[str, Metrics]) -> str:
    """The table of the README, which a test compares with it."""
    quotes = over_others(found)
    large = [(row, words) for disks, method, words in LARGE if (row := of_size(found, disks, method))]
    if large:
        said = "; ".join(
            f"{row['disks']:,} disks {words} {seconds(row['seconds'])} ({row['measured_on']})" for row, words in large
        )
        quotes.append({"what": "From scene file to stored result, on two threads", "measured": said})
    return "\n".join(
        ["| what | measured |", "|---|---|", *(f"| {row['what']} | {row['measured']} |" for row in quotes)]
    )


def main() -> None:
    found = read()
    for benchmark, draw in pictures.DRAWN.items():
        if benchmark in found:
            style.save(draw(found[benchmark]), benchmark, HERE / "figures", formats=("png",))
    write(str(HERE / "summary.json"), {"goals": goals(found)}, measured=False)
    atomic.write_bytes(HERE.parent / "docs" / "benchmarks.md", text(found).encode())
    atomic.write_bytes(HERE.parent / "docs" / "_generated" / "costs.md", f"{costs(found)}\n".encode())


if __name__ == "__main__":
    main()
