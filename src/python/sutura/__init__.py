"""Interactive simulation of surgical suturing.

    import sutura

    sim = sutura.load(sutura.scenes / "suture/prick.xml")
    for report in sim.run(0.5):
        print(report.time, sim["/grasper.force"])
    print(sim["/suture"].positions)

Units are SI. One simulation is for one thread at a time; several simulations run side by side in
several threads (calls release Python's lock) and give the bits that each gives alone.
"""

from pathlib import Path

from ._library import library as _c_library
from ._library import text as _text
from .errors import (
                     Busy,
                     Diagnostic,
                     Diverged,
                     Error,
                     FileError,
                     InternalError,
                     LoadError,
                     Misuse,
                     NotFound,
                     OutOfMemory,
                     PluginError,
                     SceneError,
                     SuturaWarning,
)
from .parts import Component, Input, Output, Shape
from .scene import Element, Node, Scene, load, loads
from .simulation import Report, Simulation

__version__: str = _text(_c_library.sutura_version())
#: Folder of the scenes that came with this package: scenes / "suture/prick.xml".
scenes = Path(__file__).parent / "scenes"

__all__ = ["Busy", "Component", "Diagnostic", "Diverged", "Element", "Error", "FileError",
           "Input", "InternalError", "LoadError", "Misuse", "Node", "NotFound", "OutOfMemory",
           "Output", "PluginError", "Report", "Scene", "SceneError", "Shape", "Simulation",
           "SuturaWarning", "load", "loads", "scenes"]
