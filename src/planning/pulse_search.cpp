#include "pulse_search.h"

#include <algorithm>
#include <nlopt.hpp>
#include <numeric>
#include <utility>

#include "snapwing/common/parallel.h"

namespace snapwing::planning {

namespace {
constexpr int LEARNED = 8;      // realisations taken over from a failed check
constexpr int CANDIDATES = 12;  // pulses of the scan that may be returned to
}  // namespace

PulseSearch::PulseSearch(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                         const rom::VehicleCurves& curves, const PlannerSettings& settings, vehicle::Mode start,
                         const vehicle::Trial& trial, std::function<bool()> cancelled)
    : settings_(settings),
      start_(start),
      trial_(trial),
      cancelled_(std::move(cancelled)),
      ensemble_(vehicle, table, curves, settings, settings.model_step),
      checked_(vehicle, table, curves, settings, 0.5 * settings.model_step) {
  const int n = static_cast<int>(plannerCoordinateNames().size());
  ensemble_.add(BoxPoint(n, 0.0));
  ensemble_.add(sobolPoints(n, settings.search_samples, 1));
  checked_.add(BoxPoint(n, 0.0));
  checked_.add(sobolPoints(n, settings.verify_samples, 1 + settings.search_samples));
  // Both ends of each number alone: a cliff right at an end hides from any number of samples.
  checked_.add(axisPoints(n));
}

void PulseSearch::scan() {
  const PlannerSettings& s = settings_;
  std::vector<std::pair<double, Candidate>> found;
  double best_value = -INFINITY;
  for (int row = 0; row < s.scan_throttles && !cancelled(); ++row) {
    // A row shares the bound known before it, so that the threads' order does not matter.
    const double give_up = std::min(best_value, 0.0);
    std::vector<BoxEnsembleOutcome> outcomes(s.scan_durations);
    const double throttle = gridValue(s.throttle_max, s.throttle_min, row, s.scan_throttles);
    const auto pulseAt = [&](int j) {
      return s.pulse(start_, throttle, gridValue(s.duration_min, s.duration_max, j, s.scan_durations));
    };
    common::parallelFor(s.scan_durations, s.threads,
                        [&](int j) { outcomes[j] = ensemble_.tryPulse(start_, pulseAt(j), trial_, give_up, 1); });
    for (int j = 0; j < s.scan_durations; ++j) {
      ++evaluations_;
      predictions_ += outcomes[j].tried;
      const double v = value(pulseAt(j), outcomes[j]);
      best_value = std::max(best_value, v);
      found.emplace_back(v, Candidate{pulseAt(j), std::move(outcomes[j])});
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  found.resize(std::min<std::size_t>(found.size(), CANDIDATES));
  for (auto& [v, candidate] : found) candidates_.push_back(std::move(candidate));
}

vehicle::Pulse PulseSearch::bestCandidate() {
  vehicle::Pulse best = settings_.pulse(start_, settings_.throttle_max, settings_.duration_max);
  double best_value = -INFINITY;
  for (auto& [pulse, known] : candidates_) {
    const int before = known.tried;
    known = ensemble_.tryPulse(start_, pulse, trial_, best_value, settings_.threads, known);
    ++evaluations_;
    predictions_ += known.tried - before;
    const double v = value(pulse, known);
    if (v > best_value) {
      best_value = v;
      best = pulse;
    }
  }
  return best;
}

void PulseSearch::learn(const vehicle::Pulse& pulse, const BoxEnsembleOutcome& checked) {
  std::vector<int> order(checked.margins.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return checked.margins[a] < checked.margins[b]; });
  order.resize(std::min<std::size_t>(order.size(), LEARNED));
  for (const int index : order) {
    if (checked.margins[index] < settings_.enough_margin) ensemble_.add(checked_.point(index));
  }
  candidates_.push_back({pulse, {}});
}

vehicle::Pulse PulseSearch::refine(const vehicle::Pulse& from) {
  const PlannerSettings& s = settings_;
  if (s.refine_evaluations == 0) return from;
  vehicle::Pulse best = from;
  double best_value = -INFINITY;
  nlopt::opt optimiser(nlopt::LN_SBPLX, 2);
  optimiser.set_lower_bounds({s.throttle_min, s.duration_min});
  optimiser.set_upper_bounds({s.throttle_max, s.duration_max});
  optimiser.set_initial_step({0.5 * (s.throttle_max - s.throttle_min) / s.scan_throttles,
                              0.5 * (s.duration_max - s.duration_min) / s.scan_durations});
  optimiser.set_xtol_abs(1e-4);
  optimiser.set_maxeval(s.refine_evaluations);
  struct Closure {
    PulseSearch* search;
    vehicle::Pulse* best;
    double* best_value;
    nlopt::opt* optimiser;
  } closure{this, &best, &best_value, &optimiser};
  optimiser.set_max_objective(
      [](const std::vector<double>& x, std::vector<double>&, void* data) {
        auto& c = *static_cast<Closure*>(data);
        PulseSearch& search = *c.search;
        if (search.cancelled()) c.optimiser->force_stop();
        const vehicle::Pulse pulse = search.settings_.pulse(search.start_, x[0], x[1]);
        const BoxEnsembleOutcome outcome =
            search.ensemble_.tryPulse(search.start_, pulse, search.trial_, -INFINITY, search.settings_.threads);
        ++search.evaluations_;
        search.predictions_ += outcome.tried;
        const double v = search.value(pulse, outcome);
        if (v > *c.best_value) {
          *c.best_value = v;
          *c.best = pulse;
        }
        return v;
      },
      &closure);
  std::vector<double> x = {std::clamp(from.throttle, s.throttle_min, s.throttle_max),
                           std::clamp(from.duration, s.duration_min, s.duration_max)};
  double reached = 0;
  try {
    optimiser.optimize(x, reached);
  } catch (const nlopt::forced_stop&) {
    // cancelled
  } catch (const nlopt::roundoff_limited&) {
    // the best so far is kept
  }
  return best;
}

std::vector<ParameterInfluence> PulseSearch::influences(const vehicle::Pulse& pulse, double* vertex_margin) {
  const std::vector<std::string> names = plannerCoordinateNames();
  const int n = static_cast<int>(names.size());
  BoxEnsemble axes = checked_.emptyCopy();
  axes.add(axisPoints(n));
  const std::vector<double> margins = axes.tryPulse(start_, pulse, trial_, -INFINITY, settings_.threads).margins;
  predictions_ += 2 * n;
  std::vector<ParameterInfluence> result(n);
  BoxPoint vertex(n);
  for (int i = 0; i < n; ++i) {
    result[i] = {names[i], margins[2 * i], margins[2 * i + 1]};
    vertex[i] = margins[2 * i] < margins[2 * i + 1] ? -1.0 : 1.0;
  }
  if (vertex_margin) {
    BoxEnsemble corner = checked_.emptyCopy();
    corner.add(vertex);
    *vertex_margin = corner.tryPulse(start_, pulse, trial_, -INFINITY, 1).worst;
    ++predictions_;
  }
  return result;
}

void PulseSearch::addCorners(const vehicle::Pulse& pulse) {
  const std::vector<ParameterInfluence> effects = influences(pulse, nullptr);
  std::vector<int> order(effects.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return std::abs(effects[a].high_margin - effects[a].low_margin) >
           std::abs(effects[b].high_margin - effects[b].low_margin);
  });
  order.resize(std::min<std::size_t>(order.size(), settings_.corner_parameters));
  const std::vector<BoxPoint> corners = cornerPoints(static_cast<int>(effects.size()), order);
  ensemble_.add(corners);
  checked_.add(corners);
}

BoxEnsembleOutcome PulseSearch::check(const vehicle::Pulse& pulse) {
  const BoxEnsembleOutcome outcome = checked_.tryPulse(start_, pulse, trial_, -INFINITY, settings_.threads);
  ++evaluations_;
  predictions_ += outcome.tried;
  return outcome;
}

}  // namespace snapwing::planning
