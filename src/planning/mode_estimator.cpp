#include "snapwing/planning/mode_estimator.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "parameter_cloud.h"
#include "particles.h"
#include "random_source.h"
#include "snapwing/common/error.h"
#include "snapwing/rom/vehicle_curves.h"
#include "snapwing/vehicle/pulse.h"

namespace snapwing::planning {

namespace {

/// Likelihood of a reading that has nothing to do with the model: uniform over what an accelerometer may show.
constexpr double OUTLIER_DENSITY = 1.0 / 300.0;  // [s2/m]
/// Likewise if nothing is known of the vehicle but that it moves somewhere between its stops.
constexpr double ANYWHERE_DENSITY = 1.0 / 60.0;  // [s2/m]

/// Misses have Student's t of four degrees of freedom: of two particles that miss by far, the nearer one counts more.
constexpr double TAIL = 4.0;
constexpr double TAIL_PEAK = 0.375;  // [1] its density at 0

constexpr double LEAST_NOISE = 0.002;       // [m/s per square root of s] of u' when nothing moves
constexpr double COMMON_NOISE = 0.05;       // [m/s per square root of s] of the common speed: drag, thrust not modelled
constexpr double MOVING = 0.1;              // [m/s] of u', above which errors of the travel show in full
constexpr double MOST_RESTITUTION = 0.6;    // [1] of the mechanical stops
constexpr double SAMPLING_MARGIN = 3.0;     // [1] standard deviations of the particles' own error
constexpr double DECIDED = 7.0;             // [1] log odds beyond which their error so far is forgotten
constexpr double LASTING = 4.0;             // [outside_time] no touch lasts this long: something else is wrong
constexpr double LASTING_FORCE = 1.0;       // [m/s2] specific force from which this is so, if
constexpr double LASTING_SHARE = 0.5;       // [1] the force from outside makes up more than this of it
constexpr double CLEAR_DOUBT = 0.1;         // [1] probability of being lost below which it counts as found again
constexpr double LOST_SHARE = 0.01;         // [1] probability of getting lost, in each correlation time
constexpr double LEAST_DOUBT = 0.1;         // [1] probability of being lost from which particles search
constexpr double MOST_DOUBT = 0.999;        // [1]
constexpr double SEARCHED_SHARE = 0.4;      // [1] of the particles in each correlation time, when surely lost
constexpr double SEARCHED_RATE = 1.0;       // [m/s] standard deviation of their u'
constexpr int CANDIDATES = 16;              // [1] states from which each of them chooses
constexpr double LEAST_EVIDENCE = 5.0;      // [1] correlation times of readings, before which nothing is known
constexpr std::size_t MOST_CHANGES = 1000;  // of the motors' output that are kept

/// A change of the motors' output.
struct OutputChange {
  double time;
  double output;
};

}  // namespace

struct ModeEstimator::Impl {
  Impl(const vehicle::Vehicle& v, const vehicle::ForceTable& table, const EstimatorSettings& s,
       const std::optional<vehicle::WingTable>& wing)
      : vehicle(v),
        settings(s),
        curves(table, wing),
        random(s.seed),
        touch(s.mount == vehicle::Mount::HELD ? 0.0 : s.outside_force, s.outside_rate, s.outside_time),
        cloud(v, table, s.particles, random),
        barrier(curves.spline().equilibria().barrier) {
    trial.mount = s.mount;
    trial.gravity = s.gravity;
    trial.wings = s.wings;
    trial.validate();
  }

  std::shared_ptr<const rom::LumpedModel> modelFor(const vehicle::VehicleParameters& p) const {
    rom::LumpedSettings lumped;
    lumped.step = settings.step;
    lumped.convergence = 1e-6;  // of the last move; the error left is about its square
    return std::make_shared<rom::LumpedModel>(curves.model(vehicle.radio, p, lumped));
  }

  void reset(double at, vehicle::Mode initial);
  /// After a gap: nothing is known but what the motors do.
  void beginAnew(double at);
  double outputFor(const Particle& particle, double at) const;
  void moveTo(double at, double longest_step);
  void forgetOldChanges();
  /// The trial with the force from outside that the particle believes in.
  vehicle::Trial trialOf(const Particle& particle) const {
    vehicle::Trial around = trial;
    around.push = particle.outside.force;
    return around;
  }
  void stopAtLimits(Particle* particle) const;
  void weigh(double specific_force);
  /// Of a reading that is no outlier, given the particle. [s2/m]
  double readingDensity(const Particle& particle, double specific_force) const;
  /// Weighs the particles against knowing nothing, by the density that they together gave to a reading.
  void doubt(double density, double share);
  /// Puts this share of the particles where the reading could come from.
  void searchAnew(double share, double specific_force);
  /// Fills in the mode, or why it is not known.
  void judge(ModeEstimate* result) const;
  void resample();
  /// Of the mode Q. Of a vehicle that may be anywhere, nothing is known of its mode.
  double probability(double quadrotor) const { return (1.0 - lost) * quadrotor + 0.5 * lost; }
  /// Log odds of the likelier mode that hold whatever the error of the particles. @param quadrotor  share of Q
  double surelyAtLeast(double quadrotor) const;
  /// Mean acceleration that those who believe in a force from outside ascribe to it and that drag could not make
  /// [m/s2].
  double pushOfTouched() const;
  /// Notes for how long a force from outside has been believed to accelerate the vehicle, and whether the mode is
  /// known. @param span  [s]
  void follow(double span, double specific_force);

  vehicle::Vehicle vehicle;
  EstimatorSettings settings;
  rom::VehicleCurves curves;
  RandomSource random;
  OutsideForceProcess touch;
  ParameterCloud cloud;
  vehicle::Trial trial;
  std::vector<Particle> particles;
  std::vector<OutputChange> changes;  ///< by time
  long steps = 0;
  double time = 0;
  double last_reading = -INFINITY;
  double lost = 0;               ///< [1] probability that the vehicle is not where the particles are
  double evidence = 0;           ///< [1] correlation times of readings since the start
  double last_effective = 0;     ///< particles that counted at the last reading
  double touched = 0;            ///< [1] probability of a force from outside
  double touched_time = 0;       ///< [s] for which it has been the likelier one
  bool known = false;            ///< the mode was known while nobody touched, and the vehicle has not been lost since
  double barrier;                ///< [m]
  double sampling_variance = 0;  ///< [1] of the log odds of the modes: what drawing anew added since the start
};

void ModeEstimator::Impl::reset(double at, vehicle::Mode initial) {
  time = at;
  last_reading = -INFINITY;
  lost = evidence = last_effective = touched = touched_time = sampling_variance = 0;
  known = initial != vehicle::Mode::UNKNOWN;
  changes.clear();
  particles.assign(settings.particles, Particle{});
  vehicle::Trial rest = trial;
  rest.initial_thrust_fraction = 0.0;
  for (int i = 0; i < settings.particles; ++i) {
    Particle& particle = particles[i];
    particle.model = modelFor(cloud.drawn()[i]);
    vehicle::Mode mode = initial;
    if (mode == vehicle::Mode::UNKNOWN) mode = i % 2 == 0 ? vehicle::Mode::FIXED_WING : vehicle::Mode::QUADROTOR;
    particle.state = particle.model->startState(mode, rest);
    particle.state.time = at;
    particle.bias = settings.accelerometer_bias * random.normal();
    particle.output_delay = settings.output_delay * random.uniform();
    particle.restitution = MOST_RESTITUTION * random.uniform();
    particle.weight = 1.0 / settings.particles;
  }
}

void ModeEstimator::Impl::beginAnew(double at) {
  const double output = changes.empty() ? 0.0 : changes.back().output;
  reset(at, vehicle::Mode::UNKNOWN);
  changes.push_back({at - settings.output_delay, output});
}

double ModeEstimator::Impl::outputFor(const Particle& particle, double at) const {
  double output = 0;
  for (const OutputChange& change : changes) {
    if (change.time + particle.output_delay <= at) output = change.output;
  }
  return output;
}

void ModeEstimator::Impl::moveTo(double at, double longest_step) {
  const double span = at - time;
  if (!(span > 0)) return;
  const int count = std::max(1, static_cast<int>(std::ceil(span / longest_step - 1e-9)));
  steps += count;
  const double dt = span / count;
  const double spread = std::sqrt(span);
  for (Particle& particle : particles) {
    particle.weight *= touch.move(&particle.outside, span, random);
    const vehicle::Trial around = trialOf(particle);
    const double q = particle.model->parameters().quadratic_share;
    for (int i = 0; i < count; ++i) {
      const double demand = vehicle::thrustFraction(q, outputFor(particle, time + (i + 0.5) * dt));
      particle.state = particle.model->step(particle.state, demand, dt, around);
      stopAtLimits(&particle);
    }
    const double kick = (settings.process_noise * std::abs(particle.state.travelRate()) + LEAST_NOISE) * spread;
    const double common_kick = settings.mount == vehicle::Mount::HELD ? 0.0 : COMMON_NOISE * spread * random.normal();
    particle.state.ring_speed += common_kick;
    particle.state.centre_speed += common_kick + kick * random.normal();
    particle.state.time = at;
  }
  normalise(&particles);
  time = at;
  forgetOldChanges();
}

void ModeEstimator::Impl::stopAtLimits(Particle* particle) const {
  rom::LumpedState& state = particle->state;
  const vehicle::Limits& limits = vehicle.limits;
  const double limit = std::clamp(state.travel, limits.travel_min, limits.travel_max);
  if (limit == state.travel) return;
  const bool outward = (state.travel > limit) == (state.travelRate() > 0);
  const double change = outward ? -(1.0 + particle->restitution) * state.travelRate() : 0.0;
  // The blow keeps the momentum m_r z_r' + m_c z_c' + S u'.
  const double centre = particle->model->parameters().centre_mass;
  const double all = trial.mount == vehicle::Mount::HELD ? INFINITY : particle->model->ringMass(trial) + centre;
  const rom::TravelInertia* moved = particle->model->inertiaOf(trial);
  const double share = rom::relativeInertia(moved ? moved->at(limit) : rom::InertiaSample(), centre, all).share;
  state.ring_speed += share * change;
  state.centre_speed -= (1.0 - share) * change;
  state.travel = limit;
}

void ModeEstimator::Impl::forgetOldChanges() {
  // Changes that every particle has long seen, but for the last of them.
  const double seen = time - settings.output_delay;
  std::size_t old = 0;
  while (old + 1 < changes.size() && changes[old + 1].time < seen) ++old;
  changes.erase(changes.begin(), changes.begin() + static_cast<std::ptrdiff_t>(old));
}

void ModeEstimator::Impl::weigh(double specific_force) {
  const double span = std::min(time - last_reading, settings.correlation_time);
  const double share = span / settings.correlation_time;
  last_reading = time;
  evidence += share;
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
  normalise(&particles);
  last_effective = effective(particles);
  if (last_effective < 0.5 * settings.particles) resample();
  if (lost > LEAST_DOUBT) searchAnew(lost * SEARCHED_SHARE * share, specific_force);
  follow(span, specific_force);
}

double ModeEstimator::Impl::pushOfTouched() const {
  double push = 0, drag = 0, weight = 0;
  for (const Particle& particle : particles) {
    if (!particle.outside.touched()) continue;
    const vehicle::VehicleParameters& p = particle.model->parameters();
    const double mass = particle.model->ringMass(trial) + p.centre_mass, v = particle.state.ring_speed;
    const double resistance =
        p.ring_drag + p.centre_drag + (settings.mount == vehicle::Mount::BOOM ? p.boom_drag : 0.0);
    push += particle.weight * particle.outside.force / mass;
    drag += particle.weight * resistance * v * v / mass;
    weight += particle.weight;
  }
  return weight > 0 ? std::max(0.0, std::abs(push) - drag) / weight : 0.0;
}

void ModeEstimator::Impl::follow(double span, double specific_force) {
  touched = shareTouched(particles);
  // A hand may hold the ring for ever, but nobody accelerates it for long. A light touch that only corrects what the
  // particles get wrong says nothing against them; nor does one within their drag: a wrong drag on a long flight looks
  // like a hand that pushes as the square of a speed that nothing measures.
  const double deviation = std::abs(specific_force - settings.gravity);
  const double push = pushOfTouched();
  const bool pushed = touched > 0.5 && deviation > LASTING_FORCE && push > LASTING_SHARE * deviation;
  touched_time = pushed ? touched_time + span : 0.0;
  const double odds = surelyAtLeast(shareInQuadrotor(particles, barrier));
  if (odds > DECIDED) sampling_variance = 0;
  const bool sure = odds >= std::log(settings.sure / (1.0 - settings.sure)) && evidence >= LEAST_EVIDENCE;
  if (lost > 0.5 || touched_time > LASTING * settings.outside_time) known = false;
  if (sure && lost < CLEAR_DOUBT && (touched < 0.5 || push == 0.0)) known = true;
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
  normalise(&particles);
}

double ModeEstimator::Impl::surelyAtLeast(double quadrotor) const {
  const double likelier = std::max(quadrotor, 1.0 - quadrotor);
  if (likelier >= 1.0) return INFINITY;
  const double odds = std::log(likelier / (1.0 - likelier));
  return odds - SAMPLING_MARGIN * std::sqrt(sampling_variance + samplingVariance(particles, barrier));
}

void ModeEstimator::Impl::judge(ModeEstimate* result) const {
  const bool fixed_wing = result->probability_fixed_wing >= settings.sure;
  const bool quadrotor = result->probability_quadrotor >= settings.sure;
  if (evidence == 0) {
    result->reason = "no IMU reading came";
  } else if (evidence < LEAST_EVIDENCE) {
    result->reason = "too few IMU readings so far";
  } else if (last_effective < settings.least_effective * settings.particles) {
    result->reason = "too few particles explain the readings";
  } else if (lost > 0.5) {
    result->reason = "the readings fit no state of the vehicle";
  } else if (!fixed_wing && !quadrotor) {
    result->reason = "the readings fit both modes";
  } else if (!known && touched > 0.5) {
    result->reason = "only a lasting force from outside explains the readings: are gravity and the IMU's axis right?";
  } else if (!known) {
    result->reason = "the readings fitted nothing a moment ago";
  } else {
    result->mode = fixed_wing ? vehicle::Mode::FIXED_WING : vehicle::Mode::QUADROTOR;
  }
}

void ModeEstimator::Impl::resample() {
  sampling_variance += samplingVariance(particles, barrier);
  std::vector<Particle> next = drawAnew(particles, barrier, random);
  std::vector<vehicle::VehicleParameters> parameters;
  for (const Particle& particle : next) parameters.push_back(particle.model->parameters());
  cloud.scatter(parameters, random);
  for (std::size_t i = 0; i < next.size(); ++i) {
    next[i].model = modelFor(parameters[i]);
    next[i].bias += 0.1 * settings.accelerometer_bias * random.normal();
  }
  particles = std::move(next);
}

ModeEstimator::ModeEstimator(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table,
                             const EstimatorSettings& settings, const std::optional<vehicle::WingTable>& wing) {
  settings.validate();
  impl_ = std::make_unique<Impl>(vehicle, table, settings, wing);
  if (!impl_->curves.spline().equilibria().bistable)
    throw common::Error("mode estimator: the force curve is not bistable");
  reset(0.0, vehicle::Mode::UNKNOWN);
}

ModeEstimator::~ModeEstimator() = default;
ModeEstimator::ModeEstimator(ModeEstimator&&) noexcept = default;

void ModeEstimator::reset(double time, vehicle::Mode initial) { impl_->reset(time, initial); }

void ModeEstimator::atRest() {
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
  if (!changes.empty() && changes.back().output == clamped) return;
  if (changes.size() >= MOST_CHANGES) changes.erase(changes.begin(), changes.begin() + MOST_CHANGES / 2);
  changes.push_back({time, clamped});
}

void ModeEstimator::accelerometer(double time, double specific_force, bool hurried) {
  if (!std::isfinite(time) || !std::isfinite(specific_force) || time < impl_->time) return;
  if (time - impl_->time > impl_->settings.longest_gap) impl_->beginAnew(time);
  impl_->moveTo(time, hurried ? impl_->settings.hurried_step : impl_->settings.step);
  impl_->weigh(specific_force);
}

const EstimatorSettings& ModeEstimator::settings() const { return impl_->settings; }

long ModeEstimator::steps() const { return impl_->steps; }

ModeEstimate ModeEstimator::estimate() const {
  ModeEstimate result;
  result.time = impl_->time;
  double quadrotor = 0, mean = 0, mean_quadrotor = 0, squares = 0;
  for (const Particle& particle : impl_->particles) {
    const double part = particle.weight * particle.state.travel;
    mean += part;
    if (particle.inQuadrotor(impl_->barrier)) quadrotor += particle.weight, mean_quadrotor += part;
  }
  for (const Particle& particle : impl_->particles) {
    squares += particle.weight * (particle.state.travel - mean) * (particle.state.travel - mean);
  }
  quadrotor = std::clamp(quadrotor, 0.0, 1.0);
  if (quadrotor > 0) result.travel_quadrotor = mean_quadrotor / quadrotor;
  if (quadrotor < 1) result.travel_fixed_wing = (mean - mean_quadrotor) / (1.0 - quadrotor);
  result.lost = impl_->lost;
  result.probability_quadrotor = impl_->probability(quadrotor);
  result.probability_fixed_wing = 1.0 - result.probability_quadrotor;
  result.travel = mean;
  result.travel_deviation = std::hypot(std::sqrt(squares), impl_->settings.travel_error);
  result.effective_particles = impl_->last_effective;
  impl_->judge(&result);
  return result;
}

}  // namespace snapwing::planning
