"""A scene that is stepped."""

from __future__ import annotations

import ctypes
import os
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from ctypes import byref, c_char_p, c_double, c_size_t, c_uint64, c_void_p
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _library
from ._caller import caller
from ._library import check, library, text
from .errors import Misuse, NotFound, SuturaWarning
from .picture import svg

Value = Union[float, NDArray[np.float64], str]
PathLike = Union[str, "os.PathLike[str]"]
#: Called with "note", "warning" or "error" and a sentence.
OnMessage = Callable[[str, str], None]


@dataclass(frozen=True)
class Report:
    """The last step."""

    step: int  #: steps since the beginning of the scene
    time: float  #: s, at its end
    solved: bool  #: every tolerance of the scene has been met
    rows: int  #: of constraints
    passes: int  #: linearisations
    parts: int  #: into how many the step was divided at its finest
    events: int  #: what cannot be undone: punctures, breaking away
    faults: int  #: reasons not to trust the step
    imbalance: float  #: of momentum, relative to the forces at work
    violation: float  #: m, the largest distance of a constraint from its law
    seconds: float  #: wall time


class Port:
    """An input or an output of a component: what it is, and its handle."""

    def __init__(self, handle: int, about: _library.CValue):
        self._handle = handle
        self.path = text(about.path)  #: of the component, "/track"
        self.name = text(about.name)  #: "position"
        self.unit = text(about.unit)  #: SI
        self.doc = text(about.doc)  #: one sentence
        self.size = int(about.size)  #: numbers, 1 or 3; 0: a text
        self.low, self.high = float(about.low), float(about.high)  #: admissible

    @property
    def full_name(self) -> str:
        """As in sim["/track.position"]."""
        return f"{self.path}.{self.name}"


class Input(Port):
    """A value that holds from the next step on."""

    def set(self, value: ArrayLike) -> None:
        """`value`: a number, or three. Misuse if it is not finite or out of range."""
        numbers = np.ascontiguousarray(value, dtype=np.float64).ravel()
        pointer = numbers.ctypes.data_as(ctypes.POINTER(c_double))
        check(library.sutura_set_input(self._handle, pointer, numbers.size))

    def __repr__(self) -> str:
        return f"<input {self.full_name} [{self.unit}]: {self.doc}>"


class Output(Port):
    """A value at the end of the last step."""

    def read(self) -> Value:
        """A number, an array of three, or a text."""
        if self.size == 0:
            words = c_char_p()
            check(library.sutura_get_text(self._handle, byref(words)))
            return text(words.value)
        numbers = np.empty(self.size)
        pointer = numbers.ctypes.data_as(ctypes.POINTER(c_double))
        check(library.sutura_get_output(self._handle, pointer, self.size))
        return float(numbers[0]) if self.size == 1 else numbers

    def __repr__(self) -> str:
        return f"<output {self.full_name} [{self.unit}]: {self.doc}>"


@dataclass(frozen=True)
class Shape:
    """A body at the end of a step. The arrays are read-only and stay as they are."""

    points: NDArray[np.float64]  #: n x 3, m
    cells: NDArray[np.int64]  #: cells x 2 (beams) or x 4 (tetrahedra): numbers of points
    topology: int  #: another number whenever cells or the number of points are others
    fields: Mapping[str, NDArray[np.float64]]  #: "velocity [m/s]": one row per point or cell


def _copied(pointer: Any, shape: tuple[int, ...], kind: Any) -> NDArray[Any]:
    if 0 in shape:
        return np.empty(shape, dtype=kind)
    out = np.ctypeslib.as_array(pointer, shape=shape).copy()
    out.flags.writeable = False
    return out


class Component:
    """One component of a scene: `sim["/suture"]`."""

    def __init__(self, sim: Simulation, about: _library.CComponent):
        self._sim = sim
        self.path = text(about.path)  #: "/skin/tissue"
        self.type = text(about.type)  #: "Tissue"
        self.plugin = text(about.plugin)  #: "tissue"
        self.summary = text(about.summary)
        self.line = int(about.line)  #: in the file of the scene

    def __getitem__(self, name: str) -> Value:
        """The value of an output: sim["/grasper"]["force"]."""
        return self._sim._read(f"{self.path}.{name}")

    def __setitem__(self, name: str, value: ArrayLike) -> None:
        """Sets an input: sim["/grasper"]["hold"] = 0."""
        self._sim[f"{self.path}.{name}"] = value

    @property
    def inputs(self) -> dict[str, Input]:
        """By name."""
        return {i.name: i for i in self._sim.inputs.values() if i.path == self.path}

    @property
    def outputs(self) -> dict[str, Output]:
        """By name."""
        return {o.name: o for o in self._sim.outputs.values() if o.path == self.path}

    @property
    def shape(self) -> Shape:
        """Points, cells and fields of a body; Misuse for a component that is none."""
        return self._sim._shape(self.path)

    @property
    def positions(self) -> NDArray[np.float64]:
        """Of the points of a body, n x 3 (m), at the end of the last step."""
        return self.shape.points

    @property
    def cells(self) -> NDArray[np.int64]:
        """Of a body: numbers of points, two per beam or four per tetrahedron."""
        return self.shape.cells

    @property
    def pose(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Of a tool: position (m) and unit quaternion w x y z by which it is away from where it
        was modelled, at the end of the last step. Set, it is where the tool is at the end of
        the next."""
        numbers = (c_double * 7)()
        check(library.sutura_get_pose(self._sim._tool(self.path), numbers))
        both = np.array(numbers)
        return both[:3], both[3:]

    @pose.setter
    def pose(self, pose: tuple[ArrayLike, ArrayLike]) -> None:
        position, quaternion = pose
        numbers = np.concatenate([np.ravel(position), np.ravel(quaternion)]).astype(np.float64)
        if numbers.size != 7:
            raise Misuse("a pose is a position, three numbers, and a quaternion w x y z, four")
        check(library.sutura_set_pose(self._sim._tool(self.path), (c_double * 7)(*numbers)))

    def __repr__(self) -> str:
        return f"<{self.type} {self.path}>"


class Simulation:
    """A scene ready for its first step. Made by sutura.load, sutura.loads and Scene.load."""

    def __init__(self, handle: int, messages: Messages):
        self._handle = handle
        self._messages = messages  # keeps the callback alive
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
        if count < 0:
            raise Misuse(f"cannot take {count} steps")
        self._changes += 1
        with self._messages.delivered():
            check(library.sutura_step(self._handle, count))
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
                      r.faults, r.imbalance, r.violation, r.seconds)

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
        if isinstance(state, (bytes, bytearray)):
            check(library.sutura_restore(self._handle, bytes(state), len(state)))
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
        return f"<sutura simulation, step {r.step}, {r.time:.4g} s, {len(self.components)} components>"

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
            fields[text(f.name)] = _copied(f.values, size, np.float64)
        shape = Shape(_copied(g.points, (g.point_count, 3), np.float64),
                      _copied(g.cells, (g.cell_count, g.corners), np.int64), g.topology, fields)
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


def load_with(call: Callable[[Any, Any], int], settings: Mapping[str, object] | None,
              plugin_path: Sequence[PathLike], output: PathLike | None, allow_outside: bool,
              on_message: OnMessage | None) -> Simulation:
    """`call` is given options and where the handle goes."""
    pairs = [t.encode() for pair in (settings or {}).items() for t in map(str, pair)]
    folders = [os.fsencode(f) for f in plugin_path]
    messages = Messages(on_message)
    options = _library.Options(
        api=_library.API, plugin_directories=(c_char_p * len(folders))(*folders),
        plugin_directory_count=len(folders), settings=(c_char_p * len(pairs))(*pairs),
        setting_count=len(pairs) // 2, output=os.fsencode(output) if output is not None else None,
        allow_outside=int(allow_outside), message=messages.callback)
    handle = c_uint64()
    with messages.delivered():
        _library.check_load(call(options, byref(handle)))
    return Simulation(handle.value, messages)
