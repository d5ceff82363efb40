// The mode estimate of a vehicle without wings in free flight, with outputs that reach the motors late and by a ramp,
// as over the radio: drag that the particles get wrong adds up over a long flight, and no hand must be made out of it.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "snapwing/planning/mode_observer.h"
#include "snapwing/standin/plant.h"
#include "snapwing/vehicle/pulse.h"
#include "snapwing/vehicle/table_origin.h"
#include "support/paths.h"

namespace snapwing::planning {
namespace {

using vehicle::Mode;

constexpr double READING = 0.005;       // [s] 200 Hz
constexpr double TRUE_LATENCY = 0.007;  // [s] to the beginning of the ramp
constexpr double RAMP = 0.021;          // [s] of the flight controller

struct Tools {
  vehicle::Vehicle vehicle = vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  vehicle::ForceTable table = vehicle::armTableOf(vehicle);
};

const Tools& shipped() {
  static const Tools instance;
  return instance;
}

/// Two thirds of the weight, so that it flies faster, and less is known of its drag.
Tools lighter() {
  Tools tools;
  tools.vehicle.masses.total = {0.500, 0.003};
  tools.vehicle.masses.centre = {0.25, 0.03};
  tools.vehicle.drag.ring_cda.plus_minus = 0.015;
  return tools;
}

standin::PlantSettings free() {
  standin::PlantSettings settings;
  settings.mount = vehicle::Mount::FREE;
  settings.wings = false;
  return settings;
}

EstimatorSettings freeEstimate() {
  EstimatorSettings settings;
  settings.mount = vehicle::Mount::FREE;
  settings.wings = false;
  return settings;
}

class Flight {
 public:
  /// @param believed  [s] latency that the estimator is told
  Flight(const Tools& tools, std::uint64_t seed, double believed)
      : tools_(tools),
        plant_(tools_.vehicle, tools_.table, standin::drawParameters(tools_.vehicle, tools_.table, seed), free()),
        estimator_(tools_.vehicle, tools_.table, freeEstimate()),
        random_(static_cast<std::mt19937::result_type>(seed)),
        believed_(believed),
        bias_(0.1 * std::normal_distribution<double>()(random_)) {
    plant_.reset(Mode::FIXED_WING);
    estimator_.reset(0.0, Mode::FIXED_WING);
  }

  /// Motors at a throttle for some time.
  void run(double throttle, double length) {
    setOutput(vehicle::motorOutput(tools_.vehicle.radio, throttle));
    for (const double end = time_ + length - 1e-9; time_ < end;) {
      moveTo(time_ + READING);
      const double noise = 0.3 * std::normal_distribution<double>()(random_);
      estimator_.accelerometer(time_, plant_.centreSpecificForce() + bias_ + noise);
      const ModeEstimate said = estimator_.estimate();
      ++readings_;
      if (said.mode == Mode::UNKNOWN) ++unsure_, why_ = said.reason;
      if (said.mode != Mode::UNKNOWN && plant_.mode() != Mode::UNKNOWN && said.mode != plant_.mode()) ++wrong_;
    }
  }

  /// The flight that follows must show the mode all the time.
  void expectKnown(Mode mode, double length) {
    run(0.0, 0.5);
    unsure_ = 0;
    run(0.0, length);
    ASSERT_EQ(plant_.mode(), mode);
    EXPECT_EQ(estimator_.estimate().mode, mode) << estimator_.estimate().reason;
    EXPECT_LE(unsure_, std::lround(length / READING) / 50) << why_;
  }

  /// A hand brakes the ring, holds it until the operator tells that it rests, and lets go.
  void hold(double untold, double told) {
    plant_.grab();
    run(0.0, untold);
    for (const long count = readings_ + std::lround(told / READING); readings_ < count;) {
      estimator_.atRest();
      run(0.0, READING);
    }
    plant_.release();
  }

  int readings() const { return readings_; }
  int wrong() const { return wrong_; }

 private:
  void setOutput(double output) {
    estimator_.motorOutput(time_ + believed_, output);
    constexpr int STEPS = 6;
    for (int k = 1; k <= STEPS; ++k) {
      const double x = static_cast<double>(k) / STEPS;
      waiting_.emplace(time_ + TRUE_LATENCY + RAMP * (k - 0.5) / STEPS,
                       output_ + (output - output_) * x * x * (3.0 - 2.0 * x));
    }
    output_ = output;
  }

  void moveTo(double time) {
    for (time_ = time; !waiting_.empty() && waiting_.begin()->first <= time_; waiting_.erase(waiting_.begin())) {
      plant_.advanceTo(waiting_.begin()->first);
      plant_.setMotorOutputs(std::vector<double>(4, waiting_.begin()->second));
    }
    plant_.advanceTo(time_);
  }

  const Tools& tools_;
  standin::Plant plant_;
  ModeEstimator estimator_;
  std::mt19937 random_;
  double believed_, bias_, time_ = 0, output_ = vehicle::motorOutput(tools_.vehicle.radio, 0.0);
  std::multimap<double, double> waiting_;
  int readings_ = 0, wrong_ = 0, unsure_ = 0;
  std::string why_;
};

void flyBothWays(double believed) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    Flight flight(shipped(), seed, believed);
    flight.run(0.0, 0.3);
    flight.run(0.568, 0.163);
    flight.expectKnown(Mode::QUADROTOR, 0.8);
    flight.run(1.0, 0.534);
    flight.expectKnown(Mode::FIXED_WING, 2.5);
    EXPECT_LE(flight.wrong(), flight.readings() / 200);
  }
}

TEST(WinglessFlight, BothSwitchesAreSeenInOneLongFlight) { flyBothWays(ObserverSettings().frame_delay); }

TEST(WinglessFlight, OutputsThatComeEarlierThanBelievedAreNoHand) { flyBothWays(0.025); }

TEST(WinglessFlight, ADragThatIsFarFromTheParticlesIsNoHand) {
  const Tools tools = lighter();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    Flight flight(tools, seed, ObserverSettings().frame_delay);
    flight.hold(0.0, 0.6);
    flight.run(0.0, 0.3);
    flight.run(0.45, 0.15);
    flight.run(0.0, 1.3);
    flight.hold(2.5, 0.3);
    flight.run(0.0, 0.1);
    flight.run(1.0, 0.45);
    flight.expectKnown(Mode::FIXED_WING, 2.5);
    EXPECT_LE(flight.wrong(), flight.readings() / 200);
  }
}

}  // namespace
}  // namespace snapwing::planning
