"""Numbers among the options: finite, in range, and the range in the message."""
import unittest

from command import BEAM, PREDICT, VEHICLE, Case


class Numbers(Case):
    def refused(self, words, option, value, allowed):
        message = self.refusal(*words, f"{option}={value}")
        self.assertIn(option.strip("-"), message)
        self.assertIn("allowed: " + allowed, message)

    def test_curve(self):
        scene = ["curve", self.file("scene.yaml", BEAM), "-q"]
        for value in ("nan", "inf", "2", "200%", "0", "0%", "100%", "-1%", "x", "2%%", "%", "0x1p-4", " 2%"):
            self.refused(scene, "--error", value, "a percentage between 0% and 100%")
        for option, values in (("--seconds", ("nan", "0", "-1")), ("--cell-size", ("nan", "0", "1e9")),
                               ("--perturb", ("nan", "inf", "1e9")), ("--step", ("nan", "1e-12", "1"))):
            for value in values:
                self.refused(scene, option, value, "a number, ")
        for option in ("--steps", "--particles", "--threads"):
            for value in ("010", "0x10", "0", "-3", "nan", "2.5", "99999999999999999999", "4294967297"):
                self.refused(scene, option, value, "a whole number, 1 .. ")
        vehicle = ["curve", VEHICLE, "-q"]
        for option, values in (("--to", ("1e9", "nan", "0", "-1")), ("--from", ("nan", "1", "-1e9"))):
            for value in values:
                self.refused(vehicle, option, value, "a number, ")
        for where, words, reason in ((scene, ("--step", "1e-3"), "for the arm of a vehicle"), (scene, ("--no-back",), "for the arm of a vehicle"),
                                     (scene, ("--to", "1"), "for the planar arm"), (scene, ("--plane", "stress"), "states the key 'plane'"),
                                     ([*vehicle, "--rung", "volumetric"], ("--from", "0"), "for the planar arm"),
                                     ([*vehicle, "--rung", "volumetric"], ("--plane", "strain"), "give --rung planar too"),
                                     ([*vehicle, "--rung", "lumped"], ("--plane", "strain"), "for a path that is traced")):
            self.assertIn(f"{words[0]} is {reason}" if reason.startswith("for") else reason, self.refusal(*where, *words))
        self.assertIn("allowed: at most 100000", self.refusal(*vehicle, "--to", "10", "--step", "1e-6"))

    def test_predict(self):
        for option, values in (("--step", ("1e-12", "nan", "1", "0")), ("--gravity", ("nan", "1e9")), ("--horizon", ("nan", "0", "1e9")),
                               ("--initial-speed", ("nan", "1e9")), ("--initial-thrust", ("nan", "2")), ("--final-thrust", ("nan", "-1"))):
            for value in values:
                self.refused(PREDICT, option, value, "a number, ")
        for option, value in (("--throttle", "nan"), ("--throttle", "2"), ("--throttle", "0x1"), ("--throttle", " 1"), ("--duration", "nan"), ("--duration", "1e9")):
            words = [word for word in PREDICT]
            at = words.index(option)
            self.refused(words[:at] + words[at + 2:], option, value, "a number, ")
        self.assertIn("allowed: at most 10000000", self.refusal(*PREDICT, "--step", "1e-7", "--horizon", "60"))

    def test_plan_and_designs(self):
        plan = ["plan", VEHICLE, "--from", "F"]
        for option in ("--required-margin", "--enough-margin", "--required-share", "--throttle-max", "--duration-max"):
            for value in ("nan", "-1", "1e9"):
                self.refused(plan, option, value, "a number, ")
        for option in ("--samples", "--search-samples", "--threads", "--map-size"):
            for value in ("010", "nan", "0", "1e9"):
                self.refused(plan, option, value, "a whole number, ")
        self.refused(["design", "arm", "x.yaml"], "--gradient-tolerance", "nan", "a number, ")
        self.refused(["design", "arm", "x.yaml"], "--threads", "010", "a whole number, ")
        self.refused(["design", "wing", "x.yaml"], "--points", "010", "a whole number, ")


if __name__ == "__main__":
    unittest.main()
