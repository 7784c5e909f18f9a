"""Documents name modules and files that exist."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_named_modules_and_links_exist(page):
    text = page.read_text(encoding="utf-8")
    modules = re.findall(r"`((?:src/granular_response/)?[a-z_]+/[a-z_/]+\.py)`", text)
    places = [ROOT, ROOT / "src" / "granular_response"]
    missing = [name for name in modules if not any((place / name).exists() for place in places)]
    links = re.findall(r"\]\((?!https?:|#|mailto:)([^)#]+)", text)
    missing += [link for link in links if not (page.parent / link).exists()]
    assert not missing
