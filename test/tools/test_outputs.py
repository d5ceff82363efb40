"""Every file that a command writes: whole or not at all, never in place of an input, before anything is printed."""
import json
import fcntl
import os
import resource
import shutil
import signal
import subprocess
import threading
import time
import unittest

from command import BEAM, COARSE, PREDICT, PROGRAM, ROOT, VEHICLE, Case


def limited(size):
    """Stands for a full disk: no file may grow beyond `size` bytes."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


class Inputs(Case):
    def test_no_command_overwrites_what_it_reads(self):
        scene = self.file("scene.yaml", BEAM)
        vehicle = self.file("vehicle.yaml", VEHICLE.read_text().replace("../../data", str(ROOT / "data")))
        table = shutil.copy(ROOT / "data" / "tables" / "arris_x220_planar.h5", self.folder / "t.h5")
        os.link(scene, self.folder / "hard.yaml")
        os.symlink("scene.yaml", self.folder / "soft.yaml")
        before = {path: path.read_bytes() for path in (scene, vehicle)}
        for name in ("scene.yaml", "hard.yaml", "soft.yaml", "./scene.yaml"):
            for option in ("--summary", "--csv", "--checkpoint"):
                self.assertIn("would overwrite the input", self.refusal("curve", "scene.yaml", *COARSE, "--steps", "14", option, name))
        for option in ("--json", "--csv"):
            self.assertIn("would overwrite the vehicle file", self.refusal("predict", vehicle, *PREDICT[2:], option, vehicle))
            self.assertIn("would overwrite the force table",
                          self.refusal("predict", vehicle, *PREDICT[2:], "--table", table, option, table))
        for option in ("--json", "--map"):
            self.assertIn("would overwrite", self.refusal("plan", vehicle, "--from", "F", option, vehicle))
        for path, content in before.items():
            self.assertEqual(path.read_bytes(), content)

    def test_named_files_and_designs_are_inputs_too(self):
        density = shutil.copy(ROOT / "data" / "arms" / "arris_x220_study.csv", self.folder / "density.csv")
        text = (ROOT / "config" / "scenes" / "arm_planar.yaml").read_text()
        start = text.index("file: ") + len("file: ")
        scene = self.file("arm.yaml", text[:start] + "density.csv" + text[text.index(".csv", start) + 4:])
        self.assertIn("would overwrite a file that the input names", self.refusal("curve", scene, "-q", "--csv", density))
        settings = ROOT / "config" / "designs" / "arm_default.yaml"
        self.assertIn("would overwrite the density", self.refusal("design", "arm", settings, "--density", density, "-o", "."))
        self.assertIn("are one file", self.refusal("curve", self.file("s.yaml", BEAM), *COARSE, "--steps", "14", "--csv", "a.csv", "-o", "./a.csv"))


class Places(Case):
    def test_two_runs_do_not_share_a_folder(self):
        trial = self.file("t.yaml", f"trial: t\nvehicle: {VEHICLE}\nstart: F\npulse: {{thrust: 0.5, duration: 0.06}}\nrung: lumped\n")
        for words in (("trial", trial), ("validate", VEHICLE), ("design", "arm", ROOT / "config" / "designs" / "arm_default.yaml")):
            with self.subTest(command=words[0]):
                folder = self.folder / words[0]
                folder.mkdir()
                held = os.open(folder, os.O_RDONLY)
                fcntl.flock(held, fcntl.LOCK_EX)
                self.assertIn("another run works in this folder", self.refusal(*words, "-o", folder, "-q"))
                self.assertEqual(list(folder.iterdir()), [])
                os.close(held)
        self.snapwing("trial", trial, "-o", self.folder / "trial", "-q")

    def test_pipes_and_links_are_written_through(self):
        scene = self.file("scene.yaml", BEAM)
        pipe, got = self.folder / "pipe", []
        os.mkfifo(pipe)
        reader = threading.Thread(target=lambda: got.append(pipe.read_bytes()))
        reader.start()
        self.snapwing("curve", scene, *COARSE, "--steps", "14", "--summary", pipe)
        reader.join(30)
        self.assertEqual(json.loads(got[0])["status"], "converged")
        self.file("real.json", "old")
        os.symlink("real.json", self.folder / "link.json")
        self.snapwing("curve", scene, *COARSE, "--steps", "14", "--summary", "link.json", "--csv", "/dev/null")
        self.assertTrue((self.folder / "link.json").is_symlink())
        self.assertEqual(json.loads((self.folder / "real.json").read_text())["status"], "converged")
        self.assertTrue(os.path.exists("/dev/null") and not os.path.isfile("/dev/null"))

    def test_standard_output_takes_a_file_as_well(self):
        with open(self.folder / "log", "wb") as log:
            self.snapwing(*PREDICT, "--json", "/dev/stdout", stdout=log)
        text = (self.folder / "log").read_text()
        self.assertIn('"vehicle_sha256"', text)
        self.assertIn("margin", text.splitlines()[-1])

    def test_places_are_looked_at_before_the_work(self):
        begin = time.monotonic()
        for words in (["plan", VEHICLE, "--from", "F", "--json"], ["plan", VEHICLE, "--from", "F", "--map"],
                      [*PREDICT, "--csv"], ["curve", self.file("s.yaml", BEAM), "-q", "--summary"],
                      ["curve", "s.yaml", "-q", "--plot"], ["curve", VEHICLE, "-q", "-o"]):
            name = "no/such/folder/x" + (".h5" if words[-1] == "-o" else ".png" if words[-1] == "--plot" else "")
            message = self.refusal(*words, name)
            self.assertIn(name + ": its folder does not exist", message)
            self.assertNotIn(".part", message)
        self.assertLess(time.monotonic() - begin, 30)  # a plan alone takes longer on a busy machine
        self.file("file", "")
        self.assertIn("is not a folder", self.refusal("curve", "s.yaml", *COARSE, "--steps", "14", "--vtu", "file/vtu"))
        self.assertIn("is not a folder", self.refusal("design", "arm", ROOT / "config/designs/arm_default.yaml", "-o", "file/x"))

    def test_removed_working_folder(self):
        gone = self.folder / "gone"
        gone.mkdir()
        words = ["bash", "-c", 'rmdir "$PWD"; exec "$@"', "x", PROGRAM, *map(str, PREDICT), "--json", "x.json"]
        done = subprocess.run(words, cwd=gone, stderr=subprocess.PIPE, stdout=subprocess.PIPE, timeout=60)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn(b"x.json: the working folder no longer exists", done.stderr)

    def test_names_that_are_no_utf8(self):
        scene = self.folder / os.fsdecode(b"Pr\xfcf.yaml")
        scene.write_bytes(BEAM.replace("scene: snap_beam", "scene: Pr").encode() .replace(b"scene: Pr\n", b"scene: Pr\xfcfling\n"))
        output = self.folder / os.fsdecode(b"k\xfcrve.csv")
        self.snapwing("curve", scene, *COARSE, "--steps", "14", "-o", output, "--summary", "s.json")
        self.assertTrue(output.exists())
        self.assertEqual(json.loads((self.folder / "s.json").read_text())["scene"], "Pr\\xFCfling")
        vehicle = self.folder / os.fsdecode(b"v\xfc.yaml")
        vehicle.write_bytes(VEHICLE.read_bytes().replace(b"../../data", str(ROOT / "data").encode()))
        self.snapwing("predict", vehicle, *PREDICT[2:], "--json", "p.json")
        self.assertIn("v\\xFC.yaml", json.loads((self.folder / "p.json").read_text())["inputs"]["vehicle_file"])


class FullDisk(Case):
    def test_a_file_that_does_not_fit_leaves_the_old_one(self):
        scene = self.file("scene.yaml", BEAM)
        for option, name in (("-o", "t.h5"), ("-o", "t.csv"), ("--summary", "t.json"), ("--plot", "t.png")):
            self.file(name, "old")
            # The checkpoint may not fit as well; that is no error.
            message = self.refusal("curve", scene, *COARSE, "--steps", "14", option, name, preexec_fn=limited(700))
            self.assertIn(f"snapwing: {name}: cannot be written: File too large", message)
            self.assertEqual((self.folder / name).read_text(), "old")
        for option in ("--json", "--csv"):
            self.assertIn("p: cannot be written: File too large", self.refusal(*PREDICT, option, "p", preexec_fn=limited(700)))
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["scene.yaml", "t.csv", "t.h5", "t.json", "t.png"])

    def test_a_checkpoint_that_cannot_be_written_is_a_warning(self):
        scene = self.file("scene.yaml", BEAM)
        words = ["curve", scene, "-q", "--steps", "20000", "--kernel", "linear_reduced", "--cell-size", "8e-4", "--checkpoint", "c"]
        run = subprocess.Popen([PROGRAM, *map(str, words), "--summary", "s.json"], cwd=self.folder, stderr=subprocess.PIPE,
                               stdout=subprocess.DEVNULL, preexec_fn=limited(20000))
        time.sleep(1.5)
        run.send_signal(signal.SIGINT)  # a checkpoint is due at once
        message = run.communicate(timeout=60)[1].decode()
        self.assertIn("warning: no checkpoint: c: cannot be written: File too large", message)
        self.assertEqual(message.count("warning"), 1)
        self.assertEqual(run.returncode, 1)
        self.assertEqual(json.loads((self.folder / "s.json").read_text())["status"], "cancelled")
        self.assertFalse((self.folder / "c").exists())

    def test_nothing_printed_is_an_error_but_no_loss(self):
        scene = self.file("scene.yaml", BEAM)
        for words in (["curve", scene, *COARSE, "--steps", "14", "--csv", "a.csv"], [*PREDICT, "--csv", "a.csv"], ["--version"]):
            (self.folder / "a.csv").unlink(missing_ok=True)
            with open("/dev/full", "wb") as full:
                message = self.refusal(*words, stdout=full)
            self.assertIn("the standard output cannot be written", message)
            self.assertEqual((self.folder / "a.csv").exists(), "--csv" in words)

    def test_a_reader_that_went_away_costs_no_file(self):
        scene = self.file("scene.yaml", BEAM)
        for words in (["curve", scene, *COARSE, "--steps", "14", "--csv", "a.csv"], [*PREDICT, "--csv", "a.csv"]):
            (self.folder / "a.csv").unlink(missing_ok=True)
            read, write = os.pipe()
            os.close(read)
            self.snapwing(*words, stdout=write, restore_signals=True)
            os.close(write)
            self.assertTrue((self.folder / "a.csv").exists())


class Resumed(Case):
    BAR = """scene: bar
length_unit: mm
dimension: 3
kernel: linear_reduced
cell_size: 1
bodies: {a: {material: {youngs_modulus: 1.0e+6, poisson_ratio: 0.0}, shape: {stl: {file: part.stl, length_unit: mm}}}}
supports: [{name: s, region: {x: [0, 0]}, hold: xyz}]
ports: [{name: p, region: {x: [8, 8]}, direction: [1, 0, 0], cross_motion: held}]
path: {to: .2, steps: 20000}
"""

    def box(self, height):
        corners = [(x, y, z) for z in (0, height) for x, y in ((0, 0), (8, 0), (8, 4), (0, 4))]
        faces = [(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7), (0, 1, 5), (0, 5, 4), (1, 2, 6), (1, 6, 5), (2, 3, 7), (2, 7, 6),
                 (3, 0, 4), (3, 4, 7)]
        self.file("part.stl", "solid p\n" + "".join(
            "facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % corners[k] for k in face)
            + "endloop\nendfacet\n" for face in faces) + "endsolid p\n")

    def test_a_changed_part_does_not_go_on(self):
        self.file("bar.yaml", self.BAR)
        self.box(4)
        run = subprocess.Popen([PROGRAM, "curve", "bar.yaml", "-q", "-o", "a.csv"], cwd=self.folder,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for _ in range(600):
            if (self.folder / "a.csv.checkpoint").exists():
                break
            time.sleep(0.1)
        run.send_signal(signal.SIGKILL)
        run.wait()
        self.assertTrue((self.folder / "a.csv.checkpoint").exists())
        self.assertEqual([p.name for p in self.folder.iterdir() if ".part" in p.name], [])
        self.box(3)
        self.assertIn("belongs to another scene", self.refusal("curve", "bar.yaml", "-q", "-o", "a.csv", "--resume"))


if __name__ == "__main__":
    unittest.main()
