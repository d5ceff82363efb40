"""clang-tidy on what has changed (.clang-tidy names the checks; each finding is an error): uncommitted and committed since `main`, or the
last commit where HEAD is main itself; only changed lines are judged. Where that is nothing, on a few core files, so that the test is never empty. Headers are seen through a
source that includes them. scripts/check_all looks at all files.
usage: test_tidy.py BUILD_FOLDER [--all | FILE...]"""
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
CORE = ["src/common/settings_reader.cpp", "src/elasticity/material.cpp", "src/rom/lumped_model.cpp", "src/link/bridge_core.cpp"]
MOST = 8  # files; half a minute of CPU each at worst. Of a larger change the rest is left to scripts/check_all, and said.


def git(*words):
    done = subprocess.run(["git", "-C", str(ROOT), *words], capture_output=True, text=True, check=False)
    return done.stdout.split() if done.returncode == 0 else []


def changed():
    """@return tracked C++ files that differ from main, or from the commit before, and the lines that do: name -> [[first, last], ...]"""
    head = git("rev-parse", "HEAD")
    for base in git("merge-base", "HEAD", "origin/main") + git("merge-base", "HEAD", "main") + git("rev-parse", "HEAD~1"):
        done = subprocess.run(["git", "-C", str(ROOT), "diff", "-U0", "--diff-filter=d", "--no-prefix", base, "--", "*.cpp", "*.h"],
                              capture_output=True, text=True, errors="replace", check=False)
        found, name = {}, None
        for line in done.stdout.splitlines():
            if line.startswith("+++ "):
                name = line[4:]
                found[name] = []
            elif hunk := re.match(r"@@ \S+ \+(\d+)(?:,(\d+))? @@", line):
                first, count = int(hunk[1]), int(hunk[2] or 1)
                if count:
                    found[name].append([first, first + count - 1])
        if [base] != head or found:
            return {name: lines for name, lines in found.items() if lines}
    return {}


def database(build):
    """@return how each source is compiled, without what only gcc understands: source -> command"""
    entries = json.loads((pathlib.Path(build) / "compile_commands.json").read_text())
    found = {}
    for entry in entries:
        command = re.sub(r" -Winvalid-pch| -Wno-maybe-uninitialized| -include \S*cmake_pch\.hxx(?:\.\w+)?| -fpch-\S+", "", entry["command"])
        name = os.path.relpath(os.path.join(entry["directory"], entry["file"]), ROOT)
        if name.endswith(".cpp") and not name.startswith("..") and not name.startswith(os.path.relpath(build, ROOT)):
            found[name] = {"directory": entry["directory"], "file": entry["file"], "command": command}
    return found


def sources_of(names, known):
    """@return the changed sources, and for each changed header one source that includes it"""
    found = [name for name in names if name in known]
    for name in names:
        if name.endswith(".h"):
            include = name.removeprefix("include/") if name.startswith("include/") else pathlib.Path(name).name
            using = [source for source in known if f'"{include}"' in (ROOT / source).read_text(errors="replace")]
            same = [source for source in using if pathlib.Path(source).stem == pathlib.Path(name).stem]
            if using and not set(using) & set(found):
                found.append((same or using)[0])
    return found


def tidy(name, folder, lines):
    """@param lines  name -> ranges to which findings are limited; none: all lines"""
    only = [f"--line-filter={json.dumps([{'name': file, 'lines': ranges} for file, ranges in lines.items()])}"] if lines else []
    done = subprocess.run(["clang-tidy", "--quiet", "-p", folder, *only, str(ROOT / name)], capture_output=True, text=True, check=False)
    errors = [line for line in done.stdout.splitlines() if ": error: " in line or ": warning: " in line]
    return name, errors or ([] if done.returncode == 0 else [done.stdout + done.stderr])


def main():
    build, asked = sys.argv[1], sys.argv[2:]
    known, lines = database(build), {}
    if asked == ["--all"]:
        names, why = list(known), "all files"
    elif asked:
        names, why = sources_of(asked, known), "files as asked"
    else:
        lines = changed()
        names, why = sources_of(lines, known), "files of the change, its lines alone"
        if len(names) > MOST:
            print(f"{len(names) - MOST} more of the change are left to scripts/check_all")
            names = names[:MOST]
        if not names:
            names, why, lines = CORE, "core files, since nothing has changed", {}
    print(f"clang-tidy on {len(names)} {why}", flush=True)
    found = set()
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "compile_commands.json").write_text(json.dumps(list(known.values())))
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            for task in concurrent.futures.as_completed([pool.submit(tidy, name, folder, lines) for name in names]):
                name, errors = task.result()
                print(f"{name}: {len(errors)} findings", flush=True)
                found.update(errors)
    print(*sorted(found), sep="\n")
    return 1 if found or not names else 0


if __name__ == "__main__":
    sys.exit(main())
