"""From an abort to the frame with throttle low and AUX1 low on the wire: by ROS service, by link_console, by a deadman on a topic
("stick"), in the middle of a pulse and while arming, with a share of all LCM datagrams lost.

usage: abort_times.py PROGRAMS [--kinds console ros stick] [--count 200] [--loss 0.5] [--helpers FOLDER]
Exit code 0 only if 99 % came within 40 ms and all within 80 ms, and none was followed by anything but such frames."""
import argparse
import os
import random
import select
import socket
import sys
import threading
import time

from link_bench import Bench, NotBegun, be_firm, free_port, raw_rc, wait_for

TYPICAL, WORST = 0.040, 0.080  # s
THROTTLE, AUX1 = 2, 4


class WireTap:
    """Carries the line between bridge and controller and notes each frame of channels: (time, throttle, AUX1)."""

    def __init__(self, port):
        self.frames, self.stop, self.rest = [], False, b""
        self.controller = port
        self.port = free_port(socket.SOCK_STREAM)
        self.listener = socket.create_server(("127.0.0.1", self.port))
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()

    def _run(self):
        be_firm(0, 55)
        self.listener.settimeout(0.2)
        while not self.stop:
            try:
                near, _ = self.listener.accept()
            except OSError:
                continue
            with near, socket.create_connection(("127.0.0.1", self.controller)) as far:
                for end in (near, far):
                    end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self._carry(near, far)

    def _carry(self, near, far):
        while not self.stop:
            for ready in select.select([near, far], [], [], 0.1)[0]:
                try:
                    data = ready.recv(4096)
                except OSError:
                    data = b""
                if not data:
                    return
                if ready is near:
                    self._note(data, time.monotonic())
                (far if ready is near else near).sendall(data)

    def _note(self, data, now):
        found, self.rest = raw_rc(self.rest + data)
        self.frames += [(now, channels[THROTTLE], channels[AUX1]) for channels in found]

    @staticmethod
    def safe(frame):
        return frame[1] <= 1000 and frame[2] <= 1000

    def since(self, begin):
        return [frame for frame in self.frames if frame[0] >= begin]

    def close(self):
        self.stop = True
        self.thread.join(2)
        self.listener.close()


def make_bench(options, kind):
    environment = {"SNAPWING_LOSS": str(options.loss)} if options.loss else {}
    if options.loss:
        environment["LD_PRELOAD"] = os.path.join(options.helpers, "libhalf_lost.so")
    taps = []

    def through(bench):
        taps.append(WireTap(bench.controller_port))
        return f"tcp:127.0.0.1:{taps[0].port}"
    kind_of_bench = Bench
    if kind != "console":
        from ros_faults import RosBench  # needs a sourced workspace

        class kind_of_bench(RosBench):
            node_settings = {"deadman": "topic"} if kind == "stick" else {}
    bench = kind_of_bench(options.programs, through=through, environment=environment)
    return bench, taps[0]


def arm(bench, kind):
    for _ in range(6):
        if kind == "stick":
            bench.console.send("deadman on")
            time.sleep(0.06)
        try:
            bench.arm(timeout=10)
            return
        except NotBegun as error:
            last = error
    raise last


def begin_arming(bench, tap, kind):
    """Leaves the controller or the bridge in the middle of arming."""
    for _ in range(10):
        if bench.fresh().get("state") == "fault":
            bench.console.send("reset")
            time.sleep(0.5)
        if kind == "stick":
            bench.console.send("deadman on")
            time.sleep(0.06)
        since = time.monotonic()
        bench.console.send("arm")
        try:
            wait_for(lambda: any(frame[2] > 1700 for frame in tap.since(since)), 0.9, "AUX1 high")
            return
        except AssertionError:
            bench.console.send("disarm")
            time.sleep(0.2)
    raise NotBegun("arming does not begin")


def stop(bench, kind):
    """@return when the operator acted"""
    if kind == "console":
        now = time.monotonic()
        bench.console.send("abort")
        return now
    said = len(bench.said)
    bench.console.send("deadman off" if kind == "stick" else "abort")
    wait_for(lambda: len(bench.said) > said, 2.0, "the console acts")
    return bench.said[-1]["t"]


def trial(bench, tap, kind, rng, arming):
    if arming:
        begin_arming(bench, tap, kind)
        time.sleep(rng.uniform(0.0, 0.03))
    else:
        arm(bench, kind)
        bench.pulse(1.0, 1.2)
        time.sleep(rng.uniform(0.03, 0.4))
    if not tap.frames or tap.safe(tap.frames[-1]):
        raise NotBegun("disarmed before the abort")
    begin = stop(bench, kind)
    wait_for(lambda: any(tap.safe(frame) for frame in tap.since(begin)), 1.5, "a safe frame")
    took = next(frame[0] for frame in tap.since(begin) if tap.safe(frame)) - begin
    time.sleep(0.2)
    late = [frame for frame in tap.since(begin + took) if not tap.safe(frame)]
    if late:
        raise AssertionError(f"{kind}: not safe after the first safe frame: {late[:3]}")
    del tap.frames[:-10]
    if kind == "console":
        bench.console.send("disarm")
        bench.console.send("reset")
        time.sleep(0.15)
    elif kind == "ros":
        bench.console.send("reset")
        time.sleep(0.3)
    else:
        bench.console.send("disarm")
        time.sleep(0.1)
    return took


def measure(options, kind):
    rng, times, lost = random.Random(7), [], 0
    bench, tap = make_bench(options, kind)
    try:
        with bench:
            while len(times) < options.count:
                try:
                    times.append(trial(bench, tap, kind, rng, arming=len(times) % 2 == 1))
                except NotBegun as error:
                    lost += 1
                    if lost > 20 + options.count // 2:
                        raise AssertionError(f"{kind}: {lost} trials did not begin: {error}") from error
    finally:
        tap.close()
    times.sort()
    share = sum(took <= TYPICAL for took in times) / len(times)
    print(f"{kind}: {len(times)} aborts, {lost} not begun, loss {options.loss:.0%}: median {1e3 * times[len(times) // 2]:.1f} ms, "
          f"within 40 ms {share:.1%}, worst {1e3 * times[-1]:.1f} ms", flush=True)
    return share >= 0.99 and times[-1] <= WORST


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs")
    parser.add_argument("--kinds", nargs="+", default=["console", "ros", "stick"], choices=["console", "ros", "stick"])
    parser.add_argument("--count", type=int, default=200, help="aborts of each kind")
    parser.add_argument("--loss", type=float, default=0.5, help="share of all LCM datagrams that is lost")
    parser.add_argument("--helpers", default=".", help="folder of libhalf_lost.so")
    options = parser.parse_args()
    be_firm(0, 31)
    return 0 if all([measure(options, kind) for kind in options.kinds]) else 1


if __name__ == "__main__":
    sys.exit(main())
