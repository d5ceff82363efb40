"""Figures of the report. Each function takes data and gives a matplotlib figure; none reads files."""

import math

import numpy as np
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from snapwing_tools import analysis, style, topics

MM = 1e3
MS = 1e3


def force_curve(curve):
    """Force and energy of the vehicle against travel, with equilibria, barrier, peak and valley."""
    fig, (top, low) = style.figure(2, 1, 5.4, sharex=True, gridspec_kw={"height_ratios": [3, 2]})
    travel, force = curve["travel"] * MM, curve["force"]
    stable = curve["stable"] > 0.5 if len(curve["stable"]) == len(travel) else np.full(len(travel), True)
    top.axhline(0, color=style.MUTED, lw=0.8)
    top.plot(travel, force, color=style.INK)
    if not stable.all():
        top.plot(travel, np.where(stable, np.nan, force), color=style.AMBER, lw=3,
                 label="unstable even with the travel held")
        top.legend(loc="upper right")
    points = [(0.0, 0.0, "F: stable, u = 0", "o", style.MODE_F, (8, -16)),
              (curve["peak_travel"], curve["peak_force"], "peak {:.2f} N at {:.1f} mm", "^", style.INK, (8, 2)),
              (curve["barrier_travel"], 0.0, "barrier {1:.1f} mm", "D", style.PURPLE, (6, 8)),
              (curve["valley_travel"], curve["valley_force"], "valley {:.2f} N at {:.1f} mm", "v", style.INK, (8, -14)),
              (curve["second_travel"], 0.0, "Q: stable, {1:.1f} mm", "o", style.MODE_Q, (8, -16))]
    for u, f, text, marker, colour, offset in points:
        if math.isfinite(u) and math.isfinite(f):
            top.plot(u * MM, f, marker, color=colour, ms=8, mec=style.PAPER, mew=0.8, zorder=5)
            style.label(top, u * MM, f, text.format(f, u * MM), colour, offset=offset,
                        ha="right" if offset[0] < 0 else "left")
    low_end, high_end = _view(force, curve["peak_force"], curve["valley_force"])
    top.set_ylim(low_end, high_end)
    top.set_ylabel("force, all arms F [N]")
    cut = " (axis cut; {:.1f} N at {:.0f} mm)".format(force[-1], travel[-1]) if force[-1] > high_end else ""
    top.set_title("Force that holds the housing at u" + cut)
    _energy(low, curve)
    low.set_xlabel("travel of the housing u [mm]")
    return fig


def _view(values, peak, valley):
    """Range of an axis that keeps peak and valley readable when the curve's ends are far outside."""
    if not (math.isfinite(peak) and math.isfinite(valley)):
        peak, valley = values.max(), values.min()
    inner = peak - valley
    low, high = max(values.min(), valley - 1.2 * inner), min(values.max(), peak + 1.2 * inner)
    return low - 0.1 * (high - low), high + 0.1 * (high - low)


def _energy(axes, curve):
    travel, energy = curve["travel"] * MM, curve["energy"] * MS
    axes.plot(travel, energy, color=style.INK)
    barrier, second = curve["barrier_travel"], curve["second_travel"]
    if math.isfinite(barrier):
        top = np.interp(barrier * MM, travel, energy)
        axes.plot([0, barrier * MM], [top, top], color=style.MUTED, lw=0.9, ls=":")
        axes.annotate("", (3, top), xytext=(3, 0), arrowprops={"arrowstyle": "<->", "color": style.MODE_F})
        style.label(axes, 0, top, "from F {:.1f} mJ".format(curve["barrier_forward"] * MS), style.MODE_F,
                    offset=(4, 5))
        axes.plot(barrier * MM, top, "D", color=style.PURPLE, ms=7)
        if math.isfinite(second):
            low = np.interp(second * MM, travel, energy)
            axes.plot([barrier * MM, second * MM], [top, top], color=style.MUTED, lw=0.9, ls=":")
            axes.annotate("", (second * MM, top), xytext=(second * MM, low),
                          arrowprops={"arrowstyle": "<->", "color": style.MODE_Q})
            style.label(axes, second * MM, top, "from Q {:.1f} mJ".format(curve["barrier_back"] * MS), style.MODE_Q,
                        offset=(0, 5), ha="right")
            axes.plot(second * MM, low, "o", color=style.MODE_Q, ms=7)
        axes.set_ylim(*_view(energy, 1.3 * top, 0.0))
    axes.plot(0, np.interp(0, travel, energy), "o", color=style.MODE_F, ms=7)
    axes.set_ylabel("energy E [mJ]")
    axes.set_title("Elastic energy, and the way up to the barrier")


def outcome_maps(entries):
    """Entries (name, OutcomeMap, pulses [(throttle, duration, text)]): share of realisations that switch, the line of
    zero margin, and the pulses of the run."""
    fig, axes = style.figure(1, len(entries), 3.9, squeeze=False, sharey=True)
    mesh = None
    for ax, (name, outcome, pulses) in zip(axes[0], entries):
        mesh = ax.pcolormesh(outcome.duration * MS, outcome.throttle * 100, outcome.share * 100, cmap="cividis",
                             vmin=0, vmax=100, shading="nearest", rasterized=True)
        if np.isfinite(outcome.margin).all() and outcome.margin.min() < 0 < outcome.margin.max():
            ax.contour(outcome.duration * MS, outcome.throttle * 100, outcome.margin, levels=[0], colors="white",
                       linewidths=1.6)
            ax.plot([], [], color=style.MUTED, lw=1.6, label="worst margin = 0 (white line)")
        for throttle, duration, text in pulses:
            ax.plot(duration * MS, throttle * 100, "o", ms=11, mfc="none", mec="white", mew=4)
            ax.plot(duration * MS, throttle * 100, "o", ms=11, mfc="none", mec=style.VERMILION, mew=2.2, label=text)
        ax.set_title("{}: {} × {} pulses".format(arrow(name), *outcome.share.shape))
        ax.set_xlabel("duration of the pulse [ms]")
        ax.grid(False)
        if ax.get_legend_handles_labels()[0]:
            ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.17))
    axes[0][0].set_ylabel("throttle [% of the stick]")
    bar = fig.colorbar(mesh, ax=axes[0].tolist(), pad=0.02)
    bar.set_label("share that ends in the target mode [%]")
    bar.outline.set_visible(False)
    return fig


def influences(entries, most=8):
    """Entries (name, Plan, same): how far one uncertain number alone moves the margin; `same`: it is the run's pulse."""
    fig, axes = style.figure(1, len(entries), 3.4, squeeze=False, sharex=True)
    for ax, (name, plan, same) in zip(axes[0], entries):
        shown = plan.influences[:most]
        for place, (_, low, high) in enumerate(shown):
            ax.plot([plan.margin, low], [place, place], color=style.BLUE, lw=9, solid_capstyle="butt",
                    label="low end" if place == 0 else None)
            ax.plot([plan.margin, high], [place, place], color=style.AMBER, lw=5, solid_capstyle="butt",
                    label="high end" if place == 0 else None)
        ax.axvline(plan.margin, color=style.INK, lw=1)
        ax.axvline(0, color=style.VERMILION, lw=1.2, ls="--", label="fails below")
        ax.set_yticks(range(len(shown)))
        ax.set_yticklabels([entry[0] for entry in shown])
        ax.set_ylim(len(shown) - 0.4, -0.6)
        ax.grid(axis="y", visible=False)
        ax.set_title(arrow(name) + ("" if same else ", another pulse"))
        ax.set_xlabel("energy margin [barriers]")
    axes[0][-1].legend(loc="lower right", ncol=3, bbox_to_anchor=(1.0, 1.1), borderaxespad=0.0)
    return fig


def arrow(name):
    return name.replace("->", " → ")


def frames(run, switches):
    """Throttle and AUX1 as sent, motor outputs as read back, state of bridge and flight controller; whole run."""
    link = run.series["link_status"]
    time = link["time"]
    fig, (top, middle, low, state) = style.figure(4, 1, 6.6, sharex=True,
                                                  gridspec_kw={"height_ratios": [3, 1.1, 2.4, 1.5]})
    top.step(time, analysis.throttle_sent(link), where="post", color=style.BLUE, lw=1.2, label="throttle channel, sent")
    top.set_title("Frames on the wire")
    top.set_ylabel("throttle [us]")
    middle.step(time, analysis.aux1_sent(link), where="post", color=style.GREEN, lw=1.2)
    middle.set_ylabel("AUX1 [us]")
    motors = link["motors"]
    for index in range(motors.shape[1]):
        low.step(time, motors[:, index], where="post", lw=1.1, alpha=0.8, color=style.VERMILION,
                 label="motor outputs, read back" if index == 0 else None)
    low.set_ylabel("motors [us]")
    if motors.shape[1] == 0:
        low.text(0.5, 0.5, "motor outputs were never read back", transform=low.transAxes, ha="center",
                 color=style.MUTED)
    for ax in (top, low):
        ax.set_ylim(950, 2250)
        ax.set_yticks([1000, 1250, 1500, 1750, 2000])
    middle.set_ylim(900, 2100)
    middle.set_yticks([1000, 2000])
    for number, switch in enumerate(switches):
        for ax in (top, low):
            ax.axvline(switch.start, color=style.COMMANDED, lw=1.2, ls="--",
                       label="pulse commanded" if number == 0 and ax is top else None)
        style.label(top, switch.start, 2250, arrow(switch.name), style.COMMANDED, offset=(4, -2), va="top")
    top.legend(loc="lower right", ncol=2, bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
    if low.get_legend_handles_labels()[0]:
        low.legend(loc="lower right", bbox_to_anchor=(1.0, 0.93), borderaxespad=0.0)
    _states(state, link)
    state.set_xlabel("time since the recording began [s]")
    return fig


def _states(axes, link):
    """Bars of bridge and flight-controller states."""
    time = link["time"]
    rows = [("bridge: pulse", link["bridge_state"] == 3, style.PURPLE),
            ("bridge: armed", (link["bridge_state"] == 2) | (link["bridge_state"] == 3), style.BLUE),
            ("controller: armed", link["controller_armed"], style.GREEN),
            ("failsafe or fault", link["controller_failsafe"] | (link["bridge_state"] == 4), style.VERMILION)]
    for place, (name, flags, colour) in enumerate(reversed(rows)):
        bars = [(start, max(end - start, 0.01)) for start, end in analysis.spans(time, flags)]
        axes.broken_barh(bars, (place - 0.35, 0.7), facecolors=colour)
    axes.set_yticks(range(len(rows)))
    axes.set_yticklabels([name for name, _, _ in reversed(rows)])
    axes.set_ylim(-0.6, len(rows) - 0.4)
    axes.grid(axis="y", visible=False)


def travel(run, switch, trajectory=None, seconds=None):
    """Travel, thrust and the frames of one switch: predicted, estimated and true."""
    until = min(switch.until - switch.start, seconds or max(1.5, 3 * switch.duration))
    fig, (top, middle, low) = style.figure(3, 1, 6.8, sharex=True, gridspec_kw={"height_ratios": [3.2, 1.6, 1.4]})
    span = (switch.start - 0.15, switch.start + until)
    if run.has("mode_state"):
        rows = analysis.window(run.series["mode_state"], *span)
        t, mean, deviation = ((rows["time"] - switch.start) * MS, rows["travel"] * MM, rows["travel_deviation"] * MM)
        top.fill_between(t, mean - deviation, mean + deviation, color=style.ESTIMATED, alpha=0.22, lw=0)
        top.plot(t, mean, color=style.ESTIMATED, lw=1.3, label="estimated, mean ± deviation")
    if run.has("truth"):
        rows = analysis.window(run.series["truth"], *span)
        top.plot((rows["time"] - switch.start) * MS, rows["travel"] * MM, color=style.TRUE, lw=2, label="true")
        middle.plot((rows["time"] - switch.start) * MS, rows["thrust"], color=style.TRUE, label="true")
    if trajectory is not None:
        inside = trajectory["time_s"] <= until
        dashes = {"color": style.PREDICTED, "ls": (0, (5, 2))}
        top.plot(trajectory["time_s"][inside] * MS, trajectory["travel_m"][inside] * MM, label="predicted, nominal",
                 **dashes)
        if "thrust_N" in trajectory:
            middle.plot(trajectory["time_s"][inside] * MS, trajectory["thrust_N"][inside], label="predicted", **dashes)
    elif switch.plan is not None:
        _predicted_numbers(top, switch.plan)
    _levels(top, run)
    top.set_ylabel("travel u [mm]")
    top.set_title("{}: {:.0f} % throttle for {:.0f} ms".format(arrow(switch.name), switch.throttle * 100,
                                                               switch.duration * MS), pad=24)
    top.legend(loc="lower left", ncol=4, bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2)
    middle.set_ylabel("thrust [N]")
    middle.set_ylim(bottom=-1)
    if middle.get_legend_handles_labels()[0]:
        middle.legend(loc="upper right")
    _pulse_frames(low, run, switch, span)
    for ax in (top, middle, low):
        ax.axvspan(0, switch.duration * MS, color=style.COMMANDED, alpha=0.12, lw=0,
                   label="pulse as commanded" if ax is low else None)
    low.legend(loc="upper right")
    low.set_xlabel("time after the command [ms]")
    low.set_xlim(-150, until * MS)
    return fig


def _pulse_frames(axes, run, switch, span):
    """The throttle channel around a pulse, one dot a frame, and the motor outputs read back."""
    axes.set_ylabel("frames [us]")
    axes.set_ylim(930, 2100)
    if not run.has("link_status"):
        return
    rows = analysis.window(run.series["link_status"], *span)
    time = (rows["time"] - switch.start) * MS
    axes.step(time, analysis.throttle_sent(rows), where="post", color=style.BLUE, lw=1.1, marker=".", ms=4,
              label="throttle channel, sent")
    for index in range(rows["motors"].shape[1]):
        axes.step(time, rows["motors"][:, index], where="post", color=style.VERMILION, lw=1.0, alpha=0.7,
                  label="motor outputs, read back" if index == 0 else None)


def _predicted_numbers(axes, plan):
    """Only the plan's numbers are known, not its trajectory: mark them."""
    if math.isfinite(plan["nominal_snap_time"]):
        axes.axvline(plan["nominal_snap_time"] * MS, color=style.PREDICTED, ls=":", label="predicted time of snap")
    axes.axhline(plan["nominal_peak_travel"] * MM, color=style.PREDICTED, ls=(0, (1, 2)), lw=1.2,
                 label="predicted largest travel")


def _levels(axes, run):
    """Lines at both equilibria and at the barrier."""
    curve = run.latched.get("force_curve")
    lines = [(0.0, "F", style.MODE_F)]
    if curve is not None:
        lines += [(float(curve["barrier_travel"]), "barrier", style.PURPLE),
                  (float(curve["second_travel"]), "Q", style.MODE_Q)]
    for level, name, colour in lines:
        if math.isfinite(level):
            axes.axhline(level * MM, color=colour, lw=0.9, ls="-.")
            axes.annotate(name, (1.0, level * MM), xycoords=("axes fraction", "data"), xytext=(4, 0),
                          textcoords="offset points", va="center", color=colour, fontsize=9)


def mode_probability(run, switches):
    """Probability of each mode over the run, with the true mode under it."""
    rows = run.series["mode_state"]
    fig, (top, low) = style.figure(2, 1, 3.6, sharex=True, gridspec_kw={"height_ratios": [3, 0.9]})
    time = rows["time"]
    top.plot(time, rows["probability_fixed_wing"] * 100, color=style.MODE_F, label="F, fixed wing")
    top.plot(time, rows["probability_quadrotor"] * 100, color=style.MODE_Q, label="Q, quadrotor")
    top.set_ylabel("probability [%]")
    top.set_ylim(-4, 104)
    top.set_title("Estimated mode")
    for switch in switches:
        top.axvline(switch.start, color=style.COMMANDED, lw=1.2, ls="--")
        style.label(top, switch.start, 50, arrow(switch.name), style.COMMANDED, offset=(-4, 0), ha="right")
    top.legend(loc="lower right", ncol=2, bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
    bands = [("estimate", rows["time"], rows["mode"])]
    if run.has("truth"):
        bands.insert(0, ("truth", run.series["truth"]["time"], run.series["truth"]["mode"]))
    for place, (name, t, mode) in enumerate(bands):
        for number, colour in ((topics.MODE_NUMBERS["F"], style.MODE_F), (topics.MODE_NUMBERS["Q"], style.MODE_Q)):
            bars = [(start, end - start) for start, end in analysis.spans(t, mode == number)]
            low.broken_barh(bars, (place - 0.35, 0.7), facecolors=colour)
    low.set_yticks(range(len(bands)))
    low.set_yticklabels([band[0] for band in bands])
    low.set_ylim(-0.6, len(bands) - 0.4)
    low.grid(axis="y", visible=False)
    low.set_xlabel("time since the recording began [s]  (no bar: unknown)")
    return fig


def link(statistics):
    """Histogram of the time between frames."""
    fig, ax = style.figure(1, 1, 2.8)
    periods = statistics.periods * MS
    low, top = 0.8 * periods.min(), max(1.2 * np.median(periods), periods.max() * 1.05)
    ax.hist(periods, bins=np.linspace(low, top, 80), color=style.BLUE, log=True)
    ax.axvline(statistics.worst * MS, color=style.VERMILION, lw=1.4, label="worst {:.1f} ms".format(
        statistics.worst * MS))
    ax.axvline(statistics.median * MS, color=style.INK, lw=1.2, ls="--", label="median {:.1f} ms".format(
        statistics.median * MS))
    if top > 0.8 * analysis.LATE_SECONDS * MS:
        ax.axvline(analysis.LATE_SECONDS * MS, color=style.PURPLE, lw=1.2, ls=":", label="limit {:.0f} ms".format(
            analysis.LATE_SECONDS * MS))
    low, high = ax.get_xlim()
    ax.set_xlim(max(low, 0.0), high)
    ax.set_xlabel("time between frames [ms]")
    ax.set_ylabel("frames (log scale)")
    ax.set_title("Frame period of the bridge")
    ax.legend(loc="lower right", ncol=3, bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
    return fig


def arm_shapes(entries, geometry=None):
    """Entries (title, loops (n, 2) [m], travel [m]): the arm at several travels, with the axle held in place."""
    fig, axes = style.figure(1, len(entries), 2.9, squeeze=False, sharex=True, sharey=True)
    for ax, (title, loops, travel_here) in zip(axes[0], entries):
        for loop in loops:
            closed = np.vstack([loop, loop[:1]]) * MM
            ax.plot(closed[:, 0], closed[:, 1], color=style.INK, lw=0.8)
        _fill(ax, loops)
        if geometry is not None:
            ax.plot(geometry["pin_x"] * MM, geometry["pin_y"] * MM, "o", color=style.VERMILION, ms=5, zorder=4)
        ax.set_aspect("equal")
        ax.set_title("{}\nu = {:.1f} mm".format(title, travel_here * MM))
        ax.set_xlabel("x [mm]")
    axes[0][0].set_ylabel("y [mm]")
    return fig


def _fill(axes, loops):
    """Fills loops so that holes stay open: outer loops run one way, loops inside an odd number of others the other."""
    vertices, codes = [], []
    for loop in loops:
        inside = sum(Path(other).contains_point(loop[0]) for other in loops if other is not loop)
        x, y = loop[:, 0], loop[:, 1]
        area = np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
        points = (loop if (area > 0) == (inside % 2 == 0) else loop[::-1]) * MM
        vertices += [tuple(point) for point in points] + [tuple(points[0])]
        codes += [Path.MOVETO] + [Path.LINETO] * (len(points) - 1) + [Path.CLOSEPOLY]
    if vertices:
        axes.add_patch(PathPatch(Path(vertices, codes), facecolor=style.BLUE, alpha=0.35, lw=0))
