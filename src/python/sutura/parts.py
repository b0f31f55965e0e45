"""What a simulation has: components, inputs, outputs, shapes."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from ctypes import byref, c_char_p, c_double
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _library
from ._library import check, library, text
from .errors import Misuse

if TYPE_CHECKING:
    from .simulation import Simulation

Value = Union[float, NDArray[np.float64], str]


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


def copied(pointer: Any, shape: tuple[int, ...], kind: Any) -> NDArray[Any]:
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
