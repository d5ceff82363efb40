"""What `snapwing curve` and `snapwing plan` say: features that depend on the beam alone, and a few lines for people."""
import csv
import json
import unittest

from command import BEAM, COARSE, PREDICT, ROOT, VEHICLE, Case

UP, DOWN = "direction: [0, -1]", "direction: [0, 1]"


class Features(Case):
    def summary(self, text, *more, steps=14):
        self.snapwing("curve", self.file("scene.yaml", text), *COARSE, "--steps", str(steps), "--csv", "c.csv", "--summary", "s.json", *more)
        return json.loads((self.folder / "s.json").read_text())

    def test_the_direction_of_travel_decides_nothing(self):
        """Towards minus everything is mirrored; backwards everything is the same."""
        self.assertIn(UP, BEAM)
        plus = self.summary(BEAM)
        minus = self.summary(BEAM.replace(UP, DOWN).replace("to: 19.6", "to: -19.6"))
        back = self.summary(BEAM, "--reverse")
        self.assertTrue(plus["bistable"])
        self.assertEqual(plus["features"], "solved for")
        # Three codes, docs of the scene; coarse cells here.
        self.assertAlmostEqual(plus["peak"]["force_N"], 0.277, delta=0.02)
        self.assertAlmostEqual(plus["valley"]["travel_m"], 0.01755, delta=5e-4)
        for other, sign in ((minus, -1), (back, 1)):
            for key in ("peak", "valley"):
                self.assertAlmostEqual(other[key]["force_N"], sign * plus[key]["force_N"], delta=1e-8)
                self.assertAlmostEqual(other[key]["travel_m"], sign * plus[key]["travel_m"], delta=1e-8)
            for key in ("first_m", "barrier_m", "second_m"):
                self.assertAlmostEqual(other["equilibria"][key], sign * plus["equilibria"][key], delta=1e-8)
            for key in ("barrier_forward_J", "barrier_back_J"):
                self.assertAlmostEqual(other[key], plus[key], delta=1e-9)
            self.assertTrue(other["bistable"])

    def test_wide_steps_are_solved_for_or_marked(self):
        fine, wide = self.summary(BEAM), self.summary(BEAM, steps=6)
        for key in ("peak", "valley"):
            self.assertAlmostEqual(wide[key]["force_N"], fine[key]["force_N"], delta=1e-8)
        for key in ("barrier_forward_J", "barrier_back_J"):
            self.assertAlmostEqual(wide[key], fine[key], delta=1e-9)
        table = self.file("lumped", "")
        self.snapwing("curve", VEHICLE, "-q", "--rung", "lumped", "--summary", table)
        found = json.loads(table.read_text())
        self.assertEqual((found["features"], found["peak"]["exact"]), ("interpolated", False))

    def test_everything_is_counted(self):
        found = self.summary(BEAM)
        self.assertGreater(found["factorizations_of_features"], 0)
        self.assertGreater(found["factorizations"], found["factorizations_of_features"])
        self.assertGreater(found["seconds"]["features"], 0)
        # Root of the Hermite polynomial, then Newton or secant: a bracketing root finder took some forty for each.
        self.assertLess(found["factorizations_of_features"], 8 * len(found["located"]))
        self.assertEqual([f["kind"] for f in found["located"]], ["zero", "peak", "zero", "valley", "zero"])

    def test_stable_points_are_counted_as_the_rows_say(self):
        found = self.summary(BEAM)
        rows = list(csv.DictReader((self.folder / "c.csv").read_text().splitlines()))
        self.assertEqual(found["points"], len(rows))
        self.assertEqual(found["points_unstable_while_held"], sum(row["stable"] == "0" for row in rows))
        falling = sum(row["stable"] == "0" or float(row["stiffness_N_per_m"]) < 0 for row in rows)
        self.assertGreater(falling, 0)
        self.assertEqual(found["points_unstable_when_free"], falling)


class Lines(Case):
    def test_the_answer_is_a_few_lines_and_json_on_demand(self):
        scene = self.file("scene.yaml", BEAM)
        lines = self.snapwing("curve", scene, *COARSE, "--steps", "14", "--csv", "c.csv").stdout.decode().splitlines()
        self.assertLess(len(lines), 12)
        for word in ("snap_beam", "peak", "valley", "equilibria", "bistable   yes; barriers", "stable while held", "wrote      c.csv"):
            self.assertTrue(any(word in line for line in lines), (word, lines))
        found = json.loads(self.snapwing("curve", scene, *COARSE, "--steps", "14", "--json").stdout)
        self.assertIn(f"{found['points']}: {found['points']} stable while held", "\n".join(lines))
        lines = self.snapwing("curve", VEHICLE, "-q", "--rung", "lumped").stdout.decode()
        self.assertIn("interpolated between the points", lines)

    def test_a_map_says_how_far_it_is(self):
        words = ["plan", VEHICLE, "--from", "F", "--samples", "2", "--search-samples", "2", "--map", "m.csv", "--map-size", "5"]
        done = self.snapwing(*words)
        self.assertIn(b"outcome map: 25 of 25 pulses", done.stderr)
        self.assertEqual(len((self.folder / "m.csv").read_text().splitlines()), 26)
        self.assertEqual(self.snapwing(*words, "-q").stderr, b"")

    def test_a_monitor_with_a_comma_is_one_column(self):
        bar = """scene: bar
length_unit: mm
dimension: 2
plane: strain
kernel: linear
cell_size: 1
bodies: {a: {material: {youngs_modulus: 1.0e+6, poisson_ratio: 0.3}, thickness: 1, shape: {box: {x: [0, 4], y: [0, 2]}}}}
supports: [{name: s, region: {x: [0, 0]}, hold: xy}]
ports: [{name: p, region: {x: [4, 4]}, direction: [1, 0], cross_motion: held}]
monitors: [{name: 'tip, "right"', at: [2, 1], direction: [1, 0]}]
path: {to: 0.02, steps: 4}
"""
        self.snapwing("curve", self.file("bar.yaml", bar), "-q", "--csv", "c.csv")
        header, *rows = csv.reader((self.folder / "c.csv").read_text().splitlines())
        self.assertEqual(header[-1], 'tip, "right"_m')
        self.assertEqual({len(row) for row in rows}, {len(header)})


class Trade(Case):
    """Errors belong to what they were measured on."""

    def test_another_beam_of_the_same_name_is_refused(self):
        folder = ROOT / "data" / "trade"
        self.snapwing("curve", self.file("same.yaml", BEAM.replace("scene: snap_beam", "scene: renamed")), "-q", "--steps", "8",
                      "--error", "7%", "--trade", folder)
        for change in (("thickness: 1.6", "thickness: 0.8"), ("youngs_modulus: 5.5e+6", "youngs_modulus: 5.0e+6"),
                       ("to: 19.6", "to: 15"), ("hold: xy", "hold: x")):
            self.assertIn(change[0], BEAM)
            message = self.refusal("curve", self.file("other.yaml", BEAM.replace(*change)), "-q", "--steps", "8", "--error", "7%",
                                   "--trade", folder)
            self.assertIn("no error was measured on this scene's bodies, material and loads", message)
            self.assertIn("--cell-size", message)

    def test_shipped_rows_belong_to_shipped_scenes(self):
        rows = list(csv.DictReader((ROOT / "data" / "trade" / "measured.csv").read_text().splitlines()))
        for name in {row["scene"] for row in rows}:
            scene = ROOT / "config" / "scenes" / f"{name}.yaml"
            found = json.loads(self.snapwing("curve", scene, "-q", "--json", "--steps", "2", "--resolution", "x0.5").stdout)
            self.assertEqual({row["content_sha256"] for row in rows if row["scene"] == name}, {found["content_sha256"]})


class Verdicts(Case):
    def test_a_wing_that_misses_its_targets_ends_with_1(self):
        text = (ROOT / "test" / "data" / "designs" / "wing_small.yaml").read_text().replace("../../../config", str(ROOT / "config"))
        for wanted, code, word in (("2.45", 0, b": met"), ("1.60", 1, b": NOT MET")):
            settings = self.file("wing.yaml", text.replace("wing_rotation: 2.45", "wing_rotation: " + wanted))
            self.assertIn(word, self.snapwing("design", "wing", settings, "-o", "w", code=code).stdout)
            self.assertTrue((self.folder / "w" / "wing_table.h5").exists())


class Hold(Case):
    """A pulse that goes over into a second level."""

    def test_prediction_says_what_was_held(self):
        done = self.snapwing(*PREDICT, "--mount", "free", "--hold-throttle", ".3", "--hold-duration", "1.2", "--json", "p.json")
        self.assertIn(b"for 0.160 s, then throttle 0.300 for 1.200 s", done.stdout)
        pulse = json.loads((self.folder / "p.json").read_text())["pulse"]
        self.assertEqual(pulse, {"throttle": .7, "duration": .16, "hold_throttle": .3, "hold_duration": 1.2})

    def test_half_a_hold_is_refused(self):
        self.assertIn("--hold-duration", self.refusal(*PREDICT, "--hold-throttle", ".3"))
        self.assertIn("hold_throttle", self.refusal(*PREDICT, "--hold-throttle", "0", "--hold-duration", "1"))
        self.assertIn("--from F only", self.refusal("plan", VEHICLE, "--from", "Q", "--hold-throttle", ".3", "--hold-duration", "1"))


class Inputs(Case):
    def test_a_prediction_names_every_table(self):
        self.snapwing(*PREDICT, "--json", "p.json")
        inputs = json.loads((self.folder / "p.json").read_text())["inputs"]
        for key in ("vehicle_sha256", "table_sha256", "wing_table_sha256"):
            self.assertEqual(len(inputs[key]), 64)


if __name__ == "__main__":
    unittest.main()
