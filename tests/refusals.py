"""Mistakes that are refused in one line, as tables."""

import pytest


def refusals(error: type[Exception], *rows):
    """A test for the rows of a table: each call raises the error, in one line that the regular expression matches."""

    @pytest.mark.parametrize(("call", "said"), rows)
    def refused(call, said):
        with pytest.raises(error, match=said) as caught:
            call()
        assert "\n" not in str(caught.value)

    return refused
