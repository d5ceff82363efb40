#include "snapwing/planning/pulse_planner.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <sstream>

#include "pulse_search.h"
#include "snapwing/common/error.h"
#include "snapwing/common/parallel.h"

namespace snapwing::planning {

namespace {

constexpr int ROUNDS = 5;  // search, check, learn from what failed
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

/// Best pulse that passed through the check, and how it did there.
struct BestPulse {
  vehicle::Pulse pulse;
  BoxEnsembleOutcome outcome;
};

BestPulse findBest(PulseSearch& search, const PlannerSettings& settings) {
  search.scan();
  vehicle::Pulse candidate = search.bestCandidate();
  search.addCorners(candidate);
  BestPulse best{candidate, {}};
  best.outcome.worst = -INFINITY;
  const double enough = std::max(settings.required_margin, 0.9 * settings.enough_margin);
  int idle_rounds = 0;
  for (int round = 0; round < ROUNDS && !search.cancelled(); ++round) {
    candidate = search.refine(search.bestCandidate());
    const BoxEnsembleOutcome checked = search.check(candidate);
    const double gain = search.value(candidate, checked) - search.value(best.pulse, best.outcome);
    if (gain > 0) best = {candidate, checked};
    // Enough, or two rounds that brought nothing.
    idle_rounds = gain > 0.01 ? 0 : idle_rounds + 1;
    if (checked.reached(settings.required_share) >= enough || idle_rounds == 2) break;
    search.learn(candidate, checked);
  }
  return best;
}

/// Fills in what was found, accepted or not.
void describe(PulseSearch& search, const BestPulse& best, const vehicle::Trial& trial, TransitionPlan* plan) {
  const BoxEnsemble& ensemble = search.checkedEnsemble();
  const BoxEnsembleOutcome& outcome = best.outcome;
  plan->pulse = best.pulse;
  plan->worst_margin = outcome.worst;
  plan->realisations = outcome.tried;
  plan->share_switched = static_cast<double>(outcome.switched) / outcome.tried;
  plan->nominal = ensemble.predict(0, plan->start_mode, best.pulse, trial);
  plan->worst = ensemble.predict(outcome.worst_index, plan->start_mode, best.pulse, trial);
  // The worst vehicle is asked again, by the integrator that conserves energy: the smaller margin counts.
  plan->worst_margin =
      std::min(plan->worst_margin, ensemble.margin(plan->worst.energy_margin, plan->worst.peak_travel));
  plan->worst_parameters = ensemble.model(outcome.worst_index).parameters();
  plan->worst_coordinates = ensemble.point(outcome.worst_index);
  plan->influences = search.influences(best.pulse, &plan->vertex_margin);
  plan->evaluations = search.evaluations();
  plan->predictions = search.predictions();
}

/// @param plan  its influences still in the order of the coordinates
std::string describeFailure(const TransitionPlan& plan) {
  return "no pulse is safe over the uncertainty; best pulse found: throttle " + number(plan.pulse.throttle) + " for " +
         number(plan.pulse.duration) + " s, worst margin " + number(plan.worst_margin) + ", " +
         number(100.0 * plan.share_switched, 4) + " % switch; defeated by " +
         describeCorner(plan.worst_coordinates, plan.influences);
}

TransitionPlan refused(TransitionPlan plan, const std::string& reason) {
  plan.accepted = false;
  plan.reason = reason;
  return plan;
}

}  // namespace

std::vector<std::string> plannerCoordinateNames() {
  std::vector<std::string> names = vehicle::uncertainNames();
  names.push_back("pulse length");
  return names;
}

vehicle::Pulse receivedPulse(const vehicle::Pulse& pulse, const PlannerSettings& settings, const vehicle::Radio& radio,
                             double length_error) {
  vehicle::Pulse received = pulse;
  received.duration = std::max(0.0, pulse.duration + length_error * settings.frame_jitter / radio.frame_rate);
  return received;
}

PulsePlanner::PulsePlanner(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                           const PlannerSettings& settings, const std::optional<vehicle::WingTable>& wing)
    : vehicle_(vehicle), table_(table), settings_(settings), curves_(table, wing) {
  settings_.validate();
}

TransitionPlan PulsePlanner::plan(vehicle::Mode start, const vehicle::Trial& trial) const {
  return plan(start, vehicle::otherMode(start), trial);
}

TransitionPlan PulsePlanner::plan(vehicle::Mode start, vehicle::Mode target, const vehicle::Trial& trial,
                                  const std::function<bool()>& cancelled) const {
  trial.validate();
  if (trial.mount == vehicle::Mount::BOOM) vehicle_.requireBoom("the trial");
  TransitionPlan plan;
  plan.start_mode = start;
  plan.target_mode = target;
  if (start == vehicle::Mode::UNKNOWN || target == vehicle::Mode::UNKNOWN) {
    return refused(plan, "start and target must be known modes");
  }
  if (start == target) return refused(plan, "the vehicle is in mode " + vehicle::modeName(target) + " already");
  if (!curves_.spline().equilibria().bistable) {
    return refused(plan, "the arms' force curve is not bistable: there is no second mode");
  }

  PulseSearch search(vehicle_, table_, curves_, settings_, start, trial, cancelled);
  const BestPulse best = findBest(search, settings_);
  if (search.cancelled()) return refused(plan, "cancelled");
  describe(search, best, trial, &plan);
  plan.thrust_fraction = search.checkedEnsemble().model(0).thrustFraction(vehicle_.radio, plan.pulse.throttle);
  const std::string reason = describeFailure(plan);
  std::stable_sort(plan.influences.begin(), plan.influences.end(), [](const auto& a, const auto& b) {
    return std::abs(a.high_margin - a.low_margin) > std::abs(b.high_margin - b.low_margin);
  });
  const bool all_must = settings_.required_share >= 1.0;
  const double reached = all_must ? plan.worst_margin : best.outcome.reached(settings_.required_share);
  plan.accepted = reached >= settings_.required_margin && plan.share_switched >= settings_.required_share;
  return plan.accepted ? plan : refused(plan, reason);
}

std::vector<RankedVehicle> PulsePlanner::weakest(vehicle::Mode start, const vehicle::Pulse& pulse,
                                                 const vehicle::Trial& trial, int count) const {
  PulseSearch search(vehicle_, table_, curves_, settings_, start, trial, {});
  search.addCorners(pulse);
  const std::vector<double> margins = search.check(pulse).margins;
  std::vector<int> order(margins.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return margins[a] < margins[b]; });
  order.resize(std::min<std::size_t>(order.size(), static_cast<std::size_t>(std::max(0, count))));
  std::vector<RankedVehicle> result;
  for (const int k : order) result.push_back({search.checkedEnsemble().point(k), margins[k]});
  return result;
}

OutcomeMap PulsePlanner::map(vehicle::Mode start, const vehicle::Trial& trial, int throttles, int durations,
                             const std::function<void(int done, int all)>& progress) const {
  trial.validate();
  if (throttles < 1 || durations < 1) throw common::Error("outcome map: sides must have 1 pulse or more");
  OutcomeMap map;
  map.start_mode = start;
  const PlannerSettings& s = settings_;
  const int n = static_cast<int>(plannerCoordinateNames().size());
  BoxEnsemble ensemble(vehicle_, table_, curves_, s, s.model_step);
  ensemble.add(BoxPoint(n, 0.0));
  ensemble.add(sobolPoints(n, s.search_samples, 1));
  map.realisations = ensemble.size();
  for (int i = 0; i < throttles; ++i) map.throttles.push_back(gridValue(s.throttle_min, s.throttle_max, i, throttles));
  for (int j = 0; j < durations; ++j) map.durations.push_back(gridValue(s.duration_min, s.duration_max, j, durations));
  map.cells.resize(static_cast<std::size_t>(throttles) * durations);
  std::mutex telling;
  int done = 0;
  common::parallelFor(throttles * durations, s.threads, [&](int k) {
    const vehicle::Pulse pulse = s.pulse(start, map.throttles[k / durations], map.durations[k % durations]);
    const BoxEnsembleOutcome outcome = ensemble.tryPulse(start, pulse, trial, -INFINITY, 1);
    map.cells[k] = {pulse.throttle, pulse.duration, static_cast<double>(outcome.switched) / outcome.tried,
                    outcome.worst};
    const std::lock_guard<std::mutex> lock(telling);
    if (++done; progress) progress(done, throttles * durations);
  });
  return map;
}

}  // namespace snapwing::planning
