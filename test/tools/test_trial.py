"""`snapwing trial`: its files, what it refuses, and that a killed run goes on to the same bits."""
import csv
import json
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import time
import unittest

from command import ROOT, Case

TRIAL = """trial: short
vehicle: {root}/config/vehicles/arris_x220.yaml
mount: boom
start: F
initial_thrust: 0
pulse: {{thrust: 0.5, duration: 0.06}}
rung: planar
solid: {{cell_size: 0.0025}}
"""


WINGED = """trial: winged
vehicle: {root}/config/vehicles/arris_x220.yaml
mount: free
wings: on
start: F
pulse: {{thrust: 0.5, duration: 0.05}}
wing_friction: {{left: 1, right: 3}}
rung: planar
solid: {{cell_size: 0.0025, wing_stop: 10}}
horizon: 0.05
"""


class Trial(Case):
    def text(self, *changes):
        text = TRIAL.format(root=ROOT)
        for old, new in changes:
            self.assertIn(old, text)
            text = text.replace(old, new)
        return text

    def test_both_rungs_answer_alike(self):
        found = {}
        for rung in ("planar", "lumped"):
            text = self.text() if rung == "planar" else self.text(("rung: planar", "rung: lumped"), ("solid: {cell_size: 0.0025}\n", ""))
            self.snapwing("trial", self.file(f"{rung}.yaml", text), "-o", rung, "-q")
            found[rung] = json.loads((self.folder / rung / "summary.json").read_text())["outcome"]
            self.assertTrue((self.folder / rung / "series.csv").read_text().startswith("time_s,travel_m,"))
        for key in ("start_mode", "end_mode", "snapped"):
            self.assertEqual(found["planar"][key], found["lumped"][key])
        self.assertAlmostEqual(found["planar"]["snap_time"], found["lumped"]["snap_time"], delta=0.005)
        self.assertFalse((self.folder / "planar" / "checkpoint.bin").exists())

    def test_a_trial_teaches_mass_damping_and_strain(self):
        said = self.snapwing("trial", self.file("t.yaml", self.text()), "-o", "out", "-q").stdout.decode()
        self.assertIn("largest mean strain of the arms within 1 mm", said)
        self.assertIn("the material's strain limit is unknown", said)
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        self.assertIsNone(summary["model"]["strain_limit"])
        done = subprocess.run(["/usr/bin/python3", str(ROOT / "scripts/motion_table"), str(self.folder / "out")], stdout=subprocess.PIPE,
                              check=True)
        with open(done.stdout.decode().strip(), encoding="utf-8") as file:
            rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
        self.assertGreater(len(rows), 20)
        outcome = summary["outcome"]
        self.assertAlmostEqual(max(row["strain"] for row in rows), outcome["largest_strain"], delta=0.01)
        self.assertAlmostEqual(max(row["mean_strain"] for row in rows), outcome["largest_mean_strain"], delta=0.01)
        with open(self.folder / "out" / "series.csv", encoding="utf-8") as file:
            series = [{key: float(row[key]) for key in ("strain", "mean_strain")} for row in csv.DictReader(file)]
        self.assertAlmostEqual(max(row["mean_strain"] for row in series), outcome["largest_mean_strain"], delta=1e-8)
        self.assertTrue(all(row["mean_strain"] <= row["strain"] for row in series))
        limited = (ROOT / "config/vehicles/arris_x220.yaml").read_text().replace("../../data", str(ROOT / "data"))
        for limit, word in ((2 * outcome["largest_mean_strain"], "below"), (0.5 * outcome["largest_mean_strain"], "ABOVE")):
            self.file("limited.yaml", limited.replace("  mass_density:", f"  strain_limit: {{value: {limit}, unit: \"1\", source: a}}\n  mass_density:", 1))
            text = self.text((f"{ROOT}/config/vehicles/arris_x220.yaml", "limited.yaml"))
            said = self.snapwing("trial", self.file("l.yaml", text), "-o", "limited_" + word, "-q").stdout.decode()
            self.assertIn(f"{word} the material's strain limit of", said)
        damping = summary["model"]["bodies"]["damping_of_travel"]
        for row in rows:
            # The arms' own motions beside the travel, and the rule in time: a few per cent of each.
            self.assertAlmostEqual(row["effective_mass_kg"] / row["static_mass_kg"], 1, delta=0.05)
            self.assertAlmostEqual(row["effective_damping_N_s_per_m"] / damping, 1, delta=0.05)

    def test_a_table_gets_what_a_trial_teaches(self):
        import h5py  # pylint: disable=import-outside-toplevel
        self.snapwing("trial", self.file("t.yaml", self.text()), "-o", "out", "-q")
        shipped = ROOT / "data" / "tables" / "arris_x220_planar.h5"
        text = (ROOT / "config/vehicles/arris_x220.yaml").read_text().replace("../../data/tables/arris_x220_planar.h5", "table.h5")
        self.file("vehicle.yaml", text.replace("../../data", str(ROOT / "data")))
        shutil.copy(shipped, self.folder / "table.h5")

        def taught(*folders, code=0):
            done = subprocess.run(["/usr/bin/python3", str(ROOT / "scripts/motion_table"), *folders, "--into", "table.h5"], cwd=self.folder,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
            self.assertEqual(done.returncode, code, done.stderr.decode())
            return done.stderr.decode()

        lumped = self.file("l.yaml", self.text(("rung: planar", "rung: lumped"), ("solid: {cell_size: 0.0025}\n", ""),
                                               (f"{ROOT}/config/vehicles/arris_x220.yaml", "vehicle.yaml")))
        before = self.snapwing("trial", lumped, "-o", "before", "-q").stdout.decode()
        self.assertNotIn("effective mass", before)
        for _ in range(2):  # a second time replaces the columns
            taught("out")
        with open(self.folder / "out/motion_table.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        with h5py.File(self.folder / "table.h5") as file, h5py.File(shipped) as plain:
            for name in plain:
                if isinstance(plain[name], h5py.Dataset):
                    self.assertTrue((file[name][()] == plain[name][()]).all(), name)
            travel, motion = file["travel"][()], file["motion"]
            self.assertEqual(motion["damping"].attrs["unit"], b"N s/m")
            self.assertEqual(motion.attrs["trial"], b"short")
            for column, key in (("effective_mass", "effective_mass_kg"), ("static_mass", "static_mass_kg"),
                                ("damping", "effective_damping_N_s_per_m")):
                middle = rows[len(rows) // 2]
                there = abs(travel - float(middle["travel_m"])).argmin()
                self.assertAlmostEqual(motion[column][there] / float(middle[key]), 1, delta=0.02)
                self.assertEqual(len(motion[column]), len(travel))
        after = self.snapwing("trial", lumped, "-o", "after", "-q").stdout.decode()
        self.assertIn("left out: effective mass and damping that trials have taught the table", after)
        self.assertEqual(after.splitlines()[0], before.splitlines()[0], "it changes no result")
        with h5py.File(self.folder / "table.h5", "r+") as file:
            file["motion/damping"][5] = -1
        self.assertIn("'motion/damping' is -1 N s/m at entry 5", self.refusal("trial", lumped, "-o", "bad", "-q"))
        self.file("table.h5", b"no table")
        self.assertIn("table.h5", taught("out", code=2))

    def test_coarser_cells_keep_mass_or_stiffness(self):
        found = {}
        for rule in ("mass", "stiffness"):
            text = self.text(("cell_size: 0.0025", f"cell_size: 0.0025, coarsening: {rule}"))
            self.snapwing("trial", self.file(f"{rule}.yaml", text), "-o", rule, "-q")
            found[rule] = json.loads((self.folder / rule / "summary.json").read_text())
            self.assertEqual(found[rule]["model"]["coarsening"], rule)
        self.assertNotAlmostEqual(*(f["model"]["static_valley_force"] for f in found.values()), delta=0.1)

    def test_a_killed_run_goes_on_to_the_same_bits(self):
        path = self.file("t.yaml", self.text())
        self.snapwing("trial", path, "-o", "whole", "-q")
        command = [os.environ["SNAPWING"], "trial", str(path), "-o", "part", "-q"]
        child = subprocess.Popen(command, cwd=self.folder)
        checkpoint = self.folder / "part" / "checkpoint.bin"
        deadline = time.monotonic() + 60
        while not checkpoint.exists() and child.poll() is None and time.monotonic() < deadline:
            time.sleep(0.002)
        child.send_signal(signal.SIGKILL)
        child.wait()
        self.assertTrue(checkpoint.exists(), "the run ended before it could be killed")
        self.snapwing("trial", path, "-o", "part", "-q")
        self.assertEqual((self.folder / "part" / "series.csv").read_bytes(), (self.folder / "whole" / "series.csv").read_bytes())

    def test_frames_and_picture(self):
        self.snapwing("trial", self.file("t.yaml", self.text()), "-o", "out", "-q", "--vtu-every", "0.1")
        frames = sorted(p.name for p in (self.folder / "out").glob("frame_*.vtu"))
        listed = re.findall(r'timestep="([0-9.e-]+)" file="([^"]+)"', (self.folder / "out" / "trial.pvd").read_text())
        self.assertEqual([name for _, name in listed], frames)
        self.assertGreaterEqual(len(frames), 5)
        for k, (moment, name) in enumerate(listed):
            self.assertEqual(name, f"frame_{k:04d}.vtu")
            self.assertAlmostEqual(float(moment), 0.1 * k, delta=0.0021)
        plot = ROOT / "scripts" / "plot_trial"
        subprocess.run([plot, "out"], cwd=self.folder, check=True, stdout=subprocess.DEVNULL)
        self.assertEqual((self.folder / "out" / "trial.png").read_bytes()[:4], b"\x89PNG")
        none = subprocess.run([plot, "nowhere"], cwd=self.folder, stderr=subprocess.PIPE, check=False)
        self.assertEqual(none.returncode, 2)
        self.assertIn(b"nowhere", none.stderr)
        self.assertNotIn(b"Traceback", none.stderr)

    def test_repeats_differ_by_seed_and_go_on(self):
        varied = ("duration: 0.06}}".replace("}}", "}"), "duration: 0.06}\nrepeats: 3\nvary: {seed: 4, strength: 0.05, duration: 0.01, vehicle: on}")
        lumped = (("rung: planar", "rung: lumped"), ("solid: {cell_size: 0.0025}\n", ""))
        path = self.file("t.yaml", self.text(varied, *lumped))
        said = self.snapwing("trial", path, "-o", "three", "-q").stdout.decode()
        self.assertIn("short: 3 of 3 switch, ", said)
        self.assertIn("margin by the tables", said)
        found = json.loads((self.folder / "three" / "summary.json").read_text())["repeats"]
        pulses = [(r["pulse"]["thrust_fraction"], r["pulse"]["duration"]) for r in found]
        self.assertEqual(len(set(pulses)), 3)
        for thrust, duration in pulses:
            self.assertTrue(0.475 <= thrust <= 0.525 and 0.05 <= duration <= 0.07, pulses)
        self.assertEqual(len({r["snap_time"] for r in found}), 3)
        stamp = (self.folder / "three" / "short_2" / "series.csv").stat().st_mtime_ns
        (self.folder / "three" / "short_3" / "done.json").unlink()
        self.snapwing("trial", path, "-o", "three", "-q")
        self.assertEqual((self.folder / "three" / "short_2" / "series.csv").stat().st_mtime_ns, stamp, "not run again")
        again = json.loads((self.folder / "three" / "summary.json").read_text())["repeats"]
        self.assertEqual(again, found)
        more = self.file("t.yaml", self.text((varied[0], varied[1].replace("repeats: 3", "repeats: 2")), *lumped))
        self.snapwing("trial", more, "-o", "two", "-q")
        two = json.loads((self.folder / "two" / "summary.json").read_text())["repeats"]
        self.assertEqual([r["pulse"] for r in two], [r["pulse"] for r in found[:2]])
        other = self.file("o.yaml", self.text((varied[0], varied[1].replace("seed: 4", "seed: 5")), *lumped))
        self.snapwing("trial", other, "-o", "other", "-q")
        seeded = json.loads((self.folder / "other" / "summary.json").read_text())["repeats"]
        self.assertNotEqual(seeded[0]["pulse"], found[0]["pulse"])

    def test_a_bag_holds_the_series(self):
        if not pathlib.Path(os.environ["SNAPWING"]).with_name("trial_bag").exists():
            self.skipTest("a build without ROS")
        import rosbag  # pylint: disable=import-outside-toplevel
        self.snapwing("trial", self.file("t.yaml", WINGED.format(root=ROOT)), "-o", "out", "-q", "--bag", code=1)
        with open(self.folder / "out" / "series.csv", encoding="utf-8") as file:
            rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
        with rosbag.Bag(str(self.folder / "out" / "run.bag")) as bag:
            joints = [(stamp.to_sec() - 1, message) for _, message, stamp in bag.read_messages(topics=["/joint_states"])]
            kinds = {name: topic.msg_type for name, topic in bag.get_type_and_topic_info().topics.items()}
        self.assertEqual(kinds["/tf"], "tf2_msgs/TFMessage")
        self.assertEqual(kinds["/markers"], "visualization_msgs/MarkerArray")
        self.assertEqual(kinds["/mode_state"], "snapwing/ModeState")
        self.assertEqual(len(joints), len(rows))
        for (moment, message), row in zip(joints, rows):
            self.assertAlmostEqual(moment, row["time_s"], delta=1e-8)
            found = dict(zip(message.name, message.position))
            for joint, column in (("travel", "travel_m"), ("wing_left", "wing_left_rad"), ("wing_right", "wing_right_rad")):
                self.assertAlmostEqual(found[joint], row[column], delta=1e-8)

    def test_a_boom_runs_out_as_friction_and_drag_say(self):
        self.snapwing("trial", ROOT / "config" / "trials" / "boom_spin_down.yaml", "-o", "out", "-q")
        model = json.loads((self.folder / "out" / "summary.json").read_text())["model"]["bodies"]
        mass = model["ring_mass"] + model["centre_mass"] + model["arms_mass"]
        drag = model["ring_drag"] + model["centre_drag"]
        text = (ROOT / "config" / "vehicles" / "arris_x220.yaml").read_text()
        friction = float(re.search(r"\bfriction: \{value: ([0-9.]+), unit: N,", text).group(1))
        with open(self.folder / "out" / "series.csv", encoding="utf-8") as file:
            rows = [{key: float(value) for key, value in row.items() if value} for row in csv.DictReader(file)]
        root, late = math.sqrt(friction / drag), rows[-1]["time_s"]
        self.assertGreater(late, 4)
        begin = math.atan(rows[0]["ring_speed_m_per_s"] / root)

        def speed(time):  # m v' = -f - c v^2
            return root * math.tan(begin - time * math.sqrt(friction * drag) / mass)

        for row in rows[::200] + rows[-1:]:
            # The bearing's friction falls with 2e-2 m/s / v below its full strength, which is a thousandth of it here.
            self.assertAlmostEqual(row["ring_speed_m_per_s"], speed(row["time_s"]), delta=0.001 * 1.5)
        # Either brake alone would leave it faster by far.
        self.assertGreater(root * math.tan(begin) - speed(late), 0.3)
        self.assertGreater(1.5 - friction * late / mass - speed(late), 0.05)
        self.assertGreater(1 / (1 / 1.5 + drag * late / mass) - speed(late), 0.1)
        loss = rows[-1]["loss_J"]
        self.assertAlmostEqual(loss, 0.5 * mass * (1.5 ** 2 - rows[-1]["ring_speed_m_per_s"] ** 2), delta=0.002 * loss)

    def test_a_build_without_ros_says_so_before_the_work(self):
        alone = self.folder / "bin" / "snapwing"
        alone.parent.mkdir()
        for program in (os.environ["SNAPWING"], os.environ["SNAPWING"] + "_all"):
            shutil.copy(program, alone.parent)
        done = subprocess.run([alone, "trial", self.file("t.yaml", self.text()), "-o", "out", "--bag"], cwd=self.folder,
                              stderr=subprocess.PIPE, check=False)
        self.assertEqual(done.returncode, 2)
        for word in (b"--bag", b"trial_bag", b"SNAPWING_WITH_ROS"):
            self.assertIn(word, done.stderr)
        self.assertFalse((self.folder / "out" / "series.csv").exists())

    def test_bad_trials_are_refused_by_key_value_and_range(self):
        for change, words in ((("duration: 0.06", "duration: -1"), ("pulse.duration", "-1", "0")),
                              (("duration: 0.06}", "duration: 0.06}\nthen:\n- {thrust: 2, duration: 0.1}"), ("then", "thrust", "2", "1")),
                              (("duration: 0.06}", "duration: 0.06}\nthen:\n- {thrust: 0.2}"), ("then", "duration")),
                              (("duration: 0.06}", "duration: 0.06}\nrepeats: 3"), ("vary", "missing", "repeats")),
                              (("duration: 0.06}", "duration: 0.06}\nrepeats: 3\nvary: {seed: 1}"), ("vary.strength", "0")),
                              (("duration: 0.06}", "duration: 0.06}\nvary: {seed: 1, strength: 0.1}"), ("vary", "one repeat")),
                              (("start: F", "start: R"), ("start", "R", "F")),
                              (("mount: boom", "mount: rope"), ("mount", "rope", "boom")),
                              (("rung: planar", "rung: exact"), ("rung", "exact", "planar")),
                              (("mount: boom", "mount: boom\nwings: on"), ("wings", "boom", "wings off")),
                              (("initial_thrust: 0", "initial_thrust: .nan"), ("initial_thrust",)),
                              (("rung: planar", "rung: planar\nhand: {}"), ("hand",)),
                              (("thrust: 0.5, ", ""), ("throttle", "missing")),
                              (("cell_size: 0.0025", "cell_size: 0.5"), ("solid.cell_size", "0.5", "0.02")),
                              (("rung: planar", "uncertain: {motor: 1}\nrung: planar"), ("motor",)),
                              (("rung: planar", "uncertain: {material.relaxation.time: 2}\nrung: planar"), ("relaxation.time", "2", "half widths")),
                              (("rung: planar\nsolid: {cell_size: 0.0025}", "uncertain: {material.relaxation.share: 1}\nrung: lumped"), ("relaxation.share", "planar")),
                              (("rung: planar\nsolid: {cell_size: 0.0025}", "time: {step: 0.001}\nrung: lumped"), ("time", "planar")),
                              (("trial: short", "trial: ../short\nrepeats: 2\nvary: {seed: 1, strength: 0.1}"), ("trial", "../short", "folder")),
                              (("rung: planar", "time: {bias: 0.1, scheme: backward_euler}\nrung: planar"), ("bias", "midpoint"))):
            with self.subTest(change=change):
                said = self.refusal("trial", self.file("bad.yaml", self.text(change)), "-o", "bad", "-q")
                for word in words:
                    self.assertIn(word, said)
                self.assertFalse((self.folder / "bad" / "summary.json").exists())

    def test_the_rung_of_tables_draws_no_arm(self):
        lumped = self.file("t.yaml", self.text(("rung: planar\nsolid: {cell_size: 0.0025}", "rung: lumped")))
        for option in (["--vtu"], ["--vtu-every", "0.01"]):
            self.assertIn("lumped", self.refusal("trial", lumped, "-o", "drawn", *option))
            self.assertFalse((self.folder / "drawn").exists())

    def test_a_checkpoint_of_another_trial_is_refused(self):
        path = self.file("t.yaml", self.text())
        (self.folder / "out").mkdir()
        (self.folder / "out" / "checkpoint.bin").write_bytes(b"nothing of ours")
        said = self.refusal("trial", path, "-o", "out", "-q")
        self.assertIn("checkpoint.bin", said)


if __name__ == "__main__":
    unittest.main()
