"""`sutura fmu` and what comes out of it, driven by an importer of our own.

    fmu_test.py BUILD
"""

import csv
import ctypes
import importlib.util
import subprocess
import sys
import tempfile
import unittest
import zipfile
from ctypes import (
    CFUNCTYPE,
    byref,
    c_bool,
    c_char_p,
    c_double,
    c_int,
    c_size_t,
    c_uint8,
    c_uint32,
    c_void_p,
)
from pathlib import Path
from xml.etree import ElementTree

SOURCE = Path(__file__).resolve().parents[2]
SCENE = SOURCE / "scenes/suture/prick.xml"
BUILD = Path(sys.argv.pop(1)).resolve()
STEPS = 30
HAS_FMPY = importlib.util.find_spec("fmpy") is not None


class Importer:
    """One instance of an extracted FMU."""

    Log = CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)

    def __init__(self, folder: Path):
        self.description = ElementTree.parse(folder / "modelDescription.xml").getroot()
        co_simulation = self.description.find("CoSimulation")
        variables = self.description.find("ModelVariables")
        self.variables = {v.get("name"): int(v.get("valueReference")) for v in variables}
        self.starts = {v.get("name"): float(v.get("start")) for v in variables if v.get("start")}
        self.dt = float(co_simulation.get("fixedInternalStepSize"))
        name = co_simulation.get("modelIdentifier")
        self.library = ctypes.CDLL(str(folder / f"binaries/x86_64-linux/{name}.so"))
        self.messages = []
        self.log = self.Log(lambda _, status, kind, text: self.messages.append(
            (status, kind.decode(), text.decode())))
        make = self.library.fmi3InstantiateCoSimulation
        make.restype = c_void_p
        self.instance = c_void_p(make(
            b"test", self.description.get("instantiationToken").encode(),
            f"{folder}/resources/".encode(), c_bool(False), c_bool(True), c_bool(False),
            c_bool(False), None, c_size_t(0), None, self.log, None))
        assert self.instance, self.messages
        self.time = 0.0

    def call(self, name: str, *arguments) -> int:
        return getattr(self.library, name)(self.instance, *arguments)

    def need(self, name: str, *arguments) -> None:
        status = self.call(name, *arguments)
        assert status == 0, (name, status, self.messages)

    def begin(self, start: float = 0.0) -> None:
        self.time = start
        self.need("fmi3EnterInitializationMode", c_bool(False), c_double(0), c_double(start),
                  c_bool(False), c_double(0))
        self.need("fmi3ExitInitializationMode")

    def step(self, span: float) -> int:
        flags, last = [c_bool(), c_bool(), c_bool()], c_double()
        status = self.call("fmi3DoStep", c_double(self.time), c_double(span), c_bool(False),
                           *map(byref, flags), byref(last))
        self.time = last.value
        return status

    def run(self, steps: int, names: list[str]) -> list[list[float]]:
        out = []
        for _ in range(steps):
            assert self.step(self.dt) == 0, self.messages
            out.append([self[n] for n in names])
        return out

    def __getitem__(self, name: str) -> float:
        value = c_double()
        self.need("fmi3GetFloat64", byref(c_uint32(self.variables[name])), c_size_t(1),
                  byref(value), c_size_t(1))
        return value.value

    def __setitem__(self, name: str, value: float) -> None:
        self.need("fmi3SetFloat64", byref(c_uint32(self.variables[name])), c_size_t(1),
                  byref(c_double(value)), c_size_t(1))

    def text(self, name: str) -> str:
        value = c_char_p()
        self.need("fmi3GetString", byref(c_uint32(self.variables[name])), c_size_t(1),
                  byref(value), c_size_t(1))
        return value.value.decode()

    def state(self) -> c_void_p:
        state = c_void_p()
        self.need("fmi3GetFMUState", byref(state))
        return state

    def set_state(self, state: c_void_p, time: float) -> None:
        self.need("fmi3SetFMUState", state)
        self.time = time

    def close(self) -> None:
        self.need("fmi3Terminate")
        self.library.fmi3FreeInstance(self.instance)


class Fmu(unittest.TestCase):
    NAMES = ["puncture.force", "grasper.force[1]", "grasper.force[3]", "suture.energy"]

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        # Made from an installed tree, as a user would: no path of the build is in it.
        subprocess.run(["cmake", "--install", BUILD, "--prefix", cls.folder / "prefix"], check=True,
                       capture_output=True)
        cls.command = cls.folder / "prefix/bin/sutura"
        subprocess.run([cls.command, "fmu", SCENE, "--output", cls.folder / "prick.fmu"],
                       check=True, capture_output=True)
        with zipfile.ZipFile(cls.folder / "prick.fmu") as packed:
            assert packed.testzip() is None
            packed.extractall(cls.folder / "prick")
        (cls.folder / "prefix").rename(cls.folder / "gone")  # it does without

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def importer(self) -> Importer:
        out = Importer(self.folder / "prick")
        self.addCleanup(out.close)
        return out

    def test_gives_the_bits_of_the_command(self):
        fmu = self.importer()
        fmu.begin()
        ours = fmu.run(STEPS, ["time", "puncture.force", "grasper.force[1]", "grasper.force[3]"])
        subprocess.run([BUILD / "bin/sutura", "run", SCENE, "--steps", str(STEPS), "--output",
                        self.folder / "run"], check=True, capture_output=True)
        with open(self.folder / "run/probe.csv") as file:
            rows = list(csv.DictReader(file))[1:]
        wanted = ["time [s]", "puncture.force [N]", "grasper.force.x [N]", "grasper.force.z [N]"]
        theirs = [[float(row[c]) for c in wanted] for row in rows]
        self.assertEqual(ours, theirs)
        self.assertEqual(fmu.text("puncture.state"), "pressing")  # on the skin, at 0.3 s

    def test_state(self):
        fmu = self.importer()
        fmu.begin()
        fmu.run(10, self.NAMES)
        here, time = fmu.state(), fmu.time
        first = fmu.run(10, self.NAMES)
        fmu.set_state(here, time)
        self.assertEqual(fmu.run(10, self.NAMES), first)
        # The same through bytes, in another instance.
        size = c_size_t()
        fmu.need("fmi3SerializedFMUStateSize", here, byref(size))
        data = (c_uint8 * size.value)()
        fmu.need("fmi3SerializeFMUState", here, data, size)
        other, state = self.importer(), c_void_p()
        other.begin()
        other.need("fmi3DeserializeFMUState", data, size, byref(state))
        other.set_state(state, time)
        self.assertEqual(other.run(10, self.NAMES), first)
        data[size.value // 2] ^= 1
        other.need("fmi3DeserializeFMUState", data, size, byref(state))
        self.assertNotEqual(other.call("fmi3SetFMUState", state), 0)
        other.need("fmi3FreeFMUState", byref(state))
        fmu.need("fmi3FreeFMUState", byref(here))
        self.assertFalse(here)

    def test_reset_and_start_time(self):
        fmu = self.importer()
        fmu.begin()
        first = fmu.run(5, self.NAMES)
        fmu.need("fmi3Reset")
        fmu.begin(start=3.0)
        self.assertEqual(fmu["time"], 3.0)
        self.assertEqual(fmu.run(5, self.NAMES), first)
        self.assertAlmostEqual(fmu["time"], 3.05, delta=1e-12)

    def test_long_steps_are_several(self):
        one, other = self.importer(), self.importer()
        one.begin()
        other.begin()
        last = one.run(6, self.NAMES)[-1]
        self.assertEqual([other.step(3 * other.dt), other.step(3 * other.dt)], [0, 0])
        self.assertEqual([other[n] for n in self.NAMES], last)

    def test_inputs(self):
        plain, told = self.importer(), self.importer()
        for name, start in told.starts.items():  # as some importers do
            told[name] = start
        plain.begin()
        told.begin()
        names = ["track.position[3]", *self.NAMES]
        self.assertEqual(told.run(3, names), plain.run(3, names))
        told["set.track.position[3]"] = told["track.position[3]"] + 1e-3
        told["set.grasper.hold"] = 0
        told.run(1, names)
        self.assertAlmostEqual(told["track.position[3]"], plain["track.position[3]"] + 1e-3,
                               delta=1e-15)
        self.assertEqual(told["grasper.holding"], 0)

    def test_a_step_that_misses_its_tolerances_is_a_warning(self):
        folder = self.folder / "hasty"
        subprocess.run([BUILD / "bin/sutura", "fmu", SCENE, "--set", ".tolerance=1e-12",
                        "--set", ".passes=1", "--set", ".substeps=1", "--output",
                        self.folder / "hasty.fmu"], check=True, capture_output=True)
        with zipfile.ZipFile(self.folder / "hasty.fmu") as packed:
            packed.extractall(folder)
        fmu = Importer(folder)
        self.addCleanup(fmu.close)
        fmu.begin()
        self.assertEqual(fmu.step(2 * fmu.dt), 1)
        self.assertIn("missed its tolerances", fmu.messages[-1][2])

    def test_what_is_wrong_is_said(self):
        fmu = self.importer()
        fmu.time = 0.0
        self.assertEqual(fmu.step(fmu.dt), 3)
        self.assertIn("fmi3ExitInitializationMode", fmu.messages[-1][2])
        fmu.begin()
        self.assertEqual(fmu.step(0.4 * fmu.dt), 3)
        self.assertIn("no whole number of time steps", fmu.messages[-1][2])
        fmu.time = 1.0
        self.assertEqual(fmu.step(fmu.dt), 3)
        self.assertIn("the simulation is at 0.0", fmu.messages[-1][2])
        fmu.time = 0.0
        value = c_double()
        self.assertEqual(fmu.call("fmi3GetFloat64", byref(c_uint32(9999)), c_size_t(1),
                                  byref(value), c_size_t(1)), 3)
        fmu["set.grasper.hold"] = 7
        self.assertEqual(fmu.step(fmu.dt), 3)
        self.assertIn("'hold' cannot be 7", fmu.messages[-1][2])
        fmu["set.grasper.hold"] = 1
        self.assertEqual(fmu.step(fmu.dt), 0)
        self.assertEqual(fmu.call("fmi3GetDirectionalDerivative"), 3)
        self.assertIn("fmi3GetDirectionalDerivative", fmu.messages[-1][2])

    def test_description(self):
        root = ElementTree.parse(self.folder / "prick/modelDescription.xml").getroot()
        self.assertEqual(root.get("fmiVersion"), "3.0")
        self.assertEqual([e.tag for e in root],
                         ["CoSimulation", "UnitDefinitions", "LogCategories", "DefaultExperiment",
                          "ModelVariables", "ModelStructure"])
        variables = list(root.find("ModelVariables"))
        names = [v.get("name") for v in variables]
        self.assertEqual(len(set(names)), len(names))
        self.assertEqual([int(v.get("valueReference")) for v in variables],
                         list(range(len(variables))))
        units = {u.get("name") for u in root.find("UnitDefinitions")}
        self.assertEqual({v.get("unit") for v in variables if v.get("unit")}, units)
        outputs = {v.get("valueReference") for v in variables if v.get("causality") == "output"}
        for kind in ("Output", "InitialUnknown"):
            self.assertEqual({e.get("valueReference") for e in root.find("ModelStructure")
                              if e.tag == kind}, outputs)
        for v in variables:
            self.assertEqual(v.get("start") is not None, v.get("causality") == "input", v.attrib)

    def test_exports_are_the_functions_of_the_standard(self):
        names = subprocess.run(
            ["nm", "--dynamic", "--defined-only", "--format=posix",
             self.folder / "prick/binaries/x86_64-linux/prick.so"], check=True, text=True,
            stdout=subprocess.PIPE).stdout.split("\n")
        functions = {n.split()[0] for n in names if n.startswith("fmi3")}
        self.assertEqual(len(functions), 75)  # that fmi3Functions.h of the standard declares

    @unittest.skipUnless(HAS_FMPY, "FMPy is not installed")
    def test_fmpy(self):
        import fmpy
        from fmpy.validation import validate_fmu
        self.assertEqual(validate_fmu(str(self.folder / "prick.fmu")), [])
        result = fmpy.simulate_fmu(str(self.folder / "prick.fmu"), stop_time=0.2,
                                   output=self.NAMES)
        fmu = self.importer()
        fmu.begin()
        self.assertEqual([[row[n] for n in self.NAMES] for row in result[1:]],
                         fmu.run(20, self.NAMES))

    def test_the_command_says_what_is_wrong(self):
        command = BUILD / "bin/sutura"
        for arguments, code in ((["nowhere.xml"], 3), ([], 1),
                                ([SCENE, "--output", "/nowhere/at/all.fmu"], 3)):
            out = subprocess.run([command, "fmu", *arguments], capture_output=True)
            self.assertEqual(out.returncode, code, out)
            self.assertTrue(out.stderr)


if __name__ == "__main__":
    unittest.main()
