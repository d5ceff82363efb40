"""Runs launch/demo.launch on ports of its own, saves the rviz picture if wanted, and judges the run by its summary."""
import argparse
import contextlib
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
LONGEST_RUN = 900.0  # s; the scenario takes well under a minute, but plans as long as a busy machine needs


def free_port(kind):
    """A port that nobody listens on now."""
    with contextlib.closing(socket.socket(socket.AF_INET, kind)) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class HiddenScreen:
    """Xvfb with a window manager; rviz needs both to draw at full size."""

    SIZE = "1280x800x24"

    def __init__(self, log):
        read, write = os.pipe()
        self.processes = [subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", self.SIZE, "-nolisten", "tcp"],
                                           pass_fds=[write], stdout=log, stderr=log)]
        os.close(write)
        with os.fdopen(read) as pipe:
            number = pipe.readline().strip()
        if not number:
            raise RuntimeError("Xvfb did not start")
        self.environment = {"DISPLAY": f":{number}", "LIBGL_ALWAYS_SOFTWARE": "1"}
        self.processes.append(subprocess.Popen(["openbox"], env={**os.environ, **self.environment}, stdout=log, stderr=log))

    def save(self, path):
        """@return whether the vehicle is drawn; if not, no file is left. The screen is of one colour without rviz, rviz without a
        vehicle has 600, and with one 6000."""
        subprocess.run(["import", "-window", "root", str(path)], env={**os.environ, **self.environment}, check=True, timeout=30)
        colours = subprocess.run(["identify", "-format", "%k", str(path)], check=True, capture_output=True, text=True, timeout=30)
        if int(colours.stdout) > 2000:
            return True
        pathlib.Path(path).unlink()
        return False

    def close(self):
        for process in reversed(self.processes):
            process.terminate()


def launch_command(options, master_port):
    arguments = {
        "output_dir": options.output,
        "vehicle_file": options.vehicle,
        "seed": options.seed,
        "mount": options.mount,
        "kill_bridge": options.kill_bridge,
        "rviz": "true" if options.rviz == "true" or options.picture else "false",
        "rviz_respawn": "true" if options.picture else "false",  # it sometimes dies as it starts; nobody closes a hidden one
        "controller_port": free_port(socket.SOCK_STREAM),
        "motor_port": free_port(socket.SOCK_DGRAM),
        "lcm_url": f"udpm://239.255.76.67:{free_port(socket.SOCK_DGRAM)}?ttl=0",
    }
    return (["roslaunch", "-p", str(master_port), str(ROOT / "launch/demo.launch")] +
            [f"{name}:={value}" for name, value in arguments.items()])


def wait_and_picture(process, screen, options, marker):
    """Waits for the end; takes the picture when the scenario says that the vehicle rests in Q (or at the latest before)."""
    deadline = time.monotonic() + LONGEST_RUN
    taken = False
    while process.poll() is None:
        if time.monotonic() > deadline:
            print(f"demo: not finished after {LONGEST_RUN:.0f} s, giving up", file=sys.stderr)
            break
        if screen and not taken and marker.exists():
            taken = screen.save(options.picture)
        time.sleep(0.1)
    return taken


def stop(process):
    """roslaunch ends its nodes on SIGINT; whatever is left after that is killed."""
    for signal_number, patience in ((signal.SIGINT, 25), (signal.SIGTERM, 10), (signal.SIGKILL, 5)):
        if process.poll() is not None:
            return
        os.killpg(process.pid, signal_number)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(patience)


def verdict(output):
    """(exit code, line) from the scenario's summary; no summary is a failure."""
    path = output / "run_summary.json"
    try:
        summary = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        return 1, f"no summary of the run: {error}"
    if summary.get("ok") is True:
        return 0, "both switches happened"
    return 1, "FAILED: " + str(summary.get("reason") or "no reason given")


def clear(output):
    """What an earlier run left must not be taken for this run's result."""
    for name in ("run_summary.json", "run.h5", "report.html", "picture_now"):
        with contextlib.suppress(FileNotFoundError):
            (output / name).unlink()


def main():
    parser = argparse.ArgumentParser()
    for name in ("--output", "--vehicle", "--seed", "--mount", "--kill-bridge", "--rviz", "--picture"):
        parser.add_argument(name, required=True)
    options = parser.parse_args()
    output = pathlib.Path(options.output)
    clear(output)
    print("demo: flying F->Q and Q->F in simulation (half a minute) ...", file=sys.stderr)
    with open(output / "roslaunch.log", "w") as log:
        screen = HiddenScreen(log) if options.picture else None
        master_port = free_port(socket.SOCK_STREAM)
        environment = {**os.environ, "ROS_MASTER_URI": f"http://localhost:{master_port}",
                       **(screen.environment if screen else {})}
        process = subprocess.Popen(launch_command(options, master_port), env=environment, stdout=log, stderr=log,
                                   start_new_session=True)
        try:
            taken = wait_and_picture(process, screen, options, output / "picture_now")
        except KeyboardInterrupt:
            print("demo: cancelled", file=sys.stderr)
            return 130
        finally:
            stop(process)
            if screen:
                screen.close()
    return conclude(output, options, taken)


def conclude(output, options, taken):
    code, line = verdict(output)
    summary = output / "summary.txt"
    if summary.exists():
        print(summary.read_text())
    if options.picture:
        print(f"picture: {options.picture if taken else 'not taken: rviz has drawn nothing, or the run ended early; see roslaunch.log'}")
        code = code if taken else max(code, 1)
    report = output / "report.html"
    print(f"report:  {report if report.exists() else 'missing; see ' + str(output / 'roslaunch.log')}")
    print(f"logs:    {output / 'roslaunch.log'}, {output / 'log'}")
    print(f"demo: {line}")
    return code if report.exists() else max(code, 1)


if __name__ == "__main__":
    sys.exit(main())
