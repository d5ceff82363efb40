"""Runs every fault of link_faults.py many times and writes the table docs/fault_table.md.
usage: fault_table.py --programs FOLDER --helpers FOLDER [--ros] [--trials 100] [--jobs 4] [--only NAME] [--write FILE]"""
import argparse
import concurrent.futures
import os
import platform
import sys
import time

import link_faults
import ros_faults
from link_bench import IDLE, NotBegun

MANY = (link_faults.BridgeKilled, link_faults.BridgeStopped, link_faults.OperatorKilled, link_faults.OperatorStopped,
        *ros_faults.ALL)
ALONE = (link_faults.Flood, link_faults.CpuStarved)  # they are about the whole machine


def run_batch(name, programs, helpers, seed, trials):
    """@return list of (seconds to idle, largest output afterwards, error text), None for trials that did not begin"""
    os.environ["SNAPWING_TEST_HELPERS"] = helpers
    results = []
    fault = None
    for number in range(trials):
        try:
            if fault is None:
                kind = getattr(link_faults, name, None) or getattr(ros_faults, name)
                fault = kind(programs, 1000 * seed + number)
            results.append((*fault.trial(), ""))
        except NotBegun:
            results.append(None)
            if fault is not None:
                fault.close()
            fault = None
        except Exception as error:  # pylint: disable=broad-except
            results.append((link_faults.NEVER, 9999, f"{type(error).__name__}: {error}"))
            if fault is not None:
                fault.close()
            fault = None
    if fault is not None:
        fault.close()
    return results


class Row:
    def __init__(self, kind, results):
        self.kind = kind
        self.void = results.count(None)
        results = [result for result in results if result is not None] or [(link_faults.NEVER, 9999, "no trial began")]
        self.trials = len(results)
        self.worst = max(result[0] for result in results)
        times = sorted(result[0] for result in results)
        self.median = times[len(times) // 2]
        self.returned = sum(result[1] > IDLE and not result[2] for result in results)
        self.late = sum(result[0] > kind.promise for result in results)
        self.errors = [result[2] for result in results if result[2]]
        self.good = not (self.returned or self.late or self.errors)

    def text(self):
        return (f"| {self.kind.name} | {self.kind.guard} | {1000 * self.kind.promise:.0f} | {self.trials} | {self.void} | "
                f"{1000 * self.median:.0f} | {1000 * self.worst:.0f} | {self.late} | {self.returned} | "
                f"{'yes' if self.good else 'NO'} |")


HEAD = """# Fault table of the radio link

Written by `test/link/processes/fault_table.py`, which runs the real programs (radio_bridge, link_console,
standin_flight_controller) on one machine and does each harm at a random moment of a full-throttle pulse. Times run from
the harm to the motors' outputs at idle or off, as the stand-in flight controller puts them out; for faults that need not
break the pulse off they run from the pulse's own end. "Thrust returned" counts trials in which the outputs rose above idle again
for more than 2 ms afterwards, with the failed part restarted, continued or plugged in again. "Void" trials did not begin, because a
busy machine let arming or the command fail. docs/safety.md explains the promises.

| fault | who notices | promised [ms] | trials | void | median [ms] | worst [ms] | late | thrust returned | kept |
|---|---|---|---|---|---|---|---|---|---|
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", required=True)
    parser.add_argument("--helpers", required=True)
    parser.add_argument("--ros", action="store_true", help="also planner, flight_link_node, master; needs a sourced workspace")
    parser.add_argument("--trials", type=int, default=100, help="for killing and stopping; a fifth of it for the others")
    parser.add_argument("--jobs", type=int, default=4)
    parser.add_argument("--only", action="append")
    parser.add_argument("--write")
    options = parser.parse_args()
    known = link_faults.ALL + (ros_faults.ALL if options.ros else [])
    kinds = [kind for kind in known if not options.only or kind.__name__ in options.only]
    rows = []
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        for kind in kinds:
            trials = options.trials if kind in MANY else max(1, options.trials // 5)
            jobs = 1 if kind in ALONE else min(options.jobs, trials)
            shares = [trials // jobs + (k < trials % jobs) for k in range(jobs)]
            batches = [pool.submit(run_batch, kind.__name__, options.programs, options.helpers, seed, share)
                       for seed, share in enumerate(shares)]
            rows.append(Row(kind, [result for batch in batches for result in batch.result()]))
            print(rows[-1].text(), flush=True)
            for error in rows[-1].errors[:3]:
                print("    " + error, flush=True)
    if options.write:
        with open(options.write, "w", encoding="utf-8") as file:
            file.write(HEAD + "".join(row.text() + "\n" for row in rows))
            for row in rows:
                file.writelines(f"\n{row.kind.name}: {error}\n" for error in row.errors[:3])
            file.write(f"\n{time.strftime('%Y-%m-%d')}, {platform.system()} {platform.release().split('-')[0]}, {os.cpu_count()} cores.\n")
    return 0 if all(row.good for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
