"""Runs every fault of process_faults.py, link_faults.py and ros_faults.py many times and writes the table docs/fault_table.md.
usage: fault_table.py --programs FOLDER --helpers FOLDER [--ros] [--trials 100] [--jobs 8] [--busy 2] [--only NAME] [--results FILE]
[--hold] [--write FILE]"""
import argparse
import concurrent.futures
import ctypes
import json
import multiprocessing
import os
import platform
import signal
import sys
import threading
import time

import link_faults
import process_faults
from link_bench import IDLE, NotBegun, Witness, busy_loops, measure_firmly

ALONE = ("Flood", "CpuStarved")  # they are about the whole machine
SHARE = 10     # trials that one worker does with one set of programs
JUDGED_MEDIAN = 20  # trials; of fewer the median is too much of a chance, and the promise that all keep decides
PATIENCE = 2   # attempts for each trial wanted
PR_SET_PDEATHSIG = 1


def kinds_of(with_ros):
    kinds = process_faults.ALL + link_faults.ALL
    if not with_ros:
        return kinds
    import ros_faults  # needs a sourced workspace
    return kinds + ros_faults.ALL


def end_on_sigterm():
    """Whatever must be closed is closed on the way out."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))


def end_worker(*_):
    """Closes what is open; what cannot be closed (a pipe that somebody still reads) is killed with the whole group. Being told once is enough: a
    second time would break off the closing."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    last_resort = threading.Timer(5, os.killpg, (0, signal.SIGKILL))
    last_resort.daemon = True
    last_resort.start()
    sys.exit(128 + signal.SIGTERM)


def begin_worker(parent):
    """A worker ends, with all its programs, when it is told to or when its parent is gone."""
    os.setpgid(0, 0)
    signal.signal(signal.SIGTERM, end_worker)
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    if os.getppid() != parent:
        sys.exit(1)


def started(kind, programs, seed):
    """A fault with its programs; what does not start has not begun."""
    try:
        return kind(programs, seed)
    except (AssertionError, OSError) as error:
        raise NotBegun(str(error)) from error


def run_batch(name, programs, helpers, seed, trials, with_ros, in_hold):
    """@return list of attempts: fault, moment from which the promise counts, seconds to idle, largest output afterwards [us], whether a return of
    thrust kept the bound that docs/safety.md names, error, void; with an error the seconds are those that the attempt took"""
    os.environ["SNAPWING_TEST_HELPERS"] = helpers
    measure_firmly()
    link_faults.Fault.in_hold = in_hold
    kind = next(kind for kind in kinds_of(with_ros) if kind.__name__ == name)
    results, fault = [], None

    def note(moment=0.0, seconds=0.0, highest=0, error="", void=False):
        results.append({"fault": name, "moment": moment, "seconds": seconds, "highest": highest, "error": error, "void": void,
                        "bounded": fault is not None and fault.bounded})

    try:
        for attempt in range(PATIENCE * trials):
            if sum(not result["void"] for result in results) == trials:
                break
            begin = time.monotonic()
            try:
                fault = fault or started(kind, programs, 1000 * seed + attempt)
                note(*fault.trial())
            except Exception as error:  # pylint: disable=broad-except
                note(begin, time.monotonic() - begin, error=f"{type(error).__name__}: {error}", void=isinstance(error, NotBegun))
                if fault is not None:
                    fault.close()
                fault = None
    except SystemExit as stop:
        if fault is not None:
            fault.close()
        os._exit(stop.code)  # else the pool would hand it the next task
    if fault is not None:
        fault.close()
    return results


class Row:
    """Results of one fault: dictionaries as run_batch makes them, with the stalls that the witness saw in `stall`."""

    def __init__(self, kind, results):
        self.kind = kind
        self.void = sum(result["void"] for result in results)
        results = [result for result in results if not result["void"]]
        self.trials = len(results)
        times = sorted(link_faults.NEVER if result["error"] else result["seconds"] for result in results) or [link_faults.NEVER]
        at = lambda share: times[min(len(times) - 1, int(share * len(times)))]
        self.median, self.most, self.worst = at(0.5), at(0.99), times[-1]
        self.returned = [result for result in results if result["highest"] > IDLE and not result["error"]]
        self.bounded = sum(result.get("bounded", False) for result in self.returned)
        unbounded = len(self.returned) - self.bounded or self.bounded > max(2, kind.seldom * self.trials)
        self.late = [result for result in results if result["seconds"] > kind.promise and not result["error"]]
        self.excused = sum(result["seconds"] - result["stall"] <= kind.promise for result in self.late)
        self.errors = [f"{result['error']}; longest stall that the witness saw in this attempt: {1000 * result['longest']:.0f} ms"
                       for result in results if result["error"]]
        slow = kind.typical is not None and self.trials >= JUDGED_MEDIAN and self.median > kind.typical
        self.good = not (slow or unbounded or len(self.late) > self.excused or self.errors or not results)

    def text(self):
        start = "fault" if self.kind.breaks else "pulse's end"
        typical = f"{1000 * self.kind.typical:.0f}, " if self.kind.typical else ""
        return (f"| {self.kind.name} | {self.kind.guard} | {typical}{1000 * self.kind.promise:.0f} from the {start} | {self.trials} | "
                f"{self.void} | {1000 * self.median:.0f} | {1000 * self.most:.0f} | {1000 * self.worst:.0f} | "
                f"{len(self.late)} ({self.excused}) | {len(self.returned)} ({self.bounded}) | {'yes' if self.good else 'NO'} |")


class Results:
    """A file with a line of JSON for each attempt; what is in it is not run again."""

    def __init__(self, path):
        self.path = path
        self.all = []
        if path and os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                self.all = [json.loads(line) for line in file if line.endswith("}\n")]

    def of(self, kind):
        return [result for result in self.all if result["fault"] == kind.__name__]

    def add(self, results):
        self.all += results
        if self.path:
            with open(self.path, "a", encoding="utf-8") as file:
                file.writelines(json.dumps(result) + "\n" for result in results)


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


HEAD = """# Fault table of the radio link{title}

Written by `test/link/processes/fault_table.py{option}`, which runs the real programs on one machine: radio_bridge with its guardian, link_console or
flight_link_node with a planner and a ROS master, and standin_flight_controller. It injects each fault at a random moment of a
{thrust}, once the motors are seen at its thrust. docs/safety.md explains the promises.

* Times run from the fault to the motors' outputs at idle or off, as the stand-in flight controller puts them out (ramp of 21 ms included). For faults
  that need not end the pulse they run from the pulse's own end (0: not later than that).
* "Promised" is a time for the median, where two are given (judged from 20 trials on), and a time for all trials, except while the machine itself stood
  still.
* "Late" counts the trials beyond the second time. In brackets: those that were late only because a witness process of the highest real-time priority was
  itself delayed.
* "Thrust returned" counts trials in which the outputs rose above idle again for more than 2 ms, with the failed part restarted, continued or plugged in
  again. In brackets: those within the bound of docs/safety.md, hazard 2, for a line that cannot be flushed (one frame: half of the thrust for 40 ms).
* "Void" attempts did not begin, because a busy machine let arming or the command fail; they were repeated.

| fault | who notices | promised [ms] | trials | void | median [ms] | 99 % [ms] | worst [ms] | late (excused) | thrust returned | kept |
|---|---|---|---|---|---|---|---|---|---|---|
"""
IN_PULSE = {"title": "", "option": "", "thrust": "full-throttle pulse"}
IN_HOLD = {"title": ", in the hold", "option": " --hold", "thrust": "hold of 0.3 throttle behind 0.1 s of full throttle"}


def notes_on(row):
    """@return lines on what was not kept, and on late trials: did the machine stand still in them?"""
    for result in row.late:
        yield (f"{row.kind.name}: {1000 * result['seconds']:.0f} ms; in this time the machine itself stood still for "
               f"{1000 * result['stall']:.0f} ms, as a witness of the highest real-time priority saw")
    bounded = [result["highest"] for result in row.returned if result.get("bounded")]
    if bounded:
        yield f"{row.kind.name}: thrust returned within the bound of docs/safety.md in {len(bounded)} of {row.trials}, up to {max(bounded)} us"
    for result in row.returned:
        if not result.get("bounded"):
            yield f"{row.kind.name}: thrust returned, up to {result['highest']} us"
    yield from row.errors[:3]


class Pool(concurrent.futures.ProcessPoolExecutor):
    """Left by an exception it does not wait for what is still to do, but ends the workers."""

    def __exit__(self, kind, *rest):
        if kind is None:
            return super().__exit__(kind, *rest)
        workers = list((self._processes or {}).values())
        for worker in workers:
            worker.terminate()
        self.shutdown(wait=False, cancel_futures=True)
        for worker in workers:
            worker.join(10)
        return False


def run_all(kinds, options, results, witness):
    """What is missing. Faults that are about the whole machine run last, by themselves."""
    context = multiprocessing.get_context("spawn")
    for alone in (False, True):
        with Pool(1 if alone else options.jobs, mp_context=context, initializer=begin_worker, initargs=(os.getpid(),)) as pool:
            tasks = {}
            for seed in range(0, options.trials, SHARE):  # a share of each fault first: what is stopped early has some of all
                for kind in kinds:
                    done = sum(not result["void"] for result in results.of(kind))
                    wanted = min(SHARE, options.trials - seed, options.trials - done - seed)
                    if (kind.__name__ in ALONE) == alone and wanted > 0:
                        task = pool.submit(run_batch, kind.__name__, options.programs, options.helpers, len(results.all) + seed,
                                           wanted, options.ros, options.hold)
                        tasks[task] = kind
            for task in concurrent.futures.as_completed(tasks):
                batch = task.result()
                for result in batch:
                    result["stall"], result["longest"] = witness.stood_still(result["moment"], result["moment"] + result["seconds"])
                results.add(batch)
                row = Row(tasks[task], results.of(tasks[task]))
                print(row.text(), *row.errors[:3], sep="\n    ", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", required=True)
    parser.add_argument("--helpers", required=True)
    parser.add_argument("--ros", action="store_true", help="also planner, flight_link_node, master; needs a sourced workspace")
    parser.add_argument("--trials", type=int, default=100, help="of each fault")
    parser.add_argument("--jobs", type=int, default=8)
    parser.add_argument("--only", action="append")
    parser.add_argument("--results", help="file that keeps every attempt; a run that was stopped goes on from it")
    parser.add_argument("--busy", type=int, default=0, help="busy processes at normal priority on each core meanwhile")
    parser.add_argument("--hold", action="store_true", help="do the harm in the hold behind a short pulse")
    parser.add_argument("--table-only", action="store_true", help="run nothing, write the table of what --results holds")
    parser.add_argument("--write")
    options = parser.parse_args()
    end_on_sigterm()
    load = Load()
    kinds = [kind for kind in kinds_of(options.ros) if not options.only or kind.__name__ in options.only]
    results = Results(options.results)
    if not options.table_only:
        hogs = busy_loops(options.busy * os.cpu_count())
        try:
            with Witness() as witness:
                run_all(kinds, options, results, witness)
        finally:
            for hog in hogs:
                hog.kill()
                hog.wait()
    rows = [row for row in (Row(kind, results.of(kind)) for kind in kinds) if row.trials + row.void > 0]
    notes = [line for row in rows for line in notes_on(row)]
    foot = (f"\n{time.strftime('%Y-%m-%d')}, {platform.system()} {platform.release().split('-')[0]}, {os.cpu_count()} cores, "
            f"{sum(row.trials for row in rows)} trials.")
    foot += "\n" if options.table_only else f" {options.jobs} benches at once, {options.busy} busy processes a core: {load.text()}.\n"
    print(*notes, foot, sep="\n")
    if options.write:
        with open(options.write, "w", encoding="utf-8") as file:
            file.write(HEAD.format(**(IN_HOLD if options.hold else IN_PULSE)) + "".join(row.text() + "\n" for row in rows))
            file.writelines(f"\n{line}\n" for line in notes)
            file.write(foot)
    return 0 if all(row.good for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
