#include "line_plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace snapwing::validation {

namespace {

constexpr double WIDTH = 620, HEIGHT = 340, LEFT = 62, RIGHT = 16, TOP = 30, BOTTOM = 46;
constexpr double LEGEND_ROW = 16;

struct Span {
  double low = INFINITY, high = -INFINITY;
  void take(const std::vector<double>& values) {
    for (const double v : values) {
      if (!std::isfinite(v)) continue;
      low = std::min(low, v), high = std::max(high, v);
    }
  }
  void widen() {
    if (!(high > low)) low -= 1, high += 1;
    const double edge = 0.04 * (high - low);
    low -= edge, high += edge;
  }
};

/// 1, 2 or 5 times a power of ten, so that about six of them fit.
double tickOf(const Span& span) {
  const double raw = (span.high - span.low) / 6, power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw) return factor * power;
  }
  return 10 * power;
}

std::string number(double value, const char* format = "%.1f") {
  char text[40];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

class Canvas {
 public:
  Canvas(const Span& x, const Span& y) : x_(x), y_(y) {}
  double atX(double x) const { return LEFT + (WIDTH - LEFT - RIGHT) * (x - x_.low) / (x_.high - x_.low); }
  double atY(double y) const { return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * (y - y_.low) / (y_.high - y_.low); }

  std::string grid() const {
    std::string svg;
    const double dx = tickOf(x_), dy = tickOf(y_);
    for (double t = std::ceil(x_.low / dx) * dx; t <= x_.high; t += dx) {
      const std::string at = number(atX(t));
      svg += "<line class='grid' x1='" + at + "' x2='" + at + "' y1='" + number(TOP) + "' y2='" +
             number(HEIGHT - BOTTOM) + "'/><text x='" + at + "' y='" + number(HEIGHT - BOTTOM + 16) +
             "' text-anchor='middle'>" + number(std::abs(t) < 1e-9 * dx ? 0 : t, "%g") + "</text>\n";
    }
    for (double t = std::ceil(y_.low / dy) * dy; t <= y_.high; t += dy) {
      const std::string at = number(atY(t));
      svg += "<line class='grid' x1='" + number(LEFT) + "' x2='" + number(WIDTH - RIGHT) + "' y1='" + at + "' y2='" +
             at + "'/><text x='" + number(LEFT - 6) + "' y='" + number(atY(t) + 4) + "' text-anchor='end'>" +
             number(std::abs(t) < 1e-9 * dy ? 0 : t, "%g") + "</text>\n";
    }
    return svg;
  }

  std::string line(const PlotLine& line) const {
    std::string points;
    for (std::size_t k = 0; k < line.x.size(); ++k) {
      if (std::isfinite(line.x[k]) && std::isfinite(line.y[k]))
        points += number(atX(line.x[k])) + "," + number(atY(line.y[k])) + " ";
    }
    return "<polyline fill='none' stroke-width='1.8' stroke='" + line.colour + "'" +
           (line.dashed ? " stroke-dasharray='6 4'" : "") + " points='" + points + "'/>\n";
  }

 private:
  Span x_, y_;
};

/// One line of each name.
std::vector<PlotLine> named(const std::vector<PlotLine>& lines) {
  std::vector<PlotLine> found;
  for (const PlotLine& line : lines) {
    const auto same = [&](const PlotLine& other) { return other.name == line.name; };
    if (std::none_of(found.begin(), found.end(), same)) found.push_back(line);
  }
  return found;
}

/// Below the axes, in two columns: within them it would cover lines.
std::string legend(const std::vector<PlotLine>& lines) {
  std::string svg;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const PlotLine& line = lines[k];
    const double x = k % 2 == 0 ? LEFT : 0.5 * (LEFT + WIDTH - RIGHT), y = HEIGHT + 8 + LEGEND_ROW * (k / 2);
    svg += "<line x1='" + number(x) + "' x2='" + number(x + 24) + "' y1='" + number(y) + "' y2='" + number(y) +
           "' stroke-width='2' stroke='" + line.colour + "'" + (line.dashed ? " stroke-dasharray='6 4'" : "") +
           "/><text x='" + number(x + 30) + "' y='" + number(y + 4) + "'>" + escaped(line.name) + "</text>\n";
  }
  return svg;
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else {
      out += c;
    }
  }
  return out;
}

std::string linePlot(const std::string& title, const std::string& x_label, const std::string& y_label,
                     const std::vector<PlotLine>& lines) {
  Span x, y;
  for (const PlotLine& line : lines) x.take(line.x), y.take(line.y);
  x.widen(), y.widen();
  const Canvas canvas(x, y);
  const std::vector<PlotLine> keys = named(lines);
  const double height = HEIGHT + LEGEND_ROW * std::ceil(0.5 * keys.size());
  std::string svg = "<svg viewBox='0 0 " + number(WIDTH, "%g") + " " + number(height, "%g") +
                    "' role='img' aria-label='" + escaped(title) + "'>\n<text class='title' x='" + number(LEFT) +
                    "' y='18'>" + escaped(title) + "</text>\n" + canvas.grid();
  for (const PlotLine& line : lines) svg += canvas.line(line);
  svg += legend(keys);
  svg += "<text x='" + number(0.5 * (LEFT + WIDTH - RIGHT)) + "' y='" + number(HEIGHT - 8) + "' text-anchor='middle'>" +
         escaped(x_label) + "</text>\n<text transform='rotate(-90)' x='" + number(-0.5 * (TOP + HEIGHT - BOTTOM)) +
         "' y='14' text-anchor='middle'>" + escaped(y_label) + "</text>\n</svg>\n";
  return svg;
}

}  // namespace snapwing::validation
