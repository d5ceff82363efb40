#pragma once
/// Estimates travel and mode from the signals of a real vehicle: motor outputs read back from the flight controller and
/// the accelerometer at the centre. Particle filter: each particle is a vehicle drawn from the uncertainty box with its
/// own u, u', speed and thrust, moved by the lumped model and weighted by the specific force that it predicts,
///   a = (F(u) + c u' - D_c) / m_c   (with wings also what they do to the centre)
/// by Student's t with the scale sigma^2 = accelerometer_noise^2 + (model_error a)^2 + (travel_error F'(u) / m_c)^2,
/// the last only while u moves.
/// A force from outside on the ring side is a jump Markov process of each particle, the mechanical stops of the vehicle
/// file throw it back, and readings that no particle explains start a new search. docs/planning.md describes all this.
/// It never reads a clock; planning/mode_observer.h feeds it in order and judges whether anything is known at all.

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "snapwing/rom/lumped_model.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/mode.h"
#include "snapwing/vehicle/trial.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::planning {

struct EstimatorSettings {
  int particles = 600;
  std::uint64_t seed = 7;            ///< equal seeds and inputs give equal estimates
  double accelerometer_noise = 0.5;  ///< [m/s2] standard deviation, of sensor and model error
  double accelerometer_bias = 0.2;   ///< [m/s2] standard deviation of a constant offset, one per particle
  /// [s] correlation time of model and sensor errors: readings closer together count for less
  double correlation_time = 0.02;
  /// [1 per square root of s] random walk of u' in proportion to |u'|: errors of the model appear in motion. Noise at
  /// rest would favour the softer mode whenever the sensor is quiet.
  double process_noise = 0.3;
  /// [1] share of the expected specific force by which model and sensor are wrong, added to the noise as its square
  double model_error = 0.03;
  double output_delay = 0.02;  ///< [s] motor outputs act up to this long after their stamp, different per particle
  /// [m] standard deviation of the error of model and tables in u: adds to the noise where the arms are stiff, and to
  /// the reported deviation
  double travel_error = 3e-4;
  double outlier_share = 1e-3;  ///< [1] outliers (a constant lower bound of the weights)
  /// External force on the ring side (src/planning/outside_force.h): Laplace distributed with this standard
  /// deviation [N], 0 = none
  double outside_force = 10.0;
  double outside_rate = 1.0;   ///< [1/s] how often a touch begins
  double outside_time = 0.3;   ///< [s] how long it lasts on average, and how long its force stays about the same
  double step = 2e-3;          ///< [s] of the particles' motion
  double hurried_step = 8e-3;  ///< [s] likewise, for readings that are late: coarse, but in time
  /// [s] a longer gap without readings discards the estimate: the particles restart, half in each mode. It also bounds
  /// the work of one reading.
  double longest_gap = 1.0;
  double least_effective = 0.02;  ///< [1] share of the particles; with fewer effective ones the mode is UNKNOWN
  double sure = 0.95;             ///< [1] probability from which a mode counts as known
  vehicle::Mount mount = vehicle::Mount::BOOM;
  double gravity = 0;         ///< [m/s2] against the thrust axis
  std::optional<bool> wings;  ///< on or off, as in vehicle::Trial
  void validate() const;      ///< @throws common::Error naming the member
};

struct ModeEstimate {
  double time = 0;
  /// UNKNOWN unless one probability exceeds `sure`, and readings stand behind it
  vehicle::Mode mode = vehicle::Mode::UNKNOWN;
  std::string reason;  ///< why the mode is UNKNOWN; empty if it is known
  double probability_fixed_wing = 0.5;
  double probability_quadrotor = 0.5;
  double travel = 0;            ///< [m] mean of u, which between two modes is the travel of neither
  double travel_deviation = 0;  ///< [m]
  /// [m] mean of u among the particles in one mode; NaN if none is there
  double travel_fixed_wing = std::numeric_limits<double>::quiet_NaN();
  double travel_quadrotor = std::numeric_limits<double>::quiet_NaN();
  double effective_particles = 0;  ///< at the last reading, before resampling
  double lost = 0;                 ///< [1] probability that the vehicle is not where the particles are

  /// The likelier mode, however small the difference; F if both are equal.
  vehicle::Mode likelier() const {
    return probability_quadrotor > probability_fixed_wing ? vehicle::Mode::QUADROTOR : vehicle::Mode::FIXED_WING;
  }
  /// [m] u in one mode if any particle is in it, else the mean
  double travelIn(vehicle::Mode in) const;
};

class ModeEstimator {
 public:
  /// @param wing  the vehicle's wings, if any
  /// @throws common::Error for bad settings or a table that is not bistable
  ModeEstimator(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                const EstimatorSettings& settings = {}, const std::optional<vehicle::WingTable>& wing = {});
  ~ModeEstimator();
  ModeEstimator(ModeEstimator&&) noexcept;

  /// Restarts at rest. @param initial  F or Q: somebody saw it; or UNKNOWN (half of the particles in each)
  void reset(double time, vehicle::Mode initial);

  /// The vehicle is seen to stand still now (hand holds the ring): the particles' speeds along the axis become 0.
  void atRest();

  /// Mean motor output [0, 1] valid from `time` [s] on. Out-of-order times are ignored.
  void motorOutput(double time, double output);
  /// Specific force of the centre along the thrust axis [m/s2]; moves the particles to `time` and weighs them.
  /// NaN and times before the last reading are ignored. After more than `longest_gap` it restarts.
  /// @param hurried  the reading is late: the particles move in steps of `hurried_step`
  void accelerometer(double time, double specific_force, bool hurried = false);

  ModeEstimate estimate() const;
  const EstimatorSettings& settings() const;
  /// Steps of all particles together: nearly all of the work.
  long steps() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace snapwing::planning
