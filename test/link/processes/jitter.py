"""Measures the radio bridge's frame period at the far end of the line with every core loaded, and the time from a command to
its frame. usage: jitter.py --programs FOLDER [--seconds 60] [--no-load] [--realtime-priority 50]"""
import argparse
import os
import socket
import subprocess
import threading
import time

from link_bench import IDLE, Bench, wait_for


class Sink:
    """Takes frames of a bridge and notes when each arrived, with a priority above the bridge's."""

    def __init__(self, size):
        self.size = size
        self.server = socket.create_server(("127.0.0.1", 0))
        self.times = []
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()

    def address(self):
        return "tcp:127.0.0.1:%d" % self.server.getsockname()[1]

    def _run(self):
        try:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(70))
        except PermissionError:
            pass
        caller, _ = self.server.accept()
        while True:
            try:
                data = caller.recv(4096)
            except ConnectionResetError:
                return
            if not data:
                return
            self.times += [time.monotonic()] * (len(data) // self.size)


WITNESS = """
import os, time
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
    """A process that sleeps 1 ms over and over at the highest priority: stalls of the machine itself (a virtual one is taken off
    its cores at times) show here, and no program could have done better during them."""

    def __enter__(self):
        self.process = subprocess.Popen(["/usr/bin/python3", "-c", WITNESS], stdout=subprocess.PIPE, text=True)
        return self

    def __exit__(self, *_):
        self.process.kill()
        text = self.process.communicate()[0]
        self.stalls = [tuple(map(float, line.split())) for line in text.splitlines() if line.count(" ") == 1]

    def saw(self, begin, end):
        return any(start < end and begin < stop for start, stop in self.stalls)


def hogs(count):
    return [subprocess.Popen(["sh", "-c", "while :; do :; done"]) for _ in range(count)]


def measure_period(programs, seconds, options):
    sink = Sink(26)
    with Bench(programs) as bench:
        bench.bridge.kill()
        bench.line, bench.protocol = sink.address(), "crsf"
        bench.bridge_options = ["--allow", "no-readback", *options]
        bench.bridge = bench.start_bridge()
        time.sleep(1.0)
        sink.times.clear()
        with Witness() as witness:
            time.sleep(seconds)
            times = list(sink.times)
    periods = sorted(abs(b - a - 0.02) for a, b in zip(times, times[1:]))
    late = [(a, b) for a, b in zip(times, times[1:]) if abs(b - a - 0.02) > 0.002]
    excused = sum(witness.saw(a - 0.02, b + 0.02) for a, b in late)
    at = lambda share: 1e3 * periods[min(len(periods) - 1, int(share * len(periods)))]
    within = sum(period <= 0.002 for period in periods) / len(periods)
    print(f"frames {len(times)} in {times[-1] - times[0]:.1f} s; |period - 20 ms|: median {at(0.5):.3f} ms, 99 % {at(0.99):.3f} ms, "
          f"99.9 % {at(0.999):.3f} ms, worst {at(1.0):.3f} ms; within 2 ms: {100 * within:.3f} %")
    print(f"beyond 2 ms: {len(late)}, of which {excused} while the machine itself stood still ({len(witness.stalls)} stalls of "
          f"more than 2.5 ms seen by a witness of higher priority)")
    return 1 - (len(late) - excused) / len(periods)


def measure_latency(programs, count, options):
    """Command stamped by the operator's process -> frame handed to the line, as the bridge reports it."""
    found = []
    for _ in range(count):
        with Bench(programs, bridge_options=options) as bench:
            for _ in range(5):
                bench.arm(timeout=20)
                bench.pulse(0.3, 0.3)
                wait_for(lambda: bench.motors.last()["motor"] <= IDLE, 2, "pulse ends")
                time.sleep(0.15)
            found.append(bench.status()["latency_worst"])
    print(f"command to frame, worst of 5 pulses in each of {count} sessions: median {1e3 * sorted(found)[count // 2]:.1f} ms, "
          f"worst {1e3 * max(found):.1f} ms")
    return max(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", required=True)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--sessions", type=int, default=10)
    parser.add_argument("--no-load", action="store_true")
    parser.add_argument("--realtime-priority", type=int, default=50)
    options = parser.parse_args()
    load = [] if options.no_load else hogs(2 * os.cpu_count())
    bridge_options = ["--realtime-priority", str(options.realtime_priority)]
    try:
        within = measure_period(options.programs, options.seconds, bridge_options)
        latency = measure_latency(options.programs, options.sessions, bridge_options)
    finally:
        for hog in load:
            hog.kill()
            hog.wait()
    return 0 if within >= 0.999 and latency < 0.02 else 1


if __name__ == "__main__":
    raise SystemExit(main())
