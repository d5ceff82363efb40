"""Measures the radio bridge on the wire with every core loaded: the period of its frames, and the time from a command's
publication on LCM to the first byte of the frame that carries it.
usage: jitter.py --programs FOLDER [--seconds 60] [--commands 200] [--runs 1] [--no-load] [--realtime-priority 50]"""
import argparse
import os
import socket
import subprocess
import threading
import time

from link_bench import Bench, Witness, be_firm, wait_for

PERIOD = 0.02  # s
WITHIN = 0.002  # s
CRSF_SIZE = 26  # bytes
LOW = 200       # ticks; throttle low is 190


class Sink:
    """Takes CRSF frames of a bridge and notes when each arrived and its throttle, with a priority above the bridge's."""

    def __init__(self):
        self.server = socket.create_server(("127.0.0.1", 0))
        self.frames = []  # (time, throttle ticks)
        threading.Thread(target=self._run, daemon=True).start()

    def address(self):
        return "tcp:127.0.0.1:%d" % self.server.getsockname()[1]

    def _run(self):
        be_firm(0, 70)
        caller, _ = self.server.accept()
        rest = b""
        while True:
            try:
                data = caller.recv(4096)
            except ConnectionResetError:
                return
            now = time.monotonic()
            if not data:
                return
            rest += data
            while len(rest) >= CRSF_SIZE:
                channels = int.from_bytes(rest[3:25], "little")
                self.frames.append((now, channels >> 22 & 0x7FF))
                rest = rest[CRSF_SIZE:]


def hogs(count):
    return [subprocess.Popen(["sh", "-c", "while :; do :; done"]) for _ in range(count)]


def percentiles(values):
    values = sorted(values)
    at = lambda share: 1e3 * values[min(len(values) - 1, int(share * len(values)))]
    return (f"median {at(0.5):.2f} ms, 90 % {at(0.9):.2f} ms, 99 % {at(0.99):.2f} ms, 99.9 % {at(0.999):.2f} ms, "
            f"worst {1e3 * values[-1]:.2f} ms")


def start(programs, options):
    sink = Sink()
    bench = Bench(programs, line=sink.address(), protocol="crsf", bridge_options=["--allow", "no-readback", *options])
    wait_for(lambda: len(sink.frames) > 10, 10, "frames arrive")
    return sink, bench


def measure_period(sink, seconds):
    first = len(sink.frames)
    with Witness() as witness:
        time.sleep(seconds)
        times = [frame[0] for frame in sink.frames[first:]]
    off = [abs(b - a - PERIOD) for a, b in zip(times, times[1:])]
    late = [(a, b) for a, b in zip(times, times[1:]) if abs(b - a - PERIOD) > WITHIN]
    excused = sum(witness.saw(a - PERIOD, b + PERIOD) for a, b in late)
    share = 1 - len(late) / len(off)
    print(f"  frames {len(times)} in {times[-1] - times[0]:.1f} s; |period - 20 ms|: {percentiles(off)}; "
          f"within 2 ms: {100 * share:.3f} %")
    print(f"  beyond 2 ms: {len(late)}, of which {excused} while the machine itself stood still ({len(witness.stalls)} stalls of "
          f"more than 2.5 ms seen by a witness of higher priority)")
    return share


def measure_latency(sink, bench, count):
    """Publication, as the operator's program notes it, -> arrival of the first frame with thrust."""
    found, lost = [], 0
    bench.arm(timeout=30)
    while len(found) < count and lost < count:
        sent = len(bench.sent)
        bench.pulse(0.3, 0.06, wait=False)
        time.sleep(0.25 + 0.02 * (len(found) * 0.618 % 1))  # any phase of the frames
        rise = None
        if len(bench.sent) > sent:
            begin = bench.sent[-1]["t"]
            rise = next((t for t, throttle in sink.frames[-60:] if t > begin and throttle > LOW), None)
        if rise is None:
            lost += 1
            bench.arm(timeout=30)
        else:
            found.append(rise - begin)
    print(f"  command to frame, {len(found)} commands ({lost} not sent or refused): {percentiles(found)}; "
          f"under one period: {100 * sum(one < PERIOD for one in found) / len(found):.2f} %")
    return sum(one < PERIOD for one in found) / len(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", required=True)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--commands", type=int, default=200)
    parser.add_argument("--runs", type=int, default=1)
    parser.add_argument("--no-load", action="store_true")
    parser.add_argument("--realtime-priority", type=int, default=50)
    options = parser.parse_args()
    load = [] if options.no_load else hogs(2 * os.cpu_count())
    good = True
    try:
        for run in range(options.runs):
            sink, bench = start(options.programs, ["--realtime-priority", str(options.realtime_priority)])
            with bench:
                within = measure_period(sink, options.seconds)
                prompt = measure_latency(sink, bench, options.commands) if options.commands else 1.0
                status = bench.status()
                print(f"run {run + 1}: real-time priority {status['realtime']}, memory locked {status['locked']}, load average "
                      f"{os.getloadavg()[0]:.1f} (with {len(load)} busy processes of this script)", flush=True)
                good &= within >= 0.999 and prompt >= 0.999
    finally:
        for hog in load:
            hog.kill()
            hog.wait()
    return 0 if good else 1


if __name__ == "__main__":
    raise SystemExit(main())
