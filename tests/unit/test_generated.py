"""Generated lines between markers: renewed, with the rest of the file left alone."""

import pytest

from granular_response.store import generated

TEXT = "before\n\n<!-- counts: begin -->\nold\nlines\n<!-- counts: end -->\n\nafter\n"


def test_lines_are_renewed(tmp_path):
    path = tmp_path / "notes.md"
    path.write_text(TEXT)
    generated.renew(path, "counts", "new")
    assert path.read_text() == TEXT.replace("old\nlines", "new")


def test_nothing_is_written_if_nothing_changes(tmp_path):
    path = tmp_path / "notes.md"
    path.write_text(TEXT)
    before = path.stat()
    generated.renew(path, "counts", "old\nlines")
    assert (path.stat().st_mtime_ns, path.stat().st_ino) == (before.st_mtime_ns, before.st_ino)


@pytest.mark.parametrize(
    "text",
    [
        "nothing",
        TEXT + TEXT,
        TEXT.replace("begin", "end"),
        "<!-- counts: end -->\n<!-- counts: begin -->",
        TEXT.replace("counts", "others"),
    ],
)
def test_a_file_without_a_place_is_left_alone(tmp_path, text):
    path = tmp_path / "notes.md"
    path.write_text(text)
    with pytest.raises(generated.GeneratedError, match=r"notes\.md: the lines <!-- counts: begin --> and") as caught:
        generated.renew(path, "counts", "new")
    assert "\n" not in str(caught.value)
    assert path.read_text() == text


@pytest.mark.parametrize("content", [None, b"\xff\xfe\x00"])
def test_a_file_that_cannot_be_read_is_one_line(tmp_path, content):
    path = tmp_path / "notes.md"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(generated.GeneratedError, match=r"notes\.md: ") as caught:
        generated.renew(path, "counts", "new")
    assert "\n" not in str(caught.value)
