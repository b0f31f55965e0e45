"""Loading, and what a simulation says while it loads and steps."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from ctypes import byref, c_char_p, c_uint64
from typing import Any, Union

from . import _library
from ._caller import caller
from ._library import text
from .errors import Misuse, SuturaWarning

PathLike = Union[str, "os.PathLike[str]"]
#: Called with "note", "warning" or "error" and a sentence.
OnMessage = Callable[[str, str], None]


class Messages:
    """What a simulation says, on its way to Python."""

    NAMES = {0: "note", 1: "warning", 2: "error"}

    def __init__(self, receive: OnMessage | None):
        self._receive = receive
        self._waiting: list[tuple[str, str]] = []
        self.callback = _library.Message(self._take)

    def _take(self, _: Any, severity: int, sentence: bytes) -> None:
        self._waiting.append((self.NAMES.get(severity, "note"), text(sentence)))

    @contextmanager
    def delivered(self) -> Iterator[None]:
        """Messages reach Python code when the call is over, so that it may raise."""
        try:
            yield
        finally:
            waiting, self._waiting = self._waiting, []
            for severity, sentence in waiting:
                if self._receive is not None:
                    self._receive(severity, sentence)
                elif severity == "warning":
                    warnings.warn_explicit(sentence, SuturaWarning, *caller())


class Pool:
    """An executor that does what need not be done within a step."""

    def __init__(self, workers: Executor | None):
        if workers is not None and (isinstance(workers, (type, ProcessPoolExecutor))
                                    or not hasattr(workers, "submit")):
            raise Misuse(f"workers cannot be {workers!r}; expected a ThreadPoolExecutor, or what "
                         "has its method submit")
        self._workers = workers
        # One without a function is null.
        self.callback = _library.Enqueue(self._enqueue) if workers is not None else _library.Enqueue()

    def _enqueue(self, _: Any, job: int, data: int) -> None:
        run = _library.Job(job)
        assert self._workers is not None
        try:
            self._workers.submit(run, data)
        except RuntimeError:  # it has been shut down
            run(data)


def load_with(call: Callable[[Any, Any], int], settings: Mapping[str, object] | None,
              plugin_path: Sequence[PathLike], output: PathLike | None, allow_outside: bool,
              on_message: OnMessage | None, workers: Executor | None
              ) -> tuple[int, tuple[Messages, Pool]]:
    """The handle of a simulation, and what must live as long. `call` is given options and where
    the handle goes."""
    pairs = [t.encode() for pair in (settings or {}).items() for t in map(str, pair)]
    folders = [os.fsencode(f) for f in plugin_path]
    messages, pool = Messages(on_message), Pool(workers)
    options = _library.Options(
        api=_library.API, plugin_directories=(c_char_p * len(folders))(*folders),
        plugin_directory_count=len(folders), settings=(c_char_p * len(pairs))(*pairs),
        setting_count=len(pairs) // 2, output=os.fsencode(output) if output is not None else None,
        allow_outside=int(allow_outside), message=messages.callback, enqueue=pool.callback)
    handle = c_uint64()
    with messages.delivered():
        _library.check_load(call(options, byref(handle)))
    return handle.value, (messages, pool)
