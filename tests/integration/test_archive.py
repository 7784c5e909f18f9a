"""The reproduction as one file, and back: a small project that DVC itself has run."""

import hashlib
import json
import os
import shutil
import stat
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from commands import refused, succeeded
from places import ROOT
from refusals import refuses

from granular_response_paper.archive import ArchiveError, crate, lock
from granular_response_paper.archive.restore import restore

SCRIPT = """\
import pathlib
import sys

for name in ("data", "figures/a"):
    pathlib.Path(name).mkdir(parents=True, exist_ok=True)
seed = pathlib.Path("params.yaml").read_text()
pathlib.Path("data/a.nc").write_bytes(seed.encode() * 1000)
pathlib.Path("figures/a/one.png").write_text("one" + seed)
pathlib.Path("figures/a/two.pdf").write_text("two")
pathlib.Path("runs").open("a").write("x")
"""
PIPELINE = """\
stages:
  simulate:
    cmd: {python} source/make.py
    deps: [source, LICENSE]
    params: [group]
    outs:
      - data/a.nc
      - figures/a: {{cache: false}}
"""


def dvc(folder: Path, *arguments: str) -> str:
    environment = {**os.environ, "DVC_NO_ANALYTICS": "1", "DVC_SITE_CACHE_DIR": str(folder.parent / "site")}
    command = [sys.executable, "-m", "dvc", *arguments]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment)
    assert run.returncode == 0, run.stdout + run.stderr
    return run.stdout


@pytest.fixture(scope="module")
def project(tmp_path_factory) -> Path:
    pytest.importorskip("dvc")
    folder = tmp_path_factory.mktemp("project") / "checkout"
    (folder / "source" / "__pycache__").mkdir(parents=True)
    for name in set(crate.ALSO) - {lock.LOCK}:
        shutil.copy(ROOT / name, folder)
    shutil.copy(ROOT / ".dvcignore", folder)
    (folder / "source" / "make.py").write_text(SCRIPT)
    (folder / "source" / "make-2.py").write_text("")  # where the order of names and that of paths differ
    (folder / "source" / "make").mkdir()
    (folder / "source" / "make" / "part.py").write_text("")
    (folder / "source" / "__pycache__" / "make.pyc").write_text("no part of it")
    (folder / "params.yaml").write_text("group: {force: 1.0e-3, steps: [1, 2]}\nother: {}\n")
    (folder / "dvc.yaml").write_text(PIPELINE.format(python=sys.executable))
    dvc(folder, "init", "--no-scm", "-q")
    dvc(folder, "repro")
    return folder


@pytest.fixture
def archived(project, tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    path = tmp_path / "all.zip"
    crate.write(path, project)
    return path


@pytest.fixture
def checkout(project, tmp_path) -> Path:
    """What a clone has: all but datasets and the cache."""
    folder = tmp_path / "clone"
    shutil.copytree(project, folder, ignore=shutil.ignore_patterns("data", "cache", "tmp", "runs"))
    return folder


def test_the_archive_is_a_crate_that_says_how_everything_was_made(archived):
    rocrate = pytest.importorskip("rocrate.rocrate")
    found = rocrate.ROCrate(archived)
    (action,) = [entity for entity in found.contextual_entities if entity.type == "CreateAction"]
    assert action["name"] == "simulate" and action["description"].endswith("source/make.py")
    assert found.root_dataset["mentions"] == [action] and action["instrument"]["name"] == "granular-response"
    read, written = ({entity["name"]: entity for entity in action[key]} for key in ("object", "result"))
    assert set(read) == {"source", "LICENSE", "params.yaml", "group"}
    assert json.loads(read["group"]["value"]) == {"force": 1e-3, "steps": [1, 2]}
    assert set(written) == {"a.nc", "figures/a"} and written["figures/a"]["md5"].endswith(".dir")
    with zipfile.ZipFile(archived) as file:
        for entity in found.data_entities:
            if entity.type == "File":
                content = file.read(entity.id)
                assert (hashlib.md5(content).hexdigest(), str(len(content))) == (entity["md5"], entity["contentSize"])
        assert {entity.id for entity in found.data_entities if entity.type == "File"} | {crate.METADATA} == set(
            file.namelist()
        )
    assert found.root_dataset["datePublished"].startswith("2023-11-14")
    assert found.root_dataset["author"][0]["name"] == "The granular-response authors"


def test_the_same_files_give_the_same_bytes(project, archived, tmp_path):
    os.utime(project / "params.yaml", (0, 0))
    crate.write(tmp_path / "again.zip", project)
    assert (tmp_path / "again.zip").read_bytes() == archived.read_bytes()


@pytest.mark.parametrize(
    ("path", "content", "said"),
    [
        ("data/a.nc", "other", r"data/a\.nc: is not what stage simulate had"),
        ("source/make.py", "pass", r"source: is not what stage simulate had"),
        ("params.yaml", "group: {force: 2.0, steps: [1, 2]}", r"params\.yaml: group is not what stage simulate had"),
        ("figures/a/one.png", None, r"figures/a: is not what stage simulate had"),
        ("CITATION.cff", None, r"CITATION\.cff: is missing"),
        ("dvc.lock", "stages: {}", r"dvc\.lock: stage simulate has not been run"),
        ("dvc.lock", "stages: {simulate: {cmd: x, outs: [{path: a}]}}", r"dvc\.lock: is not a lock file of DVC 3"),
    ],
)
def test_only_what_the_lock_says_is_archived(project, tmp_path, path, content, said):
    folder = tmp_path / "checkout"
    shutil.copytree(project, folder)
    (folder / path).unlink() if content is None else (folder / path).write_text(content)
    (tmp_path / "all.zip").write_text("as it was")
    refuses(ArchiveError, said, crate.write, tmp_path / "all.zip", folder)
    assert (tmp_path / "all.zip").read_text() == "as it was"


def test_restored_datasets_are_up_to_date_without_a_run(project, archived, checkout):
    assert "data" in dvc(checkout, "status")
    assert restore(archived, checkout) == ["data/a.nc"]
    assert (checkout / "data" / "a.nc").read_bytes() == (project / "data" / "a.nc").read_bytes()
    dvc(checkout, "commit", "simulate")  # into DVC's cache, as make restore does
    assert "up to date" in dvc(checkout, "status")
    assert "didn't change" in dvc(checkout, "repro") and not (checkout / "runs").exists()
    assert restore(archived, checkout) == []


def test_a_dataset_that_stands_there_stays(archived, checkout):
    (checkout / "data").mkdir()
    (checkout / "data" / "a.nc").write_text("an experiment")
    with pytest.raises(ArchiveError, match=r"a\.nc: is there already and is not the one of dvc\.lock; move it away"):
        restore(archived, checkout)
    assert (checkout / "data" / "a.nc").read_text() == "an experiment"


def planted(archived: Path, path: Path, *members, without="") -> Path:
    """The archive with other or further members: each a name, a content and the attributes of a file."""
    with zipfile.ZipFile(archived) as old, zipfile.ZipFile(path, "w") as new:
        for info in old.infolist():
            if info.filename != without:
                new.writestr(info, old.read(info))
        for name, content, mode in members:
            info = zipfile.ZipInfo("x")
            info.filename, info.external_attr = name, mode << 16
            new.writestr(info, content)
    return path


FILE = stat.S_IFREG | 0o644


@pytest.mark.parametrize(
    ("member", "said"),
    [
        (("data/a.nc", b"another state", FILE), r"data/a\.nc: is not the one of dvc\.lock"),
        (("data/a.nc", b"\0" * 10**7, FILE), r"data/a\.nc: is not the one of dvc\.lock"),
        (("data/b.nc", b"", FILE), r"holds no data/a\.nc"),
    ],
)
def test_archives_that_are_not_to_be_trusted_are_refused(archived, checkout, tmp_path, member, said):
    bad = planted(archived, tmp_path / "bad.zip", member, without="data/a.nc")
    before = sorted(checkout.rglob("*"))
    refuses(ArchiveError, said, restore, bad, checkout)
    assert sorted(checkout.rglob("*")) == before


def test_members_that_the_lock_does_not_name_are_left_where_they_are(archived, checkout, tmp_path):
    names = ("/etc/passwd", "data/../../x", "C:\\x", "data\\..\\x", "pipe")
    further = [(name, b"", FILE) for name in names] + [("data", b"/etc", stat.S_IFLNK | 0o777)]
    before = set(tmp_path.rglob("*"))
    assert restore(planted(archived, tmp_path / "bad.zip", *further), checkout) == ["data/a.nc"]
    made = {tmp_path / "bad.zip", checkout / "data", checkout / "data" / "a.nc"}
    assert set(tmp_path.rglob("*")) - before == made and (checkout / "data" / "a.nc").is_file()


@pytest.mark.parametrize("damage", ["cut", "bytes", "text"])
def test_damaged_archives_are_refused(archived, checkout, tmp_path, damage):
    content = bytearray(archived.read_bytes())
    with zipfile.ZipFile(archived) as file:
        middle = file.getinfo("data/a.nc").header_offset + 200
    content[middle] ^= 1
    path = tmp_path / "bad.zip"
    path.write_bytes({"cut": content[: len(content) // 2], "bytes": content, "text": b"no archive"}[damage])
    refuses(ArchiveError, "is no zip file, or a damaged one", restore, path, checkout)
    assert not (checkout / "data").exists()


def test_the_command_line_says_it_in_one_line(archived, checkout):
    assert str(checkout / "data" / "a.nc") in succeeded("restore", archived, "--root", checkout)
    for archive, said in ((checkout / "LICENSE", "is no zip file"), (checkout / "none.zip", "No such file")):
        assert said in refused("restore", archive, "--root", checkout)
