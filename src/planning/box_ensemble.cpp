#include "box_ensemble.h"

#include <algorithm>
#include <cmath>

#include "snapwing/common/parallel.h"

namespace snapwing::planning {

namespace {

rom::LumpedSettings withStep(rom::LumpedSettings settings, double step) {
  settings.step = step;
  return settings;
}

}  // namespace

BoxEnsemble::BoxEnsemble(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                         const rom::VehicleCurves& curves, const PlannerSettings& settings, double step)
    : vehicle_(vehicle),
      table_(table),
      curves_(curves),
      settings_(settings),
      step_(step),
      ensemble_(curves, vehicle.radio, {withStep(settings.model, step)}) {}

void BoxEnsemble::add(const BoxPoint& point) {
  const BoxPoint parameters(point.begin(), point.end() - 1);
  const vehicle::VehicleParameters p = vehicle::realise(vehicle_, table_, parameters);
  parameters_.push_back(p);
  ensemble_.add(p);
  points_.push_back(point);
}

void BoxEnsemble::add(const std::vector<BoxPoint>& points) {
  for (const BoxPoint& point : points) add(point);
}

rom::LumpedModel BoxEnsemble::model(int index) const {
  return curves_.model(vehicle_.radio, parameters_[index], settings_.model);
}

vehicle::Pulse BoxEnsemble::received(int index, const vehicle::Pulse& pulse) const {
  return receivedPulse(pulse, settings_, vehicle_.radio, points_[index].back());
}

rom::SnapPrediction BoxEnsemble::predict(int index, vehicle::Mode start, const vehicle::Pulse& pulse,
                                         const vehicle::Trial& trial) const {
  return model(index).predict(start, received(index, pulse), vehicle_.radio, trial);
}

double BoxEnsemble::margin(double energy_margin, double peak_travel) const {
  if (settings_.allow_out_of_table) return energy_margin;
  // Stretched beyond the table or the stop by 10 mm costs as much as missing the whole barrier: the energy stored there
  // is a guess. The other end does not count: what the model does not know there, a stop, only takes energy away.
  const double beyond = peak_travel - std::min(vehicle_.limits.travel_max, curves_.spline().highest());
  return beyond > 0 ? std::min(energy_margin, -beyond / 0.010) : energy_margin;
}

double BoxEnsembleOutcome::reached(double share) const {
  const auto allowed = static_cast<std::size_t>((1.0 - share) * static_cast<double>(margins.size()) + 1e-9);
  if (allowed == 0) return worst;
  std::vector<double> sorted = margins;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(allowed), sorted.end());
  return sorted[allowed];
}

BoxEnsembleOutcome BoxEnsemble::tryPulse(vehicle::Mode start, const vehicle::Pulse& pulse, const vehicle::Trial& trial,
                                         double give_up, int threads, const BoxEnsembleOutcome& known) const {
  constexpr int LANES = rom::Ensemble::SIDE_BY_SIDE;
  BoxEnsembleOutcome outcome = known;
  const auto hopeless = [&] { return settings_.required_share >= 1.0 && outcome.worst < give_up; };
  std::vector<double> durations(size());
  for (int i = 0; i < size(); ++i) durations[i] = received(i, pulse).duration;
  const int block = std::isinf(give_up) ? size() : LANES;  // as many as the answer needs in any case
  std::vector<rom::EnsembleOutcome> found(block);
  for (int first = known.tried; first < size() && !hopeless(); first += block) {
    const int count = std::min(block, size() - first);
    // Whole lanes of vehicles for each thread, and not less at once: the ensemble chooses who goes beside whom.
    const int per_thread = (count + LANES * threads - 1) / (LANES * threads) * LANES;
    common::parallelFor((count + per_thread - 1) / per_thread, threads, [&](int part) {
      const int begin = part * per_thread;
      const auto some =
          ensemble_.predict(start, pulse, durations, trial, first + begin, std::min(per_thread, count - begin));
      std::copy(some.begin(), some.end(), found.begin() + begin);
    });
    for (int i = 0; i < count; ++i) {
      outcome.switched += found[i].snapped;
      ++outcome.tried;
      const double here = margin(found[i].energy_margin, found[i].peak_travel);
      outcome.margins.push_back(here);
      if (here < outcome.worst) {
        outcome.worst = here;
        outcome.worst_index = first + i;
      }
    }
  }
  return outcome;
}

}  // namespace snapwing::planning
