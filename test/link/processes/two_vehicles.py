"""Two vehicles on one LCM network: each operator arms its own and never the other one; two bridges of one id and key are refused.

usage: two_vehicles.py PROGRAMS [--count 100]"""
import argparse
import socket
import sys
import time

from link_bench import OFF, Bench, free_port, wait_for


def turned(bench, since):
    return any(event["armed"] or event["motor"] > OFF for event in bench.motors.events() if event["t"] >= since)


def own_only(options, url):
    """One key for both, as careless as can be: the ids alone keep them apart."""
    with Bench(options.programs, lcm_url=url, vehicle="a") as one, \
            Bench(options.programs, lcm_url=url, vehicle="b", key=one.key) as other:
        time.sleep(0.5)
        for count in range(options.count):
            told, silent = (one, other) if count % 2 == 0 else (other, one)
            since = time.monotonic()
            told.arm()
            time.sleep(0.05)
            if not told.motors.last()["armed"] or turned(silent, since):
                raise AssertionError(f"arm {count}: the wrong vehicle")
            told.console.send("disarm")
            wait_for(lambda bench=told: not bench.motors.last()["armed"], 2.0, "disarmed")
    print(f"two ids: {options.count} arms, each of its own vehicle only", flush=True)


def same_refused(options, url):
    """Key and id of both bridges are the same: nobody is armed, and the operator is told why."""
    with Bench(options.programs, lcm_url=url) as one, Bench(options.programs, lcm_url=url, key=one.key) as other:
        wait_for(lambda: "two radio bridges" in one.status().get("hint", ""), 5.0, "the second bridge is noticed")
        since = time.monotonic()
        for _ in range(options.count):
            for word in ("disarm", "arm"):
                one.console.send(word)
                time.sleep(0.1)
        if turned(one, since) or turned(other, since):
            raise AssertionError("armed although two bridges answer")
    print(f"one id twice: {options.count} times refused", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs")
    parser.add_argument("--count", type=int, default=100)
    options = parser.parse_args()
    own_only(options, f"udpm://239.255.76.67:{free_port(socket.SOCK_DGRAM)}?ttl=0")
    same_refused(options, f"udpm://239.255.76.67:{free_port(socket.SOCK_DGRAM)}?ttl=0")
    return 0


if __name__ == "__main__":
    sys.exit(main())
