"""Measures the radio bridge on the wire with every core loaded: the period of its frames, and the time from a command's
publication on LCM to the first byte of the frame that carries it.
usage: jitter.py --programs FOLDER [--seconds 60] [--commands 200] [--runs 1] [--no-load] [--realtime-priority 50]"""
import argparse
import os
import pathlib
import time

from link_bench import Bench, Process, Witness, busy_loops, wait_for

PERIOD = 0.02  # s
WITHIN = 0.002  # s
LOW = 200       # ticks; throttle low is 190


class Sink:
    """frame_sink.py and what it has said: (time, throttle ticks) of each frame."""

    def __init__(self):
        self.process = Process(["/usr/bin/python3", pathlib.Path(__file__).with_name("frame_sink.py")])
        wait_for(lambda: self.process.lines, 10, "sink starts")

    def address(self):
        return "tcp:127.0.0.1:" + self.process.lines[0]

    @property
    def frames(self):
        return [(float(time), int(ticks)) for time, ticks in (line.split() for line in self.process.lines[1:])]


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


def measure_period(sink, bench, seconds):
    first, own = len(sink.frames), bench.status()["periods"]
    with Witness() as witness:
        time.sleep(seconds)
        times = [frame[0] for frame in sink.frames[first:]]
    own = [after - before for before, after in zip(own, bench.status()["periods"])]
    off = [abs(b - a - PERIOD) for a, b in zip(times, times[1:])]
    late = [(a, b) for a, b in zip(times, times[1:]) if abs(b - a - PERIOD) > WITHIN]
    excused = sum(witness.saw(a - PERIOD, b + PERIOD) for a, b in late)
    longest = max((stop - start for start, stop in witness.stalls), default=0)
    share = 1 - len(late) / len(off)
    print(f"  frames {len(times)} in {times[-1] - times[0]:.1f} s; |period - 20 ms|: {percentiles(off)}; "
          f"within 2 ms: {100 * share:.3f} %")
    print(f"  beyond 2 ms: {len(late)}, of which {excused} while a core itself stood still ({len(witness.stalls)} stalls of more than 2.5 ms, the "
          f"longest {1e3 * longest:.0f} ms, seen by a witness of higher priority on each core)")
    kept = sum(own[:5]) / sum(own)  # up to 2 ms
    print(f"  by the bridge's own clock, before the kernel's loopback: within 2 ms {100 * kept:.3f} % of {sum(own)}; late by less than "
          f".1 .2 .5 1 2 5 10 20 50 ms, more: {own}")
    return kept


def measure_latency(sink, bench, count):
    """Publication, as the operator's program notes it, -> arrival of the first frame with thrust."""
    found, lost = [], 0
    bench.arm(timeout=30)
    while len(found) < count and lost < count:
        first = len(sink.process.lines) - 1
        sent = len(bench.sent)
        bench.pulse(0.3, 0.06, wait=False)
        time.sleep(0.25 + 0.02 * (len(found) * 0.618 % 1))  # any phase of the frames
        rise = None
        if len(bench.sent) > sent:
            begin = bench.sent[-1]["t"]
            rise = next((t for t, throttle in sink.frames[first:] if t > begin and throttle > LOW), None)
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
    load = [] if options.no_load else busy_loops(2 * os.cpu_count())
    good = True
    try:
        for run in range(options.runs):
            sink, bench = start(options.programs, ["--realtime-priority", str(options.realtime_priority)])
            with bench:
                within = measure_period(sink, bench, options.seconds)
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
