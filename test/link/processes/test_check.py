"""`radio_bridge --check` against the stand-in set wrongly in every way that it knows, and the document's table of the same.
usage: test_check.py FOLDER_OF_PROGRAMS [unittest options]"""
import os
import pathlib
import re
import socket
import subprocess
import sys
import time
import unittest

from link_bench import Bench, Process, free_port, wait_for

PROGRAMS = os.environ.get("SNAPWING_PROGRAMS", ".")
SAFETY = pathlib.Path(__file__).parents[3] / "docs" / "safety.md"
# configuration of the stand-in -> the firmware's command, or the deed, that the sentence must name
MENDS = {"other-variant": "flash Betaflight 4.3 or later", "inav": "--allow no-readback", "old-release": "flash release 4.3 or later",
         "rx-map": "`map AETR1234`", "failsafe-delay": "`set failsafe_delay = 15`",
         "failsafe-procedure": "`set failsafe_procedure = DROP`", "rxfail-throttle-hold": "`rxfail 3 a`",
         "rxfail-throttle-set": "`rxfail 3 a`", "rxfail-pitch-hold": "`rxfail 1 a`", "rxfail-aux1-set": "`rxfail 4 h`",
         "arm-missing": "`aux 0 0 0 1700 2100 0 0`", "arm-aux2": "`aux 0 0 0 1700 2100 0 0`", "arm-always": "`aux 0 0 0 1700 2100 0 0`",
         "feature-3d": "`feature -3D`", "receiver-serial": "`feature RX_MSP`", "min-check": "`set min_check = 1050`",
         "throttle-limit": "`set throttle_limit_type = OFF`", "motor-output-limit": "`set motor_output_limit = 100`"}


class Standin:
    def __init__(self, *options):
        self.port = free_port(socket.SOCK_STREAM)
        self.process = Process([os.path.join(PROGRAMS, "standin_flight_controller"), "--listen", f"127.0.0.1:{self.port}",
                                "--motor-port", 0, *options])

    def __enter__(self):
        wait_for(lambda: any("listening" in text for text in self.process.lines), 10, "stand-in starts")
        return self

    def __exit__(self, *_):
        self.process.kill()


def check(port, *options):
    done = subprocess.run([os.path.join(PROGRAMS, "radio_bridge"), "--check", "--fc", f"tcp:127.0.0.1:{port}", *options],
                          capture_output=True, text=True, timeout=30, check=False)
    return done.returncode, done.stdout + done.stderr


class Check(unittest.TestCase):
    def test_right_settings_are_ready(self):
        with Standin() as standin:
            for protocol in ("msp1", "msp2"):
                code, text = check(standin.port, "--protocol", protocol)
                self.assertEqual(code, 0, text)
                self.assertTrue(text.endswith("\nready\n"), text)
                self.assertNotIn("NOT READY", text)
                self.assertIn("cannot be read: ", text)

    def test_each_wrong_configuration_gives_one_sentence_with_its_mend(self):
        known = subprocess.run([os.path.join(PROGRAMS, "standin_flight_controller"), "--help"], capture_output=True, text=True,
                               check=True).stdout
        listed = re.search(r"--wrong.*\{([a-z0-9,-]+)\}", known).group(1).split(",")
        self.assertEqual(sorted(listed), sorted(MENDS))
        self.assertGreaterEqual(len(MENDS), 12)
        for name, mend in MENDS.items():
            with self.subTest(name=name), Standin("--wrong", name) as standin:
                code, text = check(standin.port)
                self.assertEqual(code, 1, text)
                failed = [line for line in text.splitlines() if "NOT READY" in line]
                self.assertEqual(len(failed), 1, text)
                self.assertIn(mend, failed[0])

    def test_the_document_lists_the_same(self):
        rows = dict(re.findall(r"^\| `([a-z0-9-]+)` \| .* \| (.*) \|$", SAFETY.read_text(encoding="utf-8"), re.MULTILINE))
        for name, mend in MENDS.items():
            self.assertIn(name, rows)
            self.assertIn(mend.strip("`"), rows[name])

    def test_allowed_checks_and_silence(self):
        with Standin("--wrong", "feature-3d", "--wrong", "throttle-limit") as standin:
            self.assertEqual(check(standin.port, "--allow", "feature-3d")[0], 1)
            code, text = check(standin.port, "--allow", "feature-3d", "throttle-limit")
            self.assertEqual(code, 0, text)
            self.assertIn("allowed", text)
        code, text = check(free_port(socket.SOCK_STREAM))
        self.assertEqual(code, 3, text)
        self.assertIn("cannot be opened", text)
        with socket.create_server(("127.0.0.1", 0)) as mute:
            code, text = check(mute.getsockname()[1])
            self.assertEqual(code, 3, text)
            self.assertIn("nothing answers", text)
        code, text = check(1, "--protocol", "sbus")
        self.assertEqual(code, 2, text)
        self.assertIn("cannot be asked", text)


class Console(unittest.TestCase):
    """What a first user meets who types `arm`."""

    def refusal(self, *options):
        with Bench(PROGRAMS, standin_options=options) as bench:
            wait_for(lambda: bench.fresh().get("connected"), 5, "connected")
            time.sleep(1.0)  # eleven questions, 25 a second
            deadline = time.monotonic() + 5
            while not re.search("not fit.*(check|iNav)", bench.status().get("refusal", "")) and time.monotonic() < deadline:
                bench.console.send("disarm")
                time.sleep(0.1)
                bench.console.send("arm")
                time.sleep(0.3)
            return bench.status()["refusal"]

    def test_today_s_interface_arms(self):
        for minor in (44, 47):
            with Bench(PROGRAMS, standin_options=("--api-minor", minor)) as bench:
                bench.arm()

    def test_refusals_are_words(self):
        for options, words in ((("--api-minor", 41), ("api-version", "flash release 4.3")),
                               (("--api-minor", 47, "--wrong", "receiver-serial"), ("check receiver", "`feature RX_MSP`")),
                               (("--variant", "INAV"), ("iNav",))):
            refusal = self.refusal(*options)
            for word in words:
                self.assertIn(word, refusal)


if __name__ == "__main__":
    if len(sys.argv) > 1 and os.path.isdir(sys.argv[1]):
        PROGRAMS = sys.argv.pop(1)
    unittest.main()
