"""Runs every fault of link_faults.py and ros_faults.py many times and writes the table docs/fault_table.md.
usage: fault_table.py --programs FOLDER --helpers FOLDER [--ros] [--trials 100] [--jobs 8] [--only NAME] [--write FILE]"""
import argparse
import concurrent.futures
import multiprocessing
import os
import platform
import sys
import threading
import time

import link_faults
from link_bench import IDLE, NotBegun, Witness

ALONE = ("Flood", "CpuStarved")  # they are about the whole machine
SHARE = 25     # trials that one worker does with one set of programs
PATIENCE = 2   # attempts for each trial wanted


def kinds_of(with_ros):
    if not with_ros:
        return link_faults.ALL
    import ros_faults  # needs a sourced workspace
    return link_faults.ALL + ros_faults.ALL


def started(kind, programs, seed):
    """A fault with its programs; what does not start has not begun."""
    try:
        return kind(programs, seed)
    except (AssertionError, OSError) as error:
        raise NotBegun(str(error)) from error


def run_batch(name, programs, helpers, seed, trials, with_ros):
    """@return list of (moment, seconds to idle, largest output afterwards, error text), None for attempts that did not begin"""
    os.environ["SNAPWING_TEST_HELPERS"] = helpers
    kind = next(kind for kind in kinds_of(with_ros) if kind.__name__ == name)
    results, fault = [], None
    for attempt in range(PATIENCE * trials):
        if len(results) - results.count(None) == trials:
            break
        try:
            fault = fault or started(kind, programs, 1000 * seed + attempt)
            results.append((*fault.trial(), ""))
        except Exception as error:  # pylint: disable=broad-except
            begun = not isinstance(error, NotBegun)
            results.append((0.0, link_faults.NEVER, 9999, f"{type(error).__name__}: {error}") if begun else None)
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
        results = [result for result in results if result is not None] or [(0.0, link_faults.NEVER, 9999, "no trial began")]
        self.trials = len(results)
        times = sorted(result[1] for result in results)
        self.worst = times[-1]
        self.median = times[len(times) // 2]
        self.returned = sum(result[2] > IDLE and not result[3] for result in results)
        self.late = [result for result in results if result[1] > kind.promise]
        self.errors = [result[3] for result in results if result[3]]
        self.good = not (self.returned or self.late or self.errors)

    def text(self):
        start = "harm" if self.kind.breaks else "pulse's end"
        return (f"| {self.kind.name} | {self.kind.guard} | {1000 * self.kind.promise:.0f} from the {start} | {self.trials} | "
                f"{self.void} | {1000 * self.median:.0f} | {1000 * self.worst:.0f} | {len(self.late)} | {self.returned} | "
                f"{'yes' if self.good else 'NO'} |")


class Load:
    """The machine's load average, looked at every ten seconds."""

    def __init__(self):
        self.seen, self.begin = [], time.monotonic()
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self):
        while True:
            self.seen.append(os.getloadavg()[0])
            time.sleep(10)

    def text(self):
        seen = sorted(self.seen)
        return (f"load average {seen[0]:.1f} to {seen[-1]:.1f}, median {seen[len(seen) // 2]:.1f}, over "
                f"{(time.monotonic() - self.begin) / 60:.0f} minutes")


HEAD = """# Fault table of the radio link

Written by `test/link/processes/fault_table.py`, which runs the real programs (radio_bridge, link_console or flight_link_node with a
planner and a ROS master, standin_flight_controller) on one machine and does each harm at a random moment of a full-throttle pulse, with
the motors seen at its thrust. Times run from the harm to the motors' outputs at idle or off, as the stand-in flight controller puts
them out; for faults that need not break the pulse off, from the pulse's own end (0: not later than that). "Thrust returned" counts trials in which the
outputs rose above idle again for more than 2 ms, with the failed part restarted, continued or plugged in again. "Void" attempts did
not begin, because a busy machine let arming or the command fail; they were repeated. docs/safety.md explains the promises.

| fault | who notices | promised [ms] | trials | void | median [ms] | worst [ms] | late | thrust returned | kept |
|---|---|---|---|---|---|---|---|---|---|
"""


def explain_late(row, witness):
    """@return lines on late trials: did the machine stand still in them?"""
    for moment, seconds, _, error in row.late:
        if not error:
            stalls = [stop - start for start, stop in witness.stalls if start < moment + seconds and moment < stop]
            yield (f"{row.kind.name}: {1000 * seconds:.0f} ms; in this time the machine itself stood still for "
                   f"{1000 * sum(stalls):.0f} ms, as a witness of the highest real-time priority saw")


def run_all(kinds, options):
    """@return rows in the order of the kinds; those that are about the whole machine run last, by themselves"""
    results = {kind.__name__: [] for kind in kinds}
    context = multiprocessing.get_context("spawn")
    for alone in (False, True):
        with concurrent.futures.ProcessPoolExecutor(1 if alone else options.jobs, mp_context=context) as pool:
            tasks = {}
            for kind in kinds:
                if (kind.__name__ in ALONE) != alone:
                    continue
                for seed, first in enumerate(range(0, options.trials, SHARE)):
                    task = pool.submit(run_batch, kind.__name__, options.programs, options.helpers, seed,
                                       min(SHARE, options.trials - first), options.ros)
                    tasks[task] = kind
            for task in concurrent.futures.as_completed(tasks):
                kind = tasks[task]
                results[kind.__name__] += task.result()
                if sum(other == kind and not one.done() for one, other in tasks.items()) == 0:
                    row = Row(kind, results[kind.__name__])
                    print(row.text(), *row.errors[:3], sep="\n    ", flush=True)
    return [Row(kind, results[kind.__name__]) for kind in kinds]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", required=True)
    parser.add_argument("--helpers", required=True)
    parser.add_argument("--ros", action="store_true", help="also planner, flight_link_node, master; needs a sourced workspace")
    parser.add_argument("--trials", type=int, default=100, help="of each fault")
    parser.add_argument("--jobs", type=int, default=8)
    parser.add_argument("--only", action="append")
    parser.add_argument("--write")
    options = parser.parse_args()
    load = Load()
    with Witness() as witness:
        rows = run_all([kind for kind in kinds_of(options.ros) if not options.only or kind.__name__ in options.only], options)
    notes = [line for row in rows for line in (*row.errors[:3], *explain_late(row, witness))]
    foot = (f"\n{time.strftime('%Y-%m-%d')}, {platform.system()} {platform.release().split('-')[0]}, {os.cpu_count()} cores, "
            f"{options.jobs} benches at once: {load.text()}.\n")
    print(*notes, foot, sep="\n")
    if options.write:
        with open(options.write, "w", encoding="utf-8") as file:
            file.write(HEAD + "".join(row.text() + "\n" for row in rows))
            file.writelines(f"\n{line}\n" for line in notes)
            file.write(foot)
    return 0 if all(row.good for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
