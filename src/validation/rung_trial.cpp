#include "snapwing/validation/rung_trial.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>

#include "snapwing/common/bisection.h"
#include "snapwing/common/error.h"
#include "snapwing/motion/axis_trial.h"
#include "snapwing/rom/loaded_basins.h"

namespace snapwing::validation {

namespace {

constexpr std::size_t MOST_POINTS = 400;  // of a series that is kept

double threadSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Every n-th row, and the last.
void thin(std::vector<double>& values) {
  const std::size_t every = (values.size() + MOST_POINTS - 1) / MOST_POINTS;
  if (every < 2) return;
  std::vector<double> kept;
  for (std::size_t k = 0; k < values.size(); k += every) kept.push_back(values[k]);
  kept.push_back(values.back());
  values = kept;
}

using common::Bracket;
constexpr int MOST_HALVINGS = 60;  // beyond them a number has no more digits

/// Where something begins to be, near a place: steps away from `near` grow from `first` on, each twice the last.
/// @return NaN if there is none within `farthest`
template <class Is>
Bracket bracketNear(double near, double first, double farthest, double resolution, const Is& is) {
  constexpr Bracket NONE{NAN, NAN};
  double away = first;
  Bracket found{std::max(0.0, near - away), near + away};
  while (found.low > 0 && is(found.low)) {
    found.high = found.low, away *= 2, found.low = std::max(0.0, near - away);
    if (away > farthest) return NONE;
  }
  for (away = first; !is(found.high);) {
    found.low = found.high, away *= 2, found.high = near + away;
    if (away > farthest) return NONE;
  }
  return common::bisect(found, is, MOST_HALVINGS, resolution);
}

}  // namespace

/// Static curves of solids of the nominal arm; each is traced once, by whoever asks first, and the others wait for it.
class SolidCurves {
 public:
  template <class Trace>
  const vehicle::ForceTable& of(const RungTrial& trial, const Trace& trace) {
    Entry& entry = entryOf({static_cast<int>(trial.rung), static_cast<int>(trial.kernel), trial.cell_size});
    const std::lock_guard<std::mutex> lock(entry.mutex);
    if (!entry.table) entry.table = trace();
    return *entry.table;
  }

 private:
  using Key = std::tuple<int, int, double>;
  struct Entry {
    std::mutex mutex;
    std::optional<vehicle::ForceTable> table;
  };
  Entry& entryOf(const Key& key) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return entries_[key];
  }
  std::mutex mutex_;
  std::map<Key, Entry> entries_;
};

RungRunner::RungRunner(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                       const std::optional<vehicle::WingTable>& wing, const std::string& body,
                       std::function<bool()> cancelled)
    : vehicle_(vehicle),
      table_(table),
      wing_(wing),
      printed_(vehicle),
      cancelled_(std::move(cancelled)),
      curves_(std::make_shared<SolidCurves>()) {
  if (!body.empty()) printed_.arm.density_file = body;
}

vehicle::VehicleParameters RungRunner::parametersOf(const RungTrial& trial) const {
  return vehicle::realise(vehicle_, table_, trial.box);
}

motion::AxisSettings RungRunner::settingsOf(const RungTrial& trial) const {
  motion::AxisSettings settings;
  settings.dimension = trial.rung == motion::TrialRung::VOLUMETRIC ? 3 : 2;
  settings.cell_size = trial.cell_size;
  settings.kernel = trial.kernel;
  settings.damping = trial.damping;
  settings.coarsening = mpm::Coarsening::STIFFNESS;
  settings.cancelled = cancelled_;
  return settings;
}

rom::LumpedModel RungRunner::lumpedOf(const RungTrial& trial) const {
  const vehicle::ForceTable& curve = trial.curve ? *trial.curve : table_;
  return rom::LumpedModel::fromVehicle(vehicle_, curve, parametersOf(trial), {}, wing_);
}

RungOutcome RungRunner::runLumped(const RungTrial& trial) const {
  const rom::LumpedModel model = lumpedOf(trial);
  RungOutcome out;
  const rom::SnapPrediction p =
      model.predict(trial.start, trial.pulse, vehicle_.radio, trial.trial, [&](const rom::LumpedState& s) {
        out.time.push_back(s.time);
        out.travel.push_back(s.travel);
        out.thrust.push_back(s.thrust);
        return true;
      });
  out.end = p.end_mode, out.snapped = p.snapped, out.snap_time = p.snap_time;
  out.peak_travel = p.peak_travel, out.least_travel = p.least_travel, out.margin = p.energy_margin;
  return out;
}

RungOutcome RungRunner::runOnCurve(const RungTrial& trial) const {
  RungTrial lumped = trial;
  lumped.curve = curves_->of(trial, [&] {
    RungTrial nominal = trial;
    nominal.box.clear();
    return solidOf(nominal).staticTable();
  });
  return runLumped(lumped);
}

RungOutcome RungRunner::runSolid(const RungTrial& trial, const motion::AxisVehicle& solid) const {
  for (const double step : {trial.step, trial.step / 2}) {
    try {
      return runSolid(trial, solid, step);
    } catch (const motion::AccountError&) {
      // Told if a quarter of the step is still too long.
    }
  }
  return runSolid(trial, solid, trial.step / 4);
}

RungOutcome RungRunner::runSolid(const RungTrial& trial, const motion::AxisVehicle& solid, double step) const {
  const vehicle::VehicleParameters parameters = parametersOf(trial);
  const auto thrustOf = [&](double throttle) {
    return vehicle::thrustFraction(parameters.quadratic_share, vehicle_.radio, throttle);
  };
  motion::StepperSettings steps;
  steps.largest_step = step;
  steps.relative_tolerance = 1e-6;
  steps.keep_factor = trial.rung == motion::TrialRung::VOLUMETRIC;
  motion::Stepper stepper(solid.problem(), motion::Scheme(motion::SchemeKind::MIDPOINT), steps);
  motion::AxisRun run;
  motion::AxisRunHooks hooks;
  if (cancelled_) hooks.stepped = [this](const motion::AxisRun&) { return !cancelled_(); };
  motion::AxisTrial pulse = motion::AxisTrial::of(trial.start, thrustOf(trial.pulse.throttle), trial.pulse.duration,
                                                  parameters, thrustOf(0), trial.trial);
  if (trial.pulse.hold_duration > 0) {
    pulse.then.push_back({thrustOf(trial.pulse.hold_throttle), trial.pulse.hold_duration});
  }
  if (!motion::runTrial(solid, stepper, pulse, run, hooks)) throw common::Error("cancelled");
  RungOutcome out;
  const motion::AxisOutcome& o = run.outcome;
  out.end = o.end_mode, out.snapped = o.snapped, out.snap_time = o.snap_time;
  out.peak_travel = o.peak_travel, out.least_travel = o.least_travel, out.imbalance = o.largest_imbalance;
  out.strain = o.largest_strain, out.mean_strain = o.largest_mean_strain;
  out.min_det_f = 1;
  for (const motion::AxisSample& s : run.samples) {
    out.time.push_back(s.time);
    out.travel.push_back(s.travel);
    out.thrust.push_back(s.thrust);
    out.min_det_f = std::min(out.min_det_f, s.min_det_f);
  }
  return out;
}

double RungRunner::shortestLumped(const RungTrial& trial) const {
  constexpr double GRID = 0.005, LONGEST = 1.5;
  const rom::LumpedModel model = lumpedOf(trial);
  vehicle::Pulse asked = trial.pulse;
  const auto snaps = [&](double d) {
    asked.duration = d;
    return model.predict(trial.start, asked, vehicle_.radio, trial.trial).snapped;
  };
  double first = GRID;
  while (!snaps(first)) {
    first += GRID;
    if (first > LONGEST) throw common::Error("no pulse up to 1.5 s switches");
  }
  return common::bisect(Bracket{first - GRID, first}, snaps, MOST_HALVINGS, trial.resolution).high;
}

double RungRunner::shortestSolid(const RungTrial& trial) const {
  const bool told = std::isfinite(trial.near);  // by coarser cells: closer than the lumped one
  const double near = told ? trial.near : shortestLumped(trial);
  const motion::AxisVehicle solid = solidOf(trial);
  RungTrial asked = trial;
  constexpr double FARTHEST = 0.060;
  const auto snaps = [&](double d) {
    asked.pulse.duration = d;
    return runSolid(asked, solid).snapped;
  };
  const double found = bracketNear(near, told ? 0.001 : 0.003, FARTHEST, trial.resolution, snaps).high;
  if (std::isnan(found))
    throw common::Error("the shortest pulse that switches is more than 60 ms from where the search began");
  return found;
}

double RungRunner::carriedLumped(const RungTrial& trial) const {
  const rom::LumpedModel model = lumpedOf(trial);
  return rom::LoadedBasins(model.potential(), model.inertiaOf(trial.trial)).limit(trial.start, trial.trial.gravity);
}

double RungRunner::carriedSolid(const RungTrial& trial) const {
  constexpr double ENOUGH = 0.01, FIRST = 0.1, MOST = 8;  // [N]
  vehicle::Trial surroundings = trial.trial;
  surroundings.wings = rom::wingsAct(trial.trial, vehicle_.hasWing());
  const auto carries = [&](double weight) {
    if (cancelled_ && cancelled_()) throw common::Error("cancelled");
    vehicle::VehicleParameters p = parametersOf(trial);
    p.centre_mass = weight / trial.trial.gravity;
    const motion::AxisVehicle solid(printed_, p, surroundings, settingsOf(trial), wing_);
    bool held = false;
    solid.start(trial.start, 0, &held);
    return held;
  };
  const double near = std::isfinite(trial.near) ? trial.near : carriedLumped(trial);
  const Bracket found = bracketNear(near, FIRST, MOST, ENOUGH, [&](double weight) { return !carries(weight); });
  if (!(found.low > 0)) {
    throw common::Error("the start mode carries nothing, or its limit is more than 8 N from where the search began");
  }
  return found.low;
}

namespace {

/// What `compute` leaves, or why it leaves nothing, and its time.
template <class Compute>
RungOutcome accounted(const Compute& compute) {
  const double begin = threadSeconds();
  RungOutcome out;
  try {
    compute(out);
  } catch (const common::Error& e) {
    out = RungOutcome{};
    out.failure = e.what();
  }
  for (std::vector<double>* series : {&out.time, &out.travel, &out.thrust}) thin(*series);
  out.cpu_seconds = threadSeconds() - begin;
  return out;
}

}  // namespace

motion::AxisVehicle RungRunner::solidOf(const RungTrial& trial) const {
  vehicle::Trial surroundings = trial.trial;
  surroundings.wings = rom::wingsAct(trial.trial, vehicle_.hasWing());
  return {printed_, parametersOf(trial), surroundings, settingsOf(trial), wing_};
}

RungOutcome RungRunner::run(const RungTrial& trial) const {
  return accounted([&](RungOutcome& out) {
    out = trial.rung == motion::TrialRung::LUMPED ? runLumped(trial)
          : trial.on_curve                        ? runOnCurve(trial)
                                                  : runSolid(trial, solidOf(trial));
  });
}

RungOutcome RungRunner::carried(const RungTrial& trial) const {
  return accounted([&](RungOutcome& out) {
    out.threshold = trial.rung == motion::TrialRung::LUMPED ? carriedLumped(trial) : carriedSolid(trial);
  });
}

RungOutcome RungRunner::shortest(const RungTrial& trial) const {
  return accounted([&](RungOutcome& out) {
    out.threshold = trial.rung == motion::TrialRung::LUMPED ? shortestLumped(trial) : shortestSolid(trial);
  });
}

}  // namespace snapwing::validation
