"""The pinned versions."""

import tomllib
from importlib import metadata

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
