"""Faults of the link, each a class with a promise and a trial. A trial begins armed and in a pulse, does the harm at a random
moment and returns the seconds until the motors were at idle or off; whether thrust came back is judged for all alike."""
import os
import random
import signal
import socket
import subprocess
import time

from link_bench import IDLE, Bench, free_port, wait_for
from relays import LcmRelay, SerialRelay

PULSE = 1.4      # s
WATCH = 1.2      # s after the motors were at idle in which no thrust may return
NEVER = 99.0


class Fault:
    name = ""
    promise = 0.0        # s from the fault to idle or off
    guard = ""           # who notices
    options = {}

    def __init__(self, programs, seed):
        self.rng = random.Random(seed)
        self.bench = Bench(programs, **self.bench_options(programs))
        self.programs = programs

    def bench_options(self, _programs):
        return dict(self.options)

    def close(self):
        self.bench.__exit__()

    def harm(self):
        """Does the harm now. @return (time from which the promise counts, undo function or None)"""
        raise NotImplementedError

    def prepare(self):
        pass

    def trial(self):
        """@return (seconds to idle, largest motor output after that [us])"""
        bench = self.bench
        self.prepare()
        bench.arm(timeout=20)
        bench.pulse(1.0, PULSE)
        time.sleep(self.rng.uniform(0.0, PULSE - 0.45))
        since, undo = self.harm()
        end = time.monotonic() + PULSE + 0.6
        idle = None
        while idle is None and time.monotonic() < end:
            time.sleep(0.005)
            idle = bench.motors.first_at_or_below(IDLE, since)
        if undo:
            undo()
        if idle is None:
            return NEVER, bench.motors.last()["motor"]
        time.sleep(WATCH)
        return idle - since, bench.motors.highest(idle)


class BridgeKilled(Fault):
    name = "radio_bridge: kill -9, then started again"
    promise = 0.30
    guard = "flight controller: throttle hold, failsafe"

    def harm(self):
        self.bench.bridge.signal(signal.SIGKILL)
        since = time.monotonic()
        pause = self.rng.choice([0.32, 0.6, 1.2, 2.0])

        def undo():
            time.sleep(max(0.0, since + pause - time.monotonic()))
            self.bench.bridge.kill()
            self.bench.bridge = self.bench.start_bridge()
        return since, undo


class BridgeStopped(Fault):
    name = "radio_bridge: SIGSTOP, then SIGCONT"
    promise = 0.30
    guard = "flight controller; afterwards the bridge's own stall check"

    def harm(self):
        self.bench.bridge.signal(signal.SIGSTOP)
        since = time.monotonic()
        pause = self.rng.uniform(0.31, 2.0)

        def undo():
            time.sleep(max(0.0, since + pause - time.monotonic()))
            self.bench.bridge.signal(signal.SIGCONT)
        return since, undo


class BridgeTerminated(Fault):
    name = "radio_bridge: SIGTERM, SIGINT, SIGHUP, SIGSEGV, SIGABRT"
    promise = 0.04
    guard = "bridge: safe frames on every signal"

    def harm(self):
        self.bench.bridge.signal(self.rng.choice([signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGSEGV, signal.SIGABRT]))
        since = time.monotonic()

        def undo():
            self.bench.bridge.child.wait(3)
            self.bench.bridge.kill()
            self.bench.bridge = self.bench.start_bridge()
        return since, undo


class OperatorKilled(Fault):
    name = "operator's end (link_console): kill -9, then started again"
    promise = 0.25
    guard = "bridge: heartbeat timeout"

    def harm(self):
        self.bench.console.signal(signal.SIGKILL)
        since = time.monotonic()

        def undo():
            self.bench.console.kill()
            self.bench.console = self.bench.start_console()
        return since, undo


class OperatorStopped(Fault):
    name = "operator's end (link_console): SIGSTOP, then SIGCONT"
    promise = 0.25
    guard = "bridge: heartbeat timeout, latched"

    def harm(self):
        self.bench.console.signal(signal.SIGSTOP)
        since = time.monotonic()
        pause = self.rng.uniform(0.3, 1.0)

        def undo():
            time.sleep(max(0.0, since + pause - time.monotonic()))
            self.bench.console.signal(signal.SIGCONT)
        return since, undo


class Aborted(Fault):
    name = "abort sent"
    promise = 0.04
    guard = "bridge: next frame"

    def harm(self):
        self.bench.console.send("abort")
        return time.monotonic(), None


class DeadmanReleased(Fault):
    name = "deadman released"
    promise = 0.06
    guard = "bridge: next frame after the heartbeat"

    def harm(self):
        self.bench.console.send("deadman off")
        return time.monotonic(), lambda: self.bench.console.send("deadman on")


class Undisturbed(Fault):
    """The pulse goes on, or is broken off; in either case it is over by its own end."""
    promise = 0.04
    guard = "bridge: own deadline"
    pulse = 0.5

    def trial(self):
        bench = self.bench
        self.prepare()
        bench.arm(timeout=20)
        undo = self.begin()
        sent = bench.pulse(1.0, self.pulse, wait=self.rises)
        time.sleep(self.pulse + 0.3)
        rise = next((event["t"] for event in bench.motors.events() if event["t"] > sent and event["motor"] > IDLE), None)
        if rise is None:  # refused or lost: nothing to end
            rise = sent
        idle = bench.motors.first_at_or_below(IDLE, rise)
        if undo:
            undo()
        if idle is None:
            return NEVER, bench.motors.last()["motor"]
        time.sleep(0.3)
        self.check()
        return max(0.0, idle - rise - self.pulse), bench.motors.highest(idle)

    rises = True

    def begin(self):
        return None

    def check(self):
        pass


class Attack(Undisturbed):
    mode = "garbage"
    rate = 100000
    rises = False  # under a flood the command itself may be lost; then nothing rises at all

    def begin(self):
        self.before = dict(self.bench.status())
        self.attacker = subprocess.Popen([os.path.join(self.helpers(), "link_attack"), "--lcm-url", self.bench.url, "--mode", self.mode,
                                          "--rate", str(self.rate), "--seconds", "1.0"], stdout=subprocess.PIPE, text=True)
        time.sleep(0.1)
        return lambda: self.attacker.wait(10)

    def helpers(self):
        return os.environ["SNAPWING_TEST_HELPERS"]


class Flood(Attack):
    name = "LCM flooded with 100 000 random messages a second"
    guard = "bridge: envelope check in a thread of its own; heartbeat timeout if the operator drowns"


class Forged(Attack):
    name = "well-formed pulses, heartbeats, aborts sealed with another key"
    mode = "forged"
    rate = 2000
    rises = True
    guard = "bridge: message authentication"

    def check(self):
        wait_for(lambda: self.bench.status()["rejected"] > self.before["rejected"] + 500, 2, "forged messages are counted")
        if self.bench.status()["state"] != "armed":
            raise AssertionError("a forged message had an effect")


class Relayed(Undisturbed):
    def bench_options(self, _programs):
        ports = [free_port(socket.SOCK_DGRAM) for _ in range(2)]
        self.relay = LcmRelay(*ports)
        self.bridge_url = f"udpm://239.255.76.67:{ports[1]}?ttl=0"
        return {"lcm_url": f"udpm://239.255.76.67:{ports[0]}?ttl=0", "bridge_url": self.bridge_url}

    def close(self):
        super().close()
        self.relay.close()


class Duplicated(Relayed):
    name = "every LCM message three times, over 60 ms"
    guard = "bridge: message numbers"

    def prepare(self):
        self.relay.treat = lambda datagram: [(0.0, datagram), (0.03, datagram), (0.06, datagram)]


class Reordered(Relayed):
    name = "LCM messages delayed at random up to 40 ms (reordered)"
    guard = "bridge: message numbers"

    def prepare(self):
        self.relay.treat = lambda datagram: [(self.rng.uniform(0.0, 0.04), datagram)]


class Replayed(Relayed):
    name = "all LCM messages of the session sent again, 0.3 s later"
    guard = "bridge: age and message numbers"

    def prepare(self):
        self.relay.treat = lambda datagram: [(0.0, datagram), (0.3, datagram)]

    def trial(self):
        seconds, highest = super().trial()
        time.sleep(0.5)
        return seconds, max(highest, self.bench.motors.highest(time.monotonic() - 0.9))


class Delayed(Relayed):
    name = "pulse command delayed by 150 ms"
    guard = "bridge: age"
    rises = False

    def prepare(self):
        self.relay.treat = lambda datagram: [(0.15 if b"SNAPWING_PULSE" in datagram[:40] else 0.0, datagram)]

    def check(self):
        if "old" not in self.bench.status()["refusal"]:
            raise AssertionError("not refused as old: " + self.bench.status()["refusal"])


class NetworkGone(Relayed, Fault):
    name = "LCM network between operator and bridge gone, then back"
    promise = 0.25
    guard = "bridge: heartbeat timeout, latched"
    trial = Fault.trial

    def prepare(self):
        self.relay.treat = lambda datagram: [(0.0, datagram)]

    def harm(self):
        self.relay.treat = lambda datagram: []
        since = time.monotonic()
        return since, self.prepare


class OnSerial(Fault):
    options = {"line": "pty"}

    def bench_options(self, _programs):
        def through(bench):
            self.cable = SerialRelay(bench.far, bench.home.name)
            return "serial:" + self.cable.path
        return {"line": "pty", "through": through}

    def close(self):
        super().close()
        self.cable.close()


class SerialBlocked(OnSerial):
    name = "serial line blocked, then free again"
    promise = 0.30
    guard = "flight controller; bridge throws away what waits"

    def harm(self):
        self.cable.blocked = True
        since = time.monotonic()

        def undo():
            self.cable.blocked = False
        return since, undo


class SerialUnplugged(OnSerial):
    name = "serial line unplugged, then plugged in again"
    promise = 0.30
    guard = "flight controller; bridge latches"

    def harm(self):
        self.cable.cut()
        return time.monotonic(), self.cable.plug


class SerialNoisy(OnSerial, Undisturbed):
    name = "serial line with a flipped bit in 30 % of the packets"
    promise = 0.30
    guard = "checksums; own deadline; at the worst flight controller"
    trial = Undisturbed.trial
    rises = False

    def begin(self):
        self.cable.noisy = True

        def undo():
            self.cable.noisy = False
        return undo


class ClockStepped(Undisturbed):
    name = "wall clock jumps by an hour forth and back, seven times a second"
    guard = "only monotonic clocks count"

    def bench_options(self, programs):
        return {"environment": {"LD_PRELOAD": os.path.join(os.environ["SNAPWING_TEST_HELPERS"], "libstepped_clock.so")}}


class DiskFull(Undisturbed):
    name = "bridge's output goes to a full disk"
    guard = "bridge writes no files"

    def bench_options(self, programs):
        return {"bridge_prefix": ["sh", "-c", 'exec "$@" > /dev/full 2>&1', "bridge"]}


class CpuStarved(Undisturbed):
    name = "four busy processes on each core"
    guard = "real-time priority of the bridge; own deadline"

    def begin(self):
        hogs = [subprocess.Popen(["sh", "-c", "while :; do :; done"]) for _ in range(4 * os.cpu_count())]

        def undo():
            for hog in hogs:
                hog.kill()
                hog.wait()
        time.sleep(0.1)
        return undo

    rises = False


class LogReplayed(Undisturbed):
    name = "lcm-logplayer replays a recorded session into the live bridge"
    guard = "bridge: age, message numbers, session"

    def trial(self):
        bench = self.bench
        log = os.path.join(bench.home.name, "log")
        logger = subprocess.Popen(["lcm-logger", "--quiet", "--force", "--lcm-url=" + bench.url, log], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(0.3)
        bench.arm(timeout=20)
        bench.pulse(1.0, 0.3)
        time.sleep(0.6)
        logger.send_signal(signal.SIGINT)
        logger.wait(5)
        if self.rng.random() < 0.5:  # half of the time into a new session
            bench.bridge.kill()
            bench.bridge = bench.start_bridge()
            time.sleep(2.5)
        since = time.monotonic()
        before = bench.status()["refused"]
        subprocess.run(["lcm-logplayer", "--lcm-url=" + bench.url, log], check=True, timeout=30, capture_output=True)
        time.sleep(0.2)
        if bench.status()["refused"] <= before:
            raise AssertionError("nothing of the log was refused")
        return 0.0, bench.motors.highest(since)


ALL = [BridgeKilled, BridgeStopped, BridgeTerminated, OperatorKilled, OperatorStopped, Aborted, DeadmanReleased, NetworkGone,
       SerialBlocked, SerialUnplugged, SerialNoisy, Flood, Forged, Duplicated, Reordered, Replayed, Delayed, LogReplayed,
       ClockStepped, DiskFull, CpuStarved]
