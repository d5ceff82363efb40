"""What the documents name exists: links, files of this repository, options of its programs, commands of `snapwing`."""
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
FOLDERS = "action|bench|config|data|docs|examples|include|launch|lcm|msg|python|rviz|scripts|src|srv|test"
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")
PATH = re.compile(rf"(?<![\w/.-])((?:{FOLDERS})/[\w./-]*\w)")
OPTION = re.compile(r"(?<![\w-])--[a-z][\w-]+")
COMMAND = re.compile(r"(?:scripts/|`|rosrun snapwing |^    )snapwing ([a-z]+)", re.MULTILINE)
FOREIGN = {"--gtest_output", "--clock"}  # options of other people's programs
EXAMPLES = {"config/scenes/NAME.yaml"}


def texts(*folders):
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.is_file() and path.suffix in ("", ".cpp", ".h", ".py", ".bash", ".cmake", ".txt", ".launch"):
                yield path.read_text(encoding="utf-8", errors="replace")


class Documents(unittest.TestCase):
    def missing(self, pattern, exists):
        found = [(page, word) for page in DOCUMENTS for word in pattern.findall(page.read_text(encoding="utf-8"))]
        self.assertGreater(len(found), 40, "too few to be true: the pattern no longer fits")
        return sorted({f"{page.relative_to(ROOT)}: {word}" for page, word in found if not exists(page, word)})

    def test_links_lead_somewhere(self):
        self.assertEqual(self.missing(LINK, lambda page, word: "://" in word or (page.parent / word).exists()), [])

    def test_named_files_exist(self):
        """A name may leave out its ending, as `src/standin/standin_*.cpp` and `test/link/override_test` do."""
        self.assertEqual(self.missing(PATH, lambda _, word: word in EXAMPLES or any(ROOT.glob(word + "*"))), [])

    def test_options_are_some_programs(self):
        code = "\n".join(texts("src", "scripts", "test", "examples", "bench", "python"))
        self.assertEqual(self.missing(OPTION, lambda _, word: word in FOREIGN or re.search(re.escape(word) + r"(?![\w-])", code)), [])

    def test_commands_are_snapwings(self):
        code = "\n".join(texts("src/tools"))
        self.assertEqual(self.missing(COMMAND, lambda _, word: re.search(r"add_subcommand\(\s*\"" + word + "\"", code)), [])


if __name__ == "__main__":
    sys.exit(unittest.main())
