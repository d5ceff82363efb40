"""One look for every figure: sizes, lines, colours that colour-blind readers can tell apart, and SVG that follows the
page's light or dark theme."""

import io
import re

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402

# Name -> (colour on light paper, colour on a dark screen). The series colours are of Okabe and Ito's set, with the
# dark variants made lighter. Figures are drawn with the light ones; svg_text() swaps them for CSS variables.
PALETTE = {
    "ink": ("#1b1f24", "#e8eaed"),
    "muted": ("#6a737d", "#9aa4af"),
    "grid": ("#d9dde2", "#3a414a"),
    "blue": ("#0072b2", "#56a8e0"),
    "vermilion": ("#d55e00", "#ff8a3d"),
    "green": ("#009e73", "#2fc79b"),
    "purple": ("#b0578d", "#d992bd"),
    "amber": ("#c98a00", "#f0b840"),
    "paper": ("#fffffe", "#171b20"),
}
INK, MUTED, GRID, BLUE, VERMILION, GREEN, PURPLE, AMBER, PAPER = (PALETTE[name][0] for name in (
    "ink", "muted", "grid", "blue", "vermilion", "green", "purple", "amber", "paper"))

# Meaning of the series colours, the same in every figure.
TRUE, PREDICTED, ESTIMATED, COMMANDED = VERMILION, BLUE, GREEN, PURPLE
MODE_F, MODE_Q = BLUE, VERMILION

WIDTH = 9.0  # inches; one figure is as wide as the page's text

plt.rcParams.update({
    "figure.dpi": 100, "savefig.dpi": 150, "figure.facecolor": "none", "axes.facecolor": "none",
    "savefig.facecolor": "none", "figure.constrained_layout.use": True,
    "font.family": "sans-serif", "font.sans-serif": ["DejaVu Sans"], "font.size": 10, "axes.titlesize": 10.5,
    "axes.titleweight": "bold", "axes.titlelocation": "left", "axes.labelsize": 10, "legend.fontsize": 9,
    "legend.frameon": False, "xtick.labelsize": 9, "ytick.labelsize": 9,
    "text.color": INK, "axes.labelcolor": INK, "axes.edgecolor": MUTED, "xtick.color": MUTED, "ytick.color": MUTED,
    "xtick.labelcolor": INK, "ytick.labelcolor": INK, "axes.grid": True, "grid.color": GRID, "grid.linewidth": 0.7,
    "axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.8, "axes.axisbelow": True,
    "lines.linewidth": 1.7, "lines.markersize": 6, "svg.fonttype": "none", "svg.hashsalt": "snapwing",
    "path.simplify": True, "path.simplify_threshold": 0.3,
})


def figure(rows=1, columns=1, height=3.2, **arguments):
    """Figure and axes in the house style."""
    return plt.subplots(rows, columns, figsize=(WIDTH, height), **arguments)


def svg_text(fig):
    """The figure as inline SVG whose colours are CSS variables (--ink, --blue ...). Closes the figure."""
    stream = io.BytesIO()
    fig.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    plt.close(fig)
    text = stream.getvalue().decode("utf-8")
    text = text[text.index("<svg"):]
    for name, (light, _) in PALETTE.items():
        text = re.sub(re.escape(light) + r"\b", "var(--{})".format(name), text, flags=re.IGNORECASE)
    # The page sets the size; the viewBox keeps the proportions.
    text = re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", text, count=1)
    text = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", text, count=1)
    return text


def png_bytes(fig):
    """The figure on light paper, as a picture. Leaves the figure open."""
    stream = io.BytesIO()
    fig.savefig(stream, format="png", facecolor="white")
    return stream.getvalue()


def css_variables(index):
    """CSS declarations of the palette; index 0 = light, 1 = dark."""
    return " ".join("--{}: {};".format(name, colours[index]) for name, colours in PALETTE.items())


def label(axes, x, y, text, colour=INK, **arguments):
    """Text at a point, on a patch of paper colour so that lines do not cross it."""
    settings = {"ha": "left", "va": "bottom", "fontsize": 9, "color": colour,
                "bbox": {"facecolor": PAPER, "edgecolor": "none", "alpha": 0.75, "pad": 1.5}}
    settings.update(arguments)
    return axes.annotate(text, (x, y), xytext=settings.pop("offset", (6, 6)), textcoords="offset points", **settings)
