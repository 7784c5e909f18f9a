"""Functions that the type of their first argument chooses, in Python and in compiled code alike.

The first argument is a named tuple (a contact law, an integrator), and its class has the function as a method.
Compiled code knows the class from the type, so the choice costs nothing at run time; Numba's cache keeps a version for
each class. The classes must live in modules that can be imported.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Any

from numba.extending import overload

_OPTIONS = {"error_model": "numpy", "forceinline": True}


def by_type(function: Callable) -> Any:
    """Decorator: the method of the same name of the first argument, which takes the same arguments.

    The body of ``function`` is never run: its arguments and docstring say what the methods have in common.
    """
    name = function.__name__

    @wraps(function)
    def called(self, *arguments):
        return getattr(self, name)(*arguments)

    def method(*types):
        return getattr(types[0].instance_class, name)

    # Numba compares the names of the arguments
    method.__signature__ = called.__signature__ = inspect.signature(function)  # type: ignore[attr-defined]
    overload(called, jit_options=_OPTIONS)(method)
    return called
