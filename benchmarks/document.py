"""`docs/benchmarks.md`, its pictures, `summary.json` with its goals, and the lines of the README that quote them.

Tables and pictures come from the other JSON files alone; texts may name what earlier versions took.

`python benchmarks/document.py` from anywhere in the repository. A benchmark whose file is missing is named as not
measured.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pictures
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from pictures import Metrics, name, pick
from timing import write

from granular_response.plot import style
from granular_response.store import atomic, generated

HERE = Path(__file__).resolve().parent

TEXTS = {
    "precision": (
        "Run time against error",
        "The error is the largest difference of the normalised floor response from the quasi-static limit; times "
        "include the fall under gravity. Open symbols of integrators: without the static finish, at several kinetic "
        "energies of rest. With friction the rest state itself depends a little on how the packing fell, so LAMMPS "
        "keeps a difference however slowly it is loaded; its error is given from its own limit too.",
    ),
    "nine_points": (
        "Path and dynamics",
        "From rest, without the fall, in one run: the load path and dynamics (leapfrog in steps of 1.4e-3, 0.86 of its "
        "limit, static finish, ramps of 1, 5, 20 and 100). The error is that of the normalised floor response against "
        "the path. Of dynamics the fastest run counts whose error, known afterwards, is small enough: the luckiest "
        "ramp.",
    ),
    "exactness": (
        "How exact a path is",
        "Load paths against the same path in small increments with the return map, which share no event with it: the"
        " paper's slab under nine pairs of friction and force, packings of at most 60 disks under loads of all "
        "sizes, and slabs of 8 to 15 layers. The error is the largest difference of a force of the floor or a wall, "
        "per load. A path counts as exact that differs by no more than 1e-8 and the error of the increments. "
        "Compared are paths on which neither way loses an equilibrium.",
    ),
    "convergence": (
        "Dynamics approaches the path",
        "Responses after a linear ramp of the load, from the same rest state, compared with the load path: the "
        "difference falls like one over the ramp time, below and above the loads at which a simple follower stops "
        "(29.3 for a friction of 0.2, 62.3 for 1). Lines: the symmetric part of the difference; dotted: all of it, "
        "where that is more. The packing and its path are symmetric, but with a friction of 1 and large loads a slow "
        "ramp amplifies what rounding adds to the antisymmetric part, and under 65 the symmetric part of the slowest "
        "rises again.",
    ),
    "trajectory": (
        "Error of trajectories against the time step",
        "A smooth motion shows the order of each integrator; leapfrog's is the first, since its dashpots see the "
        "velocity of half a step before. In the fall of a slab every contact that opens, closes or starts to slide "
        "breaks the smoothness, and no integrator is of more than first order.",
    ),
    "kernel": (
        "Speed of the kernels",
        "Slabs that have fallen into their contacts, same time step and dashpots; eight pairs of a scene are taken at "
        "once. Times are of the processor, on a machine with other work. LAMMPS runs `pair_style gran/hooke/history` "
        "in the same run. Eight scenes in lock-step, one in each lane of a vector, did not pay: 0.9 to 1.3 times the "
        "steps per second of a scene alone up to 908 "
        "disks, less above, 0.993 times its speed from the lattice to rest. A scene alone passes the goal that "
        "lock-step was built for, ten times LAMMPS, so it went.",
    ),
    "arena": (
        "Beside other codes",
        "Slabs with friction 0.2 that have fallen into their contacts; same start, contact law and time step, one core "
        "each, in turns in one run, each round a new process. LAMMPS runs its old style `hooke/history` and its newer "
        "one, `granular`, with the same law; LIGGGHTS `gran model hooke/stiffness tangential history`; YADE "
        "`Law2_ScGeom_ViscElPhys_Basic` on one thread. Times are of the processor, the least of all rounds, and in "
        "brackets the least of the worst round; the machine had other work. Memory is the peak of the process; ours "
        "has Python, compiled kernels and their compiler in it, YADE Python.",
    ),
    "responses": (
        "To a response, beside other codes",
        "908 disks, the two scenes of run time against error above. The error is the largest difference of the "
        "normalised floor response from the quasi-static limit; times are of the processor and include the fall under "
        "gravity. The other codes run a ramp of the load between two rests, all longer from point to point; each of "
        "these runs was made once, several at a time. With friction their error ends at what their rest states differ "
        "by, which remember the fall. Errors below 1e-7 are drawn there.",
    ),
    "bounces": (
        "Bounces off a wall with friction",
        "One disk flies at a wall with friction 0.5 at several angles, with the paper's springs, and with dashpots of "
        "the paper and next to none. A disk that slides all the time has a closed form (dotted). `fix wall/gran "
        "hooke/history` of LAMMPS of 2025 gives it too little friction, that of 2021 did not; "
        "[lammps/lammps#5007](https://github.com/lammps/lammps/pull/5007) of 2026 corrects it. `granular` agrees with "
        "ours. With the paper's dashpots YADE lets no contact pull, and YADE and LIGGGHTS keep less energy of a disk "
        "that grazes: their motion differs, what is at rest does not.",
    ),
    "limits": (
        "How near the limit",
        "What a step of 908 disks does, counted by running the kernels on arrays that count: operations on doubles "
        "(additions, multiplications, divisions, roots, and comparisons with their choice) and bytes moved between "
        "registers and caches. Beside each kernel, in turns, a loop of the same mix for each vector, of numbers that "
        "are in order and do not wait for each other; the fastest of several arrangements of it; in one chain each "
        "operation of a vector waits for the one before. Factorisations, by "
        "the operations that their sizes need, beside LAPACK's matrix product; fronts also as bare dense "
        "factorisations of the same sizes. Times are of the processor, least of many. Above 1 a kernel is faster than "
        "the loop, which is no bound then. Pair forces lie between the two loops: their operations wait for each "
        "other, root, quotient, normal force, its limit on the tangential one. Fronts and bands are small: bare "
        "LAPACK on fronts of these sizes is no nearer to the product of large matrices than the table says, and the "
        "rest of the time puts the matrix into them.",
    ),
    "linear": (
        "Factorisations of the tangent stiffness",
        "Slabs at rest. With friction the tangent has three unknowns a disk and is factorised as L U; without, two: "
        "all but SuperLU take it as symmetric and positive. The package takes a band up to a half-width of 130, and "
        "fronts beyond. Numeric phase alone; the time of SuperLU holds its ordering, which scipy makes each time. One "
        "thread each, the instructions that the command line chooses; PARDISO (MKL) chooses its own.",
    ),
    "skipping": (
        "What skipping buys",
        "The same scene with an unneeded part forced on. Results are the same to the last bit where that is said.",
    ),
    "scale": (
        "Large systems",
        "Whole processes, `granular-response run` from a scene file to the stored result. Slabs are four times as "
        "wide as deep, and stiffness grows with their size so that the order of the slab survives. Where the time "
        "is far above the processor time of a thread, other work held the cores; goals are judged by the time.",
    ),
    "depth": (
        "The teardrop in deep slabs",
        "Without friction, the region of contacts that the load opens (Fig. 5), in slabs up to sixteen times as deep "
        "as the paper's. Stiffness grows with the size of the slab, so that gravity compresses all of them equally "
        "little; open symbols: the region has reached the floor.",
    ),
    "shares": (
        "Where the time of a solution goes",
        "Shares of the time on one thread, by a profile, on a machine with other work; the first four cases are slabs "
        "of 908 disks.",
    ),
    "startup": (
        "What a newcomer waits for",
        "Whole processes, the least of five. Compiled kernels are kept on disk. A run of two disks is what every "
        "run pays: libraries imported, kernels read from the disk and linked, a result written. Most of what is "
        "left is the fall of the slab, in the paper's time steps. On a slower machine the kernels took 54 s and the "
        "default scene 2.1 s, and in turns the first version 61 and 3.1 s.",
    ),
    "pipeline": (
        "Where the time of the pipeline goes",
        "Every group from nothing, with compiled kernels, on all cores. Wall-clock seconds of each stage with "
        "its start, one group after another. In other hours of the same machine all groups of the paper took 6.5 min "
        "in place of 5.2: `sensitivity`, which is explicit steps, 20 s in place of 13.",
    ),
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


def spread(row: dict[str, Any], key: str) -> str:
    """The least value, and that of the worst round."""
    return f"{cell(row[key])} ({cell(row[f'{key}_worst_round'])})"


def factorisations(metrics: Metrics, key: str, title: str) -> dict[str, Any]:
    """One row for each matrix, one column for each method."""
    columns = {"friction": "friction", "unknowns": "unknowns", "half_width": "half-width"}
    rows: dict[int, dict[str, Any]] = {}
    for run in metrics["runs"]:
        columns.setdefault(run["method"], run["method"])
        rows.setdefault(run["unknowns"], dict(run))[run["method"]] = run[key]
    return table(list(rows.values()), columns, skipped(title, metrics))


def skipped(title: str, metrics: Metrics) -> str:
    """The title with what was not there to be measured."""
    return title + (f" (skipped: {'; '.join(metrics['skipped'])})" if metrics["skipped"] else "") + ":"


def nine_points(points: list[dict]) -> dict[str, Any]:
    """Times of the path, and of dynamics to each error."""
    columns = {"friction": "friction", "force": "force", "fall_seconds": "fall [s]", "path": "path [s]"}
    errors = [key for key in points[0] if key.startswith("dynamics_")]
    columns |= {key: f"dynamics to {key.removeprefix('dynamics_')} [s]" for key in errors}
    return table(points, columns, "Least processor time:")


def tables(benchmark: str, metrics: Metrics) -> list[dict[str, Any]]:
    """What of a benchmark is worth reading as numbers."""
    if benchmark == "precision":
        return [
            table(
                metrics["comparison"],
                {
                    "scene": "scene", "target_error": "error", "statics_seconds": "statics [s]",
                    "dynamics_seconds": "dynamics [s]", "lammps_seconds": "LAMMPS [s]",
                    "times_faster_than_lammps": "LAMMPS / statics",
                },
                "Least time to reach an error:",
            ),
        ]  # fmt: skip
    if benchmark == "nine_points":
        return [nine_points(metrics["points"])]
    if benchmark == "exactness":
        columns = {
            "what": "packings", "scenes": "scenes", "failed": "no equilibrium", "lost_by_the_path": "lost one",
            "lost_by_the_increments_alone": "lost by increments alone", "compared": "compared", "exact": "exact",
            "largest_error": "largest error", "median_error": "median",
        }  # fmt: skip
        names = {"slab": "the paper's slab", "small": "small", "slabs": "slabs"}
        return [table([{"what": what, **metrics[f"{key}_summary"]} for key, what in names.items()], columns)]
    if benchmark == "convergence":
        return [
            table(
                metrics["fits"],
                {
                    "friction": "friction", "force": "force",
                    "exponent_of_symmetric_difference": "exponent of the symmetric part",
                    "exponent_of_difference": "exponent of the difference",
                    "largest_asymmetry": "largest asymmetry",
                },
            )
        ]  # fmt: skip
    if benchmark == "trajectory":
        orders = [{**row, "integrator": name(row["integrator"])} for row in metrics["orders"]]
        return [table(orders, {"problem": "problem", "integrator": "integrator", "measured_order": "measured order"})]
    if benchmark == "kernel":
        return [
            table(
                metrics["runs"],
                {
                    "disks": "disks", "friction": "friction", "microseconds": "ours [µs/step]",
                    "lammps_microseconds": "LAMMPS [µs/step]", "over_lammps": "speed over LAMMPS",
                },
            ),
            table(
                [row for row in metrics["profile"] if row["microseconds"] is not None],
                {"friction": "friction", "part": "part of a step, 908 disks", "microseconds": "µs", "share": "share"},
                "Where a step goes:",
            ),
        ]  # fmt: skip
    if benchmark == "arena":
        columns = {
            "disks": "disks", "code": "code", "version": "version", "spread": "µs/step (worst round)",
            "times_ours": "times ours", "peak_mebibytes": "peak memory [MiB]",
        }  # fmt: skip
        rows = [{**row, "spread": spread(row, "processor_microseconds")} for row in metrics["runs"]]
        return [table(rows, columns, skipped("Microseconds per step", metrics))]
    if benchmark == "responses":
        errors = {key: f"to {key} [s]" for key in metrics["reached"][0] if key.startswith("1e-") or key[0] == "0"}
        columns = {"scene": "scene", "code": "code", **errors, "least_error": "least error"}
        words = skipped("Least time of the processor to an error", metrics)
        if metrics.get("not_run"):
            theirs = sum("steps" in row for row in metrics["runs"])
            count = f"{len(metrics['not_run'])} of {theirs + len(metrics['not_run'])}"
            words = f"{words.removesuffix(':')}; {count} runs were not made (`responses.json` names them):"
        return [table(metrics["reached"], columns, words)]
    if benchmark == "bounces":
        columns = {
            "code": "code", "version": "version", "from_ours_weak": "next to no dashpots: from ours",
            "from_ours_strong": "the paper's dashpots: from ours", "excess": "sliding disk: from the closed form",
            "at_angle": "at [°]",
        }  # fmt: skip
        words = "Largest differences of the energy kept, in parts of the energy before"
        return [table(metrics["compared"], columns, skipped(words, metrics))]
    if benchmark == "limits":
        columns = {
            "part": "part of a step", "friction": "friction", "operations": "operations",
            "divisions_and_roots": "of which divisions and roots", "bytes": "bytes", "microseconds": "µs",
            "gigaflops": "10⁹ operations/s", "gigabytes_per_second": "GB/s",
            "mix_microseconds": "loop of the same mix [µs]", "chain_microseconds": "in one chain [µs]",
            "ratio": "of the limit",
        }  # fmt: skip
        factors = {
            "method": "factorisation", "friction": "friction", "unknowns": "unknowns",
            "size": "half-width, largest front", "operations": "operations", "milliseconds": "ms",
            "gigaflops": "10⁹ operations/s", "product_gigaflops": "matrix product", "ratio": "of the product",
            "bare_ratio": "bare fronts, of the product", "bare_share": "their share of the time",
        }  # fmt: skip
        return [table(metrics["runs"], columns), table(metrics["factorisations"], factors, "Factorisations:")]
    if benchmark == "linear":
        return [
            factorisations(metrics, "factor_milliseconds", "Factorisation, ms"),
            factorisations(metrics, "solve_milliseconds", "Solution for one right-hand side, ms"),
        ]
    if benchmark == "shares":
        columns = {
            "what": "what", "seconds": "time [s]", "factorisations": "factorisations and solutions",
            "forces and tangents": "forces and tangents of contacts", "dynamics": "steps of dynamics",
            "matrices and arrays": "matrices and arrays", "the rest": "the rest",
        }  # fmt: skip
        return [table(metrics["runs"], columns)]
    if benchmark == "skipping":
        columns = {"part": "part", "friction": "friction", "cost": "cost", "same_result": "bitwise the same"}
        return [table(metrics["runs"], columns)]
    if benchmark == "scale":
        columns = {
            "method": "method", "disks": "disks", "layers": "layers", "threads": "threads", "seconds": "time [s]",
            "cpu_seconds": "processor [s]", "peak_gibibytes": "peak memory [GiB]",
            "force_residual": "largest unbalanced force [mg]",
        }  # fmt: skip
        return [table(metrics["runs"], columns)]
    if benchmark == "depth":
        columns = {
            "layers": "layers", "from_force": "from force [mg]", "to_force": "to force [mg]",
            "exponent_of_depth": "depth grows as the force to the power", "exponent_of_width": "width",
        }  # fmt: skip
        return [table(metrics["growth"], columns)]
    if benchmark == "startup":
        return [
            table(metrics["runs"], {"what": "process", "seconds": "time [s]", "processor_seconds": "processor [s]"})
        ]
    if benchmark == "pipeline":
        columns = {"group": "group", "simulate_seconds": "simulations [s]", "draw_seconds": "figures [s]"}
        sums = {"cores": "cores", "simulate_seconds": "simulations [s]", "draw_seconds": "figures [s]"}
        return [
            table(metrics["runs"], columns),
            table(metrics["totals"], sums, "Sum of the groups that draw the paper's figures or check its claims:"),
        ]
    return []


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
        above: str = "",
    ) -> None:  # fmt: skip
        """``above``: why ``value`` is a lower bound, which can show that a goal is met but not that it is missed."""
        if benchmark not in found:
            value = None
        goal = f"at least {form(least)}" if least is not None else f"at most {form(most)}"
        if value is None:
            rows.append({"what": what, "goal": goal, "measured": "not measured", "met": None, "on": ""})
        else:
            met = value >= least if least is not None else value <= most  # type: ignore[operator]
            said = f"over {form(value)} ({above})" if above else form(value)
            known = None if above and not met else bool(met)
            on = measured_on(found[benchmark])
            rows.append({"what": what, "goal": goal, "measured": said, "met": known, "on": on})

    def times(value: float | None) -> str:
        return f"{value:,.0f} times" if value is not None and value >= 20 else f"{value:.1f} times"

    kernel = found.get("kernel", {}).get("runs", [])
    friction = [row for row in kernel if row["friction"] > 0]
    row = next(iter(pick(friction, disks=908)), {})
    add("kernel", "Speed over LAMMPS, friction, 908 disks", row.get("over_lammps"), 10.0, None, times)
    row = max(friction, key=lambda row: row["disks"], default={})
    add("kernel", "The same, 100,000 disks", row.get("over_lammps"), 4.0, None, times)
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
    points = found.get("nine_points", {}).get("points", [])
    row = next(iter(pick(points, friction=0.2, force=15.0)), {})
    what = "Path from rest, friction 0.2, force 15, processor time"
    add("nine_points", what, row.get("path"), None, 0.15, lambda v: f"{v:.2g} s")
    runs = found.get("scale", {}).get("runs", [])
    for method, disks, limit, what in (
        ("path", 100_000, 60.0, "100,000 disks with friction"),
        ("minimise", 1_000_000, 480.0, "1,000,000 disks without"),
        ("path", 1_000_000, 3600.0, "1,000,000 disks with friction, prepared without"),
    ):
        row = next((row for row in runs if row["method"] == method and row["disks"] >= disks), {})
        add("scale", f"Response of {what}", row.get("seconds"), None, limit, seconds)
        memory = row.get("peak_gibibytes")
        add("scale", "Its memory", memory, None, 16.0, lambda v: f"{v:.2g} GiB")
    for method, what in (("minimise", "without friction"), ("path", "with friction")):
        row = next(iter(pick(found.get("scale", {}).get("exponents", []), method=method)), {})
        extent = f", {row['from_disks']:,} to {row['to_disks']:,}" if row else ""
        what = f"Processor time grows as the number of disks to the power, {what}{extent}"
        add("scale", what, row.get("exponent_of_cpu_seconds"), None, 1.5, lambda v: f"{v:.2f}")
    residuals = [row["force_residual"] for row in runs if row["method"] != "dynamics"]
    add(
        "scale", "Unbalanced force of static results", max(residuals, default=None), None, 1e-9, lambda v: f"{v:.1g} mg"
    )
    totals = (found.get("pipeline", {}).get("totals") or [{}])[0]
    value = totals["simulate_seconds"] + totals["draw_seconds"] if totals else None
    add("pipeline", "All of the paper's groups from nothing, 2 cores", value, None, 300.0, seconds)
    limits = found.get("limits", {})
    for key, what in (
        ("runs", "Slowest kernel of a step over a loop of the same mix of operations"),
        ("factorisations", "Slowest factorisation over the matrix product"),
    ):
        value = min((row["ratio"] for row in limits.get(key, [])), default=None)
        add("limits", what, value, 0.7, None, lambda v: f"{v:.2f}")
    startup = found.get("startup", {}).get("runs", [])
    for index, limit, what in (
        (0, 40.0, "Every kernel compiled and kept"),
        (2, 1.2, "`granular-response run`, default scene"),
    ):
        add("startup", what, startup[index]["seconds"] if startup else None, None, limit, seconds)
    return rows


def measured_on(metrics: Metrics) -> str:
    """Kinds of processors of a benchmark: those of its rows where they say one, else that of the file."""
    each = [row.get("measured_on") for row in metrics.get("runs", [])]
    found = each if any(each) else [metrics.get("measured_on")]
    return " and ".join(dict.fromkeys(name or "a processor that was not recorded" for name in found))


def text(found: dict[str, Metrics]) -> str:
    """The page."""
    parts = []
    for benchmark, (title, words) in TEXTS.items():
        metrics = found.get(benchmark)
        part = {"title": title, "text": words, "measured_on": "", "picture": None, "tables": []}
        if metrics is None:
            part["text"] += " Not measured yet: `make benchmark`."
        else:
            part["measured_on"] = measured_on(metrics)
            part["picture"] = benchmark if benchmark in pictures.DRAWN else None
            part["tables"] = tables(benchmark, metrics)
        parts.append(part)
    environment = Environment(
        loader=FileSystemLoader(HERE),
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
        autoescape=False,
        keep_trailing_newline=True,
    )
    page = environment.get_template("benchmarks.md.j2")
    return page.render(goals=goals(found), parts=parts, machine=found.get("machine"))


#: Goals that the README quotes, after what the arena has measured.
QUOTED = (
    "Response of 100,000 disks with friction",
    "Response of 1,000,000 disks without",
    "Response of 1,000,000 disks with friction, prepared without",
)

#: Errors of responses at which the README compares, by scene.
COMPARED = {
    "friction": ("0.0001", "friction 0.2, force 15, error 1e-4"),
    "frictionless": ("0.01", "no friction, force 4, error 1e-2"),
}


def over_others(found: dict[str, Metrics]) -> list[dict[str, str]]:
    """How many times faster than other codes, of one step and of a response; the fastest run of each code counts."""
    rows: list[dict[str, str]] = []
    steps = found.get("arena", {}).get("runs", [])
    for disks in dict.fromkeys(row["disks"] for row in steps):
        times: dict[str, float] = {}
        for row in pick(steps, disks=disks):
            code = family(row["code"])
            times[code] = min(times.get(code, float("inf")), row["times_ours"])
        said = ", ".join(f"{code} {value:.0f}" for code, value in times.items() if code != OURS)
        if said:
            what = f"A step of {disks:,} disks with friction, times ours"
            rows.append({"what": what, "measured": said, "on": measured_on(found["arena"])})
    for scene, (error, words) in COMPARED.items():
        least: dict[str, float] = {}
        for row in pick(found.get("responses", {}).get("reached", []), scene=scene):
            if row[error] is not None:
                code = family(row["code"])
                least[code] = min(least.get(code, float("inf")), row[error])
        said = ", ".join(f"{code} {value / least[OURS]:.0f}" for code, value in least.items() if code != OURS)
        if said:
            what = f"A response of 908 disks ({words}), times ours"
            rows.append({"what": what, "measured": said, "on": measured_on(found["responses"])})
    return rows


#: The name of this package among the codes.
OURS = "granular_response"


def family(code: str) -> str:
    """A code whatever its version and style."""
    return code.partition(", ")[0].removeprefix("newest ")


def quoted(found: dict[str, Metrics]) -> str:
    """The lines of the README."""
    rows = {row["what"]: row for row in goals(found)}
    lines = ["| | measured | processor |", "|---|---|---|"]
    quotes = [*over_others(found), *(rows[what] for what in QUOTED)]
    return "\n".join([*lines, *(f"| {row['what']} | {row['measured']} | {row['on']} |" for row in quotes)])


def main() -> None:
    found = read()
    for benchmark, draw in pictures.DRAWN.items():
        if benchmark in found:
            style.save(draw(found[benchmark]), benchmark, HERE / "figures", formats=("png",))
    write(str(HERE / "summary.json"), {"goals": goals(found)}, measured=False)
    atomic.write_bytes(HERE.parent / "docs" / "benchmarks.md", text(found).encode())
    generated.renew(HERE.parent / "README.md", "speed", quoted(found))


if __name__ == "__main__":
    main()
