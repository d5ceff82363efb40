"""Prints "N passed, N failed" from CTest's JUnit files; exit code 1 if anything failed or nothing ran at all."""
import sys
import xml.etree.ElementTree as ElementTree


def count(path):
    """Numbers of passed and failed tests; a test that could not run counts as failed."""
    passed = failed = 0
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        good = case.get("status") == "run" and case.find("failure") is None
        passed, failed = passed + good, failed + (not good)
    return passed, failed


def main():
    try:
        counts = [count(path) for path in sys.argv[1:]]
        passed, failed = (sum(column) for column in zip(*counts))
    except (OSError, ElementTree.ParseError) as error:
        print(f"no test results: {error}", file=sys.stderr)
        passed, failed = 0, 1
    print(f"{passed} passed, {failed} failed")
    return 0 if passed and not failed else 1


if __name__ == "__main__":
    sys.exit(main())
