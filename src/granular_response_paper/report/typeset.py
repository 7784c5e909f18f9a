"""Plain text of the datasets and claims as it is set on the page: minus signs, powers, subscripts and roots."""

from __future__ import annotations

import html
import re

_GREEK = {"sigma": "σ", "mu": "µ", "delta": "δ", "gamma": "γ", "xi": "ξ", "theta": "θ", "phi": "φ", "nu": "ν"}

#: A power of ten as computers write it, with its factor; a name such as stop_1e-9 is none.
_TEN = re.compile(r"(?<![\w.])([-−]?)(\d+(?:\.\d+)?)e([-+]?)0*(\d+)(?![\w.]*\w)")
_MINUS = re.compile(r"(?<![\w.)\]])-(?=\.?\d)")
_POWER = re.compile(r"(?<=[\w)])(?:\^|\*\*)(-?\d+(?:/\d+)?)")
#: One letter, µ or the name of a Greek one, with an index of up to four letters or digits.
_INDEX = re.compile(rf"(?<![\w.])([A-Za-zµ]|{'|'.join(_GREEK)})_([A-Za-z0-9]{{1,4}})(?![\w.(]*\w)")
_ROOT = re.compile(r"\bsqrt\((\w+)\)")


def typeset(text: object) -> str:
    """The text as HTML, whatever it holds escaped."""
    found = html.escape(str(text))
    found = _TEN.sub(_ten, found)
    found = _POWER.sub(lambda match: f"<sup>{match[1].replace('-', '−')}</sup>", found)
    found = _INDEX.sub(lambda match: f"<i>{_GREEK.get(match[1], match[1])}</i><sub>{match[2]}</sub>", found)
    found = _ROOT.sub(r"√\1", found).replace("sqrt(", "√(")
    return _MINUS.sub("−", found)


def _ten(match: re.Match[str]) -> str:
    minus, factor, sign, exponent = match.groups()
    power = f"10<sup>{'−' if sign == '-' else ''}{exponent}</sup>"
    return ("−" if minus else "") + (power if factor == "1" else f"{factor}\u202f×\u202f{power}")
