"""Scenes written in Python: the same components, attributes and units as in XML, checked by the
same code."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from ._caller import caller
from ._library import library
from ._loading import OnMessage, PathLike, load_with
from .errors import LoadError, Misuse
from .simulation import Simulation


def value_text(value: Any) -> str:
    """An attribute as XML has it. Numbers are SI; a text may carry a unit: "30 kPa"."""
    if isinstance(value, str):
        return value
    if isinstance(value, Element):
        return value.path
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, os.PathLike):
        return str(os.fspath(value))
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if hasattr(value, "__float__") and not getattr(value, "ndim", 0):
        return repr(float(value))
    try:
        return " ".join(repr(float(v)) for v in value)
    except (TypeError, ValueError):
        raise Misuse(f"{value!r} cannot be an attribute; expected a number, a list of numbers, "
                     "a text with a unit, or a component") from None


def _texts(settings: Mapping[str, object] | None) -> dict[str, str]:
    return {str(name): value_text(value) for name, value in (settings or {}).items()}


class Element:
    """A component of a scene that is being written, or a node with components of its own."""

    def __init__(self, tag: str, path: str, attributes: Mapping[str, Any]):
        self.tag = tag
        self.path = path  #: "/skin/tissue"
        self.attributes = {k: value_text(v) for k, v in attributes.items() if v is not None}
        self.place = caller()  #: file and line that made it

    def __repr__(self) -> str:
        return f"<{self.tag} {self.path}>"


class Node(Element):
    """Holds components and other nodes."""

    def __init__(self, tag: str, path: str, attributes: Mapping[str, Any]):
        super().__init__(tag, path, attributes)
        self.children: list[Element] = []

    def add(self, component: str, /, name: str | None = None, **attributes: Any) -> Element:
        """A component: node.add("Tissue", young="20 kPa", poisson=0.45). `sutura describe Tissue`
        lists its attributes. A link takes the element it leads to, or a path."""
        given = attributes if name is None else {"name": name, **attributes}
        element = Element(component, self._below(name or _default_name(component)), given)
        self.children.append(element)
        return element

    def node(self, name: str) -> Node:
        """A named group: scene.node("skin").add("Tissue", ...)."""
        node = Node("node", self._below(name), {"name": name})
        self.children.append(node)
        return node

    def _below(self, name: str) -> str:
        return f"{self.path.rstrip('/')}/{name}"

    def _write(self, lines: list[str], places: list[tuple[str, int]], indent: str) -> None:
        """One element a line, so that the line of an error leads back to Python."""
        for child in self.children:
            start = " ".join([f"<{child.tag}", *(f"{k}={_quoted(v)}"
                                                 for k, v in child.attributes.items())])
            has_more = isinstance(child, Node)
            lines.append(f"{indent}{start}{'>' if has_more else '/>'}")
            places.append(child.place)
            if isinstance(child, Node):
                child._write(lines, places, indent + "  ")
                lines.append(f"{indent}</{child.tag}>")
                places.append(child.place)


class Scene(Node):
    """A scene. `settings` are those of <sutura>: dt, gravity, duration, tolerance, ..."""

    def __init__(self, plugins: Sequence[str] = (), directory: PathLike | None = None,
                 **settings: Any):
        super().__init__("sutura", "/", {"version": 1, **settings})
        self.plugins = list(plugins)
        self.directory = directory  #: files that attributes name are looked for here

    def _written(self) -> tuple[str, list[tuple[str, int]]]:
        attributes = " ".join(f"{k}={_quoted(v)}" for k, v in self.attributes.items())
        lines, places = [f"<sutura {attributes}>"], [self.place]
        for plugin in self.plugins:
            lines.append(f"  <plugin name={_quoted(plugin)}/>")
            places.append(self.place)
        self._write(lines, places, "  ")
        lines.append("</sutura>\n")
        return "\n".join(lines), [*places, self.place]

    @property
    def xml(self) -> str:
        """As a file that `sutura run` takes."""
        return self._written()[0]

    def load(self, *, settings: Mapping[str, object] | None = None,
             plugin_path: Sequence[PathLike] = (), output: PathLike | None = None,
             allow_outside: bool = False, on_message: OnMessage | None = None,
             workers: Executor | None = None) -> Simulation:
        """Ready for its first step; arguments as of sutura.load. Errors name the lines of the
        Python file that made the elements."""
        xml, places = self._written()
        try:
            return loads(xml, name="scene", directory=self.directory, settings=settings,
                         plugin_path=plugin_path, output=output, allow_outside=allow_outside,
                         on_message=on_message, workers=workers)
        except LoadError as error:
            moved = tuple(
                replace(d, file=places[d.line - 1][0], line=places[d.line - 1][1])
                if d.file == "scene" and 0 < d.line <= len(places) else d
                for d in error.diagnostics)
            raise type(error)(str(error), moved) from None


def _quoted(value: str) -> str:
    return quoteattr(value, {"\n": "&#10;", "\t": "&#9;"})


def _default_name(tag: str) -> str:
    """TetMesh -> tet_mesh, VTUFile -> vtu_file."""
    out = ""
    for i, c in enumerate(tag):
        starts = i > 0 and c.isupper() and (not tag[i - 1].isupper() or tag[i + 1:i + 2].islower())
        out += ("_" if starts and not out.endswith("_") else "") + c.lower()
    return out


def load(file: PathLike, *, settings: Mapping[str, object] | None = None,
         plugin_path: Sequence[PathLike] = (), output: PathLike | None = None,
         allow_outside: bool = False, on_message: OnMessage | None = None,
         workers: Executor | None = None) -> Simulation:
    """Reads a scene with its plugins and files and makes it ready for its first step.

    settings       replaces attributes: {"/skin/tissue.young": "30 kPa", ".dt": "5 ms"}
    plugin_path    folders searched for plugins before the others
    output         folder for the files of recorders; out/NAME if left out
    allow_outside  lets recorders write outside of it
    on_message     is called with "note", "warning" or "error" and a sentence; left out,
                   warnings become SuturaWarning
    workers        a ThreadPoolExecutor that may serve many simulations, for what need not be
                   done within a step; left out, each tissue that needs one starts a thread

    SceneError, FileError or PluginError have file and line.
    """
    return Simulation(*load_with(lambda options, handle: library.sutura_load(
        os.fsencode(file), options, handle), _texts(settings), plugin_path, output, allow_outside,
        on_message, workers))


def loads(xml: str, *, name: str = "scene", directory: PathLike | None = None,
          settings: Mapping[str, object] | None = None, plugin_path: Sequence[PathLike] = (),
          output: PathLike | None = None, allow_outside: bool = False,
          on_message: OnMessage | None = None, workers: Executor | None = None) -> Simulation:
    """The same from a text. `name` stands for the file in messages; files that the scene names
    are looked for in `directory`."""
    data = xml.encode()
    where = None if directory is None else os.fsencode(directory)
    return Simulation(*load_with(lambda options, handle: library.sutura_load_text(
        data, len(data), name.encode(), where, options, handle), _texts(settings), plugin_path,
        output, allow_outside, on_message, workers))
