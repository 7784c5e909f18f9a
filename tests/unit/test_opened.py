"""Datasets opened from a checkout and from an archive of it, if they are those of its lock."""

import hashlib
import json
import zipfile

import numpy as np
import pytest
import xarray as xr
from refusals import refuses

from granular_response.store import files as store
from granular_response.store.variables import variable
from granular_response_paper.archive import ArchiveError, lock, opened

PIPELINE = """\
stages:
  simulate:
    foreach: [influence]
    do: {cmd: "simulate ${item}", deps: [survey/data], outs: ["data/${item}.nc"]}
"""
FIGURES, SURVEYED = "data/influence.nc", "survey/data/delta_10.nc"


@pytest.fixture
def checkout(tmp_path):
    root = tmp_path / "checkout"
    for folder in ("data", "survey/data"):
        (root / folder).mkdir(parents=True)
    case = {"friction": variable("case", [0.2, 0.0], "friction"), "x": variable("case", [1.0, 2.0], "number")}
    store.write(root / FIGURES, {"packings": xr.Dataset(case)})
    store.write(root / SURVEYED, {"ensembles": xr.Dataset(case), "packings": xr.Dataset(case)})
    entries = {path: {"path": path, "md5": lock.md5(root, path), "size": 1} for path in ("survey/data", FIGURES)}
    stage = {"cmd": "simulate", "deps": [entries["survey/data"]], "outs": [entries[FIGURES]]}
    (root / lock.LOCK).write_text(json.dumps({"schema": "2.0", "stages": {"simulate@influence": stage}}))
    (root / lock.PIPELINE).write_text(PIPELINE)
    return root


@pytest.fixture
def archive(checkout, tmp_path):
    path = tmp_path / "all.zip"
    with zipfile.ZipFile(path, "w") as file:
        for name in (lock.LOCK, lock.PIPELINE, FIGURES, SURVEYED):
            file.write(checkout / name, name)
    return path


def test_what_there_is_has_description_dimensions_and_checksum(checkout, archive):
    for source in (str(checkout), str(archive), archive.as_uri()):
        one, other = opened.listed(source)
        assert (one.path, other.path) == (FIGURES, SURVEYED)
        assert one.description.startswith("Where a packing is most sensitive")
        assert other.description == "Survey: Ensembles of slabs, friction 0, 0.2"
        assert one.dimensions == {"packings": {"case": 2}}
        assert list(other.dimensions) == ["ensembles", "packings"]
        assert other.md5 == hashlib.md5((checkout / SURVEYED).read_bytes()).hexdigest()


def test_datasets_are_the_same_from_checkout_and_archive(checkout, archive):
    for path in (FIGURES, SURVEYED):
        for source in (archive, archive.as_uri()):
            found = opened.load(path, str(source))
            wanted = opened.load(path, str(checkout))
            assert list(found) == list(wanted)
            for name, data in wanted.items():
                xr.testing.assert_identical(found[name], data)
                assert np.array_equal(data["x"], [1.0, 2.0])


def test_mistakes_are_named(checkout, tmp_path):
    with pytest.raises(ArchiveError, match=r"data/pile.nc: is no dataset of .*, must be one of data/influence.nc"):
        opened.load("data/pile.nc", str(checkout))
    refuses(ArchiveError, "no archive that can be read", opened.listed, str(tmp_path / "nothing.zip"))
    refuses(ArchiveError, "cannot be downloaded", opened.listed, (tmp_path / "nothing.zip").as_uri())
