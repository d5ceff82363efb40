"""Runs one rostest with free ports and a folder of its own: run_rostest.py FILE.test FOLDER"""
import contextlib
import os
import socket
import subprocess
import sys


def free_port(kind):
    with contextlib.closing(socket.socket(socket.AF_INET, kind)) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def main():
    test, folder = sys.argv[1:3]
    os.makedirs(folder, exist_ok=True)
    arguments = {
        "controller_port": free_port(socket.SOCK_STREAM),
        "motor_port": free_port(socket.SOCK_DGRAM),
        "lcm_url": f"udpm://239.255.76.67:{free_port(socket.SOCK_DGRAM)}?ttl=0",
        "output_dir": folder,
    }
    environment = dict(os.environ, ROS_HOME=folder, PYTHONDONTWRITEBYTECODE="1")
    return subprocess.call(["rostest", "--text", test] + [f"{name}:={value}" for name, value in arguments.items()],
                           env=environment)


if __name__ == "__main__":
    sys.exit(main())
