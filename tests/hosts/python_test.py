"""The Python package against the command, the header and its own page.

    python_test.py BUILD     with SUTURA_LIBRARY and PYTHONPATH set, as ctest does
"""

import copy
import locale
import os
import re
import subprocess
import sys
import tempfile
import threading
import unittest
import warnings
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import sutura
from sutura import _library

SOURCE = Path(__file__).resolve().parents[2]
SCENES = SOURCE / "scenes"
STITCH = SCENES / "suture/first_stitch.xml"
BUILD = Path(sys.argv.pop(1))


def held_thread() -> sutura.Scene:
    scene = sutura.Scene(plugins=["thread", "tools"], dt="5 ms")
    thread = scene.add("SutureThread", name="suture", thread="4-0 polypropylene",
                       thread_length="50 mm")
    scene.add("Track", times=0)
    scene.add("Grasper", body=thread)
    return scene


class Bits(unittest.TestCase):
    """To the last bit."""

    def test_a_run_is_that_of_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            sim = sutura.load(SCENES / "suture/prick.xml", output=f"{folder}/ours")
            with sim.recording():
                sim.step(30)
                sim.save(f"{folder}/ours/state")
            subprocess.run([BUILD / "bin/sutura", "run", SCENES / "suture/prick.xml", "--steps",
                            "30", "--checkpoint-every", "0.3", "--output", f"{folder}/theirs"],
                           check=True, capture_output=True)
            ours, theirs = Path(folder, "ours"), Path(folder, "theirs")
            self.assertEqual((ours / "state").read_bytes(),
                             (theirs / "checkpoint.sutura").read_bytes())
            self.assertEqual((ours / "probe.csv").read_bytes(), (theirs / "probe.csv").read_bytes())
            again = sutura.load(SCENES / "suture/prick.xml")
            again.restore(theirs / "checkpoint.sutura")
            self.assertEqual(again.report.step, 30)

    def test_save_restore_reset(self):
        sim = held_thread().load()
        first = sim.save()
        sim["/track.position"] = [0, 0, 0.01]
        sim.step(20)
        here = sim.save()
        sim.step(20)
        there = sim.save()
        sim.restore(here)
        sim.step(20)
        self.assertEqual(sim.save(), there)
        sim.reset()
        self.assertEqual(sim.save(), first)
        self.assertEqual(sim.time, 0)

    def test_a_simulation_is_not_copied(self):
        with sutura.load(STITCH) as sim:
            for way in (copy.copy, copy.deepcopy):
                with self.assertRaises(sutura.Misuse):
                    way(sim)
            for count in (2**70, 2.0, "2"):
                with self.assertRaises(sutura.Misuse):
                    sim.step(count)
            self.assertEqual(sim.step(np.int64(1)).step, 1)

    def test_attributes_are_numbers_of_python_or_numpy(self):
        scene = sutura.Scene(plugins=["thread"], dt=0.01)
        scene.add("SutureThread", needle_length=0, thread_length=np.float32(0.05),
                  thread_beams=np.int64(20), settle=np.bool_(True), clamp="start")
        self.assertEqual(scene.load()["/suture_thread.beams"], 20)
        with self.assertRaises(sutura.Misuse):
            scene.add("ThreadLoad", at=0, force=["0", "0", "1 N"])

    def test_settings_are_what_attributes_are(self):
        with sutura.load(STITCH, settings={".gravity": [0, 0, -1], ".tolerance": 0.02}) as sim:
            self.assertIn('gravity="0 0 -1', sim.xml)
            state = sim.save()
            sim.step()
            sim.restore(memoryview(state))
            self.assertEqual(sim.time, 0)

    def test_threads_do_not_disturb_each_other(self):
        def run(out, key):
            with sutura.load(SCENES / "suture/prick.xml") as sim:
                sim.step(15)
                out[key] = sim.save()
        alone, together = {}, {}
        run(alone, 0)
        workers = [threading.Thread(target=run, args=(together, i)) for i in range(3)]
        for w in workers:
            w.start()
        for w in workers:
            w.join()
        self.assertEqual(list(together.values()), [alone[0]] * 3)

    def test_with_eigen_the_kernels_of_blas_do_not_matter(self):
        program = ("import hashlib, sys, sutura;"
                   "sim = sutura.loads(sys.argv[1], directory=sys.argv[2]); sim.step(8);"
                   "print(hashlib.sha256(sim.save()).hexdigest())")
        prick = (SCENES / "suture/prick.xml").read_text()

        def bits(backend, kernels):
            scene = prick.replace("<Attach", f'<DirectSolver backend="{backend}"/> <Attach')
            return subprocess.run(
                [sys.executable, "-W", "ignore", "-c", program, scene, SCENES / "suture"],
                check=True, env={**os.environ, "OPENBLAS_CORETYPE": kernels}, capture_output=True).stdout
        self.assertEqual(bits("eigen", "Haswell"), bits("eigen", "Nehalem"))
        if "SUTURA_CHOLMOD:BOOL=ON" in (BUILD / "CMakeCache.txt").read_text():
            self.assertNotEqual(bits("auto", "Haswell"), bits("auto", "Nehalem"),
                                "the scene does not show what this test is about")

    def test_workers_of_the_host(self):
        def run(workers):
            path = next(p for p, c in sutura.load(STITCH).components.items()
                        if c.type == "AsyncPreconditioner")
            with sutura.load(STITCH, settings={f"{path}.lag": 3}, workers=workers) as sim:
                sim.step(50)
                return sim.save()
        alone = run(None)
        handed_in = []

        class Counted(ThreadPoolExecutor):
            def submit(self, run, *arguments):
                handed_in.append(arguments)
                return super().submit(run, *arguments)
        with Counted(2) as pool, ThreadPoolExecutor(3) as hosts:
            self.assertEqual(list(hosts.map(run, [pool] * 3)), [alone] * 3)
        self.assertGreater(len(handed_in), 2)
        self.assertEqual(run(pool), alone)  # although it has been shut down
        for wrong in (3, ProcessPoolExecutor):
            with self.assertRaises(sutura.Misuse):
                held_thread().load(workers=wrong)

    def test_a_locale_with_decimal_commas_changes_nothing(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", f"{folder}/de_DE.UTF-8"],
                           check=True, capture_output=True)
            os.environ["LOCPATH"] = folder
            plain = held_thread().load(settings={".dt": "2.5 ms"})
            plain.step(3)
            try:
                locale.setlocale(locale.LC_ALL, "de_DE.UTF-8")
                self.assertEqual(locale.localeconv()["decimal_point"], ",")
                comma = held_thread().load(settings={".dt": "2.5 ms"})
                comma.step(3)
                self.assertEqual(locale.setlocale(locale.LC_ALL), "de_DE.UTF-8")
                probe = sutura.load(SCENES / "components/CsvProbe.xml", output=f"{folder}/comma")
                with probe.recording():
                    probe.step(5)
            finally:
                locale.setlocale(locale.LC_ALL, "C")
                del os.environ["LOCPATH"]
            probe = sutura.load(SCENES / "components/CsvProbe.xml", output=f"{folder}/plain")
            with probe.recording():
                probe.step(5)
            self.assertEqual(Path(folder, "comma/probe.csv").read_bytes(),
                             Path(folder, "plain/probe.csv").read_bytes())
            self.assertEqual(comma.save(), plain.save())
            self.assertEqual(comma.xml, plain.xml)


class Values(unittest.TestCase):
    def test_outputs_and_inputs(self):
        sim = held_thread().load()
        sim["/track.position"] = np.array([0.001, 0, 0.002])
        sim.step()
        np.testing.assert_allclose(sim["/track.position"], [0.001, 0, 0.002], rtol=1e-15)
        self.assertIsInstance(sim["/grasper.holding"], float)
        self.assertEqual(sim["/grasper"]["force"].shape, (3,))
        sim["/grasper"]["hold"] = 0
        sim.step()
        self.assertEqual(sim["/grasper.holding"], 0)
        self.assertEqual(set(sim["/track"].inputs), {"position", "rotation"})
        self.assertEqual(sim.inputs["/grasper.hold"].high, 1)
        self.assertEqual(sim.outputs["/grasper.force"].unit, "N")

    def test_pose(self):
        sim = held_thread().load()
        half = np.sqrt(0.5)
        sim["/track"].pose = [0, 0, 0.01], [half, 0, 0, half]
        sim.step()
        position, quaternion = sim["/track"].pose
        np.testing.assert_allclose(position, [0, 0, 0.01], atol=1e-15)
        np.testing.assert_allclose(quaternion, [half, 0, 0, half], atol=1e-15)
        with self.assertRaises(sutura.Misuse):
            sim["/track"].pose = [0, 0, 0], [2, 0, 0, 0]
        with self.assertRaises(sutura.Misuse):
            sim["/track"].pose = [0, 0], [1, 0, 0, 0]

    def test_positions_stay_those_of_their_step(self):
        sim = sutura.load(SCENES / "components/Tissue.xml")
        before = sim["/tissue"].positions
        self.assertIs(sim["/tissue"].positions, before)
        kept = before.copy()
        sim.step(3)
        after = sim["/tissue"].positions
        np.testing.assert_array_equal(before, kept)
        self.assertGreater(np.abs(after - before).max(), 0)
        self.assertFalse(after.flags.writeable)
        self.assertEqual(after.shape[1], 3)
        cells = sim["/tissue"].cells
        self.assertEqual(cells.shape[1], 4)
        self.assertTrue(((cells >= 0) & (cells < len(after))).all())
        for name, values in sim["/tissue"].shape.fields.items():
            self.assertIn(len(values), (len(after), len(cells)), name)
        sim.close()
        np.testing.assert_array_equal(before, kept)  # and outlive the simulation

    def test_run_ends_where_the_scene_does(self):
        sim = sutura.load(SCENES / "suture/prick.xml", settings={".duration": "50 ms"})
        self.assertEqual([r.step for r in sim.run()], [1, 2, 3, 4, 5])
        self.assertEqual(len(list(sim.run(0.02))), 2)

    def test_picture(self):
        sim = sutura.load(SCENES / "suture/prick.xml")
        root = ElementTree.fromstring(sim.picture(width=300))
        self.assertEqual(root.get("width"), "300")
        kinds = [e.tag.rpartition("}")[2] for e in root]
        self.assertGreater(kinds.count("polygon"), 100)
        self.assertEqual(kinds.count("path"), 1)
        self.assertIn("<svg", sim._repr_html_())


class Written(unittest.TestCase):
    """Scenes written in Python."""

    def test_is_the_scene_that_the_xml_is(self):
        scene = sutura.Scene(plugins=["thread", "tissue", "suturing", "tools", "output"],
                             dt=0.01, gravity=[0, 0, -9.81], duration="2 s",
                             directory=SCENES / "suture")
        skin = scene.node("skin")
        skin.add("TetMesh", file="../meshes/pad.msh", unit="mm")
        skin.add("Tissue", young=20e3, poisson=0.45, element="t4", density=1000)
        skin.add("Layer", region="dermis", young="100 kPa")
        skin.add("Attach", box="-25 -15 -10  25 15 -10 mm")
        thread = scene.add("SutureThread", name="suture", needle="26 mm 1/2 circle",
                           thread="4-0 polypropylene", thread_length=0.05,
                           needle_centre=[0, 0, 0.005], tip_angle="-63 deg",
                           plane_normal=(0, -1, 0))
        scene.add("Track", about=thread, times=[0, 1.6], turns="0 161 deg", easing="smooth")
        scene.add("Grasper", at="23 mm")
        scene.add("Puncture", threshold=0.3, friction=0.2)
        scene.add("Cutting", threshold=0.1)
        scene.add("SuturePath", spacing=1e-3)
        scene.add("PathFriction", coefficient=0.3, pressure="20 kPa")
        scene.add("VtuRecorder", every=5)
        scene.add("CsvProbe", columns="/puncture.force /grasper.force /path_friction.force")
        self.assertEqual(scene.load().xml, sutura.load(SCENES / "suture/prick.xml").xml)

    def test_names_are_those_of_the_library(self):
        for file in (SCENES / "components").glob("*.xml"):
            component = file.stem
            paths = {p.rpartition("/")[2]: c.type
                     for p, c in sutura.load(file).components.items()}
            if component in paths.values() and f"<{component} name=" not in file.read_text():
                self.assertEqual(paths.get(sutura.scene._default_name(component)), component)

    def test_errors_lead_to_this_file(self):
        scene = sutura.Scene(plugins=["thread"])
        line = sys._getframe().f_lineno + 1
        scene.add("SutureThread", thread_lenght="5 cm")
        scene.node("n").add("SutureThread", name="b", thread_length="5 kPa")
        with self.assertRaises(sutura.SceneError) as caught:
            scene.load()
        error = caught.exception
        self.assertEqual(Path(error.file).name, "python_test.py")
        self.assertEqual(error.line, line)
        self.assertEqual([d.line for d in error.diagnostics], [line, line + 1])
        self.assertIn("did you mean 'thread_length'?", str(error))
        self.assertIn("[/n/b]", str(error))

    def test_what_cannot_be_an_attribute(self):
        with self.assertRaises(sutura.Misuse):
            sutura.Scene().add("Track", times=object())


class Errors(unittest.TestCase):
    def test_names(self):
        sim = held_thread().load()
        for name, near in (("/sutur", "/suture"), ("/grasper.forc", "force"),
                           ("/trak.position", "/track")):
            with self.assertRaises(KeyError) as caught:
                sim[name]
            self.assertIn(f"did you mean '{near}'?", str(caught.exception))
        with self.assertRaises(sutura.NotFound):
            sim["/track.hold"] = 1
        with self.assertRaises(ValueError):
            sim["/grasper.hold"] = 2
        with self.assertRaises(sutura.NotFound):
            sim["/track"].positions

    def test_files(self):
        with self.assertRaises(OSError):
            sutura.load("nowhere.xml")
        with self.assertRaises(sutura.PluginError) as caught:
            sutura.loads("<sutura version='1'>\n<plugin name='thred'/></sutura>", name="a.xml")
        self.assertEqual((caught.exception.file, caught.exception.line), ("a.xml", 2))
        sim = held_thread().load()
        with self.assertRaises(sutura.FileError):
            sim.restore(b"no state")

    def test_closed(self):
        sim = held_thread().load()
        sim.close()
        sim.close()
        for call in (sim.step, sim.save, sim.reset, lambda: sim.time,
                     lambda: sim["/suture"].positions, lambda: sim["/grasper.force"]):
            with self.assertRaises(sutura.Misuse):
                call()
        self.assertIn("closed", repr(sim))

    def test_faults_become_warnings(self):
        crushed = {".gravity": "0 0 -5000"}
        sim = sutura.load(SCENES / "components/DirectSolver.xml", settings=crushed)
        with self.assertWarns(sutura.SuturaWarning) as caught:
            sim.step()
        self.assertEqual(Path(caught.filename).name, "python_test.py")
        heard = []
        sim = sutura.load(SCENES / "components/DirectSolver.xml", settings=crushed,
                          on_message=lambda kind, sentence: heard.append((kind, sentence)))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            sim.step()
        self.assertTrue(any(kind == "warning" and "inside out" in s for kind, s in heard), heard)

    def test_what_a_message_function_raises_arrives(self):
        def refuse(kind, sentence):
            raise RuntimeError(sentence)
        sim = sutura.load(SCENES / "components/DirectSolver.xml",
                          settings={".gravity": "0 0 -5000"}, on_message=lambda *_: None)
        sim._messages._receive = refuse
        with self.assertRaises(RuntimeError):
            sim.step()


class Documented(unittest.TestCase):
    """Header, package and page name the same things."""

    def test_every_function_of_the_header_is_declared(self):
        header = (SOURCE / "include/sutura/sutura.h").read_text()
        declared = set(re.findall(r"SUTURA_C [\w* ]*?(sutura_\w+)\(", header))
        known = set(_library.FUNCTIONS) | {"sutura_api", "sutura_version", "sutura_error",
                                            "sutura_diagnostic_count"}
        self.assertEqual(declared, known)
        package = "".join(f.read_text() for f in (SOURCE / "src/python/sutura").glob("*.py"))
        for function in known:
            kind = re.sub(r"_(find|describe)_(input|output|body|tool)|"
                          r"_(input|output|component|body|tool)_(count|at)$", "", function)
            if kind == function:  # the others are called by a name that is put together
                self.assertIn(f"library.{function}", package)

    def test_every_struct_has_the_members_of_the_header(self):
        header = (SOURCE / "include/sutura/sutura.h").read_text()
        header = re.sub(r"/\*.*?\*/", "", header, flags=re.DOTALL)
        classes = {"diagnostic": _library.CDiagnostic, "options": _library.Options,
                   "report": _library.CReport, "component": _library.CComponent,
                   "value": _library.CValue, "geometry": _library.CGeometry,
                   "field": _library.CField}
        found = dict(re.findall(r"typedef struct sutura_(\w+) \{(.*?)\}", header, re.DOTALL))
        self.assertEqual(set(found), set(classes))
        for name, body in found.items():
            members = [m for line in body.split(";") for m in re.findall(r"(\w+)(?=\s*(?:,|$))",
                                                                          line.strip())]
            self.assertEqual(members, [f[0] for f in classes[name]._fields_], name)

    def test_every_name_is_in_the_page_and_explained(self):
        page = (SOURCE / "docs/embed/python.md").read_text()
        for name in sutura.__all__:
            self.assertIn(f"`{name}`", page)
            thing = getattr(sutura, name)
            if isinstance(thing, type) or callable(thing):
                self.assertTrue(thing.__doc__, name)
        for kind in (sutura.Simulation, sutura.Component, sutura.Scene, sutura.Input,
                     sutura.Output):
            for name, member in vars(kind).items():
                if not name.startswith("_") and (callable(member) or isinstance(member, property)):
                    self.assertTrue(member.__doc__, f"{kind.__name__}.{name}")


if __name__ == "__main__":
    warnings.simplefilter("ignore", sutura.SuturaWarning)  # of the smallest scenes
    unittest.main(warnings="ignore")
