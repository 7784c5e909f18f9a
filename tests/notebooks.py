"""The notebooks of ``examples/notebooks``, which are stored with their outputs.

``python tests/notebooks.py`` executes them anew, each in a process and a folder of its own.
"""

from __future__ import annotations

import os
import re
import tempfile
from pathlib import Path

import nbformat
from nbformat import NotebookNode
from places import ROOT, SOURCE

FOLDER = ROOT / "examples" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
#: Of a stored notebook; what Jupyter adds depends on the machine.
METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}
#: Of a cell, in seconds; the first one compiles.
LONGEST = 600


def executed(path: Path) -> NotebookNode:
    """A notebook with the outputs that its cells have now. Raises CellExecutionError."""
    from nbclient import NotebookClient  # a second, which every process that collects tests would pay

    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "IPYTHONDIR": f"{folder}/.ipython"}
        environment["PYTHONPATH"] = os.pathsep.join([str(SOURCE), os.environ.get("PYTHONPATH", "")])
        environment.pop("MPLBACKEND", None)  # the notebook's own
        client = NotebookClient(
            notebook,
            timeout=LONGEST,
            kernel_name="python3",
            resources={"metadata": {"path": folder}},
            record_timing=False,
            extra_arguments=["--log-level=ERROR"],
        )
        client.execute(env=environment)
    return stripped(notebook)


def stripped(notebook: NotebookNode) -> NotebookNode:
    """Without what differs from run to run: metadata, and lines of progress, which a fast machine does not show."""
    notebook.metadata = nbformat.from_dict(METADATA)
    for cell in notebook.cells:
        cell.metadata = NotebookNode()
        for output in cell.get("outputs", []):
            if "metadata" in output:
                output.metadata = NotebookNode()
            if output.get("name") == "stderr":
                output.text = re.sub(r"\r[^\r\n]*\n?|\A\n", "", output.text)  # the end may come by itself
        if "outputs" in cell:
            cell.outputs = [output for output in cell.outputs if output.get("text") != ""]
    return notebook


def main() -> None:
    for path in NOTEBOOKS:
        nbformat.write(executed(path), path)
        print(path.relative_to(ROOT), f"{path.stat().st_size / 1000:.0f} kB", flush=True)


if __name__ == "__main__":
    main()
