"""Every benchmark compiles. CI does not build them (SNAPWING_BENCH), so without this they would rot unseen. Looked at by the compiler only (no code
is made), with the command that compiles a test.
usage: test_bench.py BUILD_FOLDER"""
import concurrent.futures
import json
import pathlib
import re
import shlex
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
ELSEWHERE = {"peer_simbody"}  # needs a library that only its own packages.txt names
LIKE = ROOT / "test/statics/test_truss.cpp"


def sources():
    return sorted(path for path in (ROOT / "bench").rglob("*.cpp") if path.parent.name not in ELSEWHERE)


def command(build):
    """@return folder and words of the test's command, without its input and output"""
    entries = json.loads((pathlib.Path(build) / "compile_commands.json").read_text())
    entry = next(entry for entry in entries if pathlib.Path(entry["directory"], entry["file"]).resolve() == LIKE)
    return entry["directory"], shlex.split(re.sub(r"\s-o\s\S+|\s-c\s\S+", "", entry["command"]))


def compiled(source, folder, words):
    done = subprocess.run([*words, "-fsyntax-only", str(source)], cwd=folder, capture_output=True, text=True, check=False)
    return source.relative_to(ROOT), done.returncode, done.stderr


def main():
    folder, words = command(sys.argv[1])
    found = sources()
    if len(found) < 10:
        sys.exit(f"only {len(found)} benchmarks found below {ROOT / 'bench'}: they have moved, and nothing is looked at")
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda source: compiled(source, folder, words), found))
    for name, status, text in results:
        print(f"{name}: {'compiles' if status == 0 else text}")
    sys.exit(any(status for _, status, _ in results))


if __name__ == "__main__":
    main()
