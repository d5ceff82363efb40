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
        for start, target in ("FQ", "QF"):
            plan = json.loads((pathlib.Path(folder) / "three" / f"plan_{start}.json").read_text())["plan"]
            assert plan["accepted"] and plan["target_mode"] == target, plan["reason"]
            assert plan["worst_margin"] > 0 and plan["share_switched"] == 1, plan
            assert plan["nominal"]["end_mode"] == target, plan["nominal"]
    return 0


if __name__ == "__main__":
    sys.exit(main())
