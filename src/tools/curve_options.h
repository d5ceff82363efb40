#pragma once
/// What `snapwing curve` was asked, shared by its parts: vehicles, scenes, pictures.

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "snapwing/common/force_table.h"
#include "snapwing/statics/newton.h"

namespace snapwing::tools {

struct CurveOptions {
  std::string input, output, csv, summary, plot, plane = "stress", kernel, vtu, rung, resolution, drive,
                                                 projection = "on_demand", trade;
  std::string checkpoint;
  double cell_size = 0, step = 0.001, from = NAN, to = NAN, perturb = 0, error = NAN, seconds = NAN;
  bool no_back = false, quiet = false, arc_length = false, no_arc = false, reverse = false, resume = false;
  int threads = 1, particles = 0, steps = 0;
};

/// SIGINT ends the run after the current iteration, with what was reached, as long as this lives.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
  static bool interrupted();

 private:
  void (*previous_)(int);
};

/// Progress on the terminal; true if the run is to stop.
bool showProgress(const CurveOptions& options, double share, double control);
bool endsWith(const std::string& text, const std::string& end);
nlohmann::json orNull(double value);
/// Outcome, counts and seconds of a path or of an arm's curve.
template <class Result>
nlohmann::json costsOf(const Result& result) {
  nlohmann::json j;
  j["status"] = statics::statusName(result.status);
  j["message"] = result.message;
  j["iterations"] = result.iterations;
  j["factorizations"] = result.factorizations;
  j["projections"] = result.projections;
  j["step_halvings"] = result.halvings;
  j["seconds"] = {{"total", result.seconds},
                  {"assembly", result.seconds_assembly},
                  {"factorization", result.seconds_factor},
                  {"solve", result.seconds_solve},
                  {"analysis", result.seconds_analysis}};
  return j;
}
/// Peak, valley, zeros by interpolation in a table.
void addFeatures(const common::ForceTable& table, nlohmann::json& j);

/// Traces a scene as asked. @return exit code
int runScene(const CurveOptions& options);

/// Draws curve and summary into a picture with `plot_curve`. @throws common::Error saying what is missing
void plotCurve(const std::string& csv, const std::string& summary, const std::string& picture);
/// @throws common::Error if pictures cannot be drawn here: asked before the work
void requirePlotting();

}  // namespace snapwing::tools
