"""The report as a user meets it: through the command, with good, partial and bad inputs."""

import contextlib
import io
import json
import os
import re
import stat
import tempfile
import unittest
from html import escape
from html.parser import HTMLParser
from unittest import mock

import h5py
import matplotlib.pyplot as plt
import matplotlib.text

import synthetic_run
from snapwing_tools import inputs, provenance, report_command, scenario_summary, style
from snapwing_tools.errors import InputError
from snapwing_tools.report import Inputs, Report
from snapwing_tools.run_file import read_run, write_run
from snapwing_tools.text_format import difference, number

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
VEHICLE = os.path.join(ROOT, "config", "vehicles", "arris_x220.yaml")
VOID = {"meta", "path", "use", "image", "rect", "br"}


class Checker(HTMLParser):
    """Sees that tags are closed in order, and collects what would be fetched and the headings."""

    def __init__(self, text):
        super().__init__()
        self.open, self.wrong, self.fetched, self.headings = [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        if tag not in VOID:
            self.open.append(tag)
        self.fetched += [value for name, value in attributes if name in ("src", "href", "xlink:href")
                         and not value.startswith(("#", "data:"))]

    def handle_startendtag(self, tag, attributes):
        self.fetched += [value for name, value in attributes if name in ("src", "href", "xlink:href")
                         and not value.startswith(("#", "data:"))]

    def handle_endtag(self, tag):
        if tag in VOID:
            return
        if not self.open or self.open.pop() != tag:
            self.wrong.append(tag)

    def handle_data(self, data):
        if self.open and self.open[-1] == "h2":
            self.headings.append(data)


def undrawn(fig):
    """Stands in for style.svg_text: the figure's texts."""
    texts = [text.get_text() for text in fig.findobj(match=matplotlib.text.Text)]
    plt.close(fig)
    return "<svg>{}</svg>".format("".join("<text>{}</text>".format(escape(text)) for text in texts))


class Command(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.keep = tempfile.TemporaryDirectory()
        cls.good = os.path.join(cls.keep.name, "good.h5")
        synthetic_run.make_buffer().save(cls.good, "closed")

    @classmethod
    def tearDownClass(cls):
        cls.keep.cleanup()

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.output = self.path("report.html")

    def tearDown(self):
        self.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def make(self, *arguments, draw=False):
        """Runs the command; (exit code, stdout, stderr). Turning figures into SVG takes most of the time: with
        `draw` it is done, else they are only made."""
        out, err = io.StringIO(), io.StringIO()
        svg = style.svg_text if draw else undrawn
        quiet = mock.patch.object(style, "svg_text", svg)
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), quiet:
            code = report_command.main([str(argument) for argument in arguments] + ["-o", self.output])
        return code, out.getvalue(), err.getvalue()

    def page(self):
        with open(self.output, encoding="utf-8") as file:
            return file.read()

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)
        return self.path(name)

    def full(self):
        synthetic_run.write_force_table(self.path("table.h5"))
        synthetic_run.write_map(self.path("f.csv"))
        synthetic_run.write_map(self.path("q.csv"), "Q->F")
        synthetic_run.write_trajectory(self.path("tf.csv"))
        synthetic_run.write_trajectory(self.path("tq.csv"), "Q->F")
        summary = self.summary()
        return ["--vehicle", VEHICLE, "--table", self.path("table.h5"), "--map", "F", self.path("f.csv"), "--map", "Q",
                self.path("q.csv"), "--trajectory", "F", self.path("tf.csv"), "--trajectory", "Q", self.path("tq.csv"),
                "--summary", summary]

    def summary(self, **changes):
        """A scenario's outcome as its own writer stores it; both switches good but for `changes` of the first."""
        outcome = scenario_summary.Outcome(vehicle="made_up", curve_rung="made up")
        for start, target in ((1, 2), (2, 1)):
            switch = scenario_summary.Switch(start, target, code=0, estimated_mode=target, rung="lumped")
            switch.happened.start_mode, switch.happened.end_mode = start, target
            outcome.switches.append(switch)
        for name, value in changes.items():
            setattr(outcome.switches[0], name, value)
        scenario_summary.write_result(outcome, self.path("summary.json"))
        return self.path("summary.json")

    def write_plan(self, throttle):
        content = {"plan": {"pulse": {"throttle": throttle, "duration": 0.3}, "nominal": {"energy_margin": 0.7},
                            "influences": [{"name": "drag", "low_margin": 0.2, "high_margin": 0.9},
                                           {"name": "lag", "low_margin": 0.6, "high_margin": None}]},
                   "accidents": [{"name": "gust", "explanation": "wind", "mode": "F", "unit": "N", "limit": 9.0,
                                  "occurs": 7.5, "holds": True},
                                 {"name": "dive", "explanation": "speed", "mode": "Q", "unit": "m/s", "limit": None,
                                  "occurs": None, "holds": False}]}
        return self.write("plan.json", json.dumps(content))

    def test_full_report(self):
        code, out, err = self.make(self.good, *self.full(), "--figures", self.path("png"), "--require-success",
                                   draw=True)
        self.assertEqual((code, err), (0, ""))
        self.assertEqual(len(re.findall(r"(F->Q|Q->F) +happened", out)), 2)
        page = self.page()
        checker = Checker(page)
        self.assertEqual((checker.wrong, checker.open, checker.fetched), ([], [], []))
        for heading in ("Force and displacement", "The arm as it snaps", "What pulses do", "Switch F \u2192 Q",
                        "Switch Q \u2192 F", "Commanded and sent", "Which mode it is in", "The link", "Provenance"):
            self.assertIn(heading, checker.headings)
        self.assertNotIn("What is missing, and remarks", checker.headings)
        self.assertIn("Both switches happened", page)
        self.assertIn("masses.total", page)
        self.assertEqual(page.count("<svg"), 8)
        self.assertEqual(len(os.listdir(self.path("png"))), 8)

    def test_figures_follow_the_theme(self):
        self.make(self.good, draw=True)
        pictures = re.findall(r"<svg.*?</svg>", self.page(), re.DOTALL)
        self.assertGreater(len(pictures), 4)
        for picture in pictures:
            self.assertIn("var(--ink)", picture)
            for light, _ in style.PALETTE.values():
                self.assertNotIn(light, picture.lower())

    def test_same_inputs_give_the_same_page(self):
        short = self.path("short.h5")
        synthetic_run.make_buffer({"F->Q": (0.5, 0.55, 0.3)}, seconds=2.0).save(short, "closed")
        self.make(short, "--vehicle", VEHICLE, draw=True)
        first = self.page()
        self.make(short, "--vehicle", VEHICLE, draw=True)
        self.assertEqual(self.page(), first)

    def test_partial_run_says_what_is_missing(self):
        for gone in (("truth", "imu"), ("mode_state", "arm_geometry"), ("link_status", "transition_plan"),
                     ("command/pulse", "force_curve"), ("truth", "mode_state", "link_status")):
            with self.subTest(gone):
                synthetic_run.make_buffer(leave_out=gone).save(self.path("run.h5"), "recording")
                code, out, _ = self.make(self.path("run.h5"), draw="truth" in gone)
                self.assertEqual(code, 0)
                page = self.page()
                for topic in gone:
                    self.assertIn("Nothing was recorded of {};".format(topic), out)
                    self.assertIn("Nothing was recorded of {};".format(topic), page)
                self.assertIn("did not end by itself", page)

    def test_empty_run_still_gives_a_page(self):
        synthetic_run.RunBuffer(0.0).save(self.path("run.h5"), "closed")
        code, out, _ = self.make(self.path("run.h5"), "--require-success")
        self.assertEqual(code, 1)
        self.assertIn("not known", out)
        self.assertIn("Not both switches are shown to have happened", self.page())

    def test_failed_switch_is_not_hidden(self):
        synthetic_run.make_buffer({"F->Q": (2.0, 0.12, 0.3)}).save(self.path("run.h5"), "closed")
        summary = self.summary()
        code, out, _ = self.make(self.path("run.h5"), "--summary", summary, "--require-success")
        self.assertEqual(code, 1)
        self.assertIn("did not happen", out)
        self.assertIn("the scenario says it succeeded", self.page())

    def test_bridge_that_died_in_the_pulse_is_reported(self):
        buffer = synthetic_run.make_buffer()
        run = buffer.to_run("closed")
        link = run.series["link_status"]
        alive = link["time"] < 2.1
        run.series["link_status"] = {name: data[alive] for name, data in link.items()}
        write_run(self.path("run.h5"), run)
        summary = self.summary(code=3, message="link lost")
        code, out, _ = self.make(self.path("run.h5"), "--summary", summary, "--require-success")
        self.assertEqual(code, 1)
        self.assertRegex(out, "F->Q: the bridge sent the pulse for [0-9]+ ms only, 300 ms were commanded")
        self.assertRegex(out, "frames end at 2.1 s, the record at 10.0 s")
        self.assertIn("Both switches happened, but the run failed", self.page())
        self.assertIn("link lost", self.page())

    def test_hostile_text_is_escaped(self):
        buffer = synthetic_run.make_buffer(provenance={"recorder_command": "<script>alert(1)</script>"})
        buffer.save(self.path("run.h5"), "closed")
        self.make(self.path("run.h5"))
        self.assertNotIn("<script>", self.page())
        self.assertIn("&lt;script&gt;", self.page())

    def refused(self, pattern, *arguments):
        code, out, err = self.make(*arguments)
        self.assertEqual(code, 2, err)
        self.assertRegex(err, pattern)
        self.assertEqual(err.count("\n"), 1)
        self.assertFalse(os.path.exists(self.output))

    def test_bad_inputs_give_one_line_and_2(self):
        empty = self.write("empty", "")
        words = self.write("words.csv", "throttle,duration_s,share_switched,worst_margin\n0.1,0.2,much,0\n")
        columns = self.write("columns.csv", "throttle,seconds\n0.1,0.2\n")
        header = self.write("header.csv", "throttle,duration_s,share_switched,worst_margin\n")
        share = self.write("share.csv", "throttle,duration_s,share_switched,worst_margin\n" + "".join(
            "{},{},1.5,0\n".format(a, b) for a in (0, 1) for b in (0, 1)))
        self.refused("no such file", self.path("absent.h5"))
        self.refused("empty: the file is empty", empty)
        self.refused("not an HDF5", columns)
        cut = self.path("cut.h5")
        with open(self.good, "rb") as whole, open(cut, "wb") as file:
            file.write(whole.read()[:4000])
        self.refused("cut off", cut)
        self.refused("column 'duration_s' is missing; found throttle, seconds", self.good, "--map", "F", columns)
        self.refused("line 2, column 'share_switched': 'much' is not a number", self.good, "--map", "F", words)
        self.refused("a header but no rows", self.good, "--map", "F", header)
        self.refused("share_switched = 1.5 is outside 0 .. 1", self.good, "--map", "F", share)
        self.refused("expected F or Q", self.good, "--map", "X", words)
        self.refused("column 'time_s' is missing", self.good, "--trajectory", "F", columns)
        self.refused("the file is empty", self.good, "--summary", empty)
        self.refused("not JSON", self.good, "--summary", columns)
        self.refused("list 'switches'", self.good, "--summary", self.write("a.json", "[]"))
        self.refused("needs 'start' and 'target'", self.good, "--summary",
                     self.write("b.json", '{"ok": true, "switches": [{"ok": true}]}'))
        self.refused("'ok' must be", self.good, "--summary", self.write("c.json", '{"ok": 1, "switches": []}'))
        self.refused("--map-size 1", self.good, "--vehicle", VEHICLE, "--snapwing", "/bin/true", "--map-size", "1")
        self.refused("no vehicle file", self.good, "--vehicle", self.write("v.yaml", "a: 1\n"))
        self.refused("not YAML", self.good, "--vehicle", self.write("w.yaml", "a: [1\n"))
        self.refused("not a program", self.good, "--vehicle", VEHICLE, "--snapwing", columns)
        self.refused("--snapwing needs --vehicle", self.good, "--snapwing", "/bin/true")
        self.refused("no force table", self.good, "--table", self.good)

    def test_another_vehicle_than_the_runs_is_refused(self):
        with open(VEHICLE, encoding="utf-8") as file:
            text = file.read()
        renamed = self.write("renamed.yaml", text.replace("name: arris_x220", "name: other"))
        self.refused("the run is of the vehicle 'arris_x220'.*is of 'other'", self.good, "--vehicle", renamed)
        recorded = self.path("recorded.h5")
        known = {"vehicle_sha256": provenance.sha256_of_file(VEHICLE), "vehicle_file": VEHICLE}
        synthetic_run.make_buffer(provenance=known).save(recorded, "closed")
        edited = self.write("edited.yaml", text.replace("value: 0.783", "value: 0.790"))
        self.refused("other contents of the vehicle file.*give the file of the run", recorded, "--vehicle", edited)
        self.assertEqual(self.make(recorded, "--vehicle", VEHICLE, "--table", self.full()[3])[0], 0)
        code, out, _ = self.make(recorded, "--vehicle", edited, "--other-vehicle", "--table", self.full()[3])
        self.assertEqual(code, 0)
        self.assertIn("Compared with another vehicle", out)

    def test_table_of_another_arm_is_refused(self):
        other = self.path("other.h5")
        synthetic_run.write_force_table(other)
        with h5py.File(other, "r+") as file:
            file["provenance"].attrs["inputs_sha256"] = "ef" * 32
        self.refused("another force table", self.good, "--table", other)

    def test_output_that_cannot_be_written(self):
        self.output = self.path("absent/report.html")
        self.refused("cannot write", self.good)

    def program(self, script):
        path = self.write("program", "#!/bin/sh\n" + script)
        os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)
        return path

    def test_command_line_fills_in_maps_and_trajectories(self):
        self.full()
        self.write_plan(synthetic_run.PULSES["F->Q"][1])
        program = self.program(
            'what=$1; while [ $# -gt 0 ]; do case $1 in --from) from=$2;; --map|--csv) out=$2;; --json) plan=$2;; esac;'
            ' shift; done\ncd {}\n'
            'case $what$from in planF) cp f.csv $out; cp plan.json $plan;; planQ) cp q.csv $out;'
            ' echo no > $plan; exit 1;; predictF) cp tf.csv $out;; predictQ) cp tq.csv $out;; esac\n'.format(self.folder.name))
        code, out, _ = self.make(self.good, "--vehicle", VEHICLE, "--snapwing", program, "--trial", "--mount boom")
        self.assertEqual(code, 0)
        self.assertNotIn("no outcome map", out)
        self.assertNotIn("no predicted trajectory", out)
        self.assertRegex(out, "Q->F: no list of influences: .*not JSON")
        headings = Checker(self.page()).headings
        self.assertIn("--mount boom", self.page())
        for heading in ("What pulses do", "What the margins hang on", "What may flip the mode by accident"):
            self.assertIn(heading, headings)
        self.assertNotIn(", another pulse</text>", self.page())

    def test_plan_of_another_pulse_is_marked(self):
        plan = inputs.read_plan(self.write_plan(0.9))
        made = Inputs(read_run(self.good))
        made.plans["F->Q"] = plan
        report = Report(made)
        figures = [entry for entry in report.figures() if entry[0] == "influences"]
        self.assertIn(", another pulse</text>", report.html(figures))

    def test_program_of_the_workspace_is_found(self):
        os.makedirs(self.path("devel/lib/snapwing"))
        program = self.program("echo from the workspace; exit 2\n")
        os.rename(program, self.path("devel/lib/snapwing/snapwing"))
        for prefix, expected in ((self.path("devel"), "ended with 2: from the workspace"),
                                 (self.path("absent"), "was not found in the workspace")):
            with mock.patch.dict(os.environ, {"CMAKE_PREFIX_PATH": self.path("other") + ":" + prefix}):
                code, out, _ = self.make(self.good, "--vehicle", VEHICLE, "--snapwing", "auto")
            self.assertEqual(code, 0)
            self.assertIn(expected, out)

    def test_command_line_that_fails_is_reported(self):
        program = self.program("echo no table >&2; exit 2\n")
        code, out, _ = self.make(self.good, "--vehicle", VEHICLE, "--snapwing", program)
        self.assertEqual(code, 0)
        self.assertIn("no outcome map: 'snapwing plan' ended with 2: no table", out)
        self.assertIn("no predicted trajectory: 'snapwing predict' ended with 2: no table", out)


class Readers(unittest.TestCase):
    def test_shipped_vehicle_lists_every_number_with_its_source(self):
        name, parameters, settings = inputs.read_vehicle(VEHICLE)
        self.assertEqual(name, "arris_x220")
        self.assertGreater(len(parameters), 40)
        for parameter in parameters:
            self.assertTrue(parameter.unit and parameter.source, parameter.name)
            self.assertIsInstance(parameter.value, (int, float), parameter.name)
        self.assertIn("arm.table_file", settings)

    def test_force_table_shapes_belong_to_their_travel(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "t.h5")
            synthetic_run.write_force_table(path)
            table = inputs.read_force_table(path)
        loops, travel = table.shape_at(0.0511)
        self.assertEqual(travel, 0.0511)
        self.assertEqual(table.shape_at(0.2)[1], table.travel[-1])
        self.assertEqual([len(loop) for loop in loops], [6, 4])
        self.assertAlmostEqual(loops[0][0][1], -travel, places=12)

    def test_map_order_does_not_matter(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "m.csv")
            with open(path, "w") as file:
                file.write("# made by hand\nworst_margin,throttle,share_switched,duration_s\n"
                           "-1,0.5,0,0.2\n2,0.9,1,0.2\n1,0.9,1,0.1\n-2,0.5,0.25,0.1\n")
            found = inputs.read_outcome_map(path)
        self.assertEqual(found.margin.tolist(), [[-2, -1], [1, 2]])
        self.assertEqual(found.share.tolist(), [[0.25, 0], [1, 1]])

    def test_summary_counts_a_switch_only_if_truth_and_estimate_agree(self):
        outcome = scenario_summary.Outcome()
        # The fourth ended in the target because it had been there all the time.
        for before, true, estimated, code in ((1, 2, 2, 0), (1, 1, 2, 0), (1, 2, 0, 0), (2, 2, 2, 0), (1, 2, 2, 3)):
            switch = scenario_summary.Switch(1, 2, code=code, estimated_mode=estimated, message="because")
            switch.happened.start_mode, switch.happened.end_mode = before, true
            outcome.switches.append(switch)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "s.json")
            scenario_summary.write_result(outcome, path)
            found = inputs.read_summary(path)
        self.assertEqual([entry["ok"] for entry in found["switches"]], [True, False, False, False, False])
        self.assertFalse(found["ok"])
        self.assertTrue(found["reason"])

    def test_trajectory_must_run_forward(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "t.csv")
            with open(path, "w") as file:
                file.write("time_s,travel_m\n0,0\n0.2,0\n0.1,0\n")
            with self.assertRaisesRegex(InputError, "time_s decreases"):
                inputs.read_trajectory(path)

    def test_numbers_of_tables(self):
        self.assertEqual(number(float("nan"), "mm"), "\u2013")
        self.assertEqual(number(12.34, "mm"), "12.3 mm")
        self.assertEqual(number(-0.5, "1"), "-0.50")
        self.assertEqual(difference("ms", 10.0, 14.0), "+4 ms")
        self.assertEqual(difference("", "Q", "F"), "differs")


if __name__ == "__main__":
    unittest.main()
