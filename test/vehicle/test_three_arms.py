"""README.md's way of an own vehicle, as examples/three_arms runs it, on coarse cells: usage test_three_arms.py PROGRAM"""
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory(prefix="three arms ") as folder:
        done = subprocess.run([str(ROOT / "examples" / "three_arms" / "run"), folder + "/three", "--quick", "--no-flight",
                               "--snapwing", program], check=False)
        if done.returncode:
            return 1
        for name, target in (("plan_f_to_q.json", "Q"), ("plan_q_to_f.json", "F")):
            plan = json.loads((pathlib.Path(folder) / "three" / "made" / name).read_text())["plan"]
            assert plan["accepted"] and plan["target_mode"] == target, plan["reason"]
            assert plan["worst_margin"] > 0 and plan["share_switched"] == 1, plan
            assert plan["nominal"]["end_mode"] == target, plan["nominal"]
        made = pathlib.Path(folder) / "three" / "made"
        answer = json.loads((made / "validation" / "validation.json").read_text())
        verdicts = {check["name"]: check["verdict"] for check in answer["checks"]}
        # Cells of 2 mm are too coarse for a verdict on the peak; what the files say of each other does not depend on them.
        for name in ("tables of this vehicle's arm", "F -> Q: plan of this vehicle and table", "Q -> F: plan of this vehicle and table",
                     "F -> Q, planar, nominal: end mode", "Q -> F, planar, nominal: end mode"):
            assert verdicts[name] == "pass", (name, verdicts[name])
    return 0


if __name__ == "__main__":
    sys.exit(main())
