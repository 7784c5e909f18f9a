"""Time and memory of whole `granular-response run` processes against the number of disks.

`python benchmarks/scale.py OUTPUT.json [--most DISKS] [--threads N] [--only METHOD LAYERS]` solves ordered slabs four
times as wide as deep, from nothing to a stored result: without friction by minimisation, with friction 0.2 by statics
alone (a rest state prepared without friction, then the load path), and for comparison by explicit dynamics, whose cost
grows as the square of the number of disks. Stiffness grows with layers times disks per row, so that every slab keeps
its order under gravity. Slabs of more than ``--most`` disks, and all but that of ``--only``, keep the rows that
OUTPUT.json has for them. Kernels are compiled beforehand; large slabs take all cores unless ``--threads`` says fewer.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from timing import power, process, processor, stored, write

from granular_response.machine.threads import cores
from granular_response.scene import Scene
from granular_response.store import files as store

#: layers and disks in the bottom row
SLABS = [(15, 61), (30, 121), (60, 241), (120, 481), (160, 641), (240, 961), (500, 2001)]
#: friction, force in disk weights, and layers of the largest slab that is tried
METHODS: dict[str, dict[str, float]] = {
    "minimise": {"friction": 0.0, "force": 5.0, "layers": 500},
    "path": {"friction": 0.2, "force": 15.0, "layers": 500},
    "dynamics": {"friction": 0.2, "force": 15.0, "layers": 30},
}
ASPECT_STIFFNESS = 3000.0 / (15 * 61)


def scene(layers: int, per_row: int, method: str, friction: float, force: float) -> Scene:
    """The slab for one run."""
    return Scene.from_dict(
        {
            "packing": {"kind": "slab", "layers": layers, "disks_per_row": per_row},
            "contact": {"normal_stiffness": ASPECT_STIFFNESS * layers * per_row, "friction": friction},
            "loads": [{"disk": {"row": "top"}, "force": [0.0, -force]}],
            "preparation": {"gravity": "at-once" if method == "dynamics" else "frictionless"},
            "protocol": {"method": "dynamics" if method == "dynamics" else "auto", "time_step": "auto"},
        }
    )


def measure(layers: int, per_row: int, method: str, friction: float, force: float, threads: int) -> dict:
    """One process: its wall-clock and CPU seconds, its peak memory, and the certificate of what it stored."""
    described = scene(layers, per_row, method, friction, force)
    with tempfile.TemporaryDirectory() as folder:
        file, result = Path(folder, "scene.yaml"), Path(folder, "result.nc")
        file.write_text(described.to_yaml(), encoding="utf-8")
        command = [sys.executable, "-m", "granular_response", "run", str(file), "-o", str(result)]
        command += ["--threads", str(threads)]
        used = process(command)
        data = store.read(result)[""]
        size = result.stat().st_size
    return {
        "measured_on": processor(),
        "method": method,
        "threads": threads,
        "layers": layers,
        "disks": int(data.sizes["disk"]),
        "friction": friction,
        "force": force,
        "normal_stiffness": described.contact.normal_stiffness,
        **used,
        "result_mebibytes": size / 2**20,
        "force_residual": float(data["certificate_force_residual"].max()),
        "negative_modes": int(data["certificate_negative_modes"].max()),
        "sum_of_response": float(data["floor_response"].sum()),
    }


def exponents(rows: list[dict]) -> list[dict]:
    """Slopes of log time and log memory against log N.

    Over slabs of more than 10,000 disks, since with fewer a process spends its time on starting, and on the processor
    of the last measurement alone.
    """
    found = []
    rows = [row for row in rows if row.get("measured_on") == processor()]
    for method in dict.fromkeys(row["method"] for row in rows):
        of = [row for row in rows if row["method"] == method]
        large = [row for row in of if row["disks"] > 10_000] if method != "dynamics" else of
        if len(large) > 1:
            n = [row["disks"] for row in large]
            entry = {"method": method, "from_disks": n[0], "to_disks": n[-1]}
            for key in ("seconds", "cpu_seconds", "peak_gibibytes"):
                entry[f"exponent_of_{key}"] = power(n, [row[key] for row in large])
            found.append(entry)
    return found


def main(path: str, most: int, threads: int, only: tuple[str, int] | None) -> None:
    known = {(row["method"], row["layers"]): row for row in stored(path)}
    for method, settings in METHODS.items():  # compiles
        for layers, per_row in ((8, 25),) if method == "dynamics" else ((8, 25), (45, 181)):  # bands and fronts
            measure(layers, per_row, method, settings["friction"], 1.0, 1)
    asked = [(method, *slab) for slab in SLABS for method in METHODS if slab[0] <= METHODS[method]["layers"]]
    for method, layers, per_row in asked:
        if layers * per_row > most or only not in (None, (method, layers)):
            continue
        settings = METHODS[method]
        row = measure(layers, per_row, method, settings["friction"], settings["force"], threads)
        print(row, flush=True)
        known[method, layers] = row
        # after every run: the last ones take long
        rows = [known[one[:2]] for one in asked if one[:2] in known]
        write(path, {"exponents": exponents(rows), "runs": rows})


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("output")
    parser.add_argument("--most", type=int, default=10**9)
    parser.add_argument("--threads", type=int, default=cores())
    parser.add_argument("--only", nargs=2, metavar=("METHOD", "LAYERS"))
    given = parser.parse_args()
    main(given.output, given.most, given.threads, given.only and (given.only[0], int(given.only[1])))
