"""Examples in the docstrings of the public namespace run, and there is one in each."""

import doctest
import inspect

import matplotlib.pyplot as plt
import pytest

import granular_response as gr

#: Classes whose methods a user calls.
USED = {"Events", "LaboratoryUnits", "Result", "Scene"}


def public() -> dict[str, object]:
    """Functions, classes and their methods, but for errors, by name."""
    found = {}
    for name in set(gr.__all__) - {"__version__", "plot"}:
        value = getattr(gr, name)
        if not (inspect.isclass(value) and issubclass(value, Exception)):
            found[name] = value
        if name in USED:
            methods = {key: getattr(one, "__func__", one) for key, one in vars(value).items() if key[0] != "_"}
            found |= {f"{name}.{key}": one for key, one in methods.items() if callable(one)}
            shown = {key: one for key, one in methods.items() if ">>>" in (inspect.getdoc(one) or "")}
            found |= {f"{name}.{key}": one for key, one in shown.items()}
    found |= {f"plot.{name}": getattr(gr.plot, name) for name in gr.plot.__all__}
    named = {name: getattr(gr.studies, name) for name in gr.studies.__all__}
    named = {name: one for name, one in named.items() if callable(one) and name not in gr.__all__}
    methods = {f"LoadPath.{name}": getattr(gr.studies.LoadPath, name) for name in ("of", "at", "through", "first")}
    return found | {f"studies.{name}": one for name, one in (named | methods).items()}


@pytest.fixture(scope="module")
def result():
    return gr.solve(gr.Scene(packing=gr.Slab(layers=4, disks_per_row=9)))


@pytest.mark.parametrize("name", sorted(public()))
def test_the_example_runs(name, result, tmp_path, monkeypatch):
    value = public()[name]
    names = {"gr": gr, "result": result, "units": gr.LaboratoryUnits()}
    (tmp_path / "examples").mkdir()
    (tmp_path / "examples" / "slab.yaml").write_text(result.scene.to_yaml())
    monkeypatch.chdir(tmp_path)
    examples = doctest.DocTestParser().get_doctest(inspect.getdoc(value) or "", names, name, None, 0)
    assert examples.examples, f"{name} has no example"
    said: list[str] = []
    doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(examples, out=said.append)
    plt.close("all")
    assert not said, "".join(said)
