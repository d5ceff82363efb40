"""demo.launch as a stranger starts it: a vehicle of one's own by a relative path, results in a folder with a blank in its
name. It flies, ends roslaunch by itself and without a line in red; a wrong vehicle ends roslaunch with one message.
usage: demo_elsewhere.py SNAPWING_PROGRAM"""
import contextlib
import json
import os
import pathlib
import socket
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def free_port(kind):
    with contextlib.closing(socket.socket(socket.AF_INET, kind)) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def roslaunch(folder, **arguments):
    """(exit code, output) of demo.launch with a master of its own, started in `folder`."""
    arguments = dict(arguments, controller_port=free_port(socket.SOCK_STREAM), motor_port=free_port(socket.SOCK_DGRAM),
                     lcm_url=f"udpm://239.255.76.67:{free_port(socket.SOCK_DGRAM)}?ttl=0")
    master = free_port(socket.SOCK_STREAM)
    environment = dict(os.environ, ROS_MASTER_URI=f"http://localhost:{master}", ROS_HOME=str(folder / "ros home"),
                       PWD=str(folder))
    done = subprocess.run(["roslaunch", "-p", str(master), str(ROOT / "launch" / "demo.launch")] +
                          [f"{name}:={value}" for name, value in arguments.items()], cwd=folder, env=environment,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=240, check=False)
    return done.returncode, done.stdout


def require(condition, what, output):
    if not condition:
        sys.exit(f"{output}\n---\nwrong: {what}")


def check_flight(folder, program):
    subprocess.run([program, "vehicle", "new", "own vehicle/vehicle.yaml", "--without", "wing,boom"], cwd=folder, check=True)
    code, output = roslaunch(folder, vehicle_file="own vehicle/vehicle.yaml", output_dir="Demo Folder")
    results = folder / "Demo Folder"
    require(code == 0, f"exit code {code}", output)
    require((results / "run_summary.json").exists(), "no summary in the folder of the caller", output)
    summary = json.loads((results / "run_summary.json").read_text())
    require(summary["ok"] is True, f"the demo failed: {summary.get('reason')}", output)
    for name in ("link.key", "run.h5", "report.html"):
        require((results / name).exists(), f"no {name}", output)
    for red in ("has died", "Traceback", "exit code 127"):
        require(red not in output, f"'{red}' after a good run", output)


def check_wrong_vehicles(folder):
    code, output = roslaunch(folder, vehicle_file="nowhere.yaml")
    require(code != 0, "exit code 0 without a vehicle", output)
    require("nowhere.yaml" in output and str(folder) in output, "the message names neither file nor folder", output)
    text = (ROOT / "config" / "vehicles" / "arris_x220.yaml").read_text()
    (folder / "copied.yaml").write_text(text)  # its ../../data is elsewhere now
    code, other = roslaunch(folder, vehicle_file="copied.yaml")
    require(code != 0, "exit code 0 with a vehicle whose tables are not there", other)
    require("arm.table_file" in other, "the message does not name the key", other)
    require("Traceback (most" not in output + other, "a traceback", output + other)


def main():
    with tempfile.TemporaryDirectory(prefix="some where ") as name:
        folder = pathlib.Path(name).resolve()
        check_wrong_vehicles(folder)
        check_flight(folder, sys.argv[1])
    print("flew from a relative vehicle file into a folder with a blank; wrong vehicles were refused")
    return 0


if __name__ == "__main__":
    sys.exit(main())
