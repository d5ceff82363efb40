"""Files of the Python tools: the same rules as those of the snapwing program."""
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import threading
import unittest


from snapwing_tools.errors import InputError
from snapwing_tools.output_file import OutputFiles, require_folder, require_writable, write_file
from snapwing_tools.run_file import write_run
from synthetic_run import make_buffer

ROOT = pathlib.Path(__file__).resolve().parents[2]


class OutputFile(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def names(self):
        return sorted(path.name for path in self.folder.iterdir())

    def test_links_are_followed_and_modes_kept(self):
        real, link = self.folder / "real", self.folder / "link"
        real.write_text("old")
        real.chmod(0o640)
        link.symlink_to("real")
        write_file(link, "new")
        self.assertTrue(link.is_symlink())
        self.assertEqual((real.read_text(), real.stat().st_mode & 0o777), ("new", 0o640))
        self.assertEqual(self.names(), ["link", "real"])

    def test_pipes_and_devices_are_written_through(self):
        pipe, got = self.folder / "pipe", []
        os.mkfifo(pipe)
        reader = threading.Thread(target=lambda: got.append(pipe.read_bytes()))
        reader.start()
        write_file(pipe, b"through")
        reader.join(30)
        write_file("/dev/null", "away")
        self.assertEqual(got, [b"through"])
        self.assertTrue(pipe.is_fifo() and pathlib.Path("/dev/null").is_char_device())
        with self.assertRaisesRegex(InputError, "/dev/full: No space"):
            write_file("/dev/full", "x")

    def test_what_does_not_fit_leaves_the_old_file(self):
        for name, write in (("a", lambda path: write_file(path, "x" * 10000)), ("r.h5", lambda path: write_run(path, make_buffer().to_run("closed")))):
            path = self.folder / name
            path.write_text("old")
            before = resource.getrlimit(resource.RLIMIT_FSIZE)
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, before[1]))
            try:
                with self.assertRaisesRegex(InputError, "cannot write {}: File too large".format(path)):
                    write(path)
            finally:
                resource.setrlimit(resource.RLIMIT_FSIZE, before)
            self.assertEqual(path.read_text(), "old")
        self.assertEqual(self.names(), ["a", "r.h5"])

    def test_no_output_is_an_input_or_another_output(self):
        scene = self.folder / "scene"
        scene.write_text("x")
        (self.folder / "soft").symlink_to("scene")
        os.link(scene, self.folder / "hard")
        files = OutputFiles([scene])
        for name in ("scene", "soft", "hard", "./scene"):
            with self.assertRaisesRegex(InputError, "--output would overwrite an input"):
                files.writes(os.path.join(self.folder, name), "--output")
        files.writes(self.folder / "new", "--output")
        with self.assertRaisesRegex(InputError, "--table and --output are one file"):
            files.writes(os.path.join(self.folder, "./new"), "--table")
        files.writes("/dev/null", "--a")
        files.writes("/dev/null", "--b")

    def test_places_are_looked_at_before(self):
        with self.assertRaisesRegex(InputError, "its folder does not exist"):
            require_writable(self.folder / "no" / "x")
        with self.assertRaisesRegex(InputError, "is a folder"):
            require_writable(self.folder)
        (self.folder / "file").write_text("")
        with self.assertRaisesRegex(InputError, "is not a folder"):
            require_folder(self.folder / "file" / "x")
        require_folder(self.folder / "new" / "deeper")
        self.assertEqual(self.names(), ["file"])


class Programs(OutputFile):
    """The scripts themselves."""

    def run_script(self, name, *words, **options):
        return subprocess.run([sys.executable, str(ROOT / "scripts" / name), *map(str, words)], stderr=subprocess.PIPE,
                              stdout=options.pop("stdout", subprocess.PIPE), cwd=self.folder, timeout=120, **options)

    def test_a_report_does_not_replace_its_run(self):
        run = self.folder / "run.h5"
        write_run(run, make_buffer().to_run("closed"))
        before = run.read_bytes()
        done = self.run_script("make_report", run, "-o", run)
        self.assertEqual((done.returncode, run.read_bytes()), (2, before), done.stderr)
        self.assertIn(b"would overwrite an input", done.stderr)
        done = self.run_script("make_report", run, "-o", "no/such/r.html")
        self.assertEqual(done.returncode, 2)
        self.assertIn(b"its folder does not exist", done.stderr)

    def test_a_report_is_there_though_nobody_reads_what_is_printed(self):
        write_run(self.folder / "run.h5", make_buffer().to_run("closed"))
        with open("/dev/full", "wb") as full:
            done = self.run_script("make_report", "run.h5", "-o", "r.html", stdout=full)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn(b"standard output cannot be written", done.stderr)
        self.assertIn("</html>", (self.folder / "r.html").read_text())

    def test_pictures_do_not_replace_what_they_show(self):
        (self.folder / "c.csv").write_text("travel_m,force_N,stable\n0,0,1\n0.001,1,1\n0.002,0,1\n")
        (self.folder / "s.json").write_text(json.dumps({"rung": "planar"}))
        for picture in ("c.csv", "no/such/p.png"):
            self.assertEqual(self.run_script("plot_curve", "c.csv", "s.json", picture).returncode, 2)
        self.assertTrue((self.folder / "c.csv").read_text().startswith("travel_m"))
        done = self.run_script("plot_curve", "c.csv", "s.json", "p.png")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.folder / "p.png").read_bytes().startswith(b"\x89PNG"))
        self.assertEqual(self.names(), ["c.csv", "p.png", "s.json"])


if __name__ == "__main__":
    unittest.main()
