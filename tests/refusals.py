"""Mistakes that are refused in one line: one by one, or as tables."""

import pytest


def refuses(error: type[Exception], said: str | None, call, /, *given, **named) -> str:
    """What the call says as it raises the error, in one line that the regular expression matches."""
    __tracebackhide__ = True
    with pytest.raises(error, match=said) as caught:
        call(*given, **named)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def refusals(error: type[Exception], *rows):
    """A test for the rows of a table: each call raises the error, in one line that the regular expression matches."""

    @pytest.mark.parametrize(("call", "said"), rows)
    def refused(call, said):
        refuses(error, said, call)

    return refused
