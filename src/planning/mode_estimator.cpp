#include "snapwing/planning/mode_estimator.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "outside_force.h"
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
/// Likewise if nothing is known of the vehicle but that it moves somewhere between its stops.
constexpr double ANYWHERE_DENSITY = 1.0 / 60.0;  // [s2/m]

/// Misses have Student's t of four degrees of freedom: of two particles that miss by far, the nearer one counts more.
constexpr double TAIL = 4.0;
constexpr double TAIL_PEAK = 0.375;  // [1] its density at 0

constexpr double LEAST_NOISE = 0.002;     // [m/s per square root of s] of u' when nothing moves
constexpr double COMMON_NOISE = 0.05;     // [m/s per square root of s] of the common speed: drag, thrust not modelled
constexpr double MOVING = 0.1;            // [m/s] of u', above which errors of the travel show in full
constexpr double MOST_RESTITUTION = 0.6;  // [1] of the mechanical stops
constexpr int LEAST_KIND = 5;             // at least one of so many particles is touched, and one is not
constexpr double LOST_SHARE = 0.01;       // [1] probability of getting lost, in each correlation time
constexpr double LEAST_DOUBT = 0.1;       // [1] probability of being lost from which particles search
constexpr double MOST_DOUBT = 0.999;      // [1]
constexpr double SEARCHED_SHARE = 0.4;    // [1] of the particles in each correlation time, when surely lost
constexpr double SEARCHED_RATE = 1.0;     // [m/s] standard deviation of their u'
constexpr int CANDIDATES = 16;            // [1] states from which each of them chooses

struct Particle {
  std::shared_ptr<const rom::LumpedModel> model;
  rom::LumpedState state;
  double bias = 0;          ///< [m/s2] of the accelerometer
  double output_delay = 0;  ///< [s] of outputs read back
  double restitution = 0;   ///< [1] of a mechanical stop
  OutsideForce outside;
  double weight = 1;  ///< normalised
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
  require(model_error >= 0 && model_error < 1, "model_error", model_error, "0 .. below 1");
  require(outside_force >= 0 && outside_force <= 1000, "outside_force", outside_force, "0 .. 1000 N");
  require(outside_rate >= 0 && outside_rate <= 100, "outside_rate", outside_rate, "0 .. 100 per s");
  require(outside_time >= 0.01 && outside_time <= 100, "outside_time", outside_time, "0.01 .. 100 s");
  require(output_delay >= 0 && output_delay <= 1, "output_delay", output_delay, "0 .. 1 s");
  require(travel_error >= 0 && travel_error <= 0.01, "travel_error", travel_error, "0 .. 0.01 m");
  require(outlier_share >= 0 && outlier_share < 1, "outlier_share", outlier_share, "0 .. below 1");
  require(step > 0 && step <= 0.01, "step", step, "above 0, up to 0.01 s");
  require(sure > 0.5 && sure < 1, "sure", sure, "between 0.5 and 1");
  require(std::abs(gravity) <= 100, "gravity", gravity, "-100 .. 100 m/s2");
}

struct ModeEstimator::Impl {
  Impl(const common::Vehicle& v, const common::ForceTable& table, const EstimatorSettings& s,
       const std::optional<common::WingTable>& wing)
      : vehicle(v),
        settings(s),
        curves(table, wing),
        random(s.seed),
        touch(s.mount == rom::Mount::HELD ? 0.0 : s.outside_force, s.outside_rate, s.outside_time),
        cloud(v, table, s.particles, random) {
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
  /// The trial with the force from outside that the particle believes in.
  rom::Trial trialOf(const Particle& particle) const;
  void stopAtLimits(Particle* particle) const;
  void normalise();
  void weigh(double specific_force);
  /// Of a reading that is no outlier, given the particle. [s2/m]
  double readingDensity(const Particle& particle, double specific_force) const;
  /// Weighs the particles against knowing nothing, by the density that they together gave to a reading.
  void doubt(double density, double share);
  /// Puts this share of the particles where the reading could come from.
  void searchAnew(double share, double specific_force);
  double effective() const;
  void resample();
  /// Draws `count` of one kind, which together weigh `weight`.
  void draw(bool touched, int count, double weight, std::vector<Particle>* next);

  common::Vehicle vehicle;
  EstimatorSettings settings;
  rom::VehicleCurves curves;
  RandomSource random;
  OutsideForceProcess touch;
  ParameterCloud cloud;
  rom::Trial trial;
  std::vector<Particle> particles;
  std::vector<OutputChange> changes;  ///< by time
  double time = 0;
  double last_reading = -INFINITY;
  double lost = 0;  ///< [1] probability that the vehicle is not where the particles are
};

void ModeEstimator::Impl::reset(double at, common::Mode initial) {
  time = at;
  last_reading = -INFINITY;
  lost = 0;
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
    particle.restitution = MOST_RESTITUTION * random.uniform();
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
    particle.weight *= touch.move(&particle.outside, span, random);
    const rom::Trial around = trialOf(particle);
    const double q = particle.model->parameters().quadratic_share;
    for (int i = 0; i < count; ++i) {
      const double demand = common::thrustFraction(q, outputFor(particle, time + (i + 0.5) * dt));
      particle.state = particle.model->step(particle.state, demand, dt, around);
      stopAtLimits(&particle);
    }
    const double kick = (settings.process_noise * std::abs(particle.state.travelRate()) + LEAST_NOISE) * spread;
    const double common_kick = settings.mount == rom::Mount::HELD ? 0.0 : COMMON_NOISE * spread * random.normal();
    particle.state.ring_speed += common_kick;
    particle.state.centre_speed += common_kick + kick * random.normal();
    particle.state.time = at;
  }
  normalise();
  time = at;
  forgetOldChanges();
}

void ModeEstimator::Impl::stopAtLimits(Particle* particle) const {
  rom::LumpedState& state = particle->state;
  const common::Limits& limits = vehicle.limits;
  const double limit = std::clamp(state.travel, limits.travel_min, limits.travel_max);
  if (limit == state.travel) return;
  const bool outward = (state.travel > limit) == (state.travelRate() > 0);
  const double change = outward ? -(1.0 + particle->restitution) * state.travelRate() : 0.0;
  // The blow keeps the momentum m_r z_r' + m_c z_c' + S u'.
  const double centre = particle->model->parameters().centre_mass;
  const double all = trial.mount == rom::Mount::HELD ? INFINITY : particle->model->ringMass(trial) + centre;
  const rom::TravelInertia* moved = particle->model->inertiaOf(trial);
  const double share = rom::relativeInertia(moved ? moved->at(limit) : rom::InertiaSample(), centre, all).share;
  state.ring_speed += share * change;
  state.centre_speed -= (1.0 - share) * change;
  state.travel = limit;
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
  std::vector<double> fit(particles.size());
  double explained = 0;
  const double noise = settings.outlier_share * OUTLIER_DENSITY;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double density = readingDensity(particles[i], specific_force);
    explained += particles[i].weight * density;
    fit[i] = std::log(density + noise);
  }
  doubt(explained + noise, share);
  const double best = *std::max_element(fit.begin(), fit.end());
  if (!std::isfinite(best)) return;  // nothing fits and no outliers are allowed for: the reading is dropped
  for (std::size_t i = 0; i < particles.size(); ++i) particles[i].weight *= std::exp(share * (fit[i] - best));
  normalise();
  if (effective() < 0.5 * settings.particles) resample();
  if (lost > LEAST_DOUBT) searchAnew(lost * SEARCHED_SHARE * share, specific_force);
}

double ModeEstimator::Impl::readingDensity(const Particle& particle, double specific_force) const {
  const double expected = particle.model->centreSpecificForce(particle.state, trialOf(particle));
  // A travel that is off by a little is read as another force where the arms are stiff. Only while it moves: at rest
  // this would make the softer mode the likelier one.
  const double stiffness = particle.model->potential().at(particle.state.travel).stiffness;
  const double rate = particle.state.travelRate(), moves = rate / std::hypot(rate, MOVING);
  const double shift = moves * settings.travel_error * stiffness / particle.model->parameters().centre_mass;
  const double sigma = std::hypot(settings.accelerometer_noise, settings.model_error * expected, shift);
  const double miss = (specific_force - expected - particle.bias) / sigma;
  const double near = 1.0 + miss * miss / TAIL;
  return (1.0 - settings.outlier_share) * TAIL_PEAK / (sigma * near * near * std::sqrt(near));
}

void ModeEstimator::Impl::doubt(double density, double share) {
  // Two hypotheses: the particles are where the vehicle is, or it may be anywhere, where every reading is as likely.
  const double before = std::min(MOST_DOUBT, lost + (1.0 - lost) * LOST_SHARE * share);  // else never found again
  const double anywhere = before * std::pow(ANYWHERE_DENSITY, share);
  lost = anywhere / (anywhere + (1.0 - before) * std::pow(density, share));
}

void ModeEstimator::Impl::searchAnew(double share, double specific_force) {
  const double low = vehicle.limits.travel_min, range = vehicle.limits.travel_max - low;
  for (Particle& particle : particles) {
    if (random.uniform() >= share) continue;
    // Anywhere within the stops, at any likely speed, as far as the reading allows it.
    double total = 0;
    Particle chosen = particle, candidate = particle;
    for (int i = 0; i < CANDIDATES; ++i) {
      candidate.state.travel = low + range * random.uniform();
      candidate.state.centre_speed = candidate.state.ring_speed - SEARCHED_RATE * random.normal();
      const double density = readingDensity(candidate, specific_force);
      total += density;
      if (density > 0 && random.uniform() * total < density) chosen = candidate;
    }
    if (total < CANDIDATES * 0.1 * OUTLIER_DENSITY) continue;  // no state explains it
    particle = chosen;
    particle.weight = 1.0 / settings.particles;
  }
  normalise();
}

void ModeEstimator::Impl::normalise() {
  double sum = 0;
  for (const Particle& particle : particles) sum += particle.weight;
  for (Particle& particle : particles) particle.weight /= sum;
}

rom::Trial ModeEstimator::Impl::trialOf(const Particle& particle) const {
  rom::Trial around = trial;
  around.push = particle.outside.force;
  return around;
}

double ModeEstimator::Impl::effective() const {
  double squares = 0;
  for (const Particle& particle : particles) squares += particle.weight * particle.weight;
  return 1.0 / squares;
}

void ModeEstimator::Impl::resample() {
  // Those who believe in a touch and those who do not, each kind apart and never fewer than a fifth of all: a force
  // needs some readings to show, and until then its weight is small [Boers and Driessen 2003].
  double touched = 0;
  std::size_t with = 0;
  for (const Particle& particle : particles) {
    if (particle.outside.touched()) touched += particle.weight, ++with;
  }
  const int all = settings.particles, least = all / LEAST_KIND;
  int count = std::clamp(static_cast<int>(std::lround(all * touched)), least, all - least);
  if (with == 0 || !(touched > 0)) count = 0;
  if (with == particles.size() || !(touched < 1)) count = all;
  std::vector<Particle> next;
  next.reserve(particles.size());
  draw(true, count, touched, &next);
  draw(false, all - count, 1.0 - touched, &next);
  std::vector<common::VehicleParameters> parameters;
  for (const Particle& particle : next) parameters.push_back(particle.model->parameters());
  cloud.scatter(parameters, random);
  for (std::size_t i = 0; i < next.size(); ++i) {
    next[i].model = modelFor(parameters[i]);
    next[i].bias += 0.1 * settings.accelerometer_bias * random.normal();
  }
  particles = std::move(next);
}

void ModeEstimator::Impl::draw(bool touched, int count, double weight, std::vector<Particle>* next) {
  if (count <= 0) return;
  std::vector<const Particle*> kind;
  for (const Particle& particle : particles) {
    if (particle.outside.touched() == touched) kind.push_back(&particle);
  }
  // Systematic: one random number for all.
  const double spacing = weight / count;
  double at = spacing * random.uniform(), sum = kind.front()->weight;
  std::size_t k = 0;
  for (int i = 0; i < count; ++i, at += spacing) {
    while (sum < at && k + 1 < kind.size()) sum += kind[++k]->weight;
    next->push_back(*kind[k]);
    next->back().weight = spacing;
  }
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
    particle.outside = {};
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
  double quadrotor = 0, mean = 0, squares = 0;
  for (const Particle& particle : impl_->particles) {
    if (particle.state.travel > barrier) quadrotor += particle.weight;
    mean += particle.weight * particle.state.travel;
  }
  for (const Particle& particle : impl_->particles) {
    squares += particle.weight * (particle.state.travel - mean) * (particle.state.travel - mean);
  }
  result.probability_quadrotor = std::clamp(quadrotor, 0.0, 1.0);
  result.probability_fixed_wing = 1.0 - result.probability_quadrotor;
  result.travel = mean;
  result.travel_deviation = std::hypot(std::sqrt(squares), impl_->settings.travel_error);
  result.effective_particles = impl_->effective();
  if (result.probability_fixed_wing >= impl_->settings.sure) result.mode = common::Mode::FIXED_WING;
  if (result.probability_quadrotor >= impl_->settings.sure) result.mode = common::Mode::QUADROTOR;
  return result;
}

}  // namespace snapwing::planning
