"""firmware_table against both stand-ins on a simulator's ports: the script must find every rule kept, and must find it when one is not.
usage: test_firmware_table.py FOLDER_OF_PROGRAMS"""
import os
import pathlib
import socket
import subprocess
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "processes"))
from link_bench import Process, be_firm, free_port, wait_for  # noqa: E402

PROGRAMS = "."
SLACK = 0.05  # s, for a machine that does other things as well
ROWS = 20


class FirmwareTable(unittest.TestCase):
    def table(self, command, ready):
        """@return exit code and text of the script against the stand-in that the command starts"""
        standin = Process(command)
        self.addCleanup(standin.kill)
        be_firm(standin.child.pid, 60)
        wait_for(lambda: any(ready in line for line in standin.lines), 20, "stand-in starts")
        done = subprocess.run([HERE.parent / "firmware_table", "--sitl", f"127.0.0.1:{self.port}", "--motor-port", str(self.motors),
                               "--fdm-port", "0", "--trials", "5", "--slack", str(SLACK)], capture_output=True, text=True, timeout=150,
                              check=False)
        return done.returncode, done.stdout + done.stderr

    def setUp(self):
        self.port, self.motors = free_port(socket.SOCK_STREAM), free_port(socket.SOCK_DGRAM)

    def first(self, *options):
        return self.table([os.path.join(PROGRAMS, "standin_flight_controller"), "--listen", f"127.0.0.1:{self.port}", "--motor-port",
                           self.motors, *options], "listening")

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


if __name__ == "__main__":
    if len(sys.argv) > 1 and os.path.isdir(sys.argv[1]):
        PROGRAMS = sys.argv.pop(1)
    unittest.main()
