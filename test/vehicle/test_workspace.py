"""scripts/lib/workspace.sh empties no build folder of another source folder, unless it is the tree's own copied one."""
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "lib" / "workspace.sh"


class Workspace(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.tree = pathlib.Path(folder.name) / "tree"
        (self.tree / "scripts/lib").mkdir(parents=True)
        shutil.copy(SCRIPT, self.tree / "scripts/lib")

    def drop(self, build):
        build.mkdir()
        (build / "CMakeCache.txt").write_text("CMAKE_HOME_DIRECTORY:INTERNAL=/elsewhere\n")
        command = f". '{self.tree}/scripts/lib/workspace.sh'; drop_foreign_build"
        return subprocess.run(["bash", "-c", command], env={"PATH": "/usr/bin:/bin", "SNAPWING_BUILD": str(build)},
                              capture_output=True, text=True, check=False)

    def test_another_trees_build_is_left_alone(self):
        build = self.tree.parent / "other"
        done = self.drop(build)
        self.assertEqual(done.returncode, 1)
        self.assertIn("SNAPWING_BUILD", done.stderr)
        self.assertTrue((build / "CMakeCache.txt").exists())

    def test_own_copied_build_is_made_anew(self):
        build = self.tree / "build"
        self.assertEqual(self.drop(build).returncode, 0)
        self.assertFalse(build.exists())


if __name__ == "__main__":
    unittest.main()
