"""What command lines share: how commands are declared, begin and end. It imports nothing that is heavy.

A command line imports this module first: it settles, before anything loads numpy, that the same command gives the same
digits on every x86 machine.
"""

from __future__ import annotations

import errno
import functools
import gc
import io
import os
import sys
import warnings
from collections.abc import Callable
from typing import Any

import typer

from .. import __version__
from ..errors import GranularError
from ..machine import floating_point
from ..sweeps.errors import SweepError

floating_point.pin()

# Commands draw into files. A notebook sets this variable for all that it starts; matplotlib, where the notebook's
# backend is not installed, would not even be imported.
os.environ["MPLBACKEND"] = "agg"

#: Exit code of a program that a signal of the terminal ends.
_INTERRUPTED = 130

#: The option of commands that make a file or a folder.
output_option = functools.partial(typer.Option, "--output", "-o")


class CommandLine:
    """A command line: commands with examples, and errors that are one line.

    ``name`` is as it is called, and stands before each of its messages; ``examples`` are arguments worth showing.
    """

    def __init__(self, name: str, about: str, *examples: str) -> None:
        self.name = name
        self.app = typer.Typer(
            name=name,
            no_args_is_help=True,
            rich_markup_mode=None,  # plain help answers twice as fast
            pretty_exceptions_enable=False,
            context_settings={"help_option_names": ["-h", "--help"]},
        )
        asked = typer.Option(
            False, "--version", help="Print the version and stop.", callback=self._version_asked, is_eager=True
        )

        def start(version: bool = asked) -> None:
            pass

        self.app.callback(help=about, epilog=self._examples(*examples))(start)

    def command(self, *examples: str, name: str | None = None) -> Callable[[Callable], Callable]:
        """A command with examples of its arguments, as they follow the name of the program.

        An interruption ends it with one line, with what the KeyboardInterrupt says, if anything.
        """

        def declare(run: Callable) -> Callable:
            @functools.wraps(run)
            def quiet(*given: Any, **options: Any) -> Any:
                try:
                    return run(*given, **options)
                except KeyboardInterrupt as error:
                    self.say("; ".join(("interrupted", *map(str, error.args))))
                    raise typer.Exit(_INTERRUPTED) from None

            self.app.command(name, epilog=self._examples(*examples))(quiet)
            return run

        return declare

    def say(self, message: str) -> None:
        """A line on standard error, after the name of the program."""
        typer.echo(f"{self.name}: {message}", err=True)

    def print_version(self) -> None:
        typer.echo(f"{self.name} {__version__}")

    def run(self) -> None:
        """Run the command that was asked for. Expected errors are one line on standard error and exit code 2.

        Importing makes many objects and no garbage, so the collector waits for :func:`loaded`; and what there is in the
        end goes with the process. Both take a tenth of a second and more off every command.
        """
        gc.disable()
        warnings.formatwarning = lambda message, *_, **__: f"{self.name}: {message}\n"
        _speak_any_name()
        try:
            try:
                self.app()
            finally:
                if sys.stdout is not None:
                    sys.stdout.flush()
        except BrokenPipeError:  # who was listening has gone
            _hush()
            sys.exit(1)
        except Exception as error:
            said = _said(error)
            if said is None:
                raise
            self.say(said)
            sys.exit(2)
        finally:
            gc.freeze()
            gc.enable()

    def _examples(self, *lines: str) -> str:
        return "\b\nExamples:\n" + "\n".join(f"  {self.name} {line}" for line in lines)

    def _version_asked(self, asked: bool) -> None:
        if asked:
            self.print_version()
            raise typer.Exit


def loaded() -> None:
    """A command has what it needs: start collecting garbage, but not among what the imports have made."""
    if not gc.isenabled():
        gc.freeze()
        gc.enable()


#: Errors of a stream, which has no name.
_NOT_WRITTEN = (errno.EIO, errno.ENOSPC, errno.EFBIG, errno.EDQUOT)


def _speak_any_name() -> None:
    """Names of files are printed as they are, also those that the locale or Unicode cannot spell."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            if stream.encoding.lower().replace("-", "") in ("ascii", "ansi_x3.41968", "usascii", "utf8"):
                stream.reconfigure(encoding="utf-8", errors="surrogateescape")
            else:
                stream.reconfigure(errors="backslashreplace")


def _hush() -> None:
    """What standard output still holds goes nowhere, so that the end of the process does not try again."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


def _said(error: Exception) -> str | None:
    """The line for an error that a user can cause; None for a mistake in a program."""
    if isinstance(error, OSError) and error.filename is None and error.errno in _NOT_WRITTEN:
        _hush()
        return f"standard output cannot be written: {error.strerror}"
    if isinstance(error, MemoryError):
        return f"not enough memory: {error or 'the scene is too large'}"
    if isinstance(error, OSError) and error.filename is not None:  # a path that cannot be read or written
        return f"{error.filename}: {error.strerror}"
    cause = error.__cause__
    programming = isinstance(error, SweepError) and cause and not isinstance(cause, GranularError)
    return str(error) if isinstance(error, GranularError) and not programming else None
