#pragma once
/// A plot of lines as SVG text. Private to the layer.

#include <string>
#include <vector>

namespace snapwing::validation {

struct PlotLine {
  std::string name;
  std::vector<double> x, y;
  std::string colour;  ///< CSS
  bool dashed = false;
};

/// Axes with round ticks, a grid, and a legend with each name once. Points that are not finite are left out.
std::string linePlot(const std::string& title, const std::string& x_label, const std::string& y_label,
                     const std::vector<PlotLine>& lines);

/// Text for HTML and SVG: & < > " are written as entities.
std::string escaped(const std::string& text);

}  // namespace snapwing::validation
