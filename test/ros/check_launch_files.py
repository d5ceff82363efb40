"""Each launch file can be read with its defaults (includes: with what they require), and each argument has its doc."""
import pathlib
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
REQUIRED = {"vehicle_file": "config/vehicles/arris_x220.yaml", "fc": "tcp:127.0.0.1:1",
            "vehicle": "config/vehicles/arris_x220.yaml", "into": "made"}


def problems(path):
    found = []
    arguments = [a for a in ElementTree.parse(path).getroot().findall("arg") if "value" not in a.attrib]
    found += [f"argument {a.get('name')} has no doc" for a in arguments if not a.get("doc")]
    given = [f"{a.get('name')}:={REQUIRED[a.get('name')]}" for a in arguments if a.get("default") is None]
    done = subprocess.run(["roslaunch", "--nodes", str(path)] + given, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, check=False, cwd=ROOT)
    if done.returncode != 0:
        found.append(done.stdout.strip())
    return found


def main():
    files = sorted(pathlib.Path(sys.argv[1]).rglob("*.launch"))
    bad = [f"{path.name}: {problem}" for path in files for problem in problems(path)]
    print("\n".join(bad) or f"{len(files)} launch files are good")
    return 0 if files and not bad else 1


if __name__ == "__main__":
    sys.exit(main())
