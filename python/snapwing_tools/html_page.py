"""Pieces of the report's HTML. No scripts, no fonts and no pictures from elsewhere."""

from html import escape

from snapwing_tools import analysis, style
from snapwing_tools.plots import arrow
from snapwing_tools.text_format import NOT_KNOWN, difference, number

_CSS = """
:root { color-scheme: light dark; LIGHT --good: #0b7a4b; --bad: #b3261e; --unsure: #8a6100; --box: #f4f6f8; }
@media (prefers-color-scheme: dark) {
  :root { DARK --good: #4cc38a; --bad: #ff8078; --unsure: #f0b840; --box: #20262d; } }
body { margin: 0 auto; max-width: 62rem; padding: 1.5rem 1.2rem 4rem; background: var(--paper); color: var(--ink);
  font: 16px/1.5 system-ui, "DejaVu Sans", Verdana, sans-serif; }
h1 { font-size: 1.5rem; margin: 0 0 .2rem; } h2 { font-size: 1.15rem; margin: 2.4rem 0 .5rem; }
p { margin: .4rem 0; max-width: 50rem; } .muted, figcaption { color: var(--muted); font-size: .9rem; }
.verdict { display: grid; grid-template-columns: repeat(auto-fit, minmax(15rem, 1fr)); gap: .8rem; margin: 1rem 0; }
.verdict > div { background: var(--box); border-left: .4rem solid var(--muted); border-radius: .3rem;
  padding: .7rem 1rem; }
.verdict .good { border-color: var(--good); } .verdict .bad { border-color: var(--bad); }
.verdict .unsure { border-color: var(--unsure); } .verdict b { font-size: 1.15rem; display: block; }
.good b { color: var(--good); } .bad b { color: var(--bad); } .unsure b { color: var(--unsure); }
.wide { overflow-x: auto; } table { margin-top: .8rem; border-collapse: collapse; font-size: .9rem;
  font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: .25rem .8rem .25rem 0; border-bottom: 1px solid var(--grid); vertical-align: top; }
thead th { border-bottom: 2px solid var(--muted); } .n { text-align: right; white-space: nowrap; }
.code, pre { font-family: "DejaVu Sans Mono", Menlo, Consolas, monospace; font-size: .82rem; overflow-wrap: anywhere; }
pre { background: var(--box); padding: .7rem 1rem; white-space: pre-wrap; border-radius: .3rem; }
figure { margin: .6rem 0 0; } svg { width: 100%; height: auto; display: block; }
.notes { background: var(--box); border-left: .4rem solid var(--unsure); border-radius: .3rem; padding: .5rem 1rem; }
.notes ul { margin: .3rem 0; padding-left: 1.2rem; }
@media print { :root { LIGHT --box: #fff; } body { max-width: none; padding: 0; font-size: 11pt; }
  figure, .verdict, .notes, tr { break-inside: avoid; } h2 { break-after: avoid; } }
"""

_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>{css}</style>
</head>
<body>
{body}
</body>
</html>
"""

_CLASSES = {"happened": "good", "did not happen": "bad", "not attempted": "bad", "not known": "unsure"}


def page(title, body):
    css = _CSS.replace("LIGHT", style.css_variables(0)).replace("DARK", style.css_variables(1))
    return _PAGE.format(title=escape(title), css=css, body=body)


def table(rows, head=None, classes=()):
    """Rows of texts; the first of each row is its heading. `classes` names the CSS class of each further column."""
    def cell(text, place):
        name = classes[place] if place < len(classes) else ""
        return "<td{}>{}</td>".format(' class="{}"'.format(name) if name else "", escape(str(text)))
    body = "".join('<tr><th scope="row">{}</th>{}</tr>'.format(
        escape(str(row[0])), "".join(cell(text, place) for place, text in enumerate(row[1:]))) for row in rows)
    top = ""
    if head:
        names = [""] + list(classes) + [""] * len(head)
        cells = ["<th{}>{}</th>".format(' class="n"' if name == "n" else "", escape(text))
                 for text, name in zip(head, names)]
        top = "<thead><tr>{}</tr></thead>".format("".join(cells))
    return '<div class="wide"><table>{}<tbody>{}</tbody></table></div>'.format(top, body)


def header(report):
    """Title and one box per switch."""
    name = report.inputs.vehicle[0] if report.inputs.vehicle else str(
        (report.inputs.run.latched.get("arm_geometry") or {}).get("vehicle", "vehicle not named"))
    boxes = []
    for switch_name, status in report.verdict.status.items():
        switch = report.verdict.switch[switch_name]
        text = "" if switch is None else "{:.0f} % throttle for {:.0f} ms, commanded at {:.2f} s".format(
            switch.throttle * 100, switch.duration * 1e3, switch.start)
        boxes.append('<div class="{}">{}<b>{}</b><span class="muted">{}</span></div>'.format(
            _CLASSES[status], escape(arrow(switch_name)), escape(status), escape(text)))
    boxes.append('<div>Model that predicted<b>{}</b><span class="muted">force curve: {}</span></div>'.format(
        escape(report.rung), escape(report.curve_rung)))
    basis = ("F fixed wing, Q quadrotor. Judged from the recorded true state, not from what the nodes say of "
             "themselves.")
    return '<h1>{}: {}</h1>\n<p class="muted">{}</p>\n<div class="verdict">{}</div>'.format(
        escape(name), escape(report.verdict_sentence), basis, "".join(boxes))


def comparison(report):
    """Predicted and happened, side by side."""
    parts = ["<h2>Predicted and happened</h2>"]
    if not report.switches:
        parts.append("<p>No pulse was recorded, so there is nothing to compare.</p>")
    for switch in report.switches:
        rows = [(label, number(nominal, unit), number(worst, unit), number(happened, unit),
                 difference(unit, nominal, happened))
                for label, unit, nominal, worst, happened in analysis.comparison_rows(switch)]
        head = (arrow(switch.name), "predicted, nominal", "predicted, worst", "happened", "happened − nominal")
        parts.append(table(rows, head, ("n",) * 4))
        if switch.plan is not None:
            text = "Plan: {:.0f} % of {} realisations of the uncertain vehicle end in {}.".format(
                100 * switch.plan["share_switched"], int(switch.plan["realisations"]), switch.target_mode)
            parts.append('<p class="muted">{}</p>'.format(escape(text)))
    return "\n".join(parts)


def notes(missing, remarks):
    items = "".join("<li>{}</li>".format(escape(arrow(text))) for text in missing + remarks)
    return '<h2>What is missing, and remarks</h2><div class="notes"><ul>{}</ul></div>'.format(items)


def figure(name, title, caption, svg, extra=""):
    head = '<h2 id="{}">{}</h2>\n'.format(escape(name), escape(title))
    return head + '<figure role="img" aria-label="{}">{}<figcaption>{}</figcaption></figure>{}'.format(
        escape(title), svg, escape(caption), extra)


def link_table(statistics):
    """Numbers of the link."""
    return table([
        ("frames recorded", statistics.frames), ("frames the recorder did not see", statistics.unseen),
        ("median period", "{:.2f} ms".format(statistics.median * 1e3)),
        ("worst period, as recorded", "{:.2f} ms".format(statistics.worst * 1e3)),
        ("worst period, as the bridge reports it", "{:.2f} ms".format(statistics.worst_reported * 1e3)),
        ("periods over {:.0f} ms".format(analysis.LATE_SECONDS * 1e3), statistics.late),
        ("commands accepted / refused", "{} / {}".format(statistics.accepted, statistics.refused)),
        ("last refusal", statistics.last_refusal or "none"), ("faults", "; ".join(statistics.faults) or "none"),
        ("oldest telemetry", number(statistics.telemetry_worst * 1e3, "ms")),
        ("time in failsafe", "{:.2f} s".format(statistics.failsafe_seconds)),
        ("restarts of the bridge", statistics.restarts)])


def _limit(entry):
    text = number(entry["limit"], entry["unit"])
    return "none in reach" if text == NOT_KNOWN else text


def accidents(entries):
    """What may flip the mode by accident."""
    rows = [(entry["name"], entry["mode"], _limit(entry), number(entry["occurs"], entry["unit"]),
             NOT_KNOWN if number(entry["occurs"]) == NOT_KNOWN else ("holds" if entry["holds"] else "flips"),
             entry["explanation"]) for entry in entries]
    head = ("accident", "mode", "limit", "met in use", "", "")
    return "<h2>What may flip the mode by accident</h2><p>Nominal vehicle, by the reduced model.</p>" + table(
        rows, head, ("", "n", "n"))


def vehicle(name, parameters, settings):
    """Every number of the vehicle file with its source."""
    rows = [(p.name, p.value, "± {}".format(p.plus_minus) if p.plus_minus else "", p.unit, p.source)
            for p in parameters]
    rows += [(key, value, "", "", "") for key, value in settings.items() if key != "name"]
    head = ("number", "value", "", "unit", "source")
    return "<h2>Vehicle: {}</h2>".format(escape(name)) + table(rows, head, ("n", "n"))


def provenance_section(report, rows):
    commands = escape("\n".join(report.inputs.commands))
    return "<h2>Provenance</h2>{}<h2>To get this again</h2><pre>{}</pre>".format(table(rows, None, ("code",)), commands)
