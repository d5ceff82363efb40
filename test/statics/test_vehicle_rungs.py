"""A vehicle's curve as a slice and as a solid: both state the totals of all arms, so they must be near each other."""
import json
import pathlib
import subprocess
import sys
import tempfile

VEHICLE = pathlib.Path(__file__).resolve().parents[2] / "config" / "vehicles" / "arris_x220.yaml"


def peak(program, folder, *options):
    summary = pathlib.Path(folder) / "s.json"
    subprocess.run([program, "curve", str(VEHICLE), "--resolution", "2.5mm", "--no-back", "-q", "--summary", str(summary), *options],
                   check=True, stdout=subprocess.DEVNULL)
    return json.loads(summary.read_text())["peak"]["force_N"]


def main():
    with tempfile.TemporaryDirectory() as folder:
        planar = peak(sys.argv[1], folder, "--step", "2e-3")
        solid = peak(sys.argv[1], folder, "--rung", "volumetric", "--steps", "40")
    # One arm alone would be a quarter.
    assert abs(solid / planar - 1) < 0.1, (planar, solid)


if __name__ == "__main__":
    main()
