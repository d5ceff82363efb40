"""design.launch and validate.launch with README.md's words, killed in the middle and started again.
usage: test_pipeline_launch.py"""
import contextlib
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
LAUNCHES = re.findall(r"roslaunch snapwing (?:design|validate)\.launch [^`\n]*", (ROOT / "README.md").read_text(encoding="utf-8"))


class Launch(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        with contextlib.closing(socket.socket()) as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        self.environment = dict(os.environ, ROS_HOME=str(self.folder / "ros"), ROS_MASTER_URI=f"http://localhost:{port}",
                                PWD=str(self.folder))
        mine = self.folder / "my_vehicle"
        mine.mkdir()
        text = (ROOT / "config/vehicles/arris_x220.yaml").read_text(encoding="utf-8").replace("../../data", str(ROOT / "data"))
        (mine / "vehicle.yaml").write_text(text, encoding="utf-8")
        text = (ROOT / "test/data/designs/arm_tiny.yaml").read_text(encoding="utf-8")
        text = text.replace("cell_sizes: [0.004]", "cell_sizes: [0.0025, 0.00125]").replace("../../../config/vehicles/arris_x220", "vehicle")
        (mine / "arm_design.yaml").write_text(text, encoding="utf-8")

    def start(self, words, *more):
        log = open(self.folder / "log", "w", encoding="utf-8")  # pylint: disable=consider-using-with
        self.addCleanup(log.close)
        child = subprocess.Popen([*words.split(), *more, f"config:={ROOT}/test/ros/pipeline_quick.yaml"], cwd=self.folder,
                                 env=self.environment, stdout=log, stderr=subprocess.STDOUT, start_new_session=True)
        self.addCleanup(self.end, child)
        return child

    def end(self, child):
        """Every process of a launch, the nodes too, which have sessions of their own."""
        mark = f"ROS_MASTER_URI={self.environment['ROS_MASTER_URI']}".encode()
        for entry in pathlib.Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError):
                if int(entry.name) != os.getpid() and mark in (entry / "environ").read_bytes().split(b"\0"):
                    os.kill(int(entry.name), signal.SIGKILL)
        child.wait()

    def log(self):
        return (self.folder / "log").read_text(encoding="utf-8")

    def kill_when(self, child, there):
        end = time.monotonic() + 100
        while not there() and child.poll() is None and time.monotonic() < end:
            time.sleep(0.02)
        self.assertTrue(there(), self.log())
        self.assertIsNone(child.poll(), "it ended before it could be killed: " + self.log())
        self.end(child)

    def finish(self, child):
        child.wait(timeout=150)
        return self.log()

    def test_the_words_of_the_readme(self):
        self.assertEqual([words.split()[2] for words in LAUNCHES], ["design.launch", "validate.launch"])
        design, validate = LAUNCHES
        body = f"density:={ROOT}/data/arms/arris_x220_body.csv"
        made = self.folder / "my_vehicle/made"
        self.kill_when(self.start(design, body), lambda: (made / "plan_f_to_q.json").exists())
        said = self.finish(self.start(design, body))
        for stage in ("check and tables", "wing", "vehicle file"):
            self.assertIn(f"{stage}: kept", said)
        self.assertIn(f"{made}/validation/report.html", said)
        self.assertTrue((made / "validation/report.html").is_file(), said)
        shutil.rmtree(made / "validation")
        trials = made / "validation/trials"
        self.kill_when(self.start(validate), lambda: len(list(trials.glob("*.json"))) >= 3)
        self.assertFalse((made / "validation/report.html").exists())
        kept = {path: path.stat().st_mtime_ns for path in trials.glob("*.json")}
        said = self.finish(self.start(validate))
        for path, stamp in kept.items():
            self.assertEqual(path.stat().st_mtime_ns, stamp, f"{path.name} was computed again")
        self.assertGreater(len(list(trials.glob("*.json"))), len(kept))
        self.assertRegex(said, r"(NOT )?(passed|decided), [0-9]+ checks passed; ")
        self.assertTrue((made / "validation/report.html").is_file(), said)


if __name__ == "__main__":
    sys.exit(unittest.main())
