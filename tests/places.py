"""Folders that tests read from."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "src"
#: What other programs and earlier versions have written.
DATA = ROOT / "tests" / "data"
