"""A run that is killed leaves the previous output as it was. usage: test_killed.py SNAPWING"""
import os
import signal
import subprocess
import sys
import tempfile
import time

SCENE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "config", "scenes", "snap_beam.yaml")
PREVIOUS = b"what an earlier run wrote\n"


def main():
    tool = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        csv, summary = os.path.join(folder, "curve.csv"), os.path.join(folder, "summary.json")
        for path in (csv, summary):
            with open(path, "wb") as file:
                file.write(PREVIOUS)
        command = [tool, "curve", SCENE, "--steps", "20000", "-o", csv, "--summary", summary]
        for delay in (0.05, 0.4, 1.5):
            run = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(delay)
            assert run.poll() is None, "the run ended before it could be killed: exit code %s" % run.returncode
            run.send_signal(signal.SIGKILL)
            assert run.wait(30) == -signal.SIGKILL
            for path in (csv, summary):
                with open(path, "rb") as file:
                    assert file.read() == PREVIOUS, path + " was touched after %g s" % delay
        # The same command does replace them when it is let run to its end.
        subprocess.run(command[:3] + ["--steps", "4"] + command[5:], check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL, timeout=120)
        with open(csv, "rb") as file:
            assert file.read().startswith(b"displacement_m,"), "the whole run must write its curve"
        assert not [name for name in os.listdir(folder) if name not in ("curve.csv", "summary.json")], os.listdir(folder)


if __name__ == "__main__":
    main()
