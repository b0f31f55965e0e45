"""A scene that is stepped."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from contextlib import contextmanager
from ctypes import byref, c_char_p, c_size_t, c_uint64, c_void_p
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _library
from ._library import check, library, text
from ._loading import Messages, PathLike, Pool
from .errors import Misuse, NotFound
from .parts import Component, Input, Output, Shape, Value, copied
from .picture import svg


@dataclass(frozen=True)
class Report:
    """The last step."""

    step: int  #: steps since the beginning of the scene
    time: float  #: s, at its end
    solved: bool  #: every tolerance of the scene has been met
    rows: int  #: of constraints
    passes: int  #: linearisations
    parts: int  #: into how many the step was divided; between two events, at its finest
    events: int  #: what cannot be undone: punctures, breaking away
    faults: int  #: reasons not to trust the step
    imbalance: float  #: of momentum, relative to the forces at work
    violation: float  #: m, the largest distance of a constraint from its law
    seconds: float  #: wall time
    missed: int  #: steps not to be trusted since loading or restoring, this one and others


class Simulation:
    """A scene ready for its first step. Made by sutura.load, sutura.loads and Scene.load."""

    def __init__(self, handle: int, callbacks: tuple[Messages, Pool]):
        self._handle = handle
        self._messages, self._pool = callbacks  # they live as long as the simulation
        self._shapes: dict[str, tuple[int, Shape]] = {}
        self._changes = 0
        self.inputs: dict[str, Input] = self._ports("input", Input)
        self.outputs: dict[str, Output] = self._ports("output", Output)
        self.components: dict[str, Component] = {}  #: by path, in the order of the scene
        for number in range(self._count("component")):
            about = _library.CComponent()
            check(library.sutura_component_at(handle, number, about))
            self.components[text(about.path)] = Component(self, about)
        self._bodies = self._handles("body")
        report = self._report()
        self.dt: float = report.dt  #: s, of one step
        self.duration: float = report.duration  #: s, what the scene gives; 0: nothing

    # Time

    def step(self, count: int = 1) -> Report:
        """Takes `count` steps. Diverged, FileError (a recorder) or InternalError end it early."""
        if not isinstance(count, (int, np.integer)) or not 0 <= count < 2**63:
            raise Misuse(f"cannot take {count} steps")
        self._changes += 1
        with self._messages.delivered():
            check(library.sutura_step(self._handle, int(count)))
        return self.report

    def run(self, duration: float | None = None) -> Iterator[Report]:
        """Steps to the end of the scene, or through `duration` seconds more:
        for report in sim.run(): ..."""
        span = duration if duration is not None else self.duration - self.time
        if duration is None and self.duration <= 0:
            raise Misuse("the scene gives no duration; say how long")
        for _ in range(round(np.ceil(span / self.dt - 1e-6))):
            yield self.step()

    @property
    def time(self) -> float:
        """s, at the end of the last step."""
        return float(self._report().time)

    @property
    def report(self) -> Report:
        """The last step."""
        r = self._report()
        return Report(r.step, r.time, bool(r.solved), r.rows, r.passes, r.parts, r.events,
                      r.faults, r.imbalance, r.violation, r.seconds, r.missed)

    # Values

    def __getitem__(self, name: str) -> Any:
        """sim["/suture"] is a component, sim["/grasper.force"] the value of an output."""
        if "." in name:
            return self._read(name)
        if name in self.components:
            return self.components[name]
        near = self._nearest(name)
        raise NotFound(f"there is no component '{name}'{near}")

    def __setitem__(self, name: str, value: ArrayLike) -> None:
        """sim["/track.position"] = [0, 0, 0.01]: an input, from the next step on."""
        if name not in self.inputs:
            self._find("input", name)
        self.inputs[name].set(value)

    def _read(self, name: str) -> Value:
        if name not in self.outputs:
            self._find("output", name)
        return self.outputs[name].read()

    # State

    def save(self, file: PathLike | None = None) -> bytes:
        """Everything that the next steps depend on, as bytes; also written to `file`."""
        data, size = c_void_p(), c_size_t()
        check(library.sutura_save(self._handle, byref(data), byref(size)))
        if file is not None:
            check(library.sutura_save_file(self._handle, os.fsencode(file)))
        return ctypes.string_at(data.value or 0, size.value)

    def restore(self, state: bytes | PathLike) -> None:
        """To a state of this scene that `save` or `sutura run --checkpoint-every` has made: its
        bytes, or the name of its file."""
        self._changes += 1
        if isinstance(state, (bytes, bytearray, memoryview)):
            state = bytes(state)
            check(library.sutura_restore(self._handle, state, len(state)))
        else:
            check(library.sutura_restore_file(self._handle, os.fsencode(state)))

    def reset(self) -> None:
        """Back to before the first step."""
        self._changes += 1
        check(library.sutura_reset(self._handle))

    @contextmanager
    def recording(self, resume: bool = False) -> Iterator[None]:
        """While this lasts the recorders of the scene write their files. `resume`: they are cut
        back to the restored state and go on."""
        start = library.sutura_resume_recording if resume else library.sutura_start_recording
        check(start(self._handle))
        try:
            yield
        finally:
            check(library.sutura_finish_recording(self._handle))

    @property
    def xml(self) -> str:
        """The scene, all settings in it."""
        out = c_char_p()
        check(library.sutura_write_scene(self._handle, byref(out)))
        return text(out.value)

    # End

    def close(self) -> None:
        """Frees everything. Closing twice is allowed."""
        if self._handle:
            check(library.sutura_destroy(self._handle))
            self._handle = 0

    def __copy__(self) -> Simulation:
        # It would share the handle, and whichever goes first would destroy both.
        raise Misuse("a simulation cannot be copied; load its scene again and restore what save() "
                     "gave")

    def __deepcopy__(self, memo: object) -> Simulation:
        return self.__copy__()

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_handle", 0):
            library.sutura_destroy(self._handle)
            self._handle = 0

    # To look at

    def picture(self, width: int = 640) -> str:
        """Its bodies, seen from the front and a little from above, as SVG."""
        return svg([(p, self._shape(p)) for p in self._bodies], width)

    def _repr_html_(self) -> str:
        return f"{self.picture()}<br><code>{self!r}</code>"

    def __repr__(self) -> str:
        if not self._handle:
            return "<sutura simulation, closed>"
        r = self._report()
        count = len(self.components)
        return f"<sutura simulation, step {r.step}, {r.time:.4g} s, {count} components>"

    # Handles

    def _report(self) -> _library.CReport:
        report = _library.CReport()
        check(library.sutura_get_report(self._handle, report))
        return report

    def _count(self, kind: str) -> int:
        count = c_size_t()
        check(getattr(library, f"sutura_{kind}_count")(self._handle, byref(count)))
        return count.value

    def _find(self, kind: str, name: str) -> int:
        handle = c_uint64()
        status = getattr(library, f"sutura_find_{kind}")(
            self._handle, name.encode(), byref(handle))
        if status == Misuse.status and self._handle:
            raise NotFound(text(library.sutura_error()))
        check(status)
        return handle.value

    def _ports(self, kind: str, port: Any) -> dict[str, Any]:
        out = {}
        for number in range(self._count(kind)):
            handle, about = c_uint64(), _library.CValue()
            check(getattr(library, f"sutura_{kind}_at")(self._handle, number, byref(handle)))
            check(getattr(library, f"sutura_describe_{kind}")(handle, about))
            found = port(handle.value, about)
            out[found.full_name] = found
        return out

    def _handles(self, kind: str) -> dict[str, int]:
        """Of bodies, by path."""
        out = {}
        for number in range(self._count(kind)):
            handle, about = c_uint64(), _library.CGeometry()
            check(getattr(library, f"sutura_{kind}_at")(self._handle, number, byref(handle)))
            check(library.sutura_get_geometry(handle, about))
            out[text(about.path)] = handle.value
        return out

    def _tool(self, path: str) -> int:
        return self._find("tool", path)

    def _shape(self, path: str) -> Shape:
        if path in self._shapes and self._shapes[path][0] == self._changes:
            return self._shapes[path][1]
        body = self._bodies.get(path) or self._find("body", path)
        g = _library.CGeometry()
        check(library.sutura_get_geometry(body, g))
        fields = {}
        for number in range(g.field_count):
            f = _library.CField()
            check(library.sutura_get_field(body, number, f))
            size = (f.count,) if f.components == 1 else (f.count, f.components)
            fields[text(f.name)] = copied(f.values, size, np.float64)
        shape = Shape(copied(g.points, (g.point_count, 3), np.float64),
                      copied(g.cells, (g.cell_count, g.corners), np.int64), g.topology, fields)
        self._shapes[path] = (self._changes, shape)
        return shape

    def _nearest(self, name: str) -> str:
        """What the library would say of an output of a component of this name."""
        try:
            self._find("output", name + ".?")
        except Misuse as error:
            _, question, rest = str(error).partition("; did you mean")
            return question + rest
        return ""
