"""The report of a run: gathers what is there, says what is missing, and lays it out as one HTML file."""

import json
import math

from snapwing_tools import analysis, html_page, plots, provenance, style
from snapwing_tools.analysis import EXPECTED
from snapwing_tools.plots import arrow
from snapwing_tools.text_format import difference, number


_CAPTIONS = {
    "curve": "Force of all arms against the travel of the housing (model: {}). Circles: stable equilibria; diamond: "
             "the unstable one between them.",
    "shapes": "Outline of one arm as the solver found it; the point is the axle. The housing is at the left and moves "
              "down.",
    "maps": "Each cell is one pulse, checked with the reduced model over the uncertainty of the vehicle file. Ring: "
            "the pulse that was sent.",
    "influences": "Energy margin of the pulse with one uncertain number at its low or high end and all others nominal. "
                  "Planned anew for this report; \"another pulse\": it is not the one that the run sent.",
    "travel": "Prediction: the nominal vehicle with the pulse as commanded. Band: the estimator's deviation.",
    "no trajectory": "The predicted trajectory is not available; the plan's numbers are marked instead.",
    "frames": "Every frame of the bridge that was recorded, with what the flight controller reported.",
    "mode": "As estimated from what the vehicle measures; the truth is shown for comparison only.",
}


def _file_name(switch):
    return "travel_" + "".join(c if c.isalnum() else "_" for c in switch.name.replace("->", "_to_")).strip("_")


class Inputs:
    """Everything that a report may be made from; only `run` is needed."""

    def __init__(self, run):
        self.run = run
        self.summary = None        # dict of run_summary.json
        self.maps = {}             # "F->Q" -> OutcomeMap
        self.trajectories = {}     # "F->Q" -> columns of a predicted trajectory
        self.plans = {}            # "F->Q" -> Plan computed again for the report
        self.table = None          # ForceTable, for the arm's shapes
        self.vehicle = None        # (name, parameters, settings)
        self.files = []            # (what, path) of the files that were read, for provenance
        self.commands = []         # command lines that were run, and the one that makes this report again
        self.notes = []            # what could not be had, and why


class Report:
    """A report ready to be written: `verdict`, `html` text and `figures` by name."""

    def __init__(self, inputs):
        self.inputs = inputs
        self.switches = analysis.find_switches(inputs.run)
        self.verdict = analysis.judge(inputs.run, self.switches, inputs.summary)
        self.statistics = analysis.link_statistics(inputs.run)
        self.missing = missing_notes(inputs, self.switches)

    @property
    def rung(self):
        """The model that predicted, as plan or summary name it."""
        for switch in self.switches:
            if switch.plan is not None and switch.plan["nominal_rung"]:
                return str(switch.plan["nominal_rung"])
        return str((self.inputs.summary or {}).get("rung") or "not known")

    @property
    def verdict_sentence(self):
        if self.verdict.good:
            return "Both switches happened."
        if self.verdict.all_happened:
            return "Both switches happened, but the run failed."
        return "Not both switches are shown to have happened."

    @property
    def curve_rung(self):
        curve = self.inputs.run.latched.get("force_curve")
        return str(curve["rung"]) if curve is not None and curve["rung"] else "not known"

    def figures(self):
        """(name, title, caption, figure) in the order of the page; figures whose data is missing are left out."""
        run, found = self.inputs.run, []
        curve, arm = run.latched.get("force_curve"), run.latched.get("arm_geometry")
        if curve is not None and len(curve["travel"]) > 1:
            found.append(("force_curve", "Force and displacement", _CAPTIONS["curve"].format(self.curve_rung),
                          plots.force_curve(curve)))
        shapes = self._shape_entries(curve)
        if shapes:
            found.append(("arm_shapes", "The arm as it snaps", _CAPTIONS["shapes"], plots.arm_shapes(shapes, arm)))
        if self.inputs.maps:
            found.append(("outcome_maps", "What pulses do", _CAPTIONS["maps"], self._maps()))
        if any(plan.influences for plan in self.inputs.plans.values()):
            found.append(("influences", "What the margins hang on", _CAPTIONS["influences"], plots.influences(
                [(name, plan, self._same_pulse(name, plan)) for name, plan in self.inputs.plans.items()])))
        for switch in self.switches:
            trajectory = self.inputs.trajectories.get(switch.name)
            found.append((_file_name(switch), "Switch " + arrow(switch.name),
                          _CAPTIONS["travel" if trajectory is not None else "no trajectory"],
                          plots.travel(run, switch, trajectory)))
        if run.has("link_status"):
            found.append(("frames", "Commanded and sent", _CAPTIONS["frames"], plots.frames(run, self.switches)))
        if run.has("mode_state"):
            found.append(("mode_probability", "Which mode it is in", _CAPTIONS["mode"],
                          plots.mode_probability(run, self.switches)))
        if self.statistics is not None and len(self.statistics.periods):
            found.append(("link", "The link", "", plots.link(self.statistics)))
        return found

    def _shape_entries(self, curve):
        table = self.inputs.table
        if table is None or not table.moved:
            return []
        wanted = [("F", 0.0)]
        if curve is not None:
            wanted += [("peak", float(curve["peak_travel"])), ("Q", float(curve["second_travel"]))]
        wanted.append(("stretched", 0.070))
        return [(title,) + table.shape_at(u) for title, u in wanted if math.isfinite(u)]

    def _maps(self):
        entries = []
        for name, outcome in self.inputs.maps.items():
            pulses = [(switch.throttle, switch.duration, "pulse of this run: {:.0f} %, {:.0f} ms".format(
                switch.throttle * 100, switch.duration * 1e3)) for switch in self.switches if switch.name == name]
            entries.append((name, outcome, pulses))
        return plots.outcome_maps(entries)

    def _same_pulse(self, name, plan):
        """Is a plan computed for the report that of the run? (It is, unless the run's planner was set differently.)"""
        return any(switch.name == name and math.isclose(switch.throttle, plan.throttle, abs_tol=1e-6)
                   and math.isclose(switch.duration, plan.duration, abs_tol=1e-6) for switch in self.switches)

    def html(self, figures):
        """The page. `figures` is what figures() gave; they are closed by this."""
        body = [html_page.header(self), html_page.comparison(self)]
        if self.missing or self.verdict.notes or self.inputs.notes:
            body.append(html_page.notes(self.missing, self.verdict.notes + self.inputs.notes))
        for name, title, caption, fig in figures:
            extra = html_page.link_table(self.statistics) if name == "link" else ""
            body.append(html_page.figure(name, title, caption, style.svg_text(fig), extra))
        accidents = next((plan.accidents for plan in self.inputs.plans.values() if plan.accidents), [])
        if accidents:
            body.append(html_page.accidents(accidents))
        if self.inputs.vehicle is not None:
            body.append(html_page.vehicle(*self.inputs.vehicle))
        body.append(html_page.provenance_section(self, provenance_rows(self.inputs)))
        return html_page.page("snapwing: report of a run", "\n".join(body))


def missing_notes(inputs, switches):
    """One sentence for everything that the run lacks, and for how the recording ended."""
    run, notes = inputs.run, []
    for topic in run.missing_topics():
        notes.append("Nothing was recorded of {}; it would have shown: {}.".format(topic.name, topic.needed_for))
    if run.attributes.get("ended") == "recording":
        notes.append("The recorder did not end by itself: it still ran, or it was killed. This is its last automatic "
                     "save; the record ends at {:.1f} s.".format(analysis.last_time(run)))
    for switch in switches:
        if switch.plan is None and run.has("transition_plan"):
            notes.append("{}: no accepted plan belongs to this pulse, so nothing was predicted.".format(switch.name))
        if switch.true is not None and switch.true.end_mode is None:
            notes.append("{}: the record ends too soon after the pulse to tell the end mode.".format(switch.name))
        sent = switch.sent
        if sent is not None and sent.duration < switch.whole - 2 * sent.period:
            notes.append("{}: the bridge sent the pulse for {:.0f} ms only, {:.0f} ms were commanded.".format(
                switch.name, sent.duration * 1e3, switch.whole * 1e3))
    if run.has("link_status") and analysis.last_time(run) - run.series["link_status"]["time"][-1] > 0.5:
        notes.append("The bridge's frames end at {:.1f} s, the record at {:.1f} s: the bridge stopped, or its status "
                     "did.".format(run.series["link_status"]["time"][-1], analysis.last_time(run)))
    if inputs.summary is None:
        notes.append("No summary of the scenario was given; what happened is judged from the record alone.")
    curve = run.latched.get("force_curve")
    if inputs.table is not None and curve is not None:
        known = inputs.table.provenance.get("inputs_sha256")
        if known and curve["inputs_sha256"] and known != curve["inputs_sha256"]:
            notes.append("The force table given for the arm's shapes is not the one that the run used.")
    return notes


def parameters_of(run):
    """{full name: value} of the nodes' parameters at the start of the run."""
    try:
        return {str(key): str(value) for key, value in json.loads(run.attributes.get("parameters", "{}")).items()}
    except (ValueError, AttributeError):
        return {}


def provenance_rows(inputs):
    """(what, value) pairs that tie the report to its inputs."""
    run = inputs.run
    rows = [("recorded with snapwing", run.attributes.get("snapwing_version", "unknown")),
            ("report made with snapwing", provenance.package_version())]
    for what, path in inputs.files:
        rows.append((what, "{}  sha256 {}".format(path, provenance.sha256_of_file(path) or "not readable")))
    curve, arm = run.latched.get("force_curve"), run.latched.get("arm_geometry")
    if curve is not None:
        rows.append(("force curve: inputs' sha256", curve["inputs_sha256"] or "not given"))
    if arm is not None:
        rows.append(("arm density: sha256", arm["density_sha256"] or "not given"))
    if inputs.table is not None:
        rows += [("force table: " + key.replace("_", " "), value)
                 for key, value in sorted(inputs.table.provenance.items())]
    rows += [("parameter " + key, value) for key, value in sorted(parameters_of(run).items())]
    for key in ("vehicle_file", "vehicle_sha256", "recorder_command", "python", "numpy", "system", "ros_distro"):
        if run.attributes.get(key):
            rows.append(("run: " + key.replace("_", " "), str(run.attributes[key])))
    return rows


_COLUMNS = "    {:36s}{:>12s}{:>12s}{:>12s}{:>12s}"


def terminal_summary(report, output=""):
    """The same in plain text."""
    lines = ["snapwing report: " + report.verdict_sentence]
    for name in EXPECTED:
        lines.append("  {:5s} {}".format(name, report.verdict.status[name]))
    lines.append("  predicted with: {}; force curve: {}".format(report.rung, report.curve_rung))
    for switch in report.switches:
        lines.append("")
        lines.append("  {}  throttle {:.0f} %, {:.0f} ms, commanded at {:.2f} s".format(
            switch.name, switch.throttle * 100, switch.duration * 1e3, switch.start))
        lines.append(_COLUMNS.format("", "predicted", "worst case", "happened", "difference"))
        for label, unit, nominal, worst, happened in analysis.comparison_rows(switch):
            lines.append(_COLUMNS.format(label, number(nominal, unit), number(worst, unit), number(happened, unit),
                                         difference(unit, nominal, happened)))
    link = report.statistics
    if link is not None:
        lines.append("")
        lines.append("  link: {} frames, period median {:.1f} ms, worst {:.1f} ms, {} over {:.0f} ms; {} frames not "
                     "seen by the recorder; {:.1f} s of failsafe".format(
                         link.frames, link.median * 1e3, link.worst * 1e3, link.late, analysis.LATE_SECONDS * 1e3,
                         link.unseen, link.failsafe_seconds))
        lines += ["  link fault: " + text for text in link.faults]
    lines += ["  note: " + text for text in report.missing + report.verdict.notes + report.inputs.notes]
    if output:
        lines.append("  report: " + output)
    return "\n".join(lines)
