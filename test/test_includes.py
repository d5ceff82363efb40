"""Refuses includes that go up or sideways in the house of floors, and ROS headers in the core."""
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
BELOW = {
    "common": [],
    "elasticity": ["common"],
    "mpm": ["common", "elasticity"],
    "statics": ["common", "elasticity", "mpm"],
    "design": ["common", "elasticity", "mpm", "statics"],
    "dynamics": ["common", "elasticity", "mpm", "statics"],
    "rom": ["common"],
    "planning": ["common", "rom"],
    "link": ["common"],
}
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.M)
ROS_HEADER = re.compile(r"^(ros|tf2|tf2_ros|actionlib|std_msgs|geometry_msgs|sensor_msgs|visualization_msgs)/")


def sources(root):
    """(floor, path) of every C++ file of the core below `root`."""
    for top in ("include/snapwing", "src"):
        for floor in BELOW:
            for path in sorted((root / top / floor).rglob("*")):
                if path.suffix in (".h", ".cpp"):
                    yield floor, path


def violations(root):
    """Every include that its floor may not have, as "file: header"."""
    wrong = []
    for floor, path in sources(root):
        for header in INCLUDE.findall(path.read_text()):
            parts = header.split("/")
            upward = parts[0] == "snapwing" and parts[1] not in BELOW[floor] + [floor]
            message = parts[0] == "snapwing" and len(parts) == 2
            if upward or message or ROS_HEADER.match(header):
                wrong.append(f"{path.relative_to(root)}: {header}")
    return wrong


class Includes(unittest.TestCase):
    def test_nothing_goes_up(self):
        self.assertEqual(violations(ROOT), [])

    def test_the_core_was_looked_at(self):
        self.assertGreater(len(list(sources(ROOT))), 10)

    def test_an_upward_include_is_found(self):
        import tempfile
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "src/rom").mkdir(parents=True)
            (root / "src/rom/a.cpp").write_text('#include "snapwing/statics/newton.h"\n#include <ros/ros.h>\n')
            self.assertEqual(len(violations(root)), 2)


if __name__ == "__main__":
    sys.exit(unittest.main())
