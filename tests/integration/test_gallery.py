"""Every example of the gallery runs, at a reduced size, and draws what it promises."""

import ast
from pathlib import Path

import matplotlib.pyplot as plt
import pytest
from places import ROOT

SCRIPTS = sorted((ROOT / "examples" / "gallery").glob("*.py"))

SMALL = {"LAYERS": 5, "DISKS": 9}
#: What each script has at its top, smaller.
REDUCED = {
    "dask_ensemble": {"LAYERS": 3, "DISKS": 7, "REALIZATIONS": 2, "WORKERS": 1},
    "displacement": SMALL,
    "crossover": {**SMALL, "LOW": 0.05, "HIGH": 8.0},
    "elastic_slab": SMALL,
    "first_response": SMALL,
    "growing_load": {**SMALL, "FORCES": [0.5, 1.0, 1.5, 2.0]},
    "hysteresis": {**SMALL, "FORCE": 3.0},
    "overview": {**SMALL, "FORCES": [0.5, 2.0]},
    "own_packing": {"ROWS": 3, "COLUMNS": 6},
    "poured": {"DISKS": 30, "WIDTH": 12.0},
    "periodic_slab": {"LAYERS": 3, "DISKS": 8},
    "photoelastic": {**SMALL, "FORCE": 5.0},
    "stress_map": SMALL,
    "sweep": {"LAYERS": 3, "DISKS": 7, "REALIZATIONS": 2},
    "to_ovito": SMALL,
}


def run(script: Path, values: dict) -> dict:
    """The names of a script after it has run with other values for the constants at its top."""
    tree, changed = ast.parse(script.read_text(encoding="utf-8")), set()
    for node in tree.body:
        if not isinstance(node, ast.Assign):
            continue
        target = node.targets[0]
        names = [getattr(name, "id", None) for name in (target.elts if isinstance(target, ast.Tuple) else [target])]
        for k, name in enumerate(names):
            if name in values:
                changed.add(name)
                new = ast.parse(repr(values[name]), mode="eval").body
                if isinstance(target, ast.Tuple):
                    node.value.elts[k] = new
                else:
                    node.value = new
    assert changed == set(values)
    names = {"__name__": "__main__"}  # as when a user runs it
    exec(compile(ast.fix_missing_locations(tree), str(script), "exec"), names)
    return names


@pytest.fixture
def figures():
    plt.close("all")
    yield lambda: [plt.figure(number) for number in plt.get_fignums()]
    plt.close("all")


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_an_example_runs_and_draws(script, figures, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    names = run(script, REDUCED[script.stem])
    drawn = figures()
    assert drawn and all(figure.axes for figure in drawn)
    for figure in drawn:
        figure.canvas.draw()  # layout and texts too
    if "result" in names:
        assert names["result"].certificate.force_residual < 1e-8
    assert not list(tmp_path.glob("*.nc"))  # what an example writes goes to a folder of its own
