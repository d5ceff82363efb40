"""Refuses includes that go up or sideways in the house of layers, and ROS headers in the core."""
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
# What each layer stands on directly; it may include these and all that they stand on.
STANDS_ON = {
    "common": [],
    "vehicle": ["common"],
    "elasticity": ["common"],
    "mpm": ["elasticity"],
    "solver": ["mpm"],
    "scene": ["solver", "vehicle"],
    "statics": ["scene"],
    "motion": ["scene"],
    "design": ["statics"],
    "rom": ["vehicle"],
    "planning": ["rom"],
    "validation": ["motion", "statics", "planning"],
    "pipeline": ["design", "validation"],
    "link": ["common"],
    "standin": ["vehicle", "link"],
    "ros": ["pipeline", "link", "standin"],
    "tools": ["pipeline", "link"],
}
# Folders of the layer `design`, each with those that it may include.
FOLDERS = {"design/optim": [], "design/arm": ["design/optim"], "design/wing": ["design/optim", "design/arm"]}
# Programs may read the vehicle file, whatever their layer's library knows.
PROGRAMS = {"link": ["vehicle"]}
# Public headers that no other layer includes: a way in for those who use the library.
WAYS_IN = {"elasticity/saint_venant_kirchhoff.h", "design/arm/arm_topology.h", "design/wing/wing_parts.h"}
FEWEST_FILES = 300  # of the layers; fewer means that the folders have moved and nothing is looked at
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.M)
ROS_HEADER = re.compile(r"^(ros|tf2|tf2_ros|actionlib|std_msgs|geometry_msgs|sensor_msgs|visualization_msgs)/")


def below(layer):
    found = {layer}
    for lower in STANDS_ON[layer]:
        found |= below(lower)
    return found


BELOW = {layer: below(layer) for layer in STANDS_ON}


def sources(root):
    """(layer, path) of every C++ file below `root`."""
    for top in ("include/snapwing", "src"):
        for layer in STANDS_ON:
            for path in sorted((root / top / layer).rglob("*")):
                if path.suffix in (".h", ".cpp"):
                    yield layer, path


def unknown_folders(root):
    """Folders beside the layers that the rules do not know."""
    return sorted(str(path.relative_to(root)) for top in ("include/snapwing", "src") if (root / top).is_dir()
                  for path in (root / top).iterdir() if path.is_dir() and path.name not in STANDS_ON)


def forbidden(layer, path, header):
    parts = header.split("/")
    if parts[0] != "snapwing":
        return layer != "ros" and bool(ROS_HEADER.match(header))
    if len(parts) == 2:
        return layer != "ros"  # a message
    allowed = BELOW[layer] | set(PROGRAMS.get(layer, []) if "programs" in path.parts else [])
    if parts[1] not in allowed:
        return True
    own = f"{layer}/{path.parent.name}"
    folder = "/".join(parts[1:3])
    return own in FOLDERS and folder in FOLDERS and folder not in FOLDERS[own] + [own]


def violations(root):
    """Every include that its layer may not have, as "file: header"."""
    return [f"{path.relative_to(root)}: {header}" for layer, path in sources(root)
            for header in INCLUDE.findall(path.read_text()) if forbidden(layer, path, header)]


def kept_inside(root):
    """Public headers that only their own layer needs: they belong in `src`."""
    headers = {str(path.relative_to(root / "include/snapwing")): path for path in (root / "include/snapwing").rglob("*.h")}
    needed = {name for name in WAYS_IN if name in headers}
    for layer, path in [*sources(root), *(("", path) for path in (root / "examples").rglob("*.cpp"))]:
        needed |= {header[len("snapwing/"):] for header in INCLUDE.findall(path.read_text())
                   if header.startswith("snapwing/") and header.split("/")[1] != layer}
    todo = [name for name in needed if name in headers]
    while todo:
        for header in INCLUDE.findall(headers[todo.pop()].read_text()):
            name = header[len("snapwing/"):]
            if header.startswith("snapwing/") and name in headers and name not in needed:
                needed.add(name)
                todo.append(name)
    return sorted(set(headers) - needed)


class Includes(unittest.TestCase):
    def test_nothing_goes_up(self):
        self.assertEqual(violations(ROOT), [])

    def test_every_folder_is_a_floor(self):
        self.assertEqual(unknown_folders(ROOT), [])

    def test_what_only_its_layer_needs_is_not_public(self):
        self.assertEqual(kept_inside(ROOT), [])

    def test_the_floors_were_looked_at(self):
        files = list(sources(ROOT))
        self.assertGreater(len(files), FEWEST_FILES)
        built = {layer for layer, _ in files}
        self.assertEqual(set(STANDS_ON) - built - {"motion", "validation"}, set())

    def test_an_upward_include_is_found(self):
        import tempfile
        wrong = {"src/rom/a.cpp": '#include "snapwing/solver/newton.h"\n#include <ros/ros.h>\n',
                 "src/tools/b.cpp": '#include "snapwing/ros/params.h"\n',
                 "src/ros/c.cpp": '#include "snapwing/tools/numbers.h"\n#include <ros/ros.h>\n',
                 "src/design/arm/d.cpp": '#include "snapwing/design/wing/wing_parts.h"\n',
                 "src/link/e.cpp": '#include "snapwing/vehicle/vehicle.h"\n',
                 "src/link/programs/f.cpp": '#include "snapwing/vehicle/vehicle.h"\n',
                 "src/engine/g.cpp": ""}
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, text in wrong.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            self.assertEqual([line.split(":")[0] for line in violations(root)],
                             ["src/design/arm/d.cpp", "src/rom/a.cpp", "src/rom/a.cpp", "src/link/e.cpp",
                              "src/ros/c.cpp", "src/tools/b.cpp"])
            self.assertEqual(unknown_folders(root), ["src/engine"])
            for name in ("a.h", "b.h"):
                (root / "include/snapwing/rom").mkdir(parents=True, exist_ok=True)
                (root / "include/snapwing/rom" / name).write_text("")
            (root / "src/planning").mkdir()
            (root / "src/planning/h.cpp").write_text('#include "snapwing/rom/a.h"\n')
            (root / "src/rom/i.cpp").write_text('#include "snapwing/rom/b.h"\n')
            self.assertEqual(kept_inside(root), ["rom/b.h"])


if __name__ == "__main__":
    sys.exit(unittest.main())
