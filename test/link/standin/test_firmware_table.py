"""firmware_table against both stand-ins on a simulator's ports: the script must find every rule kept, and must find it when one is not.
usage: test_firmware_table.py FOLDER_OF_PROGRAMS"""
import importlib.machinery
import importlib.util
import os
import pathlib
import socket
import subprocess
import sys
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "processes"))
import side_by_side  # noqa: E402
from link_bench import Process, be_firm, free_port, wait_for  # noqa: E402

PROGRAMS = "."
SLACK = 0.05  # s, for a machine that does other things as well
ROWS = 20
HOLD_UP = 0.015  # s


class HeldUp:
    """A line whose user is held up right after some of its frames have left, as on a busy machine."""

    def __init__(self, line, every):
        self.line, self.every, self.count = line, every, 0

    def sendall(self, data):
        self.line.sendall(data)
        self.count += 1
        if self.count % self.every == 0:
            time.sleep(HOLD_UP)


def measure_held_up(port, motor_port, every):
    """Edges and silences of a firmware, by a caller that is held up. @return exit code"""
    loader = importlib.machinery.SourceFileLoader("firmware_table", str(HERE.parent / "firmware_table"))
    script = importlib.util.module_from_spec(importlib.util.spec_from_loader("firmware_table", loader))
    loader.exec_module(script)
    script.be_firm()
    fc = script.Firmware(("127.0.0.1", port), script.Motors(motor_port, "127.0.0.1"))
    table, watch = script.Table(), script.Watch()
    fc.arm()
    fc.line = HeldUp(fc.line, every)
    script.measure_edges(fc, table, watch, SLACK)
    script.measure_silence(fc, table, watch, 5, SLACK)
    print(f"{watch.void} void")
    return 0 if table.good else 1


class FirmwareTable(unittest.TestCase):
    def start(self, command, ready):
        standin = Process(command)
        self.addCleanup(standin.kill)
        be_firm(standin.child.pid, 60)
        wait_for(lambda: any(ready in line for line in standin.lines), 20, "stand-in starts")

    def table(self, command, ready):
        """@return exit code and text of the script against the stand-in that the command starts"""
        self.start(command, ready)
        done = subprocess.run([HERE.parent / "firmware_table", "--sitl", f"127.0.0.1:{self.port}", "--motor-port", str(self.motors),
                               "--fdm-port", "0", "--trials", "5", "--slack", str(SLACK)], capture_output=True, text=True, timeout=240,
                              check=False)
        return done.returncode, done.stdout + done.stderr

    def held_up(self, every):
        self.start(self.first_command(), "listening")
        done = subprocess.run([sys.executable, __file__, "--held-up", str(self.port), str(self.motors), str(every)],
                              capture_output=True, text=True, timeout=240, check=False)
        return done.returncode, done.stdout + done.stderr

    def setUp(self):
        self.port, self.motors = free_port(socket.SOCK_STREAM), free_port(socket.SOCK_DGRAM)

    def first_command(self, *options):
        return [os.path.join(PROGRAMS, "standin_flight_controller"), "--listen", f"127.0.0.1:{self.port}", "--motor-port", self.motors,
                *options]

    def first(self, *options):
        return self.table(self.first_command(*options), "listening")

    def test_first_standin(self):
        code, text = self.first()
        self.assertEqual(code, 0, text)
        self.assertEqual(text.count("| yes |"), ROWS, text)

    def test_second_standin(self):
        code, text = self.table(["/usr/bin/python3", HERE / "second_standin_server.py", self.port, self.motors], "listening")
        self.assertEqual(code, 0, text)
        self.assertEqual(text.count("| yes |"), ROWS, text)

    def test_a_firmware_that_differs_is_found(self):
        code, text = self.first("--wrong", "motor-output-limit", "--wrong", "rxfail-throttle-hold", "--boot-grace", "1")
        self.assertEqual(code, 1, text)
        failed = [line for line in text.splitlines() if line.endswith("| NO |")]
        self.assertTrue(any("27 throttle levels" in line for line in failed), text)
        self.assertTrue(any("last frame to idle" in line for line in failed), text)

    def test_who_is_held_up_repeats_the_trial(self):
        code, text = self.held_up(7)
        self.assertEqual(code, 0, text)
        self.assertEqual(text.count("| yes |"), 7, text)
        self.assertNotIn("\n0 void", text)

    def test_who_is_always_held_up_says_so(self):
        code, text = self.held_up(1)
        self.assertEqual(code, 1, text)
        self.assertIn("this machine is too busy", text)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--held-up"]:
        sys.exit(measure_held_up(*map(int, sys.argv[2:])))
    if len(sys.argv) > 1 and os.path.isdir(sys.argv[1]):
        PROGRAMS = sys.argv.pop(1)
    side_by_side.main(5, PROGRAMS)
