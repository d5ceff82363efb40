"""House rules that a machine can check: formatting, file sizes, catkin_lint, no machine paths, parseable shipped files."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
MACHINE_PATH = re.compile(r"/(?:home|root|work|Users)/[\w.-]+")
TEXT = {".h", ".cpp", ".py", ".md", ".yaml", ".xml", ".launch", ".txt", ".cmake", ".msg", ".srv", ".action", ".lcm",
        ".rst", ".rviz", ".test", ".sh", ""}


def tracked():
    """Files that git tracks; every file that is no build output where there is no git."""
    listed = subprocess.run(["git", "-C", str(ROOT), "ls-files", "-z"], capture_output=True, text=True)
    if listed.returncode:
        return [p for p in ROOT.rglob("*") if p.is_file() and "build" not in p.relative_to(ROOT).parts[0]]
    return [ROOT / name for name in listed.stdout.split("\0") if name and (ROOT / name).is_file()]


def lines(path):
    return path.read_text().count("\n")


class Style(unittest.TestCase):
    def setUp(self):
        self.files = tracked()
        self.cpp = [p for p in self.files if p.suffix in (".h", ".cpp")]

    def test_clang_format(self):
        done = subprocess.run(["clang-format", "--dry-run", "-Werror", "--style=file"] + [str(p) for p in self.cpp],
                              cwd=ROOT, capture_output=True, text=True)
        wrong = sorted({line.split(":")[0] for line in done.stderr.splitlines() if "error:" in line})
        self.assertEqual(wrong, [], "run clang-format -i on these")

    def test_sizes(self):
        limits = {".h": 250, ".cpp": 500, ".py": 500}
        long = [f"{p.relative_to(ROOT)}: {lines(p)} lines" for p in self.files
                if p.suffix in limits and lines(p) > limits[p.suffix]]
        self.assertEqual(long, [])

    def test_no_machine_paths(self):
        found = []
        for path in self.files:
            if path.suffix in TEXT and path != pathlib.Path(__file__).resolve():
                found += [f"{path.relative_to(ROOT)}: {m}" for m in MACHINE_PATH.findall(path.read_text(errors="replace"))]
        self.assertEqual(found, [])

    def test_python_is_debians(self):
        """Another python3 on PATH has neither h5py nor rospy."""
        wrong = []
        for path in self.files:
            with open(path, "rb") as stream:
                first = stream.readline()
            if first.startswith(b"#!") and b"python" in first and first.strip() != b"#!/usr/bin/python3":
                wrong.append(str(path.relative_to(ROOT)))
        self.assertEqual(wrong, [])

    def test_catkin_lint(self):
        """Of the tracked files alone: build folders beside them would be linted too."""
        # Targets are installed through a list that catkin_lint cannot follow; test_install.py installs for real.
        ignored = ["unknown_package", "uninstalled_script", "uninstalled_target", "uninstalled_include_path"]
        with tempfile.TemporaryDirectory() as folder:
            for path in self.files:
                copy = pathlib.Path(folder) / path.relative_to(ROOT)
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(path, copy)
            done = subprocess.run(["/usr/bin/catkin_lint", "--offline", "-q", "--strict"] +
                                  [word for name in ignored for word in ("--ignore", name)] + ["."],
                                  cwd=folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    sys.exit(unittest.main())
