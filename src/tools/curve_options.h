#pragma once
/// What `snapwing curve` was asked, shared by its parts: vehicles, scenes, pictures.

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "snapwing/solver/newton.h"

namespace snapwing::tools {

struct CurveOptions {
  std::string input, output, csv, summary, plot, plane = "stress", kernel, vtu, rung, resolution, enforcement,
                                                 projection = "on_demand", trade;
  std::string checkpoint;
  double cell_size = 0, step = 0.001, from = NAN, to = NAN, perturb = 0, error = NAN, seconds = NAN;
  bool no_back = false, quiet = false, json = false, arc_length = false, no_arc = false, reverse = false,
       resume = false;
  int threads = 1, particles = 0, steps = 0;
  std::vector<std::string> arm_options;  ///< those of a vehicle's planar arm that were given
};

/// @throws common::Error for the first option that was given and means nothing here. @param where  it would mean
/// something
void refuseArmOptions(const CurveOptions& options, const std::vector<std::string>& meaningless,
                      const std::string& where);

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

/// All files of a run: what it reads is known by then, what it writes is checked. @throws common::FileError
void checkFiles(const CurveOptions& options, const std::vector<std::string>& inputs, const std::string& checkpoint);

/// Prints the answer after everything is written: a reader that went away, as `| head`, costs no file.
void printAnswer(const CurveOptions& options, const nlohmann::json& summary);

/// Traces a scene as asked. @return exit code
int runScene(const CurveOptions& options);

/// Has `plot_curve` draw curve and summary, and writes the picture. @throws common::Error saying what is missing
void plotCurve(const std::string& csv, const std::string& summary, const std::string& picture);
/// @throws common::Error if such a picture cannot be drawn here: asked before the work
void requirePlotting(const std::string& picture);

}  // namespace snapwing::tools
