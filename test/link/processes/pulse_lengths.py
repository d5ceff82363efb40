"""Length of pulses on the real programs: from half of the thrust to half of the thrust at the stand-in's motors, against what was commanded.

usage: pulse_lengths.py PROGRAMS [--count 200] [--protocol msp2]
Exit code 0 only if 95 % are within 10 ms and none is more than 15 ms short, but for those in which the machine itself stood still."""
import argparse
import random
import sys
import time

from link_bench import IDLE, Bench, NotBegun, Witness, measure_firmly, wait_for

CLOSE, SHORT = 0.010, 0.015  # s
FULL = 1999                  # us
HALF = (IDLE + FULL) / 2


def length_of(bench, duration):
    """@return (begin, measured length) [s]"""
    if not bench.armed():
        bench.arm(timeout=20)
    sent = bench.pulse(1.0, duration)
    wait_for(lambda: bench.motors.first_above(HALF, sent - 0.1) is not None, 0.3, "half of the thrust")
    rise = bench.motors.first_above(HALF, sent - 0.1)
    wait_for(lambda: bench.motors.first_at_or_below(HALF, rise) is not None, duration + 1.0, "the pulse's end")
    return rise, bench.motors.first_at_or_below(HALF, rise) - rise


def measure(options):
    """@return list of (measured - commanded, time for which the machine stood still) [s]; how many did not begin"""
    rng, found, void = random.Random(7), [], 0
    with Witness() as witness, Bench(options.programs, protocol=options.protocol) as bench:
        while len(found) < options.count:
            duration = rng.uniform(0.1, 1.0)
            time.sleep(rng.uniform(0.15, 0.25))  # any phase of the frames
            try:
                begin, length = length_of(bench, duration)
            except NotBegun:
                void += 1
                if void > 20 + options.count:
                    raise
                continue
            found.append((length - duration, witness.stood_still(begin - 0.05, begin + length + 0.05)[0]))
    return found, void


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--protocol", default="msp2", choices=["msp1", "msp2"])
    options = parser.parse_args()
    measure_firmly()
    found, void = measure(options)
    errors = sorted(error for error, _ in found)
    share = sum(abs(error) <= CLOSE for error in errors) / len(errors)
    short = [(error, stall) for error, stall in found if error < -SHORT]
    print(f"{len(errors)} pulses of 0.1 to 1 s by {options.protocol}, {void} not begun: within 10 ms {share:.1%}, shortest {1e3 * errors[0]:+.1f} ms, "
          f"median {1e3 * errors[len(errors) // 2]:+.1f} ms, longest {1e3 * errors[-1]:+.1f} ms", flush=True)
    for error, stall in found:
        if abs(error) > CLOSE:
            print(f"  {1e3 * error:+.1f} ms; the machine stood still for {1e3 * stall:.1f} ms in it")
    return 0 if share >= 0.95 and all(stall > 0 for _, stall in short) else 1


if __name__ == "__main__":
    sys.exit(main())
