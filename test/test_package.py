"""package.xml names the system's libraries by keys that rosdep knows, and the scripts install the same."""
import pathlib
import sys
import unittest
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parent.parent


def lines(name):
    text = (ROOT / "scripts/lib" / name).read_text()
    return [line.split("#")[0].strip() for line in text.splitlines() if line.split("#")[0].strip()]


def keys():
    return dict(line.split(": ") for line in lines("rosdep_keys.txt"))


def depends():
    tags = ("depend", "build_depend", "exec_depend", "test_depend")
    return {element.text for element in xml.etree.ElementTree.parse(ROOT / "package.xml").getroot() if element.tag in tags}


class Package(unittest.TestCase):
    def test_every_key_is_a_dependency(self):
        self.assertEqual(sorted(set(keys()) - depends()), [])

    def test_what_is_no_ros_package_has_a_key(self):
        cmake = (ROOT / "cmake/SnapwingMessages.cmake").read_text() + " message_runtime roslaunch rospy rviz tf2_tools rostest"
        self.assertEqual(sorted(d for d in depends() - set(keys()) if d not in cmake.replace("(", " ").replace(")", " ").split()), [])

    def test_the_scripts_install_what_a_key_stands_for(self):
        installed = " ".join(lines("packages.txt")).split()
        self.assertEqual(sorted(set(keys().values()) - set(installed)), [])


if __name__ == "__main__":
    sys.exit(unittest.main())
