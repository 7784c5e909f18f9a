"""What documents say that code prints."""

import re


def rounded(text: str) -> str:
    """Without the digits of rounding errors."""
    return re.sub(r"\d\.\de-\d\d", "#", text)
