// The mode estimate while somebody brakes or pushes the simulated vehicle, which nobody tells the estimator.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "outside_force.h"
#include "snapwing/common/error.h"
#include "snapwing/planning/mode_estimator.h"
#include "snapwing/standin/plant.h"
#include "snapwing/vehicle/pulse.h"
#include "support/paths.h"

namespace snapwing::planning {
namespace {

using vehicle::Mode;

constexpr double READING = 0.005;  // [s]

struct Tools {
  vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  vehicle::ForceTable table = vehicle::loadForceTable(vehicle.arm.table_file);
};

const Tools& tools() {
  static const Tools instance;
  return instance;
}

standin::PlantSettings hand(double share) {
  standin::PlantSettings settings;
  settings.hand_share_q = share;
  return settings;
}

EstimatorSettings seeded(std::uint64_t seed) {
  EstimatorSettings settings;
  settings.seed = seed;
  return settings;
}

/// A vehicle on the boom and what is believed of it.
class Watched {
 public:
  Watched(std::uint64_t seed, Mode start, const standin::PlantSettings& flight = {})
      : plant_(tools().vehicle, tools().table, standin::drawParameters(tools().vehicle, tools().table, seed), flight),
        estimator_(tools().vehicle, tools().table, seeded(seed)),
        random_(static_cast<std::mt19937::result_type>(seed)) {
    plant_.reset(start);
    estimator_.reset(0.0, start);
    bias_ = std::normal_distribution<double>(0.0, 0.1)(random_);
  }

  /// Motors at a throttle for some time.
  void run(double throttle, double length) {
    const double output = vehicle::motorOutput(tools().vehicle.radio, throttle);
    plant_.setMotorOutputs({output, output, output, output});
    estimator_.motorOutput(time_, output);
    for (const long count = std::lround(length / READING), begin = readings_; readings_ < begin + count;) {
      plant_.advanceTo(time_ += READING);
      const double noise = std::normal_distribution<double>(0.0, 0.3)(random_);
      estimator_.accelerometer(time_, plant_.centreSpecificForce() + bias_ + noise);
      const ModeEstimate said = estimator_.estimate();
      ++readings_;
      if (said.mode != Mode::UNKNOWN && plant_.mode() != Mode::UNKNOWN && said.mode != plant_.mode()) ++wrong_;
      if (std::abs(said.travel - plant_.state().travel()) < 2.0 * said.travel_deviation) ++inside_;
    }
  }

  void switchToQ() {
    run(0.0, 0.3);
    run(0.647, 0.171);
    run(0.0, 1.0);
  }

  standin::Plant& plant() { return plant_; }
  ModeEstimate estimate() const { return estimator_.estimate(); }
  int wrong() const { return wrong_; }  ///< readings after which the estimate was sure of the wrong mode
  int inside() const { return inside_; }
  int readings() const { return readings_; }

 private:
  standin::Plant plant_;
  ModeEstimator estimator_;
  std::mt19937 random_;
  double time_ = 0, bias_ = 0;
  int readings_ = 0, wrong_ = 0, inside_ = 0;
};

constexpr int SEEDS = 12;

/// Sums over the seeds of one test.
struct Sum {
  int changed = 0, right = 0, wrong = 0, inside = 0, readings = 0;
  void add(Watched& w, Mode start) {
    const Mode said = w.estimate().mode;
    changed += w.plant().mode() != start;
    right += said == w.plant().mode();
    EXPECT_TRUE(said == Mode::UNKNOWN || said == w.plant().mode()) << vehicle::modeName(said);
    wrong += w.wrong();
    inside += w.inside();
    readings += w.readings();
  }
  void check() const {
    EXPECT_GE(right, SEEDS - 1);
    EXPECT_LE(wrong, readings / 200);
    EXPECT_GE(inside, readings * 85 / 100);
  }
};

TEST(TouchedEstimate, GentleHandIsNoSwitch) {
  Sum sum;
  for (int seed = 1; seed <= SEEDS; ++seed) {
    Watched w(seed, Mode::FIXED_WING);
    w.switchToQ();
    w.plant().grab();
    w.run(0.0, 1.5);
    EXPECT_EQ(w.plant().mode(), Mode::QUADROTOR);
    sum.add(w, Mode::QUADROTOR);
  }
  sum.check();
}

TEST(TouchedEstimate, HandThatBrakesTooHardIsSeenToLoseQ) {
  Sum sum;
  for (int seed = 1; seed <= SEEDS; ++seed) {
    Watched w(seed, Mode::FIXED_WING, hand(0.99));
    w.switchToQ();
    w.plant().grab();
    w.run(0.0, 1.5);
    EXPECT_EQ(w.plant().mode(), Mode::FIXED_WING);
    sum.add(w, Mode::QUADROTOR);
  }
  EXPECT_EQ(sum.changed, SEEDS);
  sum.check();
}

TEST(TouchedEstimate, PushesThatSnapItAreSeen) {
  for (const Mode start : {Mode::FIXED_WING, Mode::QUADROTOR}) {
    Sum sum;
    for (int seed = 1; seed <= SEEDS; ++seed) {
      Watched w(seed, start);
      w.run(0.0, 0.5);
      w.plant().push(start == Mode::FIXED_WING ? 11.0 : -6.0);
      w.run(0.0, 0.2);
      w.plant().push(0.0);
      w.run(0.0, 1.5);
      sum.add(w, start);
    }
    EXPECT_GE(sum.changed, SEEDS / 2) << vehicle::modeName(start);
    sum.check();
  }
}

TEST(TouchedEstimate, ForcesHaveTheDistributionThatTheyAreSaidToHave) {
  const double strength = 4.0, rate = 0.5, time = 0.4, span = 0.05;
  const int count = 200000;
  const OutsideForceProcess process(strength, rate, time);
  RandomSource random(3);
  double all = 0, begun = 0, squares = 0, size = 0, lasting = 0, later = 0, product = 0;
  for (int i = 0; i < count; ++i) {
    OutsideForce force;
    const double weight = process.move(&force, span, random);
    all += weight;
    if (!force.touched()) continue;
    begun += weight;
    squares += weight * force.force * force.force;
    size += weight * std::abs(force.force);
    const double before = force.force;
    EXPECT_EQ(process.move(&force, span, random), 1.0);
    if (force.touched()) lasting += weight, later += weight * force.force * force.force;
    product += weight * before * force.force;
  }
  EXPECT_NEAR(all / count, 1.0, 0.01);
  EXPECT_NEAR(begun / all, 1.0 - std::exp(-rate * span), 1e-3);
  EXPECT_NEAR(std::sqrt(squares / begun), strength, 0.1);
  EXPECT_NEAR(size / begun, strength / std::sqrt(2.0), 0.05);  // of a Laplace distribution
  EXPECT_NEAR(lasting / begun, std::exp(-span / time), 0.01);
  EXPECT_NEAR(std::sqrt(later / lasting), strength, 0.1);  // stationary
  EXPECT_NEAR(product / squares, std::exp(-2.0 * span / time), 0.02);
  OutsideForce none;
  EXPECT_EQ(OutsideForceProcess(0.0, rate, time).move(&none, 1.0, random), 1.0);
  EXPECT_FALSE(none.touched());
}

TEST(TouchedEstimate, ParticlesStayWithinTheStops) {
  ModeEstimator estimator(tools().vehicle, tools().table);
  estimator.reset(0.0, Mode::FIXED_WING);
  const vehicle::Limits& limits = tools().vehicle.limits;
  for (double t = READING; t < 1.0; t += READING) {
    estimator.accelerometer(t, -60.0);  // beyond the stop without one
    EXPECT_GE(estimator.estimate().travel, limits.travel_min);
    EXPECT_LE(estimator.estimate().travel, limits.travel_max);
  }
}

TEST(TouchedEstimate, BadSettingsAreNamed) {
  const auto refused = [](const std::string& name, auto set) {
    EstimatorSettings settings;
    set(settings);
    try {
      settings.validate();
      FAIL() << name;
    } catch (const common::Error& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  };
  refused("outside_force", [](auto& s) { s.outside_force = -1.0; });
  refused("outside_force", [](auto& s) { s.outside_force = NAN; });
  refused("outside_rate", [](auto& s) { s.outside_rate = -0.1; });
  refused("outside_time", [](auto& s) { s.outside_time = 0.0; });
  refused("model_error", [](auto& s) { s.model_error = 1.0; });
  refused("travel_error", [](auto& s) { s.travel_error = NAN; });
}

}  // namespace
}  // namespace snapwing::planning
