"""Faults of radio_bridge and its guardian, from outside (signals) and from inside (fault_injection.c)."""
import mmap
import os
import signal
import struct
import tempfile
import time

from link_bench import NotBegun, wait_for
from link_faults import CONTROLLER, GUARDIAN, TYPICAL, Fault, Killed, preload


class BridgeKilled(Killed):
    name = "radio_bridge: kill -9, then started again"
    promise, typical = GUARDIAN, TYPICAL
    guard = "guardian"
    victim = "bridge"


class BridgeStopped(BridgeKilled):
    name = "radio_bridge: SIGSTOP; ended by the guardian, started again"
    signal = signal.SIGSTOP


class BridgeTerminated(Fault):
    name = "radio_bridge: SIGTERM, SIGINT, SIGHUP"
    guard = "bridge: safe frames before it ends"
    signals = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)

    def harm(self):
        bench = self.bench
        bench.bridge.signal(self.rng.choice(self.signals))

        def undo():
            bench.bridge.child.wait(3)
            bench.bridge.kill()
            bench.bridge = bench.start_bridge()
        return None, undo


class BridgeCrashed(BridgeTerminated):
    name = "radio_bridge: SIGSEGV, SIGABRT, SIGBUS, SIGTRAP sent to it"
    promise, typical = GUARDIAN, TYPICAL
    guard = "guardian"
    signals = (signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS, signal.SIGTRAP)


class Injected(Fault):
    """A fault inside radio_bridge, by fault_injection.c: tens say where (10 main loop, 20 thread that receives from the network, 30 any other
    thread, 40 clocks), ones what."""
    promise, typical = GUARDIAN, TYPICAL
    guard = "guardian"
    fault = 0
    argument = (0, 0)  # ms, drawn between these

    def bench_options(self):
        file, self.path = tempfile.mkstemp(prefix="link_fault_")
        os.write(file, bytes(24))
        os.close(file)
        with open(self.path, "r+b") as handle:
            self.order = mmap.mmap(handle.fileno(), 24)
        return {"bridge_prefix": ["env", preload("fault_injection"), "SNAPWING_FAULT=" + self.path]}

    def close(self):
        super().close()
        os.unlink(self.path)

    def harm(self):
        bench = self.bench
        self.order[8:24] = struct.pack("qq", self.rng.randint(*self.argument), 0)
        self.order[0:8] = struct.pack("q", self.fault)
        try:
            wait_for(lambda: struct.unpack("q", self.order[16:24])[0] != 0, 2, "fault is done")
        except AssertionError as error:
            raise NotBegun(f"no thread came by where the fault is done: {error}") from error
        since = 1e-6 * struct.unpack("q", self.order[16:24])[0]

        def undo():
            time.sleep(max(0.0, since + self.rng.uniform(0.31, 1.0) - time.monotonic()))
            self.order[0:24] = bytes(24)
            if not self.survives or bench.bridge.child.poll() is not None:
                bench.bridge.kill()
                bench.bridge = bench.start_bridge()
        return since, undo

    survives = False


def injected(fault, class_name, name, **others):
    return type(class_name, (Injected,), {"fault": fault, "name": name, "__module__": __name__, **others})


CLOCKS = {"guard": "bridge: clocks disagree", "promise": 0.06, "typical": None, "survives": True}
INJECTED = [
    injected(11, "SegvMain", "segmentation fault in the bridge's loop"),
    injected(21, "SegvNetwork", "segmentation fault in the thread that reads the network (LCM's, all signals blocked)"),
    injected(31, "SegvOther", "segmentation fault in another thread of the bridge"),
    injected(12, "AbortMain", "abort (as by std::terminate) in the bridge's loop"),
    injected(22, "AbortNetwork", "abort in the thread that reads the network"),
    injected(32, "AbortOther", "abort in another thread of the bridge"),
    injected(13, "MemoryMain", "the bridge's loop takes memory without end"),
    injected(23, "MemoryNetwork", "the thread that reads the network takes memory without end"),
    injected(14, "Stalled", "the bridge's loop stands still for 90 to 600 ms", argument=(90, 600)),
    injected(15, "Spinning", "the bridge's loop turns without end at its real-time priority"),
    injected(37, "ExitOther", "another thread ends the bridge's process"),
    injected(18, "TermBeforeSleep", "radio_bridge: SIGTERM just before its loop goes to sleep", guard="bridge: safe frames before it ends",
             promise=0.06, typical=None),
    injected(40, "ClockStill", "monotonic clock stands still while the others go on", guard="bridge: clocks disagree; guardian"),
    injected(41, "Suspended", "suspended for 0.1 to 3 s: boot time and wall clock went on, the monotonic clock did not",
             argument=(100, 3000), **CLOCKS),
    injected(42, "WallClockSet", "wall clock set by an hour", argument=(-3600000, 3600000), **CLOCKS),
]


class GuardianKilled(Fault):
    name = "guardian: kill -9"
    promise = 0.08  # looked at right before the frame that it makes safe
    guard = "bridge: refuses to pulse without it"
    signal = signal.SIGKILL

    def harm(self):
        bench = self.bench
        os.kill(bench.guardian(), self.signal)

        def undo():
            bench.bridge.kill()
            bench.bridge = bench.start_bridge()
        return None, undo


class GuardianStopped(GuardianKilled):
    name = "guardian: SIGSTOP"
    promise = 0.20
    guard = "bridge: the guardian does not move"
    signal = signal.SIGSTOP

    def harm(self):
        guardian = self.bench.guardian()
        since, undo = super().harm()

        def kill_both():
            os.kill(guardian, signal.SIGKILL)
            undo()
        return since, kill_both


class GuardianThenBridge(GuardianKilled):
    name = "guardian: kill -9, and the bridge at once after it"
    promise = CONTROLLER
    typical = 0.35
    guard = "flight controller: throttle hold"

    def harm(self):
        since, undo = super().harm()
        self.bench.bridge.signal(signal.SIGKILL)
        return since, undo


ALL = [BridgeKilled, BridgeStopped, BridgeTerminated, BridgeCrashed, *INJECTED, GuardianKilled, GuardianStopped, GuardianThenBridge]
