"""What can go wrong, as exceptions."""

from __future__ import annotations

from dataclasses import dataclass


class SuturaWarning(UserWarning):
    """What a scene or a step is worth a second look for."""


class Error(Exception):
    """Anything that Sutura refuses. `status` is the number of the C API and of the command."""

    status = 1

    def __str__(self) -> str:  # KeyError would quote the sentence
        return Exception.__str__(self)


class Misuse(Error, ValueError):
    """The call itself is wrong: a value out of range, a simulation that is closed."""

    status = 1


class NotFound(Misuse, KeyError):
    """A name that the scene does not have; the sentence names the nearest one."""


@dataclass(frozen=True)
class Diagnostic:
    """One thing that loading has found."""

    file: str
    line: int  #: from 1; 0: the whole file
    path: str  #: of the component, "/skin/tissue", or ""
    message: str  #: one sentence
    is_error: bool
    status: int  #: what it makes of the load

    def __str__(self) -> str:
        where = f"{self.file}:{self.line}" if self.line else self.file
        path = f"[{self.path}] " if self.path else ""
        return f"{where}: {'error' if self.is_error else 'warning'}: {path}{self.message}"


class LoadError(Error):
    """A scene that cannot be loaded. `diagnostics` has all errors, `file` and `line` the first."""

    def __init__(self, sentence: str, diagnostics: tuple[Diagnostic, ...] = ()):
        errors = [d for d in diagnostics if d.is_error]
        super().__init__("\n".join(map(str, errors)) or sentence)
        self.diagnostics = diagnostics
        self.file = errors[0].file if errors else ""
        self.line = errors[0].line if errors else 0


class SceneError(LoadError):
    """The scene is wrong."""

    status = 2


class FileError(LoadError, OSError):
    """A file is missing, wrong, or cannot be written; a state does not fit."""

    status = 3


class Diverged(Error, ArithmeticError):
    """The state is no longer finite."""

    status = 4


class PluginError(LoadError):
    """A plugin is missing or does not fit this library."""

    status = 6


class Busy(Error):
    """Another thread is at work on the same simulation."""

    status = 7


class OutOfMemory(Error, MemoryError):
    """There is not enough memory."""

    status = 8


class InternalError(Error):
    """A fault of Sutura or of a plugin: please report it."""

    status = 70


BY_STATUS: dict[int, type[Error]] = {
    kind.status: kind
    for kind in (Misuse, SceneError, FileError, Diverged, PluginError, Busy, OutOfMemory,
                 InternalError)
}
