"""Runs the tests of a file at the same time, each in a process of its own. For tests that wait far more than they reckon."""
import concurrent.futures
import signal
import subprocess
import sys
import time
import unittest


def tests_of(module):
    """@return names "Class.test" of all tests of a module"""
    found = []

    def collect(suite):
        for each in suite:
            collect(each) if isinstance(each, unittest.TestSuite) else found.append(each.id().split(".", 1)[1])
    collect(unittest.defaultTestLoader.loadTestsFromModule(module))
    return found


def run(command, name):
    """@return (exit code, text) of one test; a line on its time comes first"""
    begin = time.monotonic()
    # It ends with this process, whatever ends that.
    done = subprocess.run(["setpriv", "--pdeathsig", "TERM", *command, name], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          stdin=subprocess.DEVNULL, text=True, check=False)
    verdict = "passed" if done.returncode == 0 else "FAILED"
    return done.returncode, f"{verdict} {name}, {time.monotonic() - begin:.1f} s\n{done.stdout if done.returncode else ''}"


def main(jobs, *folders):
    """Runs the tests of the program's own file; with names of tests after the folders, only these and in this process."""
    if len(sys.argv) > 1:
        signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended"))  # unittest then still cleans up
        unittest.main()
    names = tests_of(sys.modules["__main__"])
    if not names:
        sys.exit("no tests")
    command = [sys.executable, sys.argv[0], *folders]
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        failed = 0
        for task in concurrent.futures.as_completed([pool.submit(run, command, name) for name in names]):
            code, text = task.result()
            failed += code != 0
            print(text, end="", flush=True)
    print(f"{len(names) - failed} of {len(names)} passed")
    sys.exit(1 if failed else 0)
