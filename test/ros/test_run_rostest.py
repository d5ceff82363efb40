"""run_rostest.py ends with 0 only if every test of the file says that it succeeded; rostest --text itself always does."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
PASS, FAIL = " * RESULT: SUCCESS", " * RESULT: FAIL"


class Verdict(unittest.TestCase):
    def code(self, tests, said, code=0):
        with tempfile.TemporaryDirectory() as folder:
            fake = pathlib.Path(folder) / "rostest"
            fake.write_text(f"#!/bin/sh\nprintf '{said}\\n'\nexit {code}\n", encoding="utf-8")
            fake.chmod(0o755)
            launch = pathlib.Path(folder) / "a.test"
            launch.write_text("<launch>" + "<test pkg='a' type='b' test-name='c'/>" * tests + "</launch>", encoding="utf-8")
            environment = dict(os.environ, PATH=f"{folder}:{os.environ['PATH']}")
            return subprocess.run([sys.executable, str(HERE / "run_rostest.py"), str(launch), folder], env=environment,
                                  stdout=subprocess.DEVNULL, check=False).returncode

    def test_only_success_of_all_counts(self):
        self.assertEqual(self.code(1, PASS), 0)
        self.assertEqual(self.code(2, PASS + "\\n" + PASS), 0)
        self.assertEqual(self.code(1, FAIL), 1)
        self.assertEqual(self.code(2, PASS + "\\n" + FAIL), 1)
        self.assertEqual(self.code(1, "it died"), 1)
        self.assertEqual(self.code(1, PASS, code=1), 1)
        self.assertEqual(self.code(0, ""), 1)


if __name__ == "__main__":
    sys.exit(unittest.main())
