"""Faults of the link, each a class with a promise and a trial. A trial begins armed and with the motors at a pulse's thrust, does
the harm at a random moment and says when the motors were at idle or off; whether thrust came back is judged for all alike."""
import contextlib
import os
import random
import signal
import socket
import struct
import subprocess
import time

from link_bench import IDLE, START, Bench, NotBegun, be_firm, busy_loops, free_port, wait_for, wait_for_start
from relays import LcmRelay, SerialRelay

NEVER = 99.0
FULL = 1999      # us, output at full throttle
LEAD = 0.1       # s, full throttle in front of a hold
HOLD = 0.3       # throttle of it: outputs of 1314 us
BELOW_PULSE = 1400  # us
PATIENCE = 3.0  # s beyond the pulse's end; what comes later than promised is still to be measured
GUARDIAN, TYPICAL = 0.12, 0.10  # s, the guardian ends the pulse: 99 % and median
CONTROLLER = 0.45               # s, where nobody on this side is left, or the line is: the flight controller's own hold


class Fault:
    name = ""
    promise = 0.06       # s to idle or off: from the harm if it breaks the pulse off, else from the pulse's own end
    typical = None       # s, promised for the median; None: as the promise
    guard = ""           # who notices
    breaks = True
    pulse = 1.0          # s
    latest = 0.55        # s after the motors rose in which the harm is done
    watch = 1.0          # s after the motors were at idle in which no thrust may return
    bench_kind = Bench
    seldom = 0.0         # share of trials in which thrust may return within a bound that docs/safety.md names
    bounded = False      # it did in the last trial
    in_hold = False      # the harm is done in the hold behind a short pulse, instead of in the pulse

    def __init__(self, programs, seed):
        self.rng = random.Random(f"{self.name} {seed}")
        self.bench = self.bench_kind(programs, **self.bench_options())

    def bench_options(self):
        return {}

    def close(self):
        self.bench.__exit__()

    def before(self):
        """What is done between arming and the command."""

    def harm(self):
        """Does the harm now. @return (moment from which the promise counts or None for now, what undoes it or None)"""
        return None, None

    def check(self):
        """Raises AssertionError if something else than the motors is not as it must be."""

    def begin_pulse(self):
        """The thrust in which the harm is done. @return when it began; it lasts self.pulse from then"""
        if not self.in_hold:
            return self.bench.pulse(1.0, self.pulse)
        rise = self.bench.pulse(1.0, LEAD, hold=(HOLD, self.pulse))
        try:
            wait_for(lambda: self.holds(rise + LEAD), LEAD + 0.2, "motors at the hold's level")
        except AssertionError as error:
            raise NotBegun(str(error)) from error
        return rise + LEAD

    def holds(self, begin):
        """The motors have come down to the hold's level; before `begin` they pass it on their way up."""
        return time.monotonic() > begin and IDLE < self.bench.motors.last()["motor"] < BELOW_PULSE

    def trial(self):
        """@return (moment from which the promise counts, seconds to idle from then, largest output after that [us])"""
        bench = self.bench
        bench.arm(timeout=20)
        self.before()
        rise = self.begin_pulse()
        time.sleep(self.rng.uniform(0.0, self.latest))
        moment = time.monotonic()
        since, undo = self.harm()
        since = since or moment
        try:
            idle = self.wait_for_idle(rise, rise + self.pulse + PATIENCE)
        finally:
            if undo:
                undo()
        if idle < since:
            raise NotBegun("the pulse was over before the harm was done")
        time.sleep(self.watch)
        self.check()
        begin = since if self.breaks else rise + self.pulse
        return begin, max(0.0, idle - begin), bench.motors.highest(idle)

    def wait_for_idle(self, since, until):
        over = False
        while not over:
            over = time.monotonic() > until
            idle = self.bench.motors.first_at_or_below(IDLE, since)
            if idle is not None:
                return idle
            time.sleep(0.02)
        raise AssertionError(f"motors never idle: harm at {since}, {self.bench.motors.events()[-8:]}, {self.bench.status()}")


def preload(name):
    """@return assignment for env(1)"""
    return "LD_PRELOAD=" + os.path.join(os.environ["SNAPWING_TEST_HELPERS"], f"lib{name}.so")


class Killed(Fault):
    """kill -9, later started again."""
    victim = ""
    pauses = (0.32, 0.6, 1.2, 1.7)  # s
    signal = signal.SIGKILL

    def harm(self):
        bench = self.bench
        since = time.monotonic()
        getattr(bench, self.victim).signal(self.signal)
        pause = self.rng.choice(self.pauses)

        def undo():
            time.sleep(max(0.0, since + pause - time.monotonic()))
            getattr(bench, self.victim).kill()
            setattr(bench, self.victim, getattr(bench, "start_" + self.victim)())
        return since, undo


class Stopped(Fault):
    victim = ""

    def harm(self):
        process = getattr(self.bench, self.victim)
        since = time.monotonic()
        process.signal(signal.SIGSTOP)
        pause = self.rng.uniform(0.31, 1.7)

        def undo():
            time.sleep(max(0.0, since + pause - time.monotonic()))
            process.signal(signal.SIGCONT)
        return since, undo


class OperatorKilled(Killed):
    name = "operator's end (link_console): kill -9, then started again"
    promise = 0.25
    guard = "bridge: heartbeat timeout"
    victim = "console"


class OperatorStopped(Stopped):
    name = "operator's end (link_console): SIGSTOP, then SIGCONT"
    promise = 0.25
    guard = "bridge: heartbeat timeout, latched"
    victim = "console"


class Aborted(Fault):
    name = "abort sent"
    guard = "bridge: next frame"

    def harm(self):
        self.bench.console.send("abort")
        return None, None


class DeadmanReleased(Fault):
    name = "deadman released"
    promise = 0.08
    guard = "bridge: next frame after the heartbeat"

    def harm(self):
        self.bench.console.send("deadman off")
        return None, lambda: self.bench.console.send("deadman on")


class Lasting(Fault):
    """The pulse goes on, or is broken off; in either case it is over by its own end."""
    breaks = False
    guard = "bridge: own deadline"
    pulse = 0.5
    latest = 0.45
    watch = 0.5


class Attack(Lasting):
    """From the middle of the pulse to beyond its end."""
    mode = ""
    rate = 2000     # messages a second
    least = 0.95    # share of them that a busy machine must bring out

    def harm(self):
        self.before_attack = dict(self.bench.status())
        program = os.path.join(os.environ["SNAPWING_TEST_HELPERS"], "link_attack")
        attacker = subprocess.Popen([program, "--lcm-url", self.bench.url, "--key-file", self.bench.key, "--mode", self.mode,
                                     "--rate", str(self.rate), "--seconds", "1.0"], stdout=subprocess.PIPE, text=True)

        be_firm(attacker.pid, 45)  # it stands for another machine: what hears it must not hold it up

        def undo():
            self.reached = float(attacker.communicate(timeout=10)[0].split()[0])  # messages in a second
        return None, undo

    def check(self):
        if self.reached < self.least * self.rate:
            raise NotBegun(f"only {self.reached} messages a second")


class Flood(Attack):
    name = "LCM flooded with random messages, 100 000 a second or what the machine brings out, at least 50 000"
    guard = "bridge: envelope check in a thread of its own; heartbeat timeout if the operator drowns"
    mode = "garbage"
    rate = 100000
    least = 0.5


class Ineffective(Attack):
    def check(self):
        super().check()
        before = self.before_attack
        wait_for(lambda: self.bench.status()["rejected"] + self.bench.status()["refused"] >
                 before["rejected"] + before["refused"] + 500, 2, "hostile messages are counted")
        if self.bench.status()["state"] != "armed" or self.bench.status()["pulse_id"] != before["pulse_id"]:
            raise AssertionError(f"a hostile message had an effect: {self.bench.status()}")


class Forged(Ineffective):
    name = "well-formed pulses, heartbeats, aborts sealed with another key"
    guard = "bridge: message authentication"
    mode = "forged"


class Malformed(Ineffective):
    name = "malformed messages: cut, drawn out, flipped bits, wrong sizes; absurd values under the right key"
    guard = "bridge: envelope, decoding, ranges"
    mode = "malformed"


class Relayed(Fault):
    @staticmethod
    def treat(datagram):
        """@return list of (delay [s], datagram) for the bridge"""
        return [(0.0, datagram)]

    def bench_options(self):
        ports = [free_port(socket.SOCK_DGRAM) for _ in range(2)]
        self.relay = LcmRelay(*ports)
        self.relay.treat = self.treat
        urls = [f"udpm://239.255.76.67:{port}?ttl=0" for port in ports]
        return {"lcm_url": urls[0], "bridge_url": urls[1]}

    def close(self):
        super().close()
        self.relay.close()


class NetworkGone(Relayed):
    name = "LCM network between operator and bridge gone, then back"
    promise = 0.25
    guard = "bridge: heartbeat timeout, latched"

    def harm(self):
        self.relay.treat = lambda datagram: []

        def undo():
            self.relay.treat = self.treat
        return None, undo


class Duplicated(Relayed, Lasting):
    name = "every LCM message three times, over 60 ms"
    guard = "bridge: message numbers"

    @staticmethod
    def treat(datagram):
        return [(0.0, datagram), (0.03, datagram), (0.06, datagram)]


class Reordered(Relayed, Lasting):
    name = "LCM messages delayed at random up to 40 ms (reordered)"
    guard = "bridge: message numbers"

    def treat(self, datagram):
        return [(self.rng.uniform(0.0, 0.04), datagram)]


class Replayed(Relayed, Lasting):
    name = "all LCM messages of the session sent again, 0.3 s later"
    guard = "bridge: age and message numbers"
    watch = 0.9

    @staticmethod
    def treat(datagram):
        return [(0.0, datagram), (0.3, datagram)]


class Delayed(Relayed, Lasting):
    name = "pulse command delayed by 150 ms: no pulse at all"
    guard = "bridge: age"

    @staticmethod
    def treat(datagram):
        return [(0.15 if b"SNAPWING_PULSE" in datagram[:40] else 0.0, datagram)]

    def trial(self):
        self.bench.arm(timeout=20)
        sent = self.bench.pulse(1.0, self.pulse, wait=False)
        wait_for(lambda: "old" in self.bench.status()["refusal"], 1.0, "refused as old")
        time.sleep(0.3)
        return sent, 0.0, self.bench.motors.highest(sent)


class OnSerial(Fault):
    keeps = False

    def bench_options(self):
        def through(bench):
            self.cable = SerialRelay(bench.far, bench.home.name, self.keeps)
            return "serial:" + self.cable.path
        return {"line": "pty", "through": through}

    def close(self):
        super().close()
        self.cable.close()


class SerialBlocked(OnSerial):
    name = "serial line blocked, then free again"
    promise = CONTROLLER
    typical = 0.35
    guard = "flight controller; bridge throws away what waits"
    order = "block"

    def harm(self):
        since = self.cable.order(self.order)
        pause = self.rng.uniform(0.31, 1.4)

        def undo():
            time.sleep(max(0.0, since + pause - time.monotonic()))
            self.cable.order("free")
        return since, undo


class SerialKeeps(SerialBlocked):
    name = "serial adapter that keeps what it was given, blocked, then free again"
    """A line that stops between answer and frame keeps one frame with thrust. No program can call it back: docs/safety.md, hazard 2, bounds
    what it does. More than one frame, more than that, or thrust without such a frame, is a failure."""
    keeps = True
    guard = "flight controller; thrust leaves only right behind an answer"
    seldom = 0.05
    half, duration = IDLE + (FULL - IDLE) / 2, 0.04  # us, s

    def trial(self):
        self.bounded = False
        begin, seconds, highest = super().trial()
        above = self.bench.motors.time_above(IDLE, begin + seconds)
        frames = self.cable.thrust_delivered
        assert frames <= 1, f"the line kept {frames} frames with thrust"
        self.bounded = frames == 1 and highest <= self.half and above <= self.duration
        return begin, seconds, highest


class SerialCatches(SerialKeeps):
    """The same at the worst moment, each time: what SerialKeeps meets by chance."""
    name = "serial adapter that keeps what it was given, stops right before a frame with thrust, then free again"
    guard = "flight controller; one frame at most, the safe one follows it"
    order = "catch"
    seldom = 1.0


class SerialHalfFrame(SerialBlocked):
    name = "serial line blocked in the middle of a frame, then free again"
    order = "half"


class SerialUnplugged(OnSerial):
    name = "serial line unplugged, then plugged in again"
    promise = CONTROLLER
    typical = 0.35
    guard = "flight controller; bridge latches"

    def harm(self):
        return self.cable.order("cut"), lambda: self.cable.order("plug")


class SerialNoisy(OnSerial, Lasting):
    name = "serial line with a flipped bit in 30 % of the packets"
    promise = CONTROLLER
    guard = "checksums; own deadline; at the worst flight controller"

    def harm(self):
        self.cable.order("noisy")
        return None, lambda: self.cable.order("clean")


class ShortWrites(Lasting):
    name = "every third frame written only in part"
    guard = "bridge: the rest goes first"
    promise = 0.08  # the safe frame itself may be one of them

    def bench_options(self):
        return {"line": "pty", "bridge_prefix": ["env", preload("short_writes")]}


class DiskFull(Lasting):
    name = "bridge's log goes to a full disk"
    guard = "the log is a process of its own"

    def bench_options(self):
        return {"bridge_options": ["--log", "/dev/full"]}


class CpuStarved(Lasting):
    name = "four busy processes on each core"
    guard = "real-time priority of the bridge; own deadline"

    def __init__(self, programs, seed):
        super().__init__(programs, seed)
        self.hogs = busy_loops(4 * os.cpu_count())

    def close(self):
        for hog in self.hogs:
            hog.kill()
            hog.wait()
        super().close()


def read_lcm_log(path):
    """@return list of (time [us], channel, message)"""
    messages = []
    with open(path, "rb") as log:
        while head := log.read(28):
            sync, _, stamp, channel_size, size = struct.unpack(">IqqII", head)
            if sync != 0xEDA1DA01:
                raise AssertionError(f"not an LCM log: {path}")
            messages.append((stamp, log.read(channel_size), log.read(size)))
    return messages


def play_messages(messages, url):
    """What lcm-logplayer does, on the loopback interface; lcm-logplayer itself needs a route for multicast there."""
    group, port = url.removeprefix("udpm://").split("?")[0].split(":")
    with contextlib.closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as out:
        out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
        out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        begin = time.monotonic()
        for stamp, channel, data in messages:
            time.sleep(max(0.0, begin + 1e-6 * (stamp - messages[0][0]) - time.monotonic()))
            out.sendto(b"LC02" + bytes(4) + channel + b"\0" + data, (group, int(port)))


class LogReplayed(Lasting):
    name = "a recorded LCM session is replayed into the live bridge"
    guard = "bridge: age, message numbers, session"
    new_session = None  # into the session of the recording, a new one, or either
    refusals = frozenset()  # each that the bridge told during the replay; the live operator's own late messages are among them

    def trial(self):
        bench = self.bench
        log = os.path.join(bench.home.name, "log")
        logger = subprocess.Popen(["lcm-logger", "--quiet", "--force", "--lcm-url=" + bench.url, log], stdout=subprocess.DEVNULL,
                                  stderr=subprocess.DEVNULL)
        wait_for_start(lambda: os.path.exists(log), "the recorder")
        time.sleep(0.3)
        bench.arm(timeout=20)
        bench.pulse(1.0, 0.3)
        time.sleep(0.4)
        logger.send_signal(signal.SIGINT)
        logger.wait(START)
        recorded = read_lcm_log(log)
        commands = [channel for _, channel, _ in recorded if channel in (b"SNAPWING_PULSE", b"SNAPWING_HEARTBEAT")]
        if b"SNAPWING_PULSE" not in commands or len(commands) < 25:
            raise NotBegun(f"the recorder came late: {len(commands)} commands")
        new_session = self.rng.random() < 0.5 if self.new_session is None else self.new_session
        if new_session:
            bench.bridge.kill()
            bench.bridge = bench.start_bridge()
            wait_for_start(lambda: bench.fresh().get("state") == "idle", "a new bridge is there")
        since = time.monotonic()
        before = bench.status()
        play_messages(recorded, bench.url)
        time.sleep(0.2)
        after = bench.status()
        self.refusals = {status["refusal"] for status in bench.statuses if status["t"] > since}
        if after["refused"] < before["refused"] + 20:
            raise AssertionError(f"nothing of the log was refused: {before} {after}")
        if after["pulse_id"] > before["pulse_id"] or (new_session and after["state"] != "idle"):
            raise AssertionError(f"the log had an effect: {before} {after}")
        return since, 0.0, bench.motors.highest(since)


ALL = [OperatorKilled, OperatorStopped, Aborted, DeadmanReleased, NetworkGone,
       SerialBlocked, SerialKeeps, SerialCatches, SerialHalfFrame, ShortWrites, SerialUnplugged, SerialNoisy, Flood, Forged, Malformed,
       Duplicated, Reordered, Replayed, Delayed, LogReplayed, DiskFull, CpuStarved]
