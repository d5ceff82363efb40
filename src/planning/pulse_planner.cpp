#include "snapwing/planning/pulse_planner.h"

#include <algorithm>
#include <cmath>
#include <nlopt.hpp>
#include <numeric>
#include <sstream>

#include "fleet.h"

namespace snapwing::planning {

namespace {

constexpr int ROUNDS = 5;       // search, check, learn from what failed
constexpr int LEARNED = 8;      // realisations taken over from a failed check
constexpr int CANDIDATES = 12;  // pulses of the scan that may be returned to

/// One search: the fleet grows by what the check finds.
class Search {
 public:
  Search(const common::Vehicle& vehicle, const common::ForceTable& table, const PlannerSettings& settings,
         common::Mode start, const rom::Trial& trial, const std::function<bool()>& cancelled)
      : settings_(settings),
        start_(start),
        trial_(trial),
        cancelled_(cancelled),
        fleet_(vehicle, table, settings, settings.model_step),
        checked_(vehicle, table, settings, settings.model.step) {
    const int n = static_cast<int>(plannerCoordinateNames().size());
    fleet_.add(BoxPoint(n, 0.0));
    fleet_.add(sobolPoints(n, settings.search_samples, 1));
    checked_.add(BoxPoint(n, 0.0));
    checked_.add(sobolPoints(n, settings.verify_samples, 1 + settings.search_samples));
  }

  /// Coarse scan; keeps its best pulses.
  void scan();
  /// Best of the pulses kept, by all realisations known so far.
  common::Pulse bestCandidate();
  /// NLopt from a pulse.
  common::Pulse refine(const common::Pulse& from);
  /// Effects of single parameters; adds the corners of those that matter most to both fleets.
  void addCorners(const common::Pulse& pulse);
  std::vector<ParameterInfluence> influences(const common::Pulse& pulse, double* vertex_margin);
  /// Full check with fresh realisations.
  FleetOutcome check(const common::Pulse& pulse);
  /// Takes the worst of a check into the search.
  void learn(const common::Pulse& pulse, const FleetOutcome& checked);

  /// What is maximised: worst margin (of the share that must switch), capped where there is enough of it, less the
  /// price of the impulse.
  double value(const common::Pulse& pulse, const FleetOutcome& outcome) const {
    const double margin = outcome.reached(settings_.required_share);
    if (!(margin > 0)) return margin;
    return std::min(margin, settings_.enough_margin) - settings_.impulse_price * pulse.throttle * pulse.duration;
  }
  bool cancelled() const { return cancelled_ && cancelled_(); }
  const Fleet& checkedFleet() const { return checked_; }
  int evaluations() const { return evaluations_; }
  long predictions() const { return predictions_; }

 private:
  const PlannerSettings& settings_;
  common::Mode start_;
  const rom::Trial& trial_;
  const std::function<bool()>& cancelled_;
  Fleet fleet_, checked_;
  std::vector<common::Pulse> candidates_;
  int evaluations_ = 0;
  long predictions_ = 0;
};

double gridValue(double low, double high, int index, int count) {
  return count > 1 ? low + (high - low) * index / (count - 1) : low;
}

void Search::scan() {
  const PlannerSettings& s = settings_;
  std::vector<std::pair<double, common::Pulse>> found;
  double best_value = -INFINITY;
  for (int row = 0; row < s.scan_throttles && !cancelled(); ++row) {
    // A row shares the bound known before it, so that the threads' order does not matter.
    const double give_up = std::min(best_value, 0.0);
    std::vector<FleetOutcome> outcomes(s.scan_durations);
    const double throttle = gridValue(s.throttle_max, s.throttle_min, row, s.scan_throttles);
    const auto pulseAt = [&](int j) {
      return common::Pulse{throttle, gridValue(s.duration_min, s.duration_max, j, s.scan_durations)};
    };
    parallelFor(s.scan_durations, s.threads,
                [&](int j) { outcomes[j] = fleet_.tryPulse(start_, pulseAt(j), trial_, give_up, 1); });
    for (int j = 0; j < s.scan_durations; ++j) {
      ++evaluations_;
      predictions_ += outcomes[j].tried;
      const double v = value(pulseAt(j), outcomes[j]);
      best_value = std::max(best_value, v);
      found.emplace_back(v, pulseAt(j));
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  found.resize(std::min<std::size_t>(found.size(), CANDIDATES));
  for (const auto& [v, pulse] : found) candidates_.push_back(pulse);
}

common::Pulse Search::bestCandidate() {
  common::Pulse best{settings_.throttle_max, settings_.duration_max};
  double best_value = -INFINITY;
  for (const common::Pulse& pulse : candidates_) {
    const FleetOutcome outcome = fleet_.tryPulse(start_, pulse, trial_, best_value, settings_.threads);
    ++evaluations_;
    predictions_ += outcome.tried;
    const double v = value(pulse, outcome);
    if (v > best_value) {
      best_value = v;
      best = pulse;
    }
  }
  return best;
}

void Search::learn(const common::Pulse& pulse, const FleetOutcome& checked) {
  std::vector<int> order(checked.margins.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return checked.margins[a] < checked.margins[b]; });
  order.resize(std::min<std::size_t>(order.size(), LEARNED));
  for (const int index : order) {
    if (checked.margins[index] < settings_.enough_margin) fleet_.add(checked_.point(index));
  }
  candidates_.push_back(pulse);
}

common::Pulse Search::refine(const common::Pulse& from) {
  const PlannerSettings& s = settings_;
  if (s.refine_evaluations == 0) return from;
  common::Pulse best = from;
  double best_value = -INFINITY;
  nlopt::opt optimiser(nlopt::LN_SBPLX, 2);
  optimiser.set_lower_bounds({s.throttle_min, s.duration_min});
  optimiser.set_upper_bounds({s.throttle_max, s.duration_max});
  optimiser.set_initial_step({0.5 * (s.throttle_max - s.throttle_min) / s.scan_throttles,
                              0.5 * (s.duration_max - s.duration_min) / s.scan_durations});
  optimiser.set_xtol_abs(1e-4);
  optimiser.set_maxeval(s.refine_evaluations);
  struct Closure {
    Search* search;
    common::Pulse* best;
    double* best_value;
    nlopt::opt* optimiser;
  } closure{this, &best, &best_value, &optimiser};
  optimiser.set_max_objective(
      [](const std::vector<double>& x, std::vector<double>&, void* data) {
        auto& c = *static_cast<Closure*>(data);
        Search& search = *c.search;
        if (search.cancelled()) c.optimiser->force_stop();
        const common::Pulse pulse{x[0], x[1]};
        const FleetOutcome outcome =
            search.fleet_.tryPulse(search.start_, pulse, search.trial_, -INFINITY, search.settings_.threads);
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

std::vector<ParameterInfluence> Search::influences(const common::Pulse& pulse, double* vertex_margin) {
  const std::vector<std::string> names = plannerCoordinateNames();
  const int n = static_cast<int>(names.size());
  Fleet axes = checked_.emptyCopy();
  axes.add(axisPoints(n));
  std::vector<double> margins(2 * n);
  parallelFor(2 * n, settings_.threads,
              [&](int i) { margins[i] = axes.margin(axes.predict(i, start_, pulse, trial_)); });
  predictions_ += 2 * n;
  std::vector<ParameterInfluence> result(n);
  BoxPoint vertex(n);
  for (int i = 0; i < n; ++i) {
    result[i] = {names[i], margins[2 * i], margins[2 * i + 1]};
    vertex[i] = margins[2 * i] < margins[2 * i + 1] ? -1.0 : 1.0;
  }
  if (vertex_margin) {
    axes.add(vertex);
    *vertex_margin = axes.margin(axes.predict(2 * n, start_, pulse, trial_));
    ++predictions_;
  }
  return result;
}

void Search::addCorners(const common::Pulse& pulse) {
  const std::vector<ParameterInfluence> effects = influences(pulse, nullptr);
  std::vector<int> order(effects.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return std::abs(effects[a].high_margin - effects[a].low_margin) >
           std::abs(effects[b].high_margin - effects[b].low_margin);
  });
  order.resize(std::min<std::size_t>(order.size(), settings_.corner_parameters));
  const std::vector<BoxPoint> corners = cornerPoints(static_cast<int>(effects.size()), order);
  fleet_.add(corners);
  checked_.add(corners);
}

FleetOutcome Search::check(const common::Pulse& pulse) {
  const FleetOutcome outcome = checked_.tryPulse(start_, pulse, trial_, -INFINITY, settings_.threads);
  ++evaluations_;
  predictions_ += outcome.tried;
  return outcome;
}

std::string number(double value, int digits = 3) {
  std::ostringstream text;
  text.precision(digits);
  text << value;
  return text.str();
}

/// The coordinates of a realisation that hurt most, in words.
std::string describeCorner(const BoxPoint& point, const std::vector<ParameterInfluence>& influences) {
  std::vector<std::size_t> order(point.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto harm = [&](std::size_t i) {
    return 0.5 * point[i] * (influences[i].high_margin - influences[i].low_margin);
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return harm(a) < harm(b); });
  std::string text;
  for (std::size_t k = 0; k < std::min<std::size_t>(3, order.size()); ++k) {
    if (harm(order[k]) >= 0) break;
    text += (text.empty() ? "" : ", ") + influences[order[k]].name + (point[order[k]] < 0 ? " low" : " high");
  }
  return text.empty() ? "nominal parameters" : text;
}

TransitionPlan refused(TransitionPlan plan, const std::string& reason) {
  plan.accepted = false;
  plan.reason = reason;
  return plan;
}

}  // namespace

std::vector<std::string> plannerCoordinateNames() {
  std::vector<std::string> names = common::uncertainNames();
  names.push_back("pulse length");
  return names;
}

PulsePlanner::PulsePlanner(const common::Vehicle& vehicle, const common::ForceTable& table,
                           const PlannerSettings& settings)
    : vehicle_(vehicle), table_(table), settings_(settings) {
  settings_.validate();
  table_.validate();
}

TransitionPlan PulsePlanner::plan(common::Mode start, const rom::Trial& trial) const {
  return plan(start, common::otherMode(start), trial);
}

TransitionPlan PulsePlanner::plan(common::Mode start, common::Mode target, const rom::Trial& trial,
                                  const std::function<bool()>& cancelled) const {
  trial.validate();
  TransitionPlan plan;
  plan.start_mode = start;
  plan.target_mode = target;
  if (start == common::Mode::UNKNOWN || target == common::Mode::UNKNOWN) {
    return refused(plan, "start and target must be known modes");
  }
  if (start == target) return refused(plan, "the vehicle is in mode " + common::modeName(target) + " already");
  if (!rom::EnergySpline(table_).equilibria().bistable) {
    return refused(plan, "the arms' force curve is not bistable: there is no second mode");
  }

  Search search(vehicle_, table_, settings_, start, trial, cancelled);
  search.scan();
  common::Pulse candidate = search.bestCandidate(), pulse = candidate;
  search.addCorners(candidate);
  FleetOutcome outcome;
  outcome.worst = -INFINITY;
  int idle_rounds = 0;
  for (int round = 0; round < ROUNDS && !search.cancelled(); ++round) {
    candidate = search.refine(search.bestCandidate());
    const FleetOutcome checked = search.check(candidate);
    const double gain = search.value(candidate, checked) - search.value(pulse, outcome);
    if (gain > 0) {
      pulse = candidate;
      outcome = checked;
    }
    // Enough, or two rounds that brought nothing.
    idle_rounds = gain > 0.01 ? 0 : idle_rounds + 1;
    if (checked.reached(settings_.required_share) >= 0.9 * settings_.enough_margin || idle_rounds == 2) break;
    search.learn(candidate, checked);
  }
  if (search.cancelled()) return refused(plan, "cancelled");

  const Fleet& fleet = search.checkedFleet();
  plan.pulse = pulse;
  plan.worst_margin = outcome.worst;
  plan.realisations = outcome.tried;
  plan.share_switched = static_cast<double>(outcome.switched) / outcome.tried;
  plan.thrust_fraction = fleet.model(0).thrustFraction(vehicle_.radio, pulse.throttle);
  plan.nominal = fleet.predict(0, start, pulse, trial);
  plan.worst = fleet.predict(outcome.worst_index, start, pulse, trial);
  plan.worst_parameters = fleet.model(outcome.worst_index).parameters();
  plan.worst_coordinates = fleet.point(outcome.worst_index);
  plan.influences = search.influences(pulse, &plan.vertex_margin);
  plan.evaluations = search.evaluations();
  plan.predictions = search.predictions();

  const std::string found = "best pulse found: throttle " + number(pulse.throttle) + " for " + number(pulse.duration) +
                            " s, worst margin " + number(plan.worst_margin) + ", " +
                            number(100.0 * plan.share_switched, 4) + " % switch; defeated by " +
                            describeCorner(plan.worst_coordinates, plan.influences);
  std::stable_sort(plan.influences.begin(), plan.influences.end(), [](const auto& a, const auto& b) {
    return std::abs(a.high_margin - a.low_margin) > std::abs(b.high_margin - b.low_margin);
  });
  const bool enough = outcome.reached(settings_.required_share) >= settings_.required_margin &&
                      plan.share_switched >= settings_.required_share;
  if (!enough) return refused(plan, "no pulse is safe over the uncertainty; " + found);
  plan.accepted = true;
  return plan;
}

OutcomeMap PulsePlanner::map(common::Mode start, const rom::Trial& trial, int throttles, int durations) const {
  trial.validate();
  OutcomeMap map;
  map.start_mode = start;
  const PlannerSettings& s = settings_;
  const int n = static_cast<int>(plannerCoordinateNames().size());
  Fleet fleet(vehicle_, table_, s, s.model_step);
  fleet.add(BoxPoint(n, 0.0));
  fleet.add(sobolPoints(n, s.search_samples, 1));
  map.realisations = fleet.size();
  for (int i = 0; i < throttles; ++i) map.throttles.push_back(gridValue(s.throttle_min, s.throttle_max, i, throttles));
  for (int j = 0; j < durations; ++j) map.durations.push_back(gridValue(s.duration_min, s.duration_max, j, durations));
  map.cells.resize(static_cast<std::size_t>(throttles) * durations);
  parallelFor(throttles * durations, s.threads, [&](int k) {
    const common::Pulse pulse{map.throttles[k / durations], map.durations[k % durations]};
    const FleetOutcome outcome = fleet.tryPulse(start, pulse, trial, -INFINITY, 1);
    map.cells[k] = {pulse.throttle, pulse.duration, static_cast<double>(outcome.switched) / outcome.tried,
                    outcome.worst};
  });
  return map;
}

}  // namespace snapwing::planning
