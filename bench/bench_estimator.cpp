// How well the mode estimator knows what it does not know: the simulated vehicle (dynamics, not the estimator's own
// model) is switched, braked and pushed, with a noisy, biased accelerometer and motor outputs read back late.
//   bench_estimator [seeds=20] [first=101] [rate=200] [case=PART OF A NAME] [member=value ...]
// rate [Hz] of the readings; members of EstimatorSettings. Why the mode was unknown goes to standard error.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <random>
#include <string>

#include "snapwing/planning/mode_estimator.h"
#include "snapwing/standin/plant.h"
#include "snapwing/vehicle/pulse.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"

namespace {

using namespace snapwing;
using vehicle::Mode;

double reading_period = 0.005;  // [s] between readings of the accelerometer

double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Score {
  long readings = 0, inside = 0, unsure = 0, wrong = 0;  ///< wrong: sure of the mode that the vehicle is not in
  double squares = 0;                                    ///< of the travel's error [m2]
  double cpu = 0;                                        ///< [s] in the estimator
  int runs = 0, changes = 0, ended_wrong = 0, ended_unsure = 0;
  double lag = 0, worst_lag = 0;        ///< [s] from the vehicle's change of mode until the estimate is sure of it
  int never = 0;                        ///< changes that the estimate was not sure of before the next one
  std::map<std::string, long> reasons;  ///< readings after which the mode was unknown, by the reason told
};

/// One vehicle, its sensors and its estimate.
class Trial {
 public:
  Trial(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
        const std::optional<vehicle::WingTable>& wing, standin::PlantSettings flight,
        planning::EstimatorSettings settings, std::uint64_t seed, Mode start)
      : radio_(vehicle.radio),
        random_(static_cast<std::mt19937::result_type>(seed)),
        plant_(vehicle, table, standin::drawParameters(vehicle, table, seed), flight, wing),
        estimator_(vehicle, table, (settings.seed = seed, settings), wing) {
    bias_ = std::normal_distribution<double>(0.0, 0.1)(random_);
    late_ = uniform(0.0, 0.02);
    truth_ = start;
    plant_.reset(start);
    estimator_.reset(0.0, start);
    setOutput(vehicle::motorOutput(radio_, 0.0));
  }

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  void pulse(double throttle, double duration) {
    setOutput(vehicle::motorOutput(radio_, throttle));
    run(duration);
    setOutput(vehicle::motorOutput(radio_, 0.0));
  }
  void run(double length) {
    const long count = std::lround(length / reading_period);
    for (long i = 0; i < count; ++i) step();
  }
  void pushFor(double force, double length) {
    plant_.push(force);
    run(length);
    plant_.push(0.0);
  }
  standin::Plant& plant() { return plant_; }

  Score finish() {
    const Mode said = estimator_.estimate().mode;
    ++score_.runs;
    if (pending_) ++score_.never;
    if (said == Mode::UNKNOWN) {
      ++score_.ended_unsure;
      ++score_.reasons["at the end: " + estimator_.estimate().reason];
    }
    if (said != Mode::UNKNOWN && said != truth_) ++score_.ended_wrong;
    return score_;
  }

 private:
  void setOutput(double output) { next_outputs_.push_back({time_, output}); }

  /// The outputs act at once; the estimator is told them with a stamp that is early by up to 20 ms.
  void step() {
    for (const auto& [when, output] : next_outputs_) estimator_.motorOutput(when, output);
    for (const auto& change : next_outputs_) waiting_.insert(change);
    next_outputs_.clear();
    time_ += reading_period;
    while (!waiting_.empty() && waiting_.begin()->first + late_ <= time_) {
      plant_.advanceTo(waiting_.begin()->first + late_);
      plant_.setMotorOutputs(std::vector<double>(4, waiting_.begin()->second));
      waiting_.erase(waiting_.begin());
    }
    plant_.advanceTo(time_);
    const double reading = plant_.centreSpecificForce() + bias_ + std::normal_distribution<double>(0.0, 0.3)(random_);
    const double begin = cpuSeconds();
    estimator_.accelerometer(time_, reading);
    score_.cpu += cpuSeconds() - begin;
    judge();
  }

  void judge() {
    const planning::ModeEstimate said = estimator_.estimate();
    const Mode mode = plant_.mode();
    if (mode != Mode::UNKNOWN && mode != truth_) {
      truth_ = mode;
      if (pending_) ++score_.never;
      pending_ = true;
      changed_ = time_;
      ++score_.changes;
    }
    if (pending_ && said.mode == truth_) {
      pending_ = false;
      score_.lag += time_ - changed_;
      score_.worst_lag = std::max(score_.worst_lag, time_ - changed_);
    }
    const double error = plant_.state().travel() - said.travel;
    ++score_.readings;
    score_.squares += error * error;
    if (std::abs(error) < 2.0 * said.travel_deviation) ++score_.inside;
    if (said.mode == Mode::UNKNOWN) ++score_.unsure, ++score_.reasons[said.reason];
    if (said.mode != Mode::UNKNOWN && mode != Mode::UNKNOWN && said.mode != mode) ++score_.wrong;
  }

  vehicle::Radio radio_;
  std::mt19937 random_;
  standin::Plant plant_;
  planning::ModeEstimator estimator_;
  double time_ = 0, bias_ = 0, late_ = 0, changed_ = 0;
  Mode truth_ = Mode::UNKNOWN;
  bool pending_ = false;
  std::vector<std::pair<double, double>> next_outputs_;
  std::multimap<double, double> waiting_;
  Score score_;
};

struct Case {
  const char* name;
  vehicle::Mount mount;
  bool wings;
  Mode start;
  double hand_share;  ///< [1] of what Q holds
  void (*play)(Trial&);
};

void both(Trial& t, double up, double up_time, double down, double down_time) {
  t.run(0.3);
  t.pulse(up, up_time);
  t.run(1.0);
  t.pulse(down, down_time);
  t.run(1.0);
}

/// F -> Q, then the hand takes the boom and holds it; nobody tells the estimator.
void brake(Trial& t) {
  t.run(0.3);
  t.pulse(0.647, 0.171);
  t.run(1.0);
  t.plant().grab();
  t.run(1.5);
}

void brakeAndGoOn(Trial& t) {
  brake(t);
  t.plant().release();
  t.run(0.3);
  t.pulse(1.0, 0.588);
  t.run(1.0);
}

const Case CASES[] = {
    {"at rest in F", vehicle::Mount::BOOM, false, Mode::FIXED_WING, 0.4, [](Trial& t) { t.run(3.0); }},
    {"at rest in Q", vehicle::Mount::BOOM, false, Mode::QUADROTOR, 0.4, [](Trial& t) { t.run(3.0); }},
    {"boom, F -> Q -> F", vehicle::Mount::BOOM, false, Mode::FIXED_WING, 0.4,
     [](Trial& t) { both(t, 0.647, 0.171, 1.0, 0.588); }},
    {"free, wings off, F -> Q -> F", vehicle::Mount::FREE, false, Mode::FIXED_WING, 0.4,
     [](Trial& t) { both(t, 0.617, 0.162, 1.0, 0.583); }},
    {"free, wings on, F -> Q -> F", vehicle::Mount::FREE, true, Mode::FIXED_WING, 0.4,
     [](Trial& t) { both(t, 0.622, 0.287, 0.999, 0.608); }},
    {"boom, gentle hand in Q, Q -> F", vehicle::Mount::BOOM, false, Mode::FIXED_WING, 0.4, brakeAndGoOn},
    {"boom, hand brakes too hard in Q", vehicle::Mount::BOOM, false, Mode::FIXED_WING, 0.99, brake},
    {"boom, pushed back after F -> Q", vehicle::Mount::BOOM, false, Mode::FIXED_WING, 0.4,
     [](Trial& t) {
       t.run(0.3);
       t.pulse(0.647, 0.171);
       t.run(1.0);
       t.pushFor(-t.uniform(6.0, 15.0), t.uniform(0.15, 0.4));
       t.run(1.0);
     }},
    {"boom, pushed up in F", vehicle::Mount::BOOM, false, Mode::FIXED_WING, 0.4,
     [](Trial& t) {
       t.run(0.5);
       t.pushFor(t.uniform(10.0, 22.0), t.uniform(0.12, 0.3));
       t.run(1.5);
     }},
    {"boom, pushed down in Q", vehicle::Mount::BOOM, false, Mode::QUADROTOR, 0.4,
     [](Trial& t) {
       t.run(0.5);
       t.pushFor(-t.uniform(3.0, 12.0), t.uniform(0.1, 0.4));
       t.run(1.5);
     }},
    {"free, wings on, pushed up in F", vehicle::Mount::FREE, true, Mode::FIXED_WING, 0.4,
     [](Trial& t) {
       t.run(0.5);
       t.pushFor(t.uniform(8.0, 20.0), t.uniform(0.15, 0.4));
       t.run(1.5);
     }},
};

void print(const char* name, const Score& s) {
  const double n = static_cast<double>(s.readings);
  const int seen = s.changes - s.never;
  std::printf("| %s | %.1f | %.2f | %.2f | %.1f | %d of %d | %.0f / %.0f | %d, %d of %d | %.0f |\n", name,
              100 * s.inside / n, 1e3 * std::sqrt(s.squares / n), 100 * s.wrong / n, 100 * s.unsure / n, seen,
              s.changes, seen ? 1e3 * s.lag / seen : 0.0, 1e3 * s.worst_lag, s.ended_wrong, s.ended_unsure, s.runs,
              1e6 * s.cpu / n);
  for (const auto& [reason, count] : s.reasons) std::fprintf(stderr, "  %s: %s: %ld\n", name, reason.c_str(), count);
}

}  // namespace

int main(int argc, char** argv) {
  planning::EstimatorSettings settings;
  std::map<std::string, double*> members = {{"accelerometer_noise", &settings.accelerometer_noise},
                                            {"accelerometer_bias", &settings.accelerometer_bias},
                                            {"correlation_time", &settings.correlation_time},
                                            {"process_noise", &settings.process_noise},
                                            {"model_error", &settings.model_error},
                                            {"outside_force", &settings.outside_force},
                                            {"outside_rate", &settings.outside_rate},
                                            {"outside_time", &settings.outside_time},
                                            {"travel_error", &settings.travel_error},
                                            {"step", &settings.step},
                                            {"outlier_share", &settings.outlier_share}};
  int seeds = 20, first = 101;
  std::string only;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const std::size_t at = word.find('=');
    const std::string key = word.substr(0, at), value = at == std::string::npos ? "" : word.substr(at + 1);
    if (key == "seeds") {
      seeds = std::stoi(value);
    } else if (key == "first") {
      first = std::stoi(value);
    } else if (key == "rate") {
      reading_period = 1.0 / std::stod(value);
    } else if (key == "case") {
      only = value;
    } else if (key == "particles") {
      settings.particles = std::stoi(value);
    } else if (members.count(key)) {
      *members[key] = std::stod(value);
    } else {
      std::fprintf(stderr, "unknown: %s\n", word.c_str());
      return 2;
    }
  }
  const vehicle::Vehicle vehicle =
      vehicle::loadVehicle(snapwing::test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const vehicle::ForceTable table = vehicle::loadForceTable(vehicle.arm.table_file);
  const std::optional<vehicle::WingTable> wing = vehicle::wingTableOf(vehicle, table);
  std::printf(
      "| case | inside, %% | RMS, mm | sure and wrong, %% | unsure, %% | changes seen | lag mean / worst, ms | at the "
      "end "
      "wrong, unsure | us |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const Case& c : CASES) {
    if (std::string(c.name).find(only) == std::string::npos) continue;
    standin::PlantSettings flight;
    flight.mount = c.mount;
    flight.hand_share_q = c.hand_share;
    planning::EstimatorSettings s = settings;
    s.mount = c.mount == vehicle::Mount::BOOM ? vehicle::Mount::BOOM : vehicle::Mount::FREE;
    flight.wings = s.wings = c.wings;
    Score sum;
    for (int k = 0; k < seeds; ++k) {
      Trial trial(vehicle, table, wing, flight, s, static_cast<std::uint64_t>(first + k), c.start);
      c.play(trial);
      const Score one = trial.finish();
      sum.readings += one.readings, sum.inside += one.inside, sum.unsure += one.unsure, sum.wrong += one.wrong;
      sum.squares += one.squares, sum.cpu += one.cpu, sum.runs += one.runs, sum.changes += one.changes;
      sum.ended_wrong += one.ended_wrong, sum.ended_unsure += one.ended_unsure, sum.never += one.never;
      for (const auto& [reason, count] : one.reasons) sum.reasons[reason] += count;
      sum.lag += one.lag, sum.worst_lag = std::max(sum.worst_lag, one.worst_lag);
    }
    print(c.name, sum);
    std::fflush(stdout);
  }
  return 0;
}
