"""The shared library and its functions, as include/sutura/sutura.h declares them."""

from __future__ import annotations

import ctypes
import os
from ctypes import (
    CFUNCTYPE,
    POINTER,
    Structure,
    c_char_p,
    c_double,
    c_int32,
    c_int64,
    c_size_t,
    c_uint32,
    c_uint64,
    c_void_p,
)
from pathlib import Path
from typing import Any

from .errors import BY_STATUS, Diagnostic, InternalError, LoadError

API = 1

Message = CFUNCTYPE(None, c_void_p, c_int32, c_char_p)
Job = CFUNCTYPE(None, c_void_p)
Enqueue = CFUNCTYPE(None, c_void_p, c_void_p, c_void_p)


class Sized(Structure):
    """A struct of the API: it begins with its own size."""

    def __init__(self, **values: Any):
        super().__init__(struct_size=ctypes.sizeof(self), **values)


class CDiagnostic(Sized):
    _fields_ = [("struct_size", c_uint32), ("severity", c_int32), ("status", c_int32),
                ("line", c_int32), ("file", c_char_p), ("path", c_char_p), ("message", c_char_p)]


class Options(Sized):
    _fields_ = [("struct_size", c_uint32), ("api", c_uint32),
                ("plugin_directories", POINTER(c_char_p)), ("plugin_directory_count", c_size_t),
                ("settings", POINTER(c_char_p)), ("setting_count", c_size_t),
                ("output", c_char_p), ("allow_outside", c_int32), ("message", Message),
                ("user", c_void_p), ("enqueue", Enqueue), ("pool", c_void_p)]


class CReport(Sized):
    _fields_ = [("struct_size", c_uint32), ("solved", c_int32), ("step", c_int64),
                ("time", c_double), ("dt", c_double), ("duration", c_double), ("rows", c_int64),
                ("passes", c_int64), ("parts", c_int64), ("events", c_int64), ("faults", c_int64),
                ("imbalance", c_double), ("violation", c_double), ("seconds", c_double),
                ("missed", c_int64)]


class CComponent(Sized):
    _fields_ = [("struct_size", c_uint32), ("line", c_int32), ("path", c_char_p),
                ("type", c_char_p), ("plugin", c_char_p), ("summary", c_char_p)]


class CValue(Sized):
    _fields_ = [("struct_size", c_uint32), ("size", c_uint32), ("path", c_char_p),
                ("name", c_char_p), ("unit", c_char_p), ("doc", c_char_p), ("low", c_double),
                ("high", c_double)]


class CGeometry(Sized):
    _fields_ = [("struct_size", c_uint32), ("corners", c_uint32), ("topology", c_uint64),
                ("path", c_char_p), ("point_count", c_size_t), ("points", POINTER(c_double)),
                ("cell_count", c_size_t), ("cells", POINTER(c_int64)), ("field_count", c_size_t)]


class CField(Sized):
    _fields_ = [("struct_size", c_uint32), ("on_cells", c_int32), ("name", c_char_p),
                ("count", c_size_t), ("components", c_size_t), ("values", POINTER(c_double))]


_Handle = POINTER(c_uint64)
_Numbers = POINTER(c_double)

#: Arguments of every function that returns a status.
FUNCTIONS: dict[str, list[Any]] = {
    "sutura_diagnostic_at": [c_size_t, POINTER(CDiagnostic)],
    "sutura_load": [c_char_p, POINTER(Options), _Handle],
    "sutura_load_text": [c_char_p, c_size_t, c_char_p, c_char_p, POINTER(Options), _Handle],
    "sutura_destroy": [c_uint64],
    "sutura_step": [c_uint64, c_size_t],
    "sutura_get_report": [c_uint64, POINTER(CReport)],
    "sutura_write_scene": [c_uint64, POINTER(c_char_p)],
    "sutura_save": [c_uint64, POINTER(c_void_p), POINTER(c_size_t)],
    "sutura_restore": [c_uint64, c_char_p, c_size_t],
    "sutura_save_file": [c_uint64, c_char_p],
    "sutura_restore_file": [c_uint64, c_char_p],
    "sutura_reset": [c_uint64],
    "sutura_start_recording": [c_uint64],
    "sutura_resume_recording": [c_uint64],
    "sutura_finish_recording": [c_uint64],
    "sutura_component_count": [c_uint64, POINTER(c_size_t)],
    "sutura_component_at": [c_uint64, c_size_t, POINTER(CComponent)],
    "sutura_find_input": [c_uint64, c_char_p, _Handle],
    "sutura_input_count": [c_uint64, POINTER(c_size_t)],
    "sutura_input_at": [c_uint64, c_size_t, _Handle],
    "sutura_describe_input": [c_uint64, POINTER(CValue)],
    "sutura_set_input": [c_uint64, _Numbers, c_size_t],
    "sutura_find_output": [c_uint64, c_char_p, _Handle],
    "sutura_output_count": [c_uint64, POINTER(c_size_t)],
    "sutura_output_at": [c_uint64, c_size_t, _Handle],
    "sutura_describe_output": [c_uint64, POINTER(CValue)],
    "sutura_get_output": [c_uint64, _Numbers, c_size_t],
    "sutura_get_text": [c_uint64, POINTER(c_char_p)],
    "sutura_find_body": [c_uint64, c_char_p, _Handle],
    "sutura_body_count": [c_uint64, POINTER(c_size_t)],
    "sutura_body_at": [c_uint64, c_size_t, _Handle],
    "sutura_get_geometry": [c_uint64, POINTER(CGeometry)],
    "sutura_get_field": [c_uint64, c_size_t, POINTER(CField)],
    "sutura_find_tool": [c_uint64, c_char_p, _Handle],
    "sutura_tool_count": [c_uint64, POINTER(c_size_t)],
    "sutura_tool_at": [c_uint64, c_size_t, _Handle],
    "sutura_get_pose": [c_uint64, _Numbers],
    "sutura_set_pose": [c_uint64, _Numbers],
}


def _processor_lacks() -> list[str]:
    """What this processor cannot do that the packaged library is compiled for (x86-64-v3)."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace")
    except OSError:
        return []
    flags = next((line for line in text.splitlines() if line.startswith("flags")), "").split()
    return [flag for flag in ("avx2", "fma", "bmi2") if flags and flag not in flags]


def _load() -> ctypes.CDLL:
    """The library that SUTURA_LIBRARY names, or the one that came with this package."""
    named = os.environ.get("SUTURA_LIBRARY")
    file = Path(named) if named else Path(__file__).parent / "lib" / "libsutura.so.0"
    if not named:
        if not file.exists():
            raise ImportError(f"{file} is missing: install the wheel that ./dev wheel makes, or "
                              "let SUTURA_LIBRARY name libsutura.so")
        if lacks := _processor_lacks():
            raise ImportError("this package needs a processor with AVX2 (x86-64-v3), of 2013 or "
                              f"later; this one lacks {', '.join(lacks)}")
    library = ctypes.CDLL(os.fspath(file))
    library.sutura_api.restype = c_uint32
    if (found := library.sutura_api()) != API:
        raise ImportError(f"{file} has version {found} of the interface; expected {API}")
    for name in ("sutura_version", "sutura_error"):
        getattr(library, name).restype = c_char_p
    library.sutura_diagnostic_count.restype = c_size_t
    for name, arguments in FUNCTIONS.items():
        function = getattr(library, name)
        function.argtypes = arguments
        function.restype = c_int32
    return library


library = _load()


def text(value: bytes | None) -> str:
    return (value or b"").decode("utf-8", errors="replace")


def check(status: int) -> None:
    """Raises what the status of a call means."""
    if status == 0:
        return
    kind = BY_STATUS.get(status, InternalError)
    raise kind(text(library.sutura_error()))


def diagnostics() -> tuple[Diagnostic, ...]:
    """Of the last load in this thread."""
    out = []
    for number in range(library.sutura_diagnostic_count()):
        d = CDiagnostic()
        check(library.sutura_diagnostic_at(number, d))
        out.append(Diagnostic(text(d.file), d.line, text(d.path), text(d.message),
                              d.severity == 2, d.status))
    return tuple(out)


def check_load(status: int) -> None:
    """The same after a load: the exception has every error of the scene."""
    if status == 0:
        return
    kind = BY_STATUS.get(status, InternalError)
    sentence = text(library.sutura_error())
    if issubclass(kind, LoadError):
        raise kind(sentence, diagnostics())
    raise kind(sentence)
