"""The pinned versions, and what the packages declare that they need."""

import ast
import sys
import tomllib
from importlib import metadata
from itertools import chain

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.version import Version
from places import ROOT


def test_pinned_versions_run_on_every_python_that_is_promised():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    (promised,) = SpecifierSet(project["requires-python"])
    first = Version(f"{promised.version}.0")
    pinned = [line for line in (ROOT / "requirements.lock").read_text().splitlines() if not line.startswith("#")]
    seen = 0
    for requirement in map(Requirement, pinned):
        try:
            wanted = metadata.metadata(requirement.name).get("Requires-Python")
        except metadata.PackageNotFoundError:
            continue
        seen += 1
        assert first in SpecifierSet(wanted or ""), f"{requirement} asks for Python {wanted}"
    assert seen > 100


#: Where each package stands, its own project file, and the extras that `make setup` installs with it.
PACKAGES = {
    "src/granular_response": ("pyproject.toml", ("export", "dask", "pipeline")),
    "src/granular_response_paper": ("src/granular_response_paper/pyproject.toml", ()),
    "extensions/src/granular_response_extensions": ("extensions/pyproject.toml", ()),
}


def _imported(folder):
    """Top-level names of the packages that the modules of a folder import, also within functions."""
    for path in (ROOT / folder).rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                yield from (alias.name.partition(".")[0] for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and not node.level:
                yield node.module.partition(".")[0]


def test_every_package_declares_what_it_imports():
    # so `make setup` without the tools of development has all that `make reproduce` needs
    of = metadata.packages_distributions()
    needed = set()
    for folder, (file, extras) in PACKAGES.items():
        project = tomllib.loads((ROOT / file).read_text())["project"]
        lists = project["dependencies"], *(project["optional-dependencies"][extra] for extra in extras)
        needed |= {Requirement(one).name.lower().replace("_", "-") for one in chain.from_iterable(lists)}
        found = set(_imported(folder)) - {*sys.stdlib_module_names, folder.rpartition("/")[2]}
        assert "numpy" in found
        missing = {
            name for name in found if not {one.lower().replace("_", "-") for one in of.get(name, [name])} & needed
        }
        assert not missing, f"{file} does not declare {', '.join(sorted(missing))}"
