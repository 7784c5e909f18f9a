"""All that the reproduction consists of as one RO-Crate: a zip file that says what is in it and how it was made.

Each stage of the pipeline is an action in the vocabulary of Process Run Crate (https://w3id.org/ro/wfrun/process): its
command, what it read, with parameters and hashes, and what it wrote. The same files give the same bytes.
"""

from __future__ import annotations

import io
import json
import os
import re
import subprocess
import zipfile
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

from granular_response.store import atomic
from granular_response_paper.archive import ArchiveError, lock
from granular_response_paper.archive.lock import Item, Stage

if TYPE_CHECKING:
    from rocrate.rocrate import ROCrate

#: Description of the software, in its own words.
SOFTWARE = "codemeta.json"

#: Beside what the stages name: how to run them, what they ran with, how to cite, and what a reader opens first.
ALSO = (lock.PIPELINE, lock.LOCK, "params.yaml", "requirements.lock", SOFTWARE, "CITATION.cff", "LICENSE", "README.md")

METADATA = "ro-crate-metadata.json"
PROFILE = "https://w3id.org/ro/wfrun/process/0.5"
CONTEXT = "https://w3id.org/ro/terms/workflow-run/context"

#: Media types by the ending of a name; a system's own table would differ from the next one's.
FORMATS = {
    ".cff": "application/yaml",
    ".csv": "text/csv",
    ".gif": "image/gif",
    ".html": "text/html",
    ".json": "application/json",
    ".lock": "text/plain",
    ".md": "text/markdown",
    ".nc": "application/netcdf",
    ".pdf": "application/pdf",
    ".png": "image/png",
    ".py": "text/x-python",
    ".yaml": "application/yaml",
}


def write(output: Path, root: Path = Path(".")) -> list[str]:
    """Archive the project below ``root``; returns the paths that the archive holds.

    Raises ArchiveError if a file is missing or is not the one that ``dvc.lock`` names, or there is no package
    ``rocrate``; OSError if the archive cannot be written, or would replace one of the files in it.
    """
    stages = lock.stages(root)
    items = sorted({item for stage in stages for item in (*stage.read, *stage.written)}, key=lambda item: item.path)
    inside = {item.path: lock.files(root, item.path) for item in items}
    names = sorted({*ALSO, *(name for found in inside.values() for name in found)})
    for name in names:
        lock.files(root, name)
    output.parent.mkdir(parents=True, exist_ok=True)
    atomic.check_writable(output, [root / name for name in names])
    lock.check(root, stages)
    metadata = _metadata(root, stages, items, names, inside)
    atomic.write_bytes(output, _zipped(root, names, metadata))
    return names


def _zipped(root: Path, names: Sequence[str], metadata: bytes) -> bytes:
    """Without clock times and owners, and not packed: what is large is packed by itself."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name in (METADATA, *names):
            member = zipfile.ZipInfo(name)  # of 1980, as long as nothing else is said
            member.create_system, member.external_attr = 3, 0o100644 << 16
            archive.writestr(member, metadata if name == METADATA else (root / name).read_bytes())
    return buffer.getvalue()


def _metadata(
    root: Path, stages: Sequence[Stage], items: Sequence[Item], names: Sequence[str], inside: dict[str, list[str]]
) -> bytes:
    try:
        from rocrate.model.contextentity import ContextEntity
        from rocrate.rocrate import ROCrate
    except ModuleNotFoundError as error:
        raise ArchiveError(f"needs the package {error.name}, install granular-response-paper[archive]") from error
    crate = ROCrate(version="1.1")
    crate.metadata.extra_contexts.append(CONTEXT)

    def entity(identifier: str, properties: dict[str, Any]) -> Any:
        return crate.get(identifier) or crate.add(ContextEntity(crate, identifier, properties=properties))

    software = _describe(crate, root, entity)
    hashes = {item.path: item for item in items}
    entities = {
        name: crate.add_file(root / name, name, properties=_file(root, name, hashes.get(name))) for name in names
    }
    for path, found in inside.items():
        if hashes[path].folder:
            parts = [{"@id": entities[name].id} for name in found]
            properties = {"name": path, "hasPart": parts, "md5": hashes[path].md5}
            entities[path] = crate.add_dataset(root / path, f"{path}/", properties=properties)
    actions = []
    for stage in stages:
        read = [entities[item.path] for item in stage.read]
        for file, values in stage.parameters.items():
            read.append(entities[file])
            for key, value in values.items():
                properties = {"@type": "PropertyValue", "name": key, "value": json.dumps(value, ensure_ascii=False)}
                read.append(entity(_anchor(f"{file}/{key}"), properties))
        written = [entities[item.path] for item in stage.written]
        about = {"name": stage.name, "description": stage.command}
        actions.append(crate.add_action(software, _anchor(stage.name), object=read, result=written, properties=about))
    crate.root_dataset["mentions"] = actions
    return (json.dumps(crate.metadata.generate(), indent=1, ensure_ascii=False) + "\n").encode()


def _file(root: Path, name: str, item: Item | None) -> dict[str, Any]:
    path = PurePosixPath(name)
    found = {"name": path.name, "contentSize": str((root / name).stat().st_size)}
    found["md5"] = item.md5 if item else lock.md5(root, name)
    return found | ({"encodingFormat": FORMATS[path.suffix]} if path.suffix in FORMATS else {})


def _describe(crate: ROCrate, root: Path, entity: Callable[[str, dict[str, Any]], Any]) -> Any:
    """Name, licence, authors and paper from codemeta.json; returns the software, with which every stage was run."""
    try:
        known = json.loads((root / SOFTWARE).read_text(encoding="utf-8"))
        authors = [entity(_anchor(author["name"]), dict(author)) for author in known["author"]]
        paper = dict(known["referencePublication"])
        written_by = [
            entity(_anchor(f"{author['givenName']} {author['familyName']}"), dict(author)) for author in paper["author"]
        ]
        article = entity(paper["url"], {**paper, "author": written_by})
        of_software = {
            "@type": "SoftwareApplication",
            "name": known["name"],
            "description": known["description"],
            "softwareVersion": known["version"],
            "license": known["license"],
            "author": authors,
            "citation": article,
        }
        software = entity(_anchor(known["name"]), of_software)
        crate.name = f"{known['name']} {known['version']}: datasets, figures and claims"
        crate.description = known["description"]
        crate.keywords = known["keywords"]
        crate.license = entity(known["license"], {"@type": "CreativeWork", "name": known["license"].rpartition("/")[2]})
    except (ValueError, KeyError, TypeError) as error:
        raise ArchiveError(f"{root / SOFTWARE}: is not a description of software: {error!r}") from None
    crate.creator = authors
    crate.root_dataset["author"] = authors
    crate.root_dataset["citation"] = article
    crate.root_dataset["datePublished"] = _date(root)
    profile = {"@type": "CreativeWork", "name": "Process Run Crate", "version": PROFILE.rpartition("/")[2]}
    crate.root_dataset["conformsTo"] = entity(PROFILE, profile)
    return software


def _anchor(name: str) -> str:
    return "#" + re.sub(r"[^\w.@/-]+", "-", name).strip("-")


def _date(root: Path) -> str:
    """When the results were recorded: the commit of ``dvc.lock``, or the time of that file without a repository.

    SOURCE_DATE_EPOCH takes precedence.
    """
    given = os.environ.get("SOURCE_DATE_EPOCH", "")
    if not given:
        command = ["git", "-C", str(root), "log", "-1", "--format=%ct", "--", lock.LOCK]
        try:
            given = subprocess.run(command, capture_output=True, text=True).stdout.strip()
        except OSError:
            given = ""
    seconds = int(given) if given.isdecimal() else int((root / lock.LOCK).stat().st_mtime)
    return datetime.fromtimestamp(seconds, UTC).isoformat()
