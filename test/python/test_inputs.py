"""Files that two readers could take for two things are refused by the Python readers as by the C++ ones."""

import os
import tempfile
import unittest

from snapwing_tools import inputs
from snapwing_tools.errors import InputError
from snapwing_tools.yaml_file import load_yaml

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "file")

    def write(self, content):
        with open(self.path, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return self.path

    def refused(self, pattern, read, content):
        with self.assertRaisesRegex(InputError, pattern):
            read(self.write(content))


class Yaml(Files):
    def test_what_is_read_in_two_ways_is_refused(self):
        self.refused("expected a single document", load_yaml, "a: 1\n---\na: 2\n")
        self.refused("line 2 names a node that holds this very line", load_yaml, "a: 1\nb: &s {c: [*s]}\n")
        self.refused("line 3 holds a merge key", load_yaml, "a: &x {c: 1}\nb:\n  <<: *x\n")
        self.refused("line 2: 'a' is given twice", load_yaml, "a: 1\na: 2\n")
        for number in ("010", "-007.5", "0x10", "1_000", "1:30"):
            self.refused("line 1: '{}' is read as different numbers".format(number), load_yaml, "a: [" + number + "]\n")
        self.refused("not YAML", load_yaml, "a: [1, 2")
        self.refused("not YAML", load_yaml, b"a: \xff\xfe")

    def test_plain_files_are_read(self):
        self.assertEqual(load_yaml(self.write(b"\xef\xbb\xbfa: 0.5\r\nb: '010'\r\nc: &x [1, -2.0e-3]\r\nd: *x\r\n")),
                         {"a": 0.5, "b": "010", "c": [1, -0.002], "d": [1, -0.002]})

    def test_aliases_are_not_unfolded(self):
        lines = ["a0: &a0 [1, 1]"] + ["a{0}: &a{0} [*a{1}, *a{1}]".format(k, k - 1) for k in range(1, 60)]
        self.assertEqual(len(load_yaml(self.write("\n".join(lines)))), 60)

    def test_every_shipped_file_is_read(self):
        count = 0
        for folder, _, names in os.walk(os.path.join(ROOT, "config")):
            for name in names:
                load_yaml(os.path.join(folder, name))
                count += 1
        self.assertGreater(count, 20)


class Csv(Files):
    def read(self, path):
        return inputs.read_table_csv(path, ("time_s", "travel_m"))

    def test_rows_are_strict(self):
        self.refused("line 3 has 3 fields; allowed: the 2 of the header", self.read, "time_s,travel_m\n0,1\n1,0,5\n")
        self.refused("line 2 has 1 fields", self.read, "time_s,travel_m\n0\n")
        for word in ("1abc", "1_0", "", "0x1", "1;2"):
            self.refused("line 3, column 'travel_m': '{}' is not a number".format(word), self.read,
                         "# remark\ntime_s,travel_m\n0,{}\n".format(word))
        self.refused("given twice", self.read, "time_s,travel_m,time_s\n0,1,2\n")
        self.refused("column 'travel_m' is missing", self.read, "time_s,travel_mm\n0,1\n")

    def test_line_ends_and_marks_of_other_systems(self):
        for end in (b"\n", b"\r\n", b"\r"):
            content = end.join((b"\xef\xbb\xbf# remark", b"time_s, travel_m ,note", b"", b"0,1.5e-3,x", b"1,nan,"))
            columns = self.read(self.write(content + end))
            self.assertEqual(list(columns["time_s"]), [0, 1])
            self.assertEqual(columns["travel_m"][0], 1.5e-3)


if __name__ == "__main__":
    unittest.main()
