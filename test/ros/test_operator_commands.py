"""The commands of docs/safety.md's table do what it says, under bringup's names. usage: test_operator_commands.py PROGRAMS SOURCE"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAMS, SOURCE = (pathlib.Path(part) for part in sys.argv[1:3])
sys.path.insert(0, str(SOURCE / "test/link/processes"))
from link_bench import wait_for  # noqa: E402
from ros_faults import RosBench  # noqa: E402

TABLE = re.findall(r"^\| (`.*?`) \|", (SOURCE / "docs/safety.md").read_text(encoding="utf-8").split("## The operator's commands")[1]
                   .split("\n## ")[0], re.MULTILINE)
COMMANDS = [command for cell in TABLE for command in re.findall("`((?:scripts/|rosservice )[^`]+)`", cell)]


class Bringup(RosBench):
    namespace = "/snapwing"


class Commands(unittest.TestCase):
    def setUp(self):
        self.home = tempfile.TemporaryDirectory()
        self.bench = Bringup(PROGRAMS)
        self.addCleanup(self.home.cleanup)
        self.addCleanup(self.bench.__exit__)
        os.mkdir(os.path.join(self.home.name, ".ros"))
        self.key = os.path.join(self.home.name, ".ros", "snapwing_link_snapwing.key")
        shutil.copy(self.bench.key, self.key)
        os.chmod(self.key, 0o600)

    def run_command(self, words):
        return subprocess.run(["bash", "-c", words], env={**self.bench.environment, "HOME": self.home.name, "ROS_NAMESPACE": "",
                                                              "SNAPWING_BUILD": str(PROGRAMS.parents[2])},
                              cwd=SOURCE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60, check=False)

    def state(self, wanted, what):
        wait_for(lambda: self.bench.fresh().get("state") == wanted, 3, f"{wanted} after {what}: {self.bench.status()}")

    def test_each_of_the_table(self):
        self.assertEqual(len(COMMANDS), 6, COMMANDS)
        reset = next(command for command in COMMANDS if command.endswith("reset"))
        arm = next(command for command in COMMANDS if command.endswith(" arm"))
        self.bench.arm(timeout=30)  # the controller's start is over
        self.run_command(next(command for command in COMMANDS if command.endswith("disarm")))
        for command in COMMANDS:
            if command in (reset, arm):
                continue
            done = self.run_command(arm)
            self.assertEqual(done.returncode, 0, done.stdout)
            self.state("armed", arm)
            done = self.run_command(command)
            self.assertEqual(done.returncode, 0, done.stdout)
            aborts = "abort" in command
            self.state("fault" if aborts else "idle", command)
            if aborts:
                self.assertIn("aborted", self.bench.status()["fault"])
                done = self.run_command(reset)
                self.assertEqual(done.returncode, 0, done.stdout)
                self.state("idle", reset)

    def test_a_pulse_with_an_old_id_is_not_called_taken(self):
        self.bench.arm(timeout=30)
        self.run_command("scripts/link_command disarm")
        self.assertEqual(self.run_command("scripts/link_command arm").returncode, 0)
        done = self.run_command("scripts/link_command pulse 5 0.2 0.1")
        self.assertEqual((done.returncode, done.stdout.strip().splitlines()[-1]), (0, "pulse: taken"))
        time.sleep(0.5)
        for number in (5, 4):
            done = self.run_command(f"scripts/link_command pulse {number} 0.2 0.1")
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn("not above 5", done.stdout)

    def test_without_the_key_nothing_is_armed(self):
        self.bench.arm(timeout=30)
        self.run_command("scripts/link_command disarm")
        done = self.run_command('rosservice call /snapwing/arm "data: true"')
        self.assertIn("no seal", done.stdout)
        self.assertRegex(done.stdout, "success: *False")
        subprocess.run([PROGRAMS / "radio_bridge", "--create-key", self.key + "2"], check=True, capture_output=True)
        done = self.run_command(f"scripts/link_command --key-file {self.key}2 arm")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("seal is wrong", done.stdout)
        done = self.run_command(f"scripts/link_command --vehicle b --namespace /snapwing --key-file {self.key} arm")
        self.assertIn("of vehicle 'snapwing'", done.stdout)
        self.assertEqual(self.bench.fresh().get("state"), "idle")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
