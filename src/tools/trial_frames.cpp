#include "trial_frames.h"

#include <cmath>
#include <cstdio>
#include <sstream>

#include "snapwing/common/output_file.h"

namespace snapwing::tools {

int TrialFrames::frameOf(const std::vector<motion::AxisSample>& samples, std::size_t k) const {
  if (!(every_ > 0) || k < 1 || k >= samples.size()) return -1;
  const auto stretch = [&](std::size_t i) { return static_cast<int>(std::floor(samples[i].time / every_ + 1e-9)); };
  return k == 1 || stretch(k) > stretch(k - 1) ? stretch(k) : -1;
}

std::string TrialFrames::fileOf(int frame) const {
  char name[40];
  std::snprintf(name, sizeof name, "frame_%04d.vtu", frame);
  return name;
}

void TrialFrames::take(const motion::AxisRun& run) const {
  if (run.samples.empty()) return;
  const int frame = frameOf(run.samples, run.samples.size() - 1);
  if (frame >= 0) common::writeFileAtomically(folder_ + "/" + fileOf(frame), vehicle_.vtu(run.state));
}

void TrialFrames::finish(const motion::AxisRun& run) const {
  if (!(every_ > 0)) return;
  std::ostringstream text;
  text.precision(12);
  text << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
  for (std::size_t k = 1; k < run.samples.size(); ++k) {
    const int frame = frameOf(run.samples, k);
    if (frame < 0) continue;
    text << "<DataSet timestep=\"" << run.samples[k].time << "\" file=\"" << fileOf(frame) << "\"/>\n";
  }
  text << "</Collection>\n</VTKFile>\n";
  common::writeFileAtomically(folder_ + "/trial.pvd", text.str());
}

}  // namespace snapwing::tools
