"""Runs one rostest with free ports and a folder of its own: run_rostest.py FILE.test FOLDER

With --text rostest shows what its tests say, but ends with 0 whatever they found: the verdict is read from what they say."""
import contextlib
import os
import socket
import subprocess
import sys
import xml.etree.ElementTree as ElementTree


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
    command = ["rostest", "--text", test] + [f"{name}:={value}" for name, value in arguments.items()]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace") as child:
        lines = []
        for line in child.stdout:
            print(line, end="", flush=True)
            lines.append(line)
    passed = sum("* RESULT: SUCCESS" in line for line in lines)
    wanted = len(ElementTree.parse(test).getroot().findall(".//test"))
    if child.returncode == 0 and passed == wanted and wanted > 0:
        return 0
    print(f"{os.path.basename(test)}: {passed} of {wanted} tests passed, rostest ended with {child.returncode}")
    return 1


if __name__ == "__main__":
    sys.exit(main())
