"""Who has called this package: for errors and warnings that belong to a line of theirs."""

from __future__ import annotations

import contextlib
import os
import sys

_OURS = {os.path.dirname(os.path.abspath(__file__)),
         os.path.dirname(os.path.abspath(contextlib.__file__))}


def caller() -> tuple[str, int]:
    """File and line."""
    frame = sys._getframe(1)
    while frame.f_back and os.path.dirname(os.path.abspath(frame.f_code.co_filename)) in _OURS:
        frame = frame.f_back
    return frame.f_code.co_filename, frame.f_lineno
