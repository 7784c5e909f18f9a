"""The documentation site: the pages of this folder, the gallery of ``examples/gallery``, and the docstrings.

``make docs`` builds it; nothing is fetched from a network.
"""

import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "src"), str(ROOT / "docs")]
os.environ.setdefault("MPLBACKEND", "agg")

from granular_response import __version__ as release  # noqa: E402

project = "granular-response"
author = "The granular-response authors"
copyright = author
version = release

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_gallery.gen_gallery",
    "pictures_of_pages",
]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = ["_build", "_generated", *(f"gallery/**/*.{end}" for end in ("ipynb", "py", "zip", "json"))]

myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
autodoc_type_aliases = {"ArrayLike": "ArrayLike"}
napoleon_numpy_docstring = True
napoleon_google_docstring = False
napoleon_use_rtype = False

sphinx_gallery_conf = {
    "examples_dirs": [str(ROOT / "examples" / "gallery")],
    "gallery_dirs": ["gallery"],
    "filename_pattern": r"\.py$",
    "within_subsection_order": "ExampleTitleSortKey",
    "download_all_examples": False,
    "remove_config_comments": True,
    "run_stale_examples": True,  # an example is stale when the package has changed, too
    "min_reported_time": 1e9,
    "show_memory": False,
    "show_signature": False,
    "abort_on_example_error": True,
    "capture_repr": (),
    "matplotlib_animations": True,
    "write_computation_times": False,
    "reset_modules": ("matplotlib", "gallery_look.apply"),
    "thumbnail_size": (700, 300),  # of most pictures; narrow.css shows the square in the middle
}

html_theme = "pydata_sphinx_theme"
html_title = "granular-response"
html_show_sourcelink = False
html_copy_source = False
html_static_path = ["_static"]
html_css_files = ["narrow.css"]
html_theme_options = {
    "navigation_with_keys": False,
    "show_prev_next": False,
    "header_links_before_dropdown": 4,  # all in one row with the search field
    "use_edit_page_button": False,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
}
html_sidebars: dict[str, list[str]] = {"**": []}
