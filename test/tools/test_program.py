"""What an earlier run left is taken by the program that made it, and by no other build of the same version: kept trials, checkpoints of
trials and curves. Another build is made by a copy of a library that says another build id."""
import json
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import time
import unittest

from command import PROGRAM, ROOT, Case
import test_outputs
from test_trial import TRIAL
from test_validate import QUICK

NOTE = struct.pack("<III", 4, 20, 3) + b"GNU\0"  # of a build id: sizes of name and content, kind; the id follows
LUMPED = TRIAL.format(root=ROOT).replace("rung: planar", "rung: lumped").replace("solid: {cell_size: 0.0025}\n", "")


def libraries():
    """Files of the snapwing libraries that the program under test loads."""
    whole = pathlib.Path(PROGRAM).with_name("snapwing_all")
    said = subprocess.run(["ldd", whole], stdout=subprocess.PIPE, check=True).stdout.decode()
    words = [line.split() for line in said.splitlines() if "libsnapwing_" in line]
    return {line[0]: pathlib.Path(line[2]) for line in words}


class OtherProgram(Case):
    BAR, box = test_outputs.Resumed.BAR, test_outputs.Resumed.box

    def another_build(self, layer, change=lambda found, data: data.__setitem__(found + len(NOTE), data[found + len(NOTE)] ^ 1)):
        """Environment in which one library is a copy with another build id."""
        name = f"libsnapwing_{layer}.so"
        data = bytearray(libraries()[name].read_bytes())
        found = data.find(NOTE)
        self.assertGreater(found, 0, "the library has no build id")
        change(found, data)
        folder = self.folder / f"other_{layer}"
        folder.mkdir(exist_ok=True)
        shutil.copymode(libraries()[name], self.file(f"other_{layer}/{name}", bytes(data)))
        return {**os.environ, "LD_LIBRARY_PATH": f"{folder}:{os.environ.get('LD_LIBRARY_PATH', '')}"}

    def stopped(self, output, *words):
        """A run that is killed as soon as its checkpoint is there."""
        run = subprocess.Popen([PROGRAM, *map(os.fspath, words)], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + 60
        while not (self.folder / output).exists() and run.poll() is None and time.monotonic() < deadline:
            time.sleep(0.005)
        run.send_signal(signal.SIGKILL)
        run.wait()
        self.assertTrue((self.folder / output).exists(), "the run ended before it could be killed")

    def test_a_trial_that_is_done_is_done_for_its_own_program_alone(self):
        words = ("trial", self.file("t.yaml", LUMPED), "-o", "out", "-q", "--unless-done")
        self.snapwing(*words)
        stamp = (self.folder / "out/series.csv").stat().st_mtime_ns
        again = self.snapwing(*words)
        self.assertEqual(again.stdout.decode(), "short: done before, by this program and with the same files\n")
        self.assertEqual(again.stderr, b"")
        self.assertEqual((self.folder / "out/series.csv").stat().st_mtime_ns, stamp, "not run again")
        other = self.snapwing(*words, env=self.another_build("rom"))
        self.assertIn("left by another program (0.", other.stderr.decode())
        self.assertIn("; computed anew", other.stderr.decode())
        self.assertNotEqual((self.folder / "out/series.csv").stat().st_mtime_ns, stamp)
        self.snapwing("trial", self.file("t.yaml", LUMPED.replace("0.06}", "0.07}")), "-o", "out", "-q", "--unless-done",
                      env=self.another_build("rom"))
        self.assertEqual(json.loads((self.folder / "out/summary.json").read_text())["pulse"]["duration"], 0.07, "another file")

    def test_a_library_without_a_build_id_is_known_by_its_bytes(self):
        words = ("trial", self.file("t.yaml", LUMPED), "-o", "out", "-q", "--unless-done")

        def without(found, data):
            data[found + 8] = 99  # another kind of note

        none = self.another_build("rom", without)
        self.snapwing(*words, env=none)
        self.assertIn("done before", self.snapwing(*words, env=none).stdout.decode())

        def changed(found, data):
            without(found, data)
            data[found + len(NOTE)] ^= 1

        self.assertIn("left by another program", self.snapwing(*words, env=self.another_build("rom", changed)).stderr.decode())

    def test_repeats_of_another_program_are_run_again(self):
        path = self.file("t.yaml", LUMPED + "repeats: 2\nvary: {seed: 4, strength: 0.05}\n")
        self.snapwing("trial", path, "-o", "out", "-q")
        stamps = {p: p.stat().st_mtime_ns for p in self.folder.glob("out/*/series.csv")}
        self.assertEqual(len(stamps), 2)
        said = self.snapwing("trial", path, "-o", "out", "-q", env=self.another_build("motion")).stderr.decode()
        self.assertEqual(said.count("left by another program"), 2)
        for file, stamp in stamps.items():
            self.assertNotEqual(file.stat().st_mtime_ns, stamp)

    def test_a_trials_checkpoint_of_another_program_begins_anew(self):
        path = self.file("t.yaml", TRIAL.format(root=ROOT))
        self.stopped("out/checkpoint.bin", "trial", path, "-o", "out", "-q")
        said = self.snapwing("trial", path, "-o", "out", "-q", env=self.another_build("solver")).stderr.decode()
        self.assertIn("checkpoint.bin: was written by another program (0.", said)
        self.assertIn("; begins anew", said)
        self.assertNotIn("resuming", said)

    def test_validation_takes_no_trials_of_another_program(self):
        vehicle = ROOT / "config/vehicles/arris_x220.yaml"
        words = ("validate", vehicle, "-o", "out", *QUICK, "--one-cell-size")
        first = self.snapwing(*words, code=(0, 1, 3))
        stamps = {p: p.stat().st_mtime_ns for p in self.folder.glob("out/trials/*.json")}
        self.assertGreater(len(stamps), 5)
        # What does not compute the trials has no say in them.
        again = self.snapwing(*words, code=first.returncode, env=self.another_build("pipeline"))
        self.assertEqual((again.stderr, again.stdout), (b"", first.stdout))
        self.assertEqual(stamps, {p: p.stat().st_mtime_ns for p in stamps})
        other = self.snapwing(*words, code=first.returncode, env=self.another_build("elasticity"))
        self.assertEqual(other.stderr.decode().count("left by another program"), 1)
        self.assertEqual(other.stdout, first.stdout)
        for file, stamp in stamps.items():
            self.assertNotEqual(file.stat().st_mtime_ns, stamp, file.name)

    def test_a_curves_checkpoint_of_another_program_begins_anew(self):
        self.box(4)
        path = self.file("bar.yaml", self.BAR)
        self.stopped("a.csv.checkpoint", "curve", path, "-q", "-o", "a.csv")
        self.file("bar.yaml", self.BAR)
        run = subprocess.Popen([PROGRAM, "curve", path, "-o", "a.csv", "--resume"], cwd=self.folder, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, env=self.another_build("solver"))
        said = run.stderr.readline().decode()
        run.kill()
        run.communicate()
        self.assertIn("a.csv.checkpoint: was written by another program (0.", said)
        self.assertIn("; begins anew", said)


if __name__ == "__main__":
    unittest.main()
