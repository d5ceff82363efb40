#include "snapwing/planning/mode_estimator.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "parameter_cloud.h"
#include "random_source.h"
#include "snapwing/common/error.h"
#include "snapwing/common/pulse.h"
#include "snapwing/rom/vehicle_curves.h"

namespace snapwing::planning {

namespace {

void require(bool good, const char* name, double value, const char* allowed) {
  if (!good) {
    throw common::Error(std::string("mode estimator: ") + name + " is " + std::to_string(value) +
                        "; allowed: " + allowed);
  }
}

/// Likelihood of a reading that has nothing to do with the model: uniform over what an accelerometer may show.
constexpr double OUTLIER_DENSITY = 1.0 / 300.0;  // [s2/m]

constexpr double LEAST_NOISE = 0.002;  // [m/s per square root of s] of u' when nothing moves
constexpr double COMMON_NOISE = 0.05;  // [m/s per square root of s] of the common speed: drag and thrust not modelled

struct Particle {
  std::shared_ptr<const rom::LumpedModel> model;
  rom::LumpedState state;
  double bias = 0;          ///< [m/s2] of the accelerometer
  double output_delay = 0;  ///< [s] of outputs read back
  double weight = 1;        ///< normalised
};

/// A change of the motors' output; commanded ones take the particle's radio latency to act.
struct OutputChange {
  double time;
  double output;
  bool commanded;
};

}  // namespace

void EstimatorSettings::validate() const {
  require(particles >= 10 && particles <= 1000000, "particles", particles, "10 .. 1000000");
  require(accelerometer_noise > 0 && std::isfinite(accelerometer_noise), "accelerometer_noise", accelerometer_noise,
          "above 0 m/s2");
  require(accelerometer_bias >= 0 && std::isfinite(accelerometer_bias), "accelerometer_bias", accelerometer_bias,
          "0 m/s2 or more");
  require(correlation_time > 0 && correlation_time <= 10, "correlation_time", correlation_time, "above 0, up to 10 s");
  require(process_noise >= 0 && std::isfinite(process_noise), "process_noise", process_noise, "0 or more");
  require(output_delay >= 0 && output_delay <= 1, "output_delay", output_delay, "0 .. 1 s");
  require(outlier_share >= 0 && outlier_share < 1, "outlier_share", outlier_share, "0 .. below 1");
  require(step > 0 && step <= 0.01, "step", step, "above 0, up to 0.01 s");
  require(sure > 0.5 && sure < 1, "sure", sure, "between 0.5 and 1");
  require(std::abs(gravity) <= 100, "gravity", gravity, "-100 .. 100 m/s2");
}

struct ModeEstimator::Impl {
  Impl(const common::Vehicle& v, const common::ForceTable& table, const EstimatorSettings& s,
       const std::optional<common::WingTable>& wing)
      : vehicle(v), settings(s), curves(table, wing), random(s.seed), cloud(v, table, s.particles, random) {
    trial.mount = s.mount;
    trial.gravity = s.gravity;
    trial.wings = s.wings;
    trial.validate();
  }

  std::shared_ptr<const rom::LumpedModel> modelFor(const common::VehicleParameters& p) const {
    rom::LumpedSettings lumped;
    lumped.step = settings.step;
    return std::make_shared<rom::LumpedModel>(curves.model(vehicle.radio, p, lumped));
  }

  void reset(double at, common::Mode initial);
  double outputFor(const Particle& particle, double at) const;
  void moveTo(double at);
  void forgetOldChanges();
  void weigh(double specific_force);
  void resample();

  common::Vehicle vehicle;
  EstimatorSettings settings;
  rom::VehicleCurves curves;
  RandomSource random;
  ParameterCloud cloud;
  rom::Trial trial;
  std::vector<Particle> particles;
  std::vector<OutputChange> changes;  ///< by time
  double time = 0;
  double last_reading = -INFINITY;
};

void ModeEstimator::Impl::reset(double at, common::Mode initial) {
  time = at;
  last_reading = -INFINITY;
  changes.clear();
  particles.assign(settings.particles, Particle{});
  rom::Trial rest = trial;
  rest.initial_thrust_fraction = 0.0;
  for (int i = 0; i < settings.particles; ++i) {
    Particle& particle = particles[i];
    particle.model = modelFor(cloud.drawn()[i]);
    common::Mode mode = initial;
    if (mode == common::Mode::UNKNOWN) mode = i % 2 == 0 ? common::Mode::FIXED_WING : common::Mode::QUADROTOR;
    particle.state = particle.model->startState(mode, rest);
    particle.state.time = at;
    particle.bias = settings.accelerometer_bias * random.normal();
    particle.output_delay = settings.output_delay * random.uniform();
    particle.weight = 1.0 / settings.particles;
  }
}

double ModeEstimator::Impl::outputFor(const Particle& particle, double at) const {
  double output = 0;
  for (const OutputChange& change : changes) {
    const double delay = change.commanded ? particle.model->parameters().latency : particle.output_delay;
    if (change.time + delay <= at) output = change.output;
  }
  return output;
}

void ModeEstimator::Impl::moveTo(double at) {
  const double span = at - time;
  if (!(span > 0)) return;
  const int count = std::max(1, static_cast<int>(std::ceil(span / settings.step - 1e-9)));
  const double dt = span / count;
  const double spread = std::sqrt(span);
  for (Particle& particle : particles) {
    const double q = particle.model->parameters().quadratic_share;
    for (int i = 0; i < count; ++i) {
      const double demand = common::thrustFraction(q, outputFor(particle, time + (i + 0.5) * dt));
      particle.state = particle.model->step(particle.state, demand, dt, trial);
    }
    const double kick = (settings.process_noise * std::abs(particle.state.travelRate()) + LEAST_NOISE) * spread;
    const double common_kick = settings.mount == rom::Mount::HELD ? 0.0 : COMMON_NOISE * spread * random.normal();
    particle.state.ring_speed += common_kick;
    particle.state.centre_speed += common_kick + kick * random.normal();
    particle.state.time = at;
  }
  time = at;
  forgetOldChanges();
}

void ModeEstimator::Impl::forgetOldChanges() {
  // Changes that every particle has long seen, but for the last of them.
  const double seen = time - settings.output_delay - vehicle.radio.latency.high();
  std::size_t old = 0;
  while (old + 1 < changes.size() && changes[old + 1].time < seen) ++old;
  changes.erase(changes.begin(), changes.begin() + static_cast<std::ptrdiff_t>(old));
}

void ModeEstimator::Impl::weigh(double specific_force) {
  const double share = std::min(1.0, (time - last_reading) / settings.correlation_time);
  last_reading = time;
  const double sigma = settings.accelerometer_noise;
  const double peak = 1.0 / (sigma * std::sqrt(2.0 * M_PI));
  double total = 0;
  for (Particle& particle : particles) {
    const double expected = particle.model->centreSpecificForce(particle.state, trial);
    const double miss = (specific_force - expected - particle.bias) / sigma;
    const double density =
        (1.0 - settings.outlier_share) * peak * std::exp(-0.5 * miss * miss) + settings.outlier_share * OUTLIER_DENSITY;
    particle.weight *= std::pow(density, share);
    total += particle.weight;
  }
  if (!(total > 0)) {  // nothing fits and no outliers are allowed for: the reading is dropped
    for (Particle& particle : particles) particle.weight = 1.0 / settings.particles;
    return;
  }
  double squares = 0;
  for (Particle& particle : particles) {
    particle.weight /= total;
    squares += particle.weight * particle.weight;
  }
  if (1.0 / squares < 0.5 * settings.particles) resample();
}

void ModeEstimator::Impl::resample() {
  // Systematic: one random number for all.
  std::vector<Particle> next;
  next.reserve(particles.size());
  const double spacing = 1.0 / settings.particles;
  double at = spacing * random.uniform(), sum = particles.front().weight;
  std::size_t k = 0;
  for (int i = 0; i < settings.particles; ++i, at += spacing) {
    while (sum < at && k + 1 < particles.size()) sum += particles[++k].weight;
    next.push_back(particles[k]);
    next.back().weight = spacing;
  }
  std::vector<common::VehicleParameters> parameters;
  for (const Particle& particle : next) parameters.push_back(particle.model->parameters());
  cloud.scatter(parameters, random);
  for (std::size_t i = 0; i < next.size(); ++i) {
    next[i].model = modelFor(parameters[i]);
    next[i].bias += 0.1 * settings.accelerometer_bias * random.normal();
  }
  particles = std::move(next);
}

ModeEstimator::ModeEstimator(const common::Vehicle& vehicle, const common::ForceTable& table,
                             const EstimatorSettings& settings, const std::optional<common::WingTable>& wing) {
  settings.validate();
  impl_ = std::make_unique<Impl>(vehicle, table, settings, wing);
  if (!impl_->curves.spline().equilibria().bistable)
    throw common::Error("mode estimator: the force curve is not bistable");
  reset(0.0, common::Mode::UNKNOWN);
}

ModeEstimator::~ModeEstimator() = default;
ModeEstimator::ModeEstimator(ModeEstimator&&) noexcept = default;

void ModeEstimator::reset(double time, common::Mode initial) { impl_->reset(time, initial); }

void ModeEstimator::atRest(double time) {
  impl_->moveTo(time);
  for (Particle& particle : impl_->particles) {
    particle.state.centre_speed -= particle.state.ring_speed;
    particle.state.ring_speed = 0.0;
  }
}

void ModeEstimator::motorOutput(double time, double output) {
  auto& changes = impl_->changes;
  if (!std::isfinite(output) || !std::isfinite(time) || (!changes.empty() && time < changes.back().time)) return;
  const double clamped = std::clamp(output, 0.0, 1.0);
  if (!changes.empty() && changes.back().output == clamped && !changes.back().commanded) return;
  changes.push_back({time, clamped, false});
}

void ModeEstimator::commandedPulse(double time, const common::Pulse& pulse) {
  if (!std::isfinite(time)) return;
  const common::Radio& radio = impl_->vehicle.radio;
  impl_->changes.push_back({time, common::motorOutput(radio, pulse.throttle), true});
  impl_->changes.push_back({time + pulse.duration, common::motorOutput(radio, 0.0), true});
}

void ModeEstimator::accelerometer(double time, double specific_force) {
  if (!std::isfinite(time) || !std::isfinite(specific_force) || time < impl_->time) return;
  impl_->moveTo(time);
  impl_->weigh(specific_force);
}

void ModeEstimator::predictTo(double time) {
  if (std::isfinite(time)) impl_->moveTo(time);
}

ModeEstimate ModeEstimator::estimate() const {
  ModeEstimate result;
  result.time = impl_->time;
  const double barrier = impl_->curves.spline().equilibria().barrier;
  double quadrotor = 0, mean = 0, squares = 0, weights = 0;
  for (const Particle& particle : impl_->particles) {
    if (particle.state.travel > barrier) quadrotor += particle.weight;
    mean += particle.weight * particle.state.travel;
    weights += particle.weight * particle.weight;
  }
  for (const Particle& particle : impl_->particles) {
    squares += particle.weight * (particle.state.travel - mean) * (particle.state.travel - mean);
  }
  result.probability_quadrotor = std::clamp(quadrotor, 0.0, 1.0);
  result.probability_fixed_wing = 1.0 - result.probability_quadrotor;
  result.travel = mean;
  result.travel_deviation = std::sqrt(squares);
  result.effective_particles = 1.0 / weights;
  if (result.probability_fixed_wing >= impl_->settings.sure) result.mode = common::Mode::FIXED_WING;
  if (result.probability_quadrotor >= impl_->settings.sure) result.mode = common::Mode::QUADROTOR;
  return result;
}

}  // namespace snapwing::planning
