"""The look of figures that gallery examples make with pyplot: that of ``gr.plot``."""

from typing import Any

import matplotlib as mpl

from granular_response.plot import style


def apply(gallery: dict[str, Any], example: str) -> None:
    """Before each example, as ``reset_modules`` of sphinx-gallery takes it."""
    mpl.rcParams.update({name: value for name, value in style.RC.items() if not name.endswith(".dpi")})
