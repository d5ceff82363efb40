"""The paper's experiments as simulated: figures, and the table of what the paper says beside what came out.

The paper: X. Li, J. McWilliams, M. Li, C. Sung, C. Jiang, "Soft Hybrid Aerial Vehicle via Bistable Mechanism"."""

import csv
import io
import itertools
import json
import math

import numpy as np

from snapwing_tools import html_page, style
from snapwing_tools.errors import InputError

COLOURS = (style.BLUE, style.VERMILION, style.GREEN)
BOOM_LENGTH = 0.987  # [m] paper
AGREES, DISAGREES, PARTLY, OPEN = "agrees", "DISAGREES", "partly", "not run"
WAYS = {"f_to_q": ("F", "Q"), "q_to_f": ("Q", "F")}
# Wings on the soft arms with a stop at rest, and with something else.
ASSUMPTIONS = {"cut": "no push after the pulse", "free": "no stop at rest", "tied": "cranks tied to the path"}
# What would keep a wing from running through its dead point, one at a time.
REMEDIES = {"fold_stop": "arm's end stopped at the wing's design", "bias": "central fold biased"}
# Friction at which wings stay folded.
STIFF = {"stiff": "both wings 20 x friction", "stiff_uneven": "left wing 20, right wing 30 x friction"}
SETTLED = 15.0  # [deg] by which a wing at rest in F may be off
FOLDED = 90.0  # [deg] from which on a wing counts as folded
FRICTIONS = {"even": "even friction", "uneven": "right wing 3 x friction", "film": "both wings 5 x friction (film)"}


class Run:
    """Series (arrays by column) and outcome of one trial."""

    def __init__(self, folder):
        try:
            with open(folder / "series.csv", encoding="utf-8", newline="") as file:
                rows = list(csv.reader(file))
            self.summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise InputError(f"{folder}: {error}; it must hold series.csv and summary.json of `snapwing trial -o`") from error
        columns = np.array([[float(text) if text else np.nan for text in row] for row in rows[1:]]).T
        self.series = dict(zip(rows[0], columns))
        self.outcome, self.pulse = self.summary["outcome"], self.summary["pulse"]

    @property
    def cpu_seconds(self):
        return self.summary.get("cpu_seconds", {}).get("all", 0.0)

    @property
    def switched(self):
        return bool(self.outcome["snapped"])

    def wing(self, side):
        """[deg] without the jump by a whole turn of an angle that runs through half a turn."""
        return np.degrees(np.unwrap(self.series[f"wing_{side}_rad"]))

    @property
    def wings_in_place(self):
        """Both wings end where the end mode has them: at rest in F, folded in Q."""
        ends = [self.wing(side)[-1] for side in ("left", "right")]
        return all(abs(end) < SETTLED if self.outcome["end_mode"] == "F" else end > FOLDED for end in ends)

    def words(self):
        o = self.outcome
        end = {"F": "ends in F", "Q": "ends in Q"}.get(o["end_mode"], "not settled within the horizon")
        snap = f", snap at {1e3 * o['snap_time']:.0f} ms" if o["snap_time"] is not None else ""
        held = "" if o["start_held"] else ", its start is not an equilibrium"
        return f"{end}{snap}, travel {1e3 * o['least_travel']:.1f} .. {1e3 * o['peak_travel']:.1f} mm{held}"

    def label(self):
        return f"{100 * self.pulse['thrust_fraction']:.0f} % for {1e3 * self.pulse['duration']:.0f} ms"


def svg_of(figure):
    """On light paper, so that the file stands by itself; style.svg_text() is for pages only. Closes the figure."""
    text = io.StringIO()
    figure.savefig(text, format="svg", facecolor="white", metadata={"Date": None})
    style.plt.close(figure)
    return text.getvalue()


def canvas(columns=1, height=3.6):
    figure, axes = style.figure(1, columns, height, sharey=True, squeeze=False)
    for axis in axes[0]:
        axis.set_xlabel("time [s]")
    return figure, axes[0]


def draw_levels(axis, runs):
    for key, name in (("static_barrier", "barrier"), ("static_second_equilibrium", "second equilibrium")):
        level = next((run.summary["model"][key] for run in runs if run.summary.get("model", {}).get(key)), None)
        if level:
            axis.axhline(1e3 * level, color=style.MUTED, lw=.8, ls=":")
            axis.annotate(name, (1, 1e3 * level), xycoords=("axes fraction", "data"), ha="right", va="bottom", color=style.MUTED, fontsize=8)


def travel_figure(named):
    """Travel against time of some runs; the bars below are their pulses."""
    figure, (axis,) = canvas()
    draw_levels(axis, list(named.values()))
    for place, ((name, run), colour) in enumerate(zip(named.items(), COLOURS)):
        axis.plot(run.series["time_s"], 1e3 * run.series["travel_m"], color=colour, label=name)
        axis.plot([0, run.pulse["duration"]], [-24 - 3 * place] * 2, color=colour, lw=3, solid_capstyle="butt")
    axis.set_ylabel("travel of the centre [mm]")
    axis.legend(fontsize=8)
    return svg_of(figure)


def wing_figure(runs, way):
    """Angles of both wings: with even, uneven and more friction, with high friction, with other assumptions, with what may stop them when folded."""
    groups = (FRICTIONS, STIFF, ASSUMPTIONS, REMEDIES)
    panels = [[(key, words) for key, words in group.items() if f"hand_{way}_{key}" in runs] for group in groups]
    panels = [panel for panel in panels if panel]
    rows = (len(panels) + 1) // 2
    figure, axes = style.figure(rows, min(len(panels), 2), 3.6 * rows, sharey=True, squeeze=False)
    for axis, panel in itertools.zip_longest(axes.flat, panels):
        if panel is None:
            axis.remove()
            continue
        for (key, words), colour in zip(panel, COLOURS):
            run = runs[f"hand_{way}_{key}"]
            axis.plot(run.series["time_s"], run.wing("left"), color=colour, label=words)
            axis.plot(run.series["time_s"], run.wing("right"), "--", color=colour)
        # Above the panel: the wings swing all over it.
        axis.legend(fontsize=7, loc="lower left", bbox_to_anchor=(0, 1), borderaxespad=0.2, handlelength=1.5)
        axis.set_xlabel("time [s]")
    for axis in axes[:, 0]:
        axis.set_ylabel("wing angle [deg], 0 in F")
    return svg_of(figure)


def boom_wing_figure(run):
    """Angles of the outer and the inner wing on the boom, and how fast it turns."""
    figure, (axis,) = canvas(1, 4)
    for side, words, colour in (("left", "outer wing", COLOURS[0]), ("right", "inner wing", COLOURS[1])):
        axis.plot(run.series["time_s"], run.wing(side), color=colour, label=words)
    axis.set_ylabel("wing angle [deg], 0 in F")
    speed = axis.twinx()
    speed.grid(False)
    speed.plot(run.series["time_s"], run.series["ring_speed_m_per_s"], color=style.MUTED, lw=1, label="speed of the ring")
    speed.set_ylabel("speed [m/s]")
    lines = [*axis.get_lines(), *speed.get_lines()]
    axis.legend(lines, [line.get_label() for line in lines], fontsize=8, loc="center left")
    return svg_of(figure)


def named(runs, *names):
    return {f"{name}: {runs[name].label()}": runs[name] for name in names if name in runs}


def figures(runs):
    """SVG by name; what was not run is left out."""
    found = {}
    for way in WAYS:
        trials = named(runs, *(f"boom_{way}_{k}" for k in (1, 2, 3)))
        if trials:
            found[f"boom_{way}"] = travel_figure(trials)
        if any(name.startswith(f"hand_{way}") for name in runs):
            found[f"wings_{way}"] = wing_figure(runs, way)
        first = f"boom_{way}_1"
        variants = {words: runs[first + key] for key, words in
                    (("", "as assumed: motors decay in 50 ms, drag"), ("_instant_cut", "thrust cut at once"), ("_no_drag", "no drag"))
                    if first + key in runs}
        if len(variants) > 1:
            found[f"variants_{way}"] = travel_figure(variants)
    battery = {name: runs[name] for name in ("battery_alone_in_f", "battery_in_f_wings_off", "battery_in_f_wings_on") if name in runs}
    if battery:
        found["battery"] = travel_figure(battery)
    for name in ("boom_wings", "boom_wings_f_to_q"):
        if name in runs:
            found[name] = boom_wing_figure(runs[name])
    return found


def judged(good, all_count):
    return OPEN if all_count == 0 else AGREES if good == all_count else DISAGREES if good == 0 else PARTLY


def boom_row(runs, way):
    start, target = WAYS[way]
    trials = [runs[f"boom_{way}_{k}"] for k in (1, 2, 3) if f"boom_{way}_{k}" in runs]
    good = sum(run.switched for run in trials)
    says = {"f_to_q": "3 trials with one short, mid range pulse: all switch", "q_to_f": "3 trials with full thrust for about .75 s: all switch"}
    came = f"{good} of {len(trials)} switch. " + "; ".join(f"{run.label()}: {run.words()}" for run in trials)
    return f"Boom without wings, {start} to {target}", says[way], came, judged(good, len(trials))


def hand_row(runs, way, keys, what):
    start, target = WAYS[way]
    trials = {keys[key]: runs[f"hand_{way}_{key}"] for key in keys if f"hand_{way}_{key}" in runs}
    good = sum(run.switched and run.wings_in_place for run in trials.values())
    came = f"{good} of {len(trials)} switch and bring the wings along. " + "; ".join(
        f"{words}: {run.words()}, wings at {run.wing('left')[-1]:.0f} and {run.wing('right')[-1]:.0f} deg" for words, run in trials.items())
    return f"By hand with wings, {start} to {target}{what}", "all switch", came, judged(good, len(trials))


def largest_difference(run):
    """[deg] of left and right wing at any time."""
    return float(np.nanmax(np.abs(run.wing("left") - run.wing("right"))))


def last_difference(run):
    """[deg]"""
    return float(abs(run.wing("left")[-1] - run.wing("right")[-1]))


def friction_row(runs, even_key="even", uneven_key="uneven", what=""):
    pairs = [(runs[f"hand_{way}_{even_key}"], runs[f"hand_{way}_{uneven_key}"], " to ".join(WAYS[way])) for way in WAYS
             if f"hand_{way}_{even_key}" in runs and f"hand_{way}_{uneven_key}" in runs]
    good = sum(largest_difference(even) < 0.1 and 0.5 < largest_difference(uneven) < 45 for even, uneven, _ in pairs)
    came = "; ".join(f"{way}: left and right differ by up to {largest_difference(uneven):.1f} deg, at the end by {last_difference(uneven):.1f}, "
                     f"with even friction by {largest_difference(even):.1f} deg" for even, uneven, way in pairs)
    return ("Wing angles with uneven friction" + what,
            "simulation symmetric; imbalances of friction cause small differences in the fold-out angle", came, judged(good, len(pairs)))


def film_row(runs):
    """Does resistance keep the wings from their extreme angles?"""
    pairs = [(runs[f"hand_{way}_even"], runs[f"hand_{way}_film"], " to ".join(WAYS[way])) for way in WAYS
             if f"hand_{way}_even" in runs and f"hand_{way}_film" in runs]

    def reach(run):
        return float(np.nanmax(run.wing("left")) - np.nanmin(run.wing("left")))
    good = sum(reach(film) < reach(even) - 5 for even, film, _ in pairs)
    came = "; ".join(f"{way}: the wing's range is {reach(film):.1f} deg in place of {reach(even):.1f}" for even, film, way in pairs)
    return ("Film on the wings", "further deviation: folded wings resist folding out, extreme angles are not reached",
            came + " (five times the pins' friction stands for the film; its folds are not modelled)",
            judged(good, len(pairs)))


def battery_rows(runs):
    rows = []
    for name, what, says in (("battery_alone_in_f", "F carries the battery's weight (.190 kg)", "yes"),
                             ("battery_in_f_wings_off", "F carries the whole centre (.400 kg, an assumption), wings off", "not said"),
                             ("battery_in_f_wings_on", "the same with wings on the soft arms", "not said")):
        run = runs.get(name)
        holds = run is not None and run.outcome["end_mode"] == "F" and not run.switched
        verdict = OPEN if run is None else (AGREES if holds else DISAGREES) if says == "yes" else "-"
        rows.append((what, says, "" if run is None else ("holds: " if holds else "does not hold: ") + run.words(), verdict))
    return rows


def outward_row(runs, name, what):
    """The boom with wings: the left one lies outside of the vehicle, the right one inside, so that a tip points outwards
    where the left one is unfolded and the right one folded."""
    says = "centripetal load turns both tips to the outside of the circle: no useful test"
    run = runs.get(name)
    if run is None:
        return what, says, "", OPEN
    rate, bodies, linkage = run.series["turn_rate_rad_per_s"], run.summary["model"]["bodies"], run.summary["model"]["linkage"]
    fastest = int(np.nanargmax(rate))
    load = float(rate[fastest])**2 * BOOM_LENGTH
    wing = sum(linkage[bar]["mass"] for bar in ("crank", "wing", "rocker"))
    left, right = float(run.wing("left")[fastest]), float(run.wing("right")[fastest])
    came = (f"{run.label()} from {run.outcome['start_mode']}: at the fastest, {float(rate[fastest]) * BOOM_LENGTH:.1f} m/s after "
            f"{run.series['time_s'][fastest]:.2f} s, the load is {load:.0f} m/s2: {bodies['centre_mass'] * load:.0f} N on the centre, "
            f"{bodies['arms_mass'] * load:.1f} N on the arms, {wing * load:.1f} N on each wing. The outer wing is then at {left:.0f} deg, the inner one "
            f"at {right:.0f} deg; the centre is {1e3 * float(np.nanmax(run.series['centre_off_m'][:fastest + 1])):.0f} mm off the ring's axis; "
            f"at the end, at {run.series['time_s'][-1]:.2f} s, the wings are at {float(run.wing('left')[-1]):.0f} and "
            f"{float(run.wing('right')[-1]):.0f} deg, the housing at {1e3 * float(run.series['travel_m'][-1]):.0f} mm")
    return what, says, came, AGREES if left < FOLDED < right else DISAGREES


def variant_rows(runs):
    rows = []
    for way in WAYS:
        first = runs.get(f"boom_{way}_1")
        for key, what, says in (("instant_cut", "thrust cut at once", "the paper's simulation cuts thrust at once"),
                                ("no_drag", "without drag and the bearing's friction", "drag is not mentioned")):
            run = runs.get(f"boom_{way}_1_{key}")
            if first is None or run is None:
                continue
            decides = "decides: " if run.switched != first.switched else "does not decide: "
            rows.append((f"Boom, {' to '.join(WAYS[way])}, {what}", says, f"{decides}{run.words()}; as assumed: {first.words()}", "-"))
    return rows


def rows(runs):
    found = [boom_row(runs, way) for way in WAYS]
    for way in WAYS:
        found.append(hand_row(runs, way, FRICTIONS, ""))
        found += [hand_row(runs, way, {key: words}, f", {words}") for key, words in {**ASSUMPTIONS, "stiff": STIFF["stiff"], **REMEDIES}.items()]
    return [row for row in [*found, friction_row(runs), friction_row(runs, "stiff", "stiff_uneven", ", pins with 20 x (right 30 x) friction"), film_row(runs), *battery_rows(runs), outward_row(runs, "boom_wings", "Boom with wings, from Q with full thrust"),
                                       outward_row(runs, "boom_wings_f_to_q", "Boom with wings, from F with the pulse without wings"),
                                       *variant_rows(runs)]
            if row[3] != OPEN]


TITLES = {
    "boom_f_to_q": ("F to Q comparison (boom, without wings)", "Paper: central displacement similar to the simulation's, three trials."),
    "boom_q_to_f": ("Q to F comparison (boom, without wings)", "Paper: full thrust for about .75 s stores energy, its end releases it."),
    "wings_f_to_q": ("F to Q wing angle comparison (by hand)", "Zero is the fixed-wing mode; left solid, right dashed."),
    "wings_q_to_f": ("Q to F wing angle comparison (by hand)", "Zero is the fixed-wing mode; left solid, right dashed."),
    "variants_f_to_q": ("What decides, F to Q", "The same pulse with another decay of the motors, and without drag."),
    "variants_q_to_f": ("What decides, Q to F", "The same pulse with another decay of the motors, and without drag."),
    "boom_wings_f_to_q": ("Wings on the boom, F to Q", "Outside of the circle is 0 deg for the outer wing, folded for the inner one."),
    "boom_wings": ("Wings on the boom", "Outside of the circle is 0 deg for the outer wing, folded for the inner one."),
    "battery": ("F against gravity", "Ring held, thrust axis up, motors still."),
}


def page(runs, failures, drawn, others=None):
    """One page of HTML with everything inside it. others: shipped trials that are none of the paper's."""
    table = rows(runs)
    bad = [row for row in table if row[3] in (DISAGREES, PARTLY)]
    body = ["<h1>The paper's experiments, simulated</h1>",
            f"<p>{len(runs)} trials ran. {sum(row[3] == AGREES for row in table)} statements of the paper agree with the simulation, "
            f"{len(bad)} do not or in part.</p>"]
    if bad:
        body.append(html_page.notes([f"{what}: {came}" for what, _, came, _ in bad], []).replace(
            "What is missing, and remarks", "Where simulation and paper disagree"))
    body += ["<h2>What the paper says, and what came out</h2>",
             html_page.table(table, ("experiment", "the paper says", "what came out", ""))]
    for name, (title, caption) in TITLES.items():
        if name in drawn:
            svg = drawn[name][drawn[name].index("<svg"):]
            body.append(html_page.figure(name, title, caption, f'<div style="background:#fff;padding:.4rem">{svg}</div>'))
    if others:
        body.append("<h2>Other shipped trials</h2>" + html_page.table(
            [(name, run.words(), f"{run.cpu_seconds:.1f}") for name, run in others.items()], ("trial", "what came out", "CPU s")))
    left_out = sorted({what for run in runs.values() for what in run.summary["model"].get("left_out", [])})
    body.append("<h2>What these trials leave out</h2>" + html_page.table([(what,) for what in left_out]))
    if failures:
        body.append("<h2>Trials without an answer</h2>" + html_page.table(sorted(failures.items())))
    imbalance = [run.outcome["largest_imbalance"] for run in runs.values() if run.outcome["largest_imbalance"] is not None]
    if imbalance and math.isfinite(max(imbalance)):
        body.append(f'<p class="muted">The energy error of the time scheme is at most {1e3 * max(imbalance):.1f} mJ in any of them.</p>')
    return html_page.page("The paper's experiments, simulated", "\n".join(body))
