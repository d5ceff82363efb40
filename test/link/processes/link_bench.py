"""Real programs on the loopback: stand-in flight controller, radio bridge, operator's console. Used by the process tests and
by the fault table. Times are seconds of the monotonic clock that all of them share."""
import contextlib
import itertools
import json
import os
import pathlib
import signal
import socket
import struct
import subprocess
import tempfile
import threading
import time

IDLE = 1070  # us, armed and throttle low
OFF = 1000
BLINK = 0.002  # s; what motors with a lag of tens of milliseconds cannot follow
START = 60     # s in which a program starts on a machine at work
HARNESS = 29   # real-time priority of a script that measures: below all that it measures


_ports = itertools.count(20000 + 100 * (os.getpid() % 120))


def free_port(kind):
    """A port of this process's own hundred, so that benches in several processes do not meet."""
    for port in _ports:
        with contextlib.closing(socket.socket(socket.AF_INET, kind)) as probe, contextlib.suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return port
    return None


def be_firm(process, priority):
    """Real-time priority for what stands for a machine or a cable of its own, if allowed."""
    with contextlib.suppress(PermissionError):
        os.sched_setscheduler(process, os.SCHED_FIFO, os.sched_param(priority))


def measure_firmly():
    """The calling thread takes the harness's priority, so that a harm happens when its time is noted; children and threads do not inherit it."""
    with contextlib.suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(HARNESS))


def wait_for(condition, timeout, what):
    deadline = time.monotonic() + timeout
    while time.monotonic() < deadline:
        if condition():
            return
        time.sleep(0.005)
    raise AssertionError(f"not within {timeout} s: {what}")


RAW_RC = b"$X<" + struct.pack("<BHH", 0, 200, 16)  # head of MSP_SET_RAW_RC with eight channels, MSP version 2


def raw_rc(data):
    """@return channels of each whole frame in `data`, and what is left behind the last"""
    frames, whole = [], len(RAW_RC) + 17
    while (at := data.find(RAW_RC)) >= 0 and len(data) >= at + whole:
        frames.append(struct.unpack_from("<8H", data, at + len(RAW_RC)))
        data = data[at + whole:]
    return frames, data


class NotBegun(AssertionError):
    """The harm could not be done because arming or the pulse before it failed (a machine too busy): says nothing about the fault."""


def wait_for_start(condition, what):
    """Raises NotBegun: that a program starts late on a busy machine says nothing about the link."""
    try:
        wait_for(condition, START, what)
    except AssertionError as error:
        raise NotBegun(str(error)) from error


class Process:
    """A child whose output lines are read by a thread and handed to `on_line`."""

    def __init__(self, command, on_line=None, **options):
        self.child = subprocess.Popen([str(part) for part in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                      stderr=subprocess.STDOUT, text=True, bufsize=1, **options)
        self.lines = []
        self.on_line = on_line
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        measure_firmly()  # it holds locks that the measuring thread waits for
        for line in self.child.stdout:
            if self.on_line:
                self.on_line(line)
            else:
                self.lines.append(line.rstrip())

    def signal(self, number):
        self.child.send_signal(number)

    def send(self, line):
        self.child.stdin.write(line + "\n")
        self.child.stdin.flush()

    def kill(self):
        if self.child.poll() is None:
            self.child.send_signal(signal.SIGCONT)
            self.child.kill()
        self.child.wait()
        self.reader.join(2)
        for stream in (self.child.stdin, self.child.stdout):
            with contextlib.suppress(OSError):
                stream.close()


def busy_loops(count):
    """@return processes that do nothing for ever, and end with the thread that started them"""
    return [subprocess.Popen(["setpriv", "--pdeathsig", "KILL", "sh", "-c", "while :; do :; done"]) for _ in range(count)]


WITNESS = """
import ctypes, os, sys, time
ctypes.CDLL(None).prctl(1, 9)  # PR_SET_PDEATHSIG, SIGKILL: it ends with its parent
os.sched_setaffinity(0, {int(sys.argv[1])})
try:
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(80))
except PermissionError:
    pass
before = time.monotonic()
while True:
    time.sleep(0.001)
    now = time.monotonic()
    if now - before > 0.0025:
        print(before, now, flush=True)
    before = now
"""


class Witness:
    """On each core a process that sleeps 1 ms over and over at the highest priority: stalls of the machine itself (a virtual one is taken off
    its cores at times) show here, and no program could have done better during them."""

    def __enter__(self):
        self.stalls = []  # (begin, end), grows while it runs
        self.processes = [Process(["/usr/bin/python3", "-c", WITNESS, str(core)], self._note) for core in os.sched_getaffinity(0)]
        return self

    def _note(self, line):
        if line.count(" ") == 1:
            self.stalls.append(tuple(map(float, line.split())))

    def __exit__(self, *_):
        for process in self.processes:
            process.kill()

    def stood_still(self, begin, end):
        """@return (time for which at least one core stood still between begin and end, longest such stall) [s]"""
        total, longest, covered = 0.0, 0.0, begin
        for start, stop in sorted(list(self.stalls)):
            start, stop = max(start, covered), min(stop, end)
            if start < stop:
                total, longest, covered = total + stop - start, max(longest, stop - start), stop
        return total, longest

    def saw(self, begin, end):
        return self.stood_still(begin, end)[1] > 0


class Motors:
    """Events of the stand-in: (time, armed, failsafe, motor [us]) at each change since the last forget()."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.file = None
        self.rest = ""
        self.known = []

    def events(self):
        if self.file is None and self.path.exists():
            self.file = open(self.path, encoding="ascii")
        if self.file is not None:
            *lines, self.rest = (self.rest + self.file.read()).split("\n")
            self.known += [json.loads(line) for line in lines]
        return self.known

    def forget(self):
        self.known = self.events()[-1:]

    def close(self):
        if self.file is not None:
            self.file.close()

    def last(self):
        events = self.events()
        return events[-1] if events else {"t": 0, "armed": False, "failsafe": False, "motor": 0, "flags": 0}

    def first_above(self, level, since):
        """Time when the motors rose above `level` after `since`; None if never."""
        return next((event["t"] for event in self.events() if event["t"] > since and event["motor"] > level), None)

    def first_at_or_below(self, level, since):
        """Time when the motors are at `level` or lower and `since` has passed; None if never."""
        before = None
        for event in self.events():
            if event["t"] <= since:
                before = event
            elif event["motor"] <= level:
                if before is not None and before["motor"] <= level:
                    return since
                return event["t"]
            else:
                before = event
        return since if before is not None and before["motor"] <= level else None

    def time_above(self, level, since):
        """Seconds after `since` for which the outputs were above `level`."""
        return sum(max(0.0, lasted) for motor, lasted in self.outputs(since) if motor > level)

    def outputs(self, since):
        """Outputs with the seconds that each lasted after `since`; not positive if it was over by then."""
        now = time.monotonic()
        events = self.events()
        for event, following in zip(events, events[1:] + [{"t": now}]):
            yield event["motor"], min(following["t"], now) - max(event["t"], since)

    def highest(self, since):
        """Largest output after `since`; outputs that lasted no longer than BLINK do not count."""
        return max((motor for motor, lasted in self.outputs(since) if lasted > BLINK), default=0)


class Bench:
    """One set of programs on ports of their own; a context manager that leaves nothing behind."""

    def __init__(self, folder, line="tcp", protocol="msp2", boot_grace=0.3, bridge_options=(), lcm_url=None,
                 standin_options=(), through=None, bridge_url=None, environment=None, bridge_prefix=(), vehicle="snapwing", key=None):
        self.programs = pathlib.Path(folder)
        self.home = tempfile.TemporaryDirectory(prefix="link_bench_")
        self.key = os.path.join(self.home.name, "key")
        if key:
            self.key = key
        else:
            subprocess.run([self.programs / "radio_bridge", "--create-key", self.key], check=True, capture_output=True)
        self.vehicle = vehicle
        self.url = lcm_url or f"udpm://239.255.76.67:{free_port(socket.SOCK_DGRAM)}?ttl=0"
        self.bridge_url = bridge_url or self.url
        self.environment = {**os.environ, **(environment or {})}
        self.bridge_prefix = list(bridge_prefix)
        self.motor_port = free_port(socket.SOCK_DGRAM)
        self.events = os.path.join(self.home.name, "events")
        self.motors = Motors(self.events)
        self.statuses = []
        self.sent = []  # publications of pulse commands
        self.said = []  # other words of the console
        self.processes = []
        self.bridge_options = list(bridge_options)
        self.protocol = protocol
        self.pulse_id = 0
        listen = ["--protocol", protocol if protocol in ("sbus", "crsf") else "msp", "--boot-grace", boot_grace,
                  "--motor-port", self.motor_port, "--events", self.events, *standin_options]
        self.controller_port = free_port(socket.SOCK_STREAM)
        if ":" in line:  # somebody else's end
            self.line, self.controller = line, None
        elif line == "pty":
            self.far = os.path.join(self.home.name, "line")
            listen += ["--pty", self.far]
            self.line = "serial:" + self.far
        else:
            listen += ["--listen", f"127.0.0.1:{self.controller_port}"]
            self.line = f"tcp:127.0.0.1:{self.controller_port}"
        try:
            if ":" not in line:
                self.start_controller(listen)
            if through is not None:
                self.line = through(self)
            self.bridge = self.start_bridge()
            self.console = self.start_console()
        except BaseException:
            self.__exit__()
            raise

    def start_controller(self, arguments):
        self.controller = self.start("standin_flight_controller", arguments)
        be_firm(self.controller.child.pid, 60)
        wait_for(lambda: any("listening" in text or "pseudo" in text for text in self.controller.lines), 5, "stand-in starts")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.motors.close()
        for process in reversed(self.processes):
            process.kill()
        self.home.cleanup()

    def start(self, program, arguments, on_line=None, prefix=(), **options):
        process = Process([*prefix, self.programs / program, *arguments], on_line, env=self.environment, **options)
        self.processes.append(process)
        return process

    def start_bridge(self, prefix=(), **options):
        return self.start("radio_bridge", ["--fc", self.line, "--lcm-url", self.bridge_url, "--key-file", self.key,
                                           "--vehicle", self.vehicle, "--protocol", self.protocol, *self.bridge_options],
                          prefix=[*prefix, *self.bridge_prefix], **options)

    def guardian(self):
        """@return process id, as the bridge says"""
        return next(int(line.split("guardian ")[1]) for line in self.bridge.lines if "guardian " in line)

    def start_console(self, prefix=()):
        return self.start("link_console", ["--lcm-url", self.url, "--key-file", self.key, "--vehicle", self.vehicle],
                          self._status, prefix=prefix)

    def _status(self, line):
        with contextlib.suppress(ValueError):
            said = json.loads(line)
            (self.sent if "sent" in said else self.said if "said" in said else self.statuses).append(said)

    def status(self):
        return self.statuses[-1] if self.statuses else {"state": "none", "known": 0, "connected": 0, "armed": 0, "flags": -1}

    def fresh(self):
        """The latest status, or an empty one if it is older than 0.2 s."""
        status = self.status()
        return status if status.get("t", 0) > time.monotonic() - 0.2 else {"state": "none"}

    def armed(self):
        """As bridge and stand-in say; a controller that the bridge cannot ask counts as armed after 0.2 s."""
        if self.fresh().get("state") != "armed" or (self.controller and not self.motors.last()["armed"]):
            return False
        if "no-readback" in self.bridge_options:
            time.sleep(0.25)
            return True
        return bool(self.fresh().get("armed"))

    def arm(self, timeout=10):
        """Arms; tries again while the controller is not ready, as an operator would."""
        deadline = time.monotonic() + timeout
        while time.monotonic() < deadline:
            self.console.send("disarm")
            if self.fresh().get("state") == "fault":
                self.console.send("reset")
                time.sleep(0.15)
            time.sleep(0.08)
            self.console.send("arm")
            with contextlib.suppress(AssertionError):
                return wait_for(self.armed, 0.7, "armed")
        raise NotBegun(f"not armed: {self.status()} {self.bridge.lines[-3:]}")

    def pulse(self, throttle=1.0, duration=1.0, wait=True, pitch=None, hold=None):
        """@param hold  throttle and duration of a level behind the pulse
        @return time at which the motors rose, or of the command if not waited for"""
        self.pulse_id = max(self.pulse_id, self.status().get("pulse_id", 0)) + 1
        self.motors.forget()
        sent = time.monotonic()
        if hold:
            self.console.send(f"hold {self.pulse_id} {throttle} {duration} {hold[0]} {hold[1]}")
        else:
            self.console.send(f"pulse {self.pulse_id} {throttle} {duration}" + ("" if pitch is None else f" {pitch}"))
        if not wait:
            return sent
        try:
            wait_for(lambda: self.motors.first_above(IDLE, sent) is not None, 1.0, f"motors rise: {self.status()}")
        except AssertionError as error:
            raise NotBegun(str(error)) from error
        return self.motors.first_above(IDLE, sent)
