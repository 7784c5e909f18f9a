"""The documentation site: the pages of this folder, the gallery of ``examples/gallery``, and the docstrings.

``make docs`` builds it; nothing is fetched from a network.
"""

import os
import re
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
]
#: The order of the pages on the site; the pages themselves are plain Markdown.
CONTENTS = {
    "Use": "installation tutorial concepts gallery/index experiment packings loads motion results many-scenes export "
    "from-lammps methods troubleshooting scene-reference api reference trust",
    "The paper": "results-of-the-paper reproduction-notes one-figure reproducing extensions",
    "Background": "physics benchmarks architecture extending claims contributing changelog",
}


def on_the_site(app, page, source):
    """What only the site has: its table of contents, and the built gallery in place of the folder of its scripts."""
    source[0] = source[0].replace("](../examples/gallery)", "](gallery/index.rst)")
    # Markdown beside this folder is no page of the site
    source[0] = re.sub(r"\[([^\]]+)\]\((\.\./[\w./]+\.md)(?:#[\w-]+)?\)", r"{download}`\1 <\2>`", source[0])
    if page == "index":
        for title, names in CONTENTS.items():
            names = "\n".join(names.split())
            source[0] += f"\n```{{toctree}}\n:hidden:\n:maxdepth: 1\n:caption: {title}\n\n{names}\n```\n"


def setup(app):
    app.connect("source-read", on_the_site)
    return {"parallel_read_safe": True}


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

# A checkout may lie in a folder with a blank: no link of the site holds that folder's path.
suppress_warnings = ["sphinx_gallery.space_in_filename"]
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
