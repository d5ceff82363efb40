"""Messages -> buffer -> file -> run: nothing is lost, units are kept, bad files are refused with one line."""

import os
import re
import tempfile
import unittest
from unittest import mock

import h5py
import numpy as np

import synthetic_run
from snapwing_tools import clock_watch, run_file, topics
from snapwing_tools.clock_watch import ClockWatch
from snapwing_tools.errors import InputError
from snapwing_tools.recorder import RunBuffer

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def message_fields(name):
    """{field: type} of a message definition in msg/, constants left out."""
    fields = {}
    with open(os.path.join(ROOT, "msg", name + ".msg")) as file:
        for line in file:
            found = re.match(r"\s*([\w/\[\]]+)\s+(\w+)\s*(#.*)?$", line.split("#")[0].rstrip() + "\n")
            if found and "=" not in line.split("#")[0]:
                fields[found.group(2)] = found.group(1)
    return fields


class Clocks(unittest.TestCase):
    """The rule of test/common/test_time_watch.cpp."""

    def test_a_first_time_a_pause_and_a_small_correction_are_no_jumps(self):
        watch = ClockWatch()
        self.assertEqual(watch.look(0.0, 1.0), clock_watch.MISSING)
        for now, steady in ((1.5e9, 2.0), (1.5e9 + 30, 32.0), (1.5e9 + 30, 62.0), (1.5e9 + 29.8, 62.1)):
            self.assertEqual(watch.look(now, steady), clock_watch.ON)
        self.assertEqual(watch.jumps, 0)

    def test_jumps_both_ways(self):
        watch = ClockWatch()
        watch.look(100.0, 1.0)
        self.assertEqual(watch.look(20.0, 1.1), clock_watch.BACK)
        self.assertEqual(watch.look(620.0, 1.2), clock_watch.AHEAD)
        self.assertEqual(watch.look(620.1, 1.3), clock_watch.ON)
        self.assertEqual(watch.jumps, 2)

    def test_a_run_goes_on_through_a_jump(self):
        topic = next(t for t in topics.SERIES if t.name == "imu")
        zero = synthetic_run.Message(x=0.0, y=0.0, z=0.0)
        buffer = RunBuffer(1000.0)
        for stamp, steady in ((1000.0, 5.0), (1000.1, 5.1), (920.2, 5.2), (920.3, 5.3)):
            message = synthetic_run.Message(header=synthetic_run.Message(stamp=stamp), linear_acceleration=zero,
                                            angular_velocity=zero)
            buffer.add(topic, message, stamp, steady)
        run = buffer.to_run("closed")
        np.testing.assert_allclose(run.series["imu"]["time"], [0.0, 0.1, 0.2, 0.3], atol=1e-9)
        self.assertEqual(run.attributes["clock_jumps"], 1)


class Schema(unittest.TestCase):
    """The table of columns agrees with the message definitions."""

    def own(self):
        return [t for t in topics.SERIES + topics.LATCHED if t.message.startswith("snapwing/")]

    def test_every_column_is_a_field(self):
        for topic in self.own():
            for column in topic.columns:
                fields = message_fields(topic.message.split("/")[1])
                for part in column.path.split(".")[:-1]:
                    self.assertIn(part, fields, column.path)
                    if not fields[part].startswith("snapwing/"):
                        fields = {"x": "float64", "y": "float64"}
                    else:
                        fields = message_fields(fields[part].split("/")[1])
                last = column.path.split(".")[-1]
                self.assertIn(last, fields, topic.name + " " + column.path)
                kind = fields[last]
                kinds = {"string": "text", "bool": "bool", "float64": "float"}
                expected = "array" if kind.endswith("]") else kinds.get(kind, "int")
                self.assertEqual(column.kind, expected, topic.name + " " + column.path)

    def test_every_field_is_recorded(self):
        # The outline is in the force table, with its motion; a seal is of no use later.
        left_out = {"header", "outline", "seal"}
        for topic in self.own():
            recorded = {column.path.split(".")[0] for column in topic.columns}
            self.assertEqual(set(message_fields(topic.message.split("/")[1])) - left_out - recorded, set(), topic.name)


class RoundTrip(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.buffer = synthetic_run.make_buffer()

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = os.path.join(self.folder.name, "run.h5")

    def tearDown(self):
        self.folder.cleanup()

    def test_file_holds_what_the_buffer_held(self):
        wanted = self.buffer.to_run("closed")
        self.buffer.save(self.path, "closed")
        found = run_file.read_run(self.path)
        for topic in topics.SERIES:
            self.assertGreater(len(wanted.series[topic.name]["time"]), 0, topic.name)
            order = np.argsort(wanted.series[topic.name]["time"], kind="stable")
            for name, data in wanted.series[topic.name].items():
                np.testing.assert_array_equal(found.series[topic.name][name], data[order], topic.name + "/" + name)
        for topic in topics.LATCHED:
            for name, data in wanted.latched[topic.name].items():
                np.testing.assert_array_equal(found.latched[topic.name][name], data)
        self.assertEqual(found.attributes["ended"], "closed")
        self.assertEqual(found.origin, synthetic_run.ORIGIN)

    def test_every_dataset_has_its_unit(self):
        self.buffer.save(self.path, "closed")
        with h5py.File(self.path, "r") as file:
            self.assertEqual(file["truth/travel"].attrs["unit"], "m")
            self.assertEqual(file["link_status/channels"].attrs["unit"], "us")
            self.assertEqual(file["truth/time"].attrs["unit"], "s")
            names = []
            file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset)
                            and "unit" not in item.attrs else None)
        self.assertEqual(names, [])

    def test_arrays_of_varying_length_are_padded_with_nan(self):
        motors = self.buffer.to_run("closed").series["link_status"]["motors"]
        self.assertEqual(motors.shape[1], 4)
        self.assertTrue(np.isnan(motors[0]).all())
        self.assertTrue(np.isfinite(motors[-1]).all())

    def test_message_without_stamp_takes_its_arrival(self):
        buffer = RunBuffer(100.0)
        message = synthetic_run.link_message(0.0, 1, 0, 0.0, False)
        message.header.stamp = 0.0
        buffer.add(topics.series_topic("link_status"), message, 101.5)
        self.assertEqual(buffer.to_run("closed").series["link_status"]["time"][0], 1.5)

    def test_empty_run_can_be_written_and_read(self):
        RunBuffer(5.0).save(self.path, "closed")
        run = run_file.read_run(self.path)
        self.assertEqual(len(run.missing_topics()), len(topics.SERIES) + len(topics.LATCHED))

    def test_failed_write_leaves_the_old_file_and_no_scraps(self):
        self.buffer.save(self.path, "closed")
        before = self.content()
        with mock.patch.object(run_file, "_fill", side_effect=OSError("disk full")):
            with self.assertRaises(InputError):
                self.buffer.save(self.path, "closed")
        self.assertEqual(self.content(), before)
        self.assertEqual(os.listdir(self.folder.name), ["run.h5"])

    def content(self):
        with open(self.path, "rb") as file:
            return file.read()

    def test_place_that_cannot_be_written(self):
        with self.assertRaisesRegex(InputError, "cannot write .*absent"):
            self.buffer.save(os.path.join(self.folder.name, "absent", "run.h5"), "closed")


class BadRunFiles(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = os.path.join(self.folder.name, "run.h5")

    def tearDown(self):
        self.folder.cleanup()

    def refused(self, pattern):
        with self.assertRaisesRegex(InputError, pattern) as caught:
            run_file.read_run(self.path)
        self.assertNotIn("\n", str(caught.exception))
        self.assertIn(self.path, str(caught.exception))

    def test_missing_empty_and_foreign(self):
        self.refused("no such file")
        open(self.path, "w").close()
        self.refused("empty")
        with open(self.path, "w") as file:
            file.write("time,travel\n0,0\n")
        self.refused("not an HDF5 file")
        with h5py.File(self.path, "w") as file:
            file["travel"] = [1.0]
        self.refused("no recorded run")

    def test_cut_off_file(self):
        synthetic_run.make_buffer(seconds=1.0, pulses={}).save(self.path, "closed")
        with open(self.path, "r+b") as file:
            file.truncate(os.path.getsize(self.path) // 2)
        self.refused("cut off")

    def damage(self, change):
        synthetic_run.make_buffer(seconds=1.0, pulses={}).save(self.path, "closed")
        with h5py.File(self.path, "r+") as file:
            change(file)

    def test_later_version(self):
        self.damage(lambda file: file.attrs.modify("format_version", 3))
        self.refused("format version 3")

    def test_earlier_version(self):
        self.damage(lambda file: file.attrs.modify("format_version", 1))
        self.refused("format version 1")

    def test_missing_dataset(self):
        self.damage(lambda file: file.__delitem__("truth/travel"))
        self.refused("truth/travel is missing")

    def test_wrong_unit(self):
        self.damage(lambda file: file["truth/travel"].attrs.modify("unit", "mm"))
        self.refused("unit 'mm', expected 'm'")

    def test_unequal_lengths(self):
        def shorten(file):
            del file["truth/travel"]
            file["truth/travel"] = [0.0]
            file["truth/travel"].attrs["unit"] = "m"
        self.damage(shorten)
        self.refused("truth/travel has 1 rows")


if __name__ == "__main__":
    unittest.main()
