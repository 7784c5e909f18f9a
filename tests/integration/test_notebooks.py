"""The notebooks of ``examples/notebooks`` are stored as they were executed, and one of them is executed again."""

from collections.abc import Iterator

import nbformat
import notebooks
import pytest
from nbformat import NotebookNode
from notebooks import NOTEBOOKS
from printed import rounded


def cells(notebook: NotebookNode) -> list[NotebookNode]:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def outputs(notebook: NotebookNode) -> Iterator[NotebookNode]:
    return (output for cell in cells(notebook) for output in cell.outputs)


def shown(notebook: NotebookNode) -> list[list[object]]:
    """What each cell shows: texts without digits of rounding errors, and the kinds of its pictures."""
    return [
        [
            rounded(output.text)
            if output.output_type == "stream"
            else {kind: rounded(data) if kind.startswith("text/") else "" for kind, data in output.data.items()}
            for output in cell.outputs
        ]
        for cell in cells(notebook)
    ]


def read(name: str) -> NotebookNode:
    (path,) = [path for path in NOTEBOOKS if path.stem == name]
    return nbformat.read(path, as_version=4)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_stored_notebook_was_executed_from_top_to_bottom(path):
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    assert [cell.execution_count for cell in cells(notebook)] == [*range(1, len(cells(notebook)) + 1)]
    assert all(cell.outputs for cell in cells(notebook)), "a cell shows nothing: make notebooks"
    kinds = {output.output_type for output in outputs(notebook)}
    assert kinds <= {"stream", "display_data", "execute_result"}  # no error
    assert not [output.text for output in outputs(notebook) if output.get("name") == "stderr"]  # no warning
    assert any(kind in output.get("data", {}) for output in outputs(notebook) for kind in ("image/png", "image/gif"))


@pytest.mark.parametrize("parts", [["\rworking: 1 of 2, 3 s \n"], ["\rworking: 1 of 2, 3 s ", "\n"]])
def test_a_line_of_progress_is_no_output_in_whatever_parts_it_comes(parts):
    cell = nbformat.v4.new_code_cell("")
    cell.outputs = [nbformat.v4.new_output("stream", name="stderr", text=part) for part in parts]
    assert notebooks.stripped(nbformat.v4.new_notebook(cells=[cell])).cells[0].outputs == []


def test_the_first_notebook_shows_again_what_is_stored():
    """Every text, and as many pictures, from a kernel of its own: two that are drawn, and that of a result."""
    stored = read("first_response")
    again = notebooks.executed(notebooks.FOLDER / "first_response.ipynb")
    assert shown(again) == shown(stored)
    assert sum("image/png" in output.get("data", {}) for output in outputs(again)) == 3
