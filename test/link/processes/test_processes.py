"""The real programs, killed and stopped in the middle of a pulse. usage: test_processes.py FOLDER_OF_PROGRAMS FOLDER_OF_HELPERS [unittest options]"""
import os
import pathlib
import signal
import socket
import subprocess
import sys
import time
import unittest

import link_faults
import process_faults
import side_by_side
from link_bench import IDLE, OFF, Bench, wait_for

PROGRAMS = os.environ.get("SNAPWING_PROGRAMS", ".")
SLACK = 0.05  # s, for a machine that does other things as well
GUARDIAN, CONTROLLER = link_faults.GUARDIAN, link_faults.CONTROLLER


class Processes(unittest.TestCase):
    def setUp(self):
        self.bench = Bench(PROGRAMS)
        self.addCleanup(self.bench.__exit__)

    def idle_after(self, since, timeout=1.0):
        return self.idle_time(self.bench, since, timeout)

    @staticmethod
    def idle_time(bench, since, timeout=1.0):
        wait_for(lambda: bench.motors.first_at_or_below(IDLE, since) is not None, timeout, "motors at idle")
        return bench.motors.first_at_or_below(IDLE, since) - since

    @staticmethod
    def wait_for_end(process):
        """Of all who could still write: bridge, guardian, log."""
        process.reader.join(5)
        assert not process.reader.is_alive(), process.lines

    def test_pulse_has_its_length(self):
        bench = self.bench
        bench.arm()
        bench.pulse(0.5, 0.25)
        rise = bench.motors.first_above(IDLE, 0)
        wait_for(lambda: bench.motors.last()["motor"] == 1509, 0.2, "motors at half")
        self.assertAlmostEqual(self.idle_after(rise), 0.25, delta=0.04 + SLACK)  # idle comes at the end of a ramp of 21 ms
        self.assertLess(bench.status()["latency_worst"], 0.03 + SLACK)

    def test_pulse_and_its_hold_have_their_lengths(self):
        bench = self.bench
        bench.arm()
        bench.pulse(1.0, 0.15, hold=(0.3, 0.4))
        rise = bench.motors.first_above(IDLE, 0)
        wait_for(lambda: bench.motors.last()["motor"] == 1314, 0.3, "motors at the hold's level")
        fall = bench.motors.first_at_or_below(1400, rise + 0.05)
        self.assertAlmostEqual(fall - rise, 0.15, delta=0.04 + SLACK)
        self.assertAlmostEqual(self.idle_after(rise), 0.55, delta=0.04 + SLACK)
        wait_for(lambda: bench.fresh().get("state") == "armed", 0.3, "the bridge has ended it")
        self.assertEqual(bench.status()["fault"], "")

    def test_hold_that_is_too_long_is_refused_with_its_pulse(self):
        bench = self.bench
        bench.arm()
        sent = bench.pulse(1.0, 0.3, wait=False, hold=(0.3, 1.3))
        wait_for(lambda: "hold, pitch or pulse id is" in bench.status()["refusal"], 1.0, "refused by its hold")
        time.sleep(0.3)
        self.assertLessEqual(bench.motors.highest(sent), IDLE)

    def test_killed_bridge_is_followed_by_its_guardian_and_a_new_one_brings_no_thrust(self):
        bench = self.bench
        bench.arm()
        bench.pulse(1.0, 1.4)
        time.sleep(0.2)
        bench.bridge.signal(signal.SIGKILL)
        killed = time.monotonic()
        self.assertLess(self.idle_after(killed), GUARDIAN + SLACK)
        wait_for(lambda: bench.motors.last()["motor"] == OFF, 1.0, "disarmed by the guardian, long before the failsafe")
        self.assertFalse(bench.motors.last()["failsafe"])
        self.wait_for_end(bench.bridge)
        self.assertIn("guardian: the bridge died", "\n".join(bench.bridge.lines))
        restarted = time.monotonic()
        bench.bridge = bench.start_bridge()
        time.sleep(2.0)
        self.assertEqual(bench.fresh()["connected"], 1)
        self.assertLessEqual(bench.motors.highest(restarted), IDLE)

    def test_terminated_bridge_lowers_throttle_and_disarms_at_once(self):
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT, signal.SIGUSR1, signal.SIGPROF,
                       signal.SIGRTMIN):
            with self.subTest(signal=number), Bench(PROGRAMS) as bench:
                bench.arm()
                bench.pulse(1.0, 1.4)
                time.sleep(0.1)
                before = time.monotonic()  # what must last long enough runs from here: being held up makes no time short
                bench.bridge.signal(number)
                sent = time.monotonic()
                wait_for(lambda: bench.motors.last()["motor"] == OFF, 1.0, "motors off")
                self.assertLess(self.idle_time(bench, sent), 0.04 + SLACK)
                self.assertLess(bench.motors.last()["t"] - sent, 0.12 + SLACK, "off with the fifth frame")
                self.assertFalse(bench.motors.last()["failsafe"], "disarmed by the bridge, not by the failsafe")
                bench.bridge.child.wait(2)
                self.assertGreater(time.monotonic() - before, 0.2, "safe frames for at least 0.2 s")
                self.wait_for_end(bench.bridge)
                self.assertRegex("\n".join(bench.bridge.lines), r"went out in 1\d frames over 3\d\d ms")

    def test_a_fault_table_that_is_ended_leaves_nothing_behind(self):
        def left(session):
            """Process id and command of each process of a session."""
            found = {}
            for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
                try:
                    fields = stat.read_text().rpartition(")")[2].split()
                    if int(fields[3]) == session and fields[0] != "Z":
                        found[int(stat.parent.name)] = (stat.parent / "cmdline").read_text().replace("\0", " ")
                except OSError:
                    pass  # it has ended
            return found
        script = pathlib.Path(__file__).with_name("fault_table.py")
        for number in (signal.SIGTERM, signal.SIGKILL):
            with self.subTest(signal=number):
                table = subprocess.Popen([sys.executable, script, "--programs", PROGRAMS, "--helpers", os.environ["SNAPWING_TEST_HELPERS"],
                                          "--trials", "30", "--jobs", "2", "--only", "BridgeKilled", "--only", "Aborted"],
                                         start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                try:
                    wait_for(lambda: sum("radio_bridge" in command for command in left(table.pid).values()) >= 2, 60, "both workers are at work")
                    table.send_signal(number)
                    table.wait(30)
                    deadline = time.monotonic() + 30
                    while left(table.pid) and time.monotonic() < deadline:
                        time.sleep(0.1)
                    self.assertEqual(left(table.pid), {})
                finally:
                    for process in left(table.pid):
                        os.kill(process, signal.SIGKILL)

    def test_killed_console_disarms(self):
        bench = self.bench
        bench.arm()
        bench.pulse(1.0, 1.4)
        time.sleep(0.1)
        bench.console.signal(signal.SIGKILL)
        killed = time.monotonic()
        self.assertLess(self.idle_after(killed), 0.25 + SLACK)
        wait_for(lambda: bench.motors.last()["motor"] == OFF, 1.0, "motors off")
        bench.console = bench.start_console()
        time.sleep(0.5)
        self.assertEqual(bench.fresh()["state"], "fault")
        self.assertIn("heartbeat", bench.fresh()["fault"])

    def test_abort_takes_one_frame(self):
        bench = self.bench
        bench.arm()
        bench.pulse(1.0, 1.4)
        time.sleep(0.1)
        bench.console.send("abort")
        sent = time.monotonic()
        self.assertLess(self.idle_after(sent), 0.04 + SLACK)
        wait_for(lambda: bench.motors.last()["motor"] == OFF, 0.2, "motors off")

    def test_stopped_bridge_is_ended_and_brings_nothing_back(self):
        bench = self.bench
        bench.arm()
        bench.pulse(1.0, 1.4)
        bench.bridge.signal(signal.SIGSTOP)
        stopped = time.monotonic()
        self.assertLess(self.idle_after(stopped), GUARDIAN + SLACK)
        idle = time.monotonic()
        self.assertEqual(bench.bridge.child.wait(2), -signal.SIGKILL)
        time.sleep(1.5)
        self.assertLessEqual(bench.motors.highest(idle), IDLE)
        self.assertIn("guardian: the bridge stood still", "\n".join(bench.bridge.lines))

    def test_without_its_guardian_the_bridge_refuses_to_pulse(self):
        bench = self.bench
        bench.arm()
        bench.pulse(1.0, 1.4)
        os.kill(bench.guardian(), signal.SIGKILL)
        killed = time.monotonic()
        self.assertLess(self.idle_after(killed), GUARDIAN + SLACK)
        wait_for(lambda: "guardian" in bench.fresh().get("fault", ""), 1.0, "fault with a name")
        with self.assertRaises(AssertionError):
            bench.arm(timeout=1.5)

    def test_the_first_frame_after_the_guardians_death_is_safe(self):
        bench = self.bench
        bench.arm()
        bench.pulse(1.0, 1.4)
        frames = len(bench.statuses)
        wait_for(lambda: len(bench.statuses) > frames, 1.0, "a frame leaves")
        os.kill(bench.guardian(), signal.SIGKILL)
        killed = time.monotonic()
        wait_for(lambda: "guardian" in bench.fresh().get("fault", ""), 1.0, "fault with a name")
        safe = next(status["frame_time"] for status in bench.statuses if status["state"] == "fault")
        self.assertLess(safe - killed, 0.028, "frames leave every 20 ms")

    def test_guardian_killed_first_and_then_the_bridge(self):
        """Nobody is left on this side: the flight controller's own hold."""
        bench = self.bench
        bench.arm()
        bench.pulse(1.0, 1.4)
        time.sleep(0.1)
        os.kill(bench.guardian(), signal.SIGKILL)
        bench.bridge.signal(signal.SIGKILL)
        killed = time.monotonic()
        self.assertLess(self.idle_after(killed), CONTROLLER + SLACK)

    def test_missing_device_is_named_and_nothing_is_claimed(self):
        log = os.path.join(self.bench.home.name, "log")
        process = self.bench.start("radio_bridge", ["--fc", "serial:/dev/ttyNOPE", "--key-file", self.bench.key, "--lcm-url",
                                                    self.bench.url, "--log", log])
        wait_for(lambda: any("ttyNOPE: No such file" in line for line in process.lines), 5, "a word on the device")
        process.signal(signal.SIGINT)
        self.assertEqual(process.child.wait(5), 0)
        self.wait_for_end(process)
        said = "\n".join(process.lines)
        self.assertIn("nothing could be sent", said)
        self.assertNotIn("AUX1 low", said)
        self.assertEqual(said.count("cannot open"), 1, said)
        with open(log, encoding="ascii") as file:
            self.assertRegex(file.read(), r"(?m)^\d{4}-\d\d-\d\dT.*Z cannot open serial:/dev/ttyNOPE: No such file")

    def test_recorded_session_is_refused_as_stale(self):
        """lcm-logger and lcm-logplayer; into the same session and into a new one."""
        for new_session in (False, True):
            with self.subTest(new_session=new_session):
                fault = link_faults.LogReplayed(PROGRAMS, 0)
                fault.new_session = new_session
                try:
                    begin, _, highest = fault.trial()
                    self.assertGreater(begin, 0)
                    self.assertLessEqual(highest, IDLE)
                    self.assertRegex("; ".join(sorted(fault.refusals)), "session" if new_session else "old|used before")
                finally:
                    fault.close()

    def test_serial_line(self):
        for protocol in ("msp1", "msp2", "sbus", "crsf"):
            options = ("--allow", "no-readback") if protocol in ("sbus", "crsf") else ()
            with self.subTest(protocol=protocol), Bench(PROGRAMS, line="pty", protocol=protocol, bridge_options=options,
                                                        boot_grace=0.6) as bench:
                time.sleep(1.0)
                bench.arm()
                bench.pulse(0.5, 0.2)
                rise = bench.motors.first_above(IDLE, 0)
                wait_for(lambda: abs(bench.motors.last()["motor"] - 1509) <= 2, 0.2, "motors at half")
                wait_for(lambda: bench.motors.first_at_or_below(IDLE, rise) is not None, 1.0, "motors at idle")
                self.assertAlmostEqual(bench.motors.first_at_or_below(IDLE, rise) - rise, 0.2, delta=0.04 + SLACK)

    def test_controller_serves_one_caller_at_a_time(self):
        wait_for(lambda: self.bench.fresh().get("connected"), 10, "the bridge is there first")
        with socket.create_connection(("127.0.0.1", self.bench.controller_port), timeout=2) as second:
            self.assertEqual(second.recv(1), b"", "closed at once, since the bridge is there")
        self.bench.bridge.kill()
        time.sleep(0.1)
        with socket.create_connection(("127.0.0.1", self.bench.controller_port), timeout=2) as second:
            second.sendall(bytes.fromhex("244d3c000101"))
            self.assertEqual(second.recv(3), b"$M>")

    def test_what_the_console_does_not_understand_it_says_and_does_not_send(self):
        bench = self.bench
        bench.arm()
        for line in ("pulse 9 .2.5 .3", "pulse 9 0,5 0.3", "pulse 9 1", "pulse 9 0.5 0.3s", "pulse 9 0.5 0.3 x", "pulse nine 0.5 0.3",
                     "hold 9 0.5 0.3 0.2", "hold 9 0.5 0.3 0.2 0.3 0.4", "halt", "pulse9 1 1"):
            with self.subTest(line=line):
                said = len(bench.said)
                bench.console.send(line)
                wait_for(lambda: len(bench.said) > said, 1.0, "the console says so")
                self.assertIn("allowed", bench.said[-1]["said"])
        self.assertEqual(bench.sent, [])
        self.assertEqual(bench.fresh().get("state"), "armed")
        bench.console.send("  STOP")
        wait_for(lambda: bench.fresh().get("fault", "").startswith("aborted"), 1.0, "stop is abort")

    def test_bad_input_is_refused_with_a_reason(self):
        for options, words in ((["--fc", "nonsense"], "tcp:HOST:PORT"), (["--max-pulse", "99"], "max_pulse"),
                               (["--protocol", "sbus"], "no-readback"), (["--allow", "everything"], "rx-map"),
                               (["--key-file", "/nonexistent"], "--create-key"), (["--bogus"], "bogus")):
            with self.subTest(options=options):
                key = [] if "--key-file" in options else ["--key-file", self.bench.key]
                process = self.bench.start("radio_bridge", [*key, *options])
                self.assertEqual(process.child.wait(5), 2)
                process.reader.join(2)
                self.assertIn(words, "\n".join(process.lines))


class FaultsOfTheProgram(unittest.TestCase):
    """Whatever goes wrong inside of the bridge ends in the guardian: one test for each kind of fault_injection.c."""


def fault_test(kind):
    def test(self):
        fault = kind(PROGRAMS, 0)
        self.addCleanup(fault.close)
        _, seconds, highest = fault.trial()
        self.assertLess(seconds, kind.promise + SLACK)
        self.assertLessEqual(highest, IDLE)
    return test


for injected in process_faults.INJECTED:
    setattr(FaultsOfTheProgram, f"test_{injected.__name__}", fault_test(injected))


if __name__ == "__main__":
    if len(sys.argv) > 1 and os.path.isdir(sys.argv[1]):
        PROGRAMS = sys.argv.pop(1)
    if len(sys.argv) > 1 and os.path.isdir(sys.argv[1]):
        os.environ["SNAPWING_TEST_HELPERS"] = sys.argv.pop(1)
    side_by_side.main(5, PROGRAMS, os.environ["SNAPWING_TEST_HELPERS"])
