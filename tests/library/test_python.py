"""The module wirebench: its structs match the compiler's, its arrays match the files.

Usage: test_python.py SOURCE_ROOT RECORDING DATASET COMPILER...
"""

import csv
import math
import os
import re
import subprocess
import sys
import tempfile
import threading
import unittest
import warnings

import numpy as np

import wirebench
from wirebench import _structs

SOURCE, RECORDING, DATASET = sys.argv[1:4]
COMPILER = sys.argv[4:]
HEADER = os.path.join(SOURCE, "include", "wirebench.h")


def rows_of_csv():
    with open(os.path.join(DATASET, "force_deflection.csv"), newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


class Binding(unittest.TestCase):
    def test_structs_have_the_layout_of_the_compiler(self):
        wanted, lines = [], []
        for name, struct in _structs.STRUCTS.items():
            full = "struct wirebench_" + name
            wanted.append((full, struct.__name__, _size(struct)))
            lines.append('printf("%%zu\\n", sizeof(%s));' % full)
            for field, *_ in struct._fields_:
                wanted.append((full, field, getattr(struct, field).offset))
                lines.append('printf("%%zu\\n", offsetof(%s, %s));' % (full, field))
        source = '#include <stdio.h>\n#include "%s"\nint main(void)\n{\n%s\nreturn 0;\n}\n' % (
            HEADER, "\n".join(lines))
        with tempfile.TemporaryDirectory() as folder:
            program = os.path.join(folder, "layout")
            subprocess.run(COMPILER + ["-x", "c", "-", "-o", program], input=source.encode(),
                           check=True)
            found = subprocess.run([program], capture_output=True, check=True).stdout.split()
        self.assertEqual(len(found), len(wanted))
        for (struct, field, offset), number in zip(wanted, found):
            self.assertEqual(offset, int(number), "%s.%s" % (struct, field))

    def test_every_function_and_struct_of_the_header_is_declared(self):
        with open(HEADER) as file:
            text = file.read()
        code = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
        self.assertEqual(set(re.findall(r"\bwirebench_([a-z_]+)\(", code)),
                         set(_structs.FUNCTIONS))
        self.assertEqual(set(re.findall(r"^struct wirebench_([a-z_]+) *\{", code, flags=re.M)),
                         set(_structs.STRUCTS))


def _size(struct):
    import ctypes
    return ctypes.sizeof(struct)


class Files(unittest.TestCase):
    def test_a_dataset_is_its_csv_in_si(self):
        table, rows = wirebench.Dataset(DATASET).table(), rows_of_csv()
        self.assertEqual(table.rows, len(rows))
        self.assertGreater(len(rows), 100)
        for column, of, scale in (("force_N", "force_N", 1.0), ("t_s", "t_s", 1.0),
                                  ("deflection_m", "deflection_mm", 1e-3)):
            expected = np.array([float(row[of]) if row[of] else math.nan for row in rows])
            np.testing.assert_allclose(table[column], expected * scale, rtol=1e-15, atol=0)
        self.assertEqual(list(table["phase"]), [row["phase"] for row in rows])
        self.assertEqual(table["cycle"].dtype, np.int64)
        self.assertEqual(table.units["force_N"], "N")

    def test_a_dataset_describes_itself(self):
        dataset = wirebench.Dataset(DATASET)
        self.assertEqual((dataset.info.wire, dataset.info.kind), ("type1", "cantilever"))
        self.assertAlmostEqual(dataset.info.length, 0.085)
        self.assertIn("corrections", dataset.document)
        shape = dataset.table("shape")
        self.assertEqual(set(shape["marker"]), set(range(7)))

    def test_a_recording_is_aligned_to_the_dataset_that_the_tool_writes(self):
        written = wirebench.Dataset(DATASET)
        with self.assertWarnsRegex(wirebench.Incomplete, "1 gap in the rows") as warned:
            aligned = wirebench.align(RECORDING)
        self.assertEqual(warned.filename, __file__)  # the caller's line
        self.assertIsInstance(aligned, wirebench.Dataset)
        for name in ("force_deflection", "shape"):
            one, other = aligned.table(name), written.table(name)
            self.assertEqual(list(one), list(other))
            self.assertGreater(one.rows, 1000)
            for column in one:
                np.testing.assert_array_equal(one[column], other[column], column)
        self.assertEqual(aligned.info, written.info)
        self.assertEqual(aligned.document, written.document)

    def test_options_and_files_of_an_alignment_are_used(self):
        with wirebench.Recording(RECORDING) as recording:
            specimen = recording.meta("specimen").replace("sample: 1", "sample: 7")
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            file.write(specimen)
            file.flush()
            with self.assertWarnsRegex(wirebench.Remark, "sample"):
                aligned = wirebench.align(RECORDING, specimen=file.name,
                                          options={"longest-gap-s": 5, "row-rate": 2})
        self.assertEqual((aligned.info.sample, aligned.info.is_complete), (7, 1))
        self.assertTrue(500 < aligned.table().rows < 700)
        with self.assertRaisesRegex(wirebench.Error, "no-such"):
            wirebench.align(RECORDING, options={"no-such": 1})

    def test_a_recording_has_samples_and_texts(self):
        with wirebench.Recording(RECORDING) as recording:
            self.assertTrue(recording.info.is_whole)
            self.assertEqual(recording.problems, [])
            load = [s for s in recording.streams if s.role == "load"][0]
            table = recording.table("load")
            self.assertEqual(table.rows, load.samples)
            self.assertTrue(np.all(np.diff(table["index"]) == 1))
            self.assertIn("wire: type1", recording.meta("specimen"))
            self.assertIsNone(recording.meta("nothing"))
        with self.assertRaises(ValueError):
            recording.meta("specimen")

    def test_a_table_becomes_a_frame(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("pandas is not there")
        table = wirebench.Dataset(DATASET).table("shape")
        frame = table.frame()
        self.assertIsInstance(frame, pandas.DataFrame)
        self.assertEqual(list(frame.columns), list(table))
        self.assertEqual(len(frame), table.rows)

    def test_failures_are_exceptions_with_the_tools_message(self):
        with self.assertRaisesRegex(wirebench.Error, "/no/such.wbr") as caught:
            wirebench.Recording("/no/such.wbr")
        self.assertEqual(caught.exception.status, -4)
        with self.assertRaisesRegex(wirebench.Error, "no table 'forces'"):
            wirebench.Dataset(DATASET).table("forces")


class Mechanics(unittest.TestCase):
    diameter, modulus, length = 1.1e-3, 5e9, 0.085
    rigidity = modulus * math.pi * diameter**4 / 64

    def test_an_elastic_wire_follows_the_cubic_formulas(self):
        wire = wirebench.Properties(self.diameter, self.modulus)
        solution = wirebench.solve_cantilever(wire, self.length, [0, 1e-4],
                                              positions=[0, self.length / 2, self.length])
        expected = 3 * self.rigidity * 1e-4 / self.length**3
        np.testing.assert_allclose(solution.force[1], expected, rtol=1e-3)
        np.testing.assert_allclose(solution.shape_y[1], [0, 0.3125e-4, 1e-4], rtol=1e-3,
                                   atol=1e-12)
        self.assertFalse(solution.slack.any())
        bent = wirebench.solve_three_point(wire, 0.04, [5e-5])
        np.testing.assert_allclose(bent.force[0], 48 * self.rigidity * 5e-5 / 0.04**3, rtol=5e-3)
        np.testing.assert_allclose(wire.moments([[1.0, 2.0]]),
                                   [[self.rigidity, 2 * self.rigidity]], rtol=1e-6)

    def test_parallel_parts_are_passed_with_their_rule(self):
        parts = [(3e9, 1e-3), (1e9, 4e-3), (0.5e9, math.inf)]
        info = wirebench.Properties(self.diameter, parts=parts, kinematic_share=0.25).info
        self.assertEqual([(p.modulus, p.yield_strain) for p in info.parts], parts)
        self.assertAlmostEqual(info.kinematic_share, 0.25)
        with self.assertRaises(ValueError):
            wirebench.Properties(self.diameter, parts=[(1e9, 1e-3)] * 13)

    def test_chaboches_law_is_passed_with_its_back_stresses(self):
        backs = [(2.6e9, 900.0), (0.7e9, 60.0)]
        wire = wirebench.Properties(self.diameter, 5.6e9, 2.2e6, saturation=1.4e6, rate=250.0,
                                    backs=backs)
        info = wire.info
        self.assertEqual([(b.modulus, b.recovery) for b in info.backs], backs)
        self.assertEqual((info.law_youngs_modulus, info.law_yield_stress, info.saturation,
                          info.rate), (5.6e9, 2.2e6, 1.4e6, 250.0))
        rigidity = 5.6e9 * math.pi * self.diameter**4 / 64
        np.testing.assert_allclose(wire.bend(30.0).rigidity, rigidity, rtol=1e-9)
        self.assertLess(wire.moments([30.0])[0], 0.5 * 30.0 * rigidity)
        with self.assertRaisesRegex(wirebench.Error, "n_parts"):
            wirebench.Properties(self.diameter, 5.6e9, 2.2e6, backs=backs, parts=[(1e9, 1e-3)])
        with self.assertRaises(ValueError):
            wirebench.Properties(self.diameter, 5.6e9, 2.2e6, backs=backs * 2)

    def test_unreachable_deflections_are_a_warning(self):
        wire = wirebench.Properties(self.diameter, self.modulus)
        with self.assertWarnsRegex(wirebench.Incomplete, "row 1 of 2"):
            bent = wirebench.solve_three_point(wire, 0.04, [1e-3, 0.5], overhang=1e-3)
        self.assertEqual(bent.n_done, 1)
        self.assertTrue(math.isnan(bent.force[1]))


class Harness(unittest.TestCase):
    def test_a_harness_is_assembled_and_undone(self):
        with wirebench.Harness("small") as harness:
            self.assertEqual((harness.info.name, harness.info.n_steps, harness.info.state),
                             ("small", 7, 0))
            harness.hang()
            harness.mount("C1", [0.19, 0, 0.03], direction=[1, 0.2, 0.2])
            before, forces = harness.table(), harness.table("forces")
            self.assertEqual(list(forces["item"]), ["R", "C1"])
            self.assertEqual(set(before["branch"]), {"B1", "B2", "B3"})
            self.assertEqual(before.units["moment_Nm"], "N m")
            harness.snapshot("mounted")
            harness.move("C1", np.array([0.19, 0.02, 0.03]))
            items = harness.table("items")
            np.testing.assert_allclose(items["y_m"][list(items["item"]).index("C1")], 0.02,
                                       atol=1e-10)
            self.assertGreater(np.abs(harness.table()["y_m"] - before["y_m"]).max(), 0.015)
            harness.undo()
            for column in before:
                np.testing.assert_array_equal(harness.table()[column], before[column])
            harness.release("C1")
            harness.restore("mounted")
            np.testing.assert_array_equal(harness.table("forces")["force_N"], forces["force_N"])
            with self.assertRaisesRegex(wirebench.Error, "C1 to R: 230.2 mm apart, 200 mm"):
                harness.move("C1", [0.19, 0, 0.13])
            harness.take_off()
            self.assertTrue(harness.info.is_converged)
            self.assertEqual(harness.info.step, "take_off")

    def test_wire_that_slides_through_a_clip_has_its_length(self):
        with open(os.path.join(SOURCE, "fixtures", "harnesses", "small.yaml")) as file:
            text = file.read().replace("holds: axis", "holds: slide")
        text = re.sub(r"(mount: C1.*\]), direction.*", r"\1}", text)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "slides.yaml")
            with open(path, "w") as file:
                file.write(text)
            with wirebench.Harness(path) as harness:
                harness.mount("C1", [0.19, 0, 0.03])
                harness.move("C1", [0.15, 0, 0.03])
                forces = harness.table("forces")
        slid = dict(zip(forces["item"], forces["slid_m"]))
        self.assertTrue(math.isnan(slid["R"]))
        self.assertLess(abs(slid["C1"] + 0.047), 0.01)  # towards the end: 200 mm of wire, 153 mm away

    def test_steps_of_the_file_are_those_of_the_methods(self):
        one, other = wirebench.Harness("small"), wirebench.Harness("small")
        for step in one.planned_steps[:2]:
            one.take_step(step)
        other.hang()
        other.mount("C1", [0.19, 0, 0.03], [1, 0.2, 0.2])
        np.testing.assert_allclose(one.table()["z_m"], other.table()["z_m"], rtol=1e-9, atol=1e-12)
        elastic = wirebench.Harness("small", is_elastic=True)
        elastic.hang()
        self.assertLess(elastic.info.plastic, 1e-9 * elastic.info.elastic)


class Calibration(unittest.TestCase):
    def test_both_methods_give_properties_that_can_be_read(self):
        dataset = wirebench.Dataset(DATASET)
        for method in ("cycle", "paper"):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", wirebench.Remark)
                made = wirebench.calibrate([dataset], method)
            self.assertEqual(made.info.method, method)
            with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
                file.write(made.text)
                file.flush()
                again = wirebench.Properties.read(file.name)
            self.assertEqual(again.info.youngs_modulus, made.info.youngs_modulus)

    def test_options_remarks_and_progress_are_passed(self):
        dataset = wirebench.Dataset(DATASET)
        with self.assertWarns(wirebench.Remark):
            made = wirebench.calibrate([dataset], "paper", options={"elastic-zone": 0.1})
        self.assertIn("elastic_zone: 0.1\n", made.text)
        with self.assertRaisesRegex(wirebench.Error, "no-such"):
            wirebench.calibrate([dataset], options={"no-such": 1})

        def fail(done, all_):
            raise KeyError("mine")

        with warnings.catch_warnings(), self.assertRaisesRegex(KeyError, "mine"):
            warnings.simplefilter("ignore")
            wirebench.calibrate([dataset], "paper", progress=fail)

    def test_threads_calibrate_at_the_same_time(self):
        found = []

        def work():
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                found.append(wirebench.calibrate([wirebench.Dataset(DATASET)], "paper",
                                                 threads=1).info.youngs_modulus)

        threads = [threading.Thread(target=work) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(found), 2)
        self.assertEqual(found[0], found[1])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
