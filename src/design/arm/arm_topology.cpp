#include "snapwing/design/arm/arm_topology.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "arm_states.h"
#include "design_scene.h"
#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"

namespace snapwing::design {

namespace {

constexpr int RETRACE_EVERY = 20;  ///< iterations: shows whether warm starts stayed on the path from rest

}  // namespace

/// a q(first) + b q(second) <= limit for a quantity q of the states.
struct ArmTopology::Bound {
  enum class Quantity { FORCE, STRAIN, ROTATION };

  int first = 0, second = -1;
  double factor_first = 0, factor_second = 0;
  Quantity quantity = Quantity::FORCE;
  std::string name;
  double limit = 1;

  double value(const State& s) const {
    if (quantity == Quantity::STRAIN) return s.strain.value;
    if (quantity == Quantity::ROTATION) return s.rotation.value;
    return s.force;
  }
  const Eigen::VectorXd& derivative(const State& s) const {
    if (quantity == Quantity::STRAIN) return s.strain.by_density;
    if (quantity == Quantity::ROTATION) return s.rotation.by_density;
    return s.by_density;
  }
};

ArmTopology::ArmTopology(const ArmDesignSettings& settings, int stage, double newton_tolerance)
    : settings_(settings), stage_(stage), newton_tolerance_(newton_tolerance) {
  const ArmDesignSettings& s = settings_;
  travels_ = {s.peak_travel, s.valley_range[0], s.valley_range[1]};
  for (const auto* list :
       {&s.peak_travels, &s.valley_travels, &s.slope_travels, &s.strain_travels, &s.rotation_travels}) {
    travels_.insert(travels_.end(), list->begin(), list->end());
  }
  std::sort(travels_.begin(), travels_.end());
  travels_.erase(std::unique(travels_.begin(), travels_.end(), [](double a, double b) { return b - a < 1e-9; }),
                 travels_.end());
  makeBounds();
  makeVariants();
  sharpness_ = s.sharpness_start;
  volume_bound_ = s.volume_start;
  buildMaps();
}

ArmTopology::~ArmTopology() = default;

void ArmTopology::makeVariants() {
  SceneRung rung;
  rung.volumetric = settings_.stages[stage_].volumetric;
  rung.cell_size = settings_.stages[stage_].cell_size;
  const scene::Scene scene = designScene(settings_, rung, nullptr);
  const int count = static_cast<int>(settings_.thresholds.size());
  // The variants' workers share the threads; what is left over goes to the assembly.
  const int threads = std::max(1, settings_.threads / (count * Worker::A_VARIANT));
  for (int v = 0; v < count; ++v) {
    variants_.push_back(std::make_unique<Variant>(scene, settings_.body, threads));
    Variant& variant = *variants_.back();
    for (const double travel : travels_) {
      variant.states.emplace_back();
      variant.states.back().travel = travel;
    }
    makeLanes(variant);
    for (const double u : settings_.strain_travels) variant.states[indexOf(u)].wants_strain = true;
    for (const double u : settings_.rotation_travels) variant.states[indexOf(u)].wants_rotation = true;
    if (settings_.valley_range[1] <= settings_.valley_range[0]) continue;
    for (const double u : settings_.valley_range) variant.states[indexOf(u)].wants_potential = true;
  }
  if (!settings_.rotation_travels.empty() && !variants_.front()->mechanism.turns()) {
    throw common::Error("bounds.rotation needs a scene with a monitor of a rotation (one with a radius)");
  }
  count_ = variants_.front()->mechanism.columnCount();
  mass_density_ = scene.bodies[settings_.body].material.mass_density;
  if (settings_.mass_limit > 0 && !(mass_density_ > 0)) {
    throw common::Error("limits.mass needs the mass_density of the designed body's material");
  }
}

void ArmTopology::makeBounds() {
  using Quantity = Bound::Quantity;
  const ArmDesignSettings& s = settings_;
  char text[96];
  for (const double u : s.peak_travels) {
    std::snprintf(text, sizeof text, "R(%g m) <= %g N", u, s.peak_bound);
    bounds_.push_back({indexOf(u), -1, 1 / s.peak_bound, 0, Quantity::FORCE, text});
  }
  if (s.peak_share_least > 0) {
    const double least = s.peak_share_least * s.peak_bound;
    std::snprintf(text, sizeof text, "R(%g m) >= %g N", s.peak_travel, least);
    bounds_.push_back({indexOf(s.peak_travel), -1, -1 / least, 0, Quantity::FORCE, text, -1});
  }
  for (const double u : s.valley_travels) {
    std::snprintf(text, sizeof text, "R(%g m) >= %g N", u, -s.valley_bound);
    bounds_.push_back({indexOf(u), -1, -1 / s.valley_bound, 0, Quantity::FORCE, text});
  }
  for (std::size_t k = 0; k + 1 < s.slope_travels.size(); ++k) {
    const double a = s.slope_travels[k], b = s.slope_travels[k + 1];
    const double factor = 1 / (s.slope_bound * (b - a));
    std::snprintf(text, sizeof text, "fall from %g to %g m <= %g N/m", a, b, s.slope_bound);
    bounds_.push_back({indexOf(a), indexOf(b), factor, -factor, Quantity::FORCE, text});
  }
  // Over half the interval's width, so that the optimiser's tolerance is a share of that.
  const double low = s.rotation_bound[0], high = s.rotation_bound[1], half = 0.5 * (high - low);
  for (const double u : s.rotation_travels) {
    std::snprintf(text, sizeof text, "rotation(%g m) <= %g rad", u, high);
    bounds_.push_back({indexOf(u), -1, 1 / half, 0, Quantity::ROTATION, text, high / half});
    std::snprintf(text, sizeof text, "rotation(%g m) >= %g rad", u, low);
    bounds_.push_back({indexOf(u), -1, -1 / half, 0, Quantity::ROTATION, text, -low / half});
  }
  for (const double u : s.strain_travels) {
    std::snprintf(text, sizeof text, "strain(%g m) <= %g", u, s.strain_limit);
    bounds_.push_back({indexOf(u), -1, 1 / s.strain_limit, 0, Quantity::STRAIN, text});
  }
}

int ArmTopology::constraintCount() const {
  return static_cast<int>(bounds_.size() * variants_.size()) + 1 + (settings_.mass_limit > 0 ? 1 : 0);
}

std::vector<std::string> ArmTopology::constraintNames() const {
  std::vector<std::string> names;
  for (const double threshold : settings_.thresholds) {
    char text[40];
    std::snprintf(text, sizeof text, ", threshold %.2f", threshold);
    for (const Bound& bound : bounds_) names.push_back(bound.name + text);
  }
  names.push_back("volume");
  if (settings_.mass_limit > 0) names.push_back("mass");
  return names;
}

void ArmTopology::buildMaps() {
  if (!filter_) {
    std::vector<std::array<double, 2>> centres;
    for (int c = 0; c < count_; ++c) centres.push_back(variants_.front()->mechanism.centre(c));
    filter_ = std::make_shared<DensityFilter>(centres, settings_.filter_radius);
    patches_ = std::make_shared<Patches>(designPatches(settings_, centres));
  }
  for (std::size_t v = 0; v < variants_.size(); ++v) {
    const auto projection = std::make_shared<Projection>(sharpness_, settings_.thresholds[v]);
    variants_[v]->map = std::make_shared<Chain>(
        std::vector<std::shared_ptr<const Parametrization>>{patches_, filter_, projection, patches_});
  }
}

void ArmTopology::beginIteration(int k, int /*total*/) {
  const ArmDesignSettings& s = settings_;
  int before = 0;
  for (int stage = 0; stage < stage_; ++stage) before += s.stages[stage].iterations;
  const int all = s.iterations();
  const double share = all > 1 ? std::min(1.0, static_cast<double>(before + k) / (all - 1)) : 1;
  const double way = std::clamp((share - s.sharpness_from) / std::max(1e-9, s.sharpness_to - s.sharpness_from), 0., 1.);
  sharpness_ = s.sharpness_start > 0 ? s.sharpness_start * common::pow(s.sharpness_end / s.sharpness_start, way)
                                     : way * s.sharpness_end;
  const double lowered = s.volume_until > 0 ? std::clamp(share / s.volume_until, 0., 1.) : 1;
  volume_bound_ = s.volume_start * common::pow(s.volume / s.volume_start, lowered);
  retrace_wanted_ = (retrace_wanted_ || k % RETRACE_EVERY == 0) && !restored_;
  restored_ = false;
  buildMaps();
}

mpm::DensityField ArmTopology::variables(const Eigen::VectorXd& x) const {
  return variants_.front()->mechanism.field(x);
}

Eigen::VectorXd ArmTopology::variablesFrom(const mpm::DensityField& field) const {
  const double cell = settings_.stages[stage_].cell_size;
  const mpm::DensityField there = field.resampled(cell);
  return variants_.front()->mechanism.columnsOf(there, settings_.start_density);
}

Eigen::VectorXd ArmTopology::density(const Eigen::VectorXd& x, int variant) const {
  return variants_[variant]->map->eval(x);
}

mpm::DensityField ArmTopology::field(const Eigen::VectorXd& x, int variant) const {
  return variants_.front()->mechanism.field(density(x, variant));
}

int ArmTopology::indexOf(double travel) const {
  for (std::size_t k = 0; k < travels_.size(); ++k) {
    if (std::abs(travels_[k] - travel) < 2e-9) return static_cast<int>(k);
  }
  throw common::Error("travel is not among the states");
}

int ArmTopology::freedomCount() const { return variants_.front()->mechanism.problem().freeCount(); }

/// The force in the valley that the objective lowers: at one travel, or its mean over a range, from the energies.
Mechanism::Sensed ArmTopology::valleyForce(const Variant& variant, bool with_derivatives) const {
  const auto& [from, to] = settings_.valley_range;
  const State &first = variant.states[indexOf(from)], &last = variant.states[indexOf(to)];
  Mechanism::Sensed mean;
  if (to <= from) {
    mean.value = first.force;
    if (with_derivatives) mean.by_density = first.by_density;
    return mean;
  }
  mean.value = (last.potential.value - first.potential.value) / (to - from);
  if (with_derivatives) mean.by_density = (last.potential.by_density - first.potential.by_density) / (to - from);
  return mean;
}

/// Adds a variant's share of the objective and its constraints, from `row` on.
void ArmTopology::addVariant(const Eigen::VectorXd& x, const Variant& variant, int& row, bool with_derivatives,
                             Evaluated& out) const {
  const ArmDesignSettings& s = settings_;
  const auto back = [&](const Eigen::VectorXd& g) { return variant.map->applyJacobianTranspose(x, g); };
  const double share = 1.0 / static_cast<double>(variants_.size());
  const double alpha = s.compliance_force > 0 ? s.compliance_weight : 0;
  const State& peak = variant.states[indexOf(s.peak_travel)];
  const Mechanism::Sensed valley = valleyForce(variant, with_derivatives);
  out.objective += share * (valley.value - peak.force) / s.peak_bound;
  if (alpha > 0) out.objective -= share * alpha * s.compliance_force * variant.pulled.travel;
  if (with_derivatives) {
    Eigen::VectorXd g = (valley.by_density - peak.by_density) / s.peak_bound;
    if (alpha > 0) g += alpha * s.compliance_force / variant.pulled.stiffness * variant.pulled.by_density;
    out.gradient += share * back(g);
  }
  for (const Bound& bound : bounds_) {
    const State& first = variant.states[bound.first];
    out.constraints(row) = bound.factor_first * bound.value(first) - bound.limit;
    if (bound.second >= 0) out.constraints(row) += bound.factor_second * bound.value(variant.states[bound.second]);
    if (with_derivatives) {
      Eigen::VectorXd g = bound.factor_first * bound.derivative(first);
      if (bound.second >= 0) g += bound.factor_second * bound.derivative(variant.states[bound.second]);
      out.jacobian.row(row) = back(g).transpose();
    }
    ++row;
  }
}

/// Volume and mass of the nominal variant. Ten times: a volume that is 1 % off counts as much as a force that is 10 %
/// off.
void ArmTopology::addSize(const Eigen::VectorXd& x, int row, bool with_derivatives, Evaluated& out) {
  constexpr double WEIGHT = 10;
  const Variant& nominal = *variants_.front();
  const Eigen::VectorXd &areas = nominal.mechanism.areas(), &volumes = nominal.mechanism.volumes();
  const auto put = [&](double value, double bound, const Eigen::VectorXd& g) {
    out.constraints(row) = WEIGHT * (value / bound - 1);
    if (with_derivatives) {
      out.jacobian.row(row) = nominal.map->applyJacobianTranspose(x, WEIGHT / bound * g).transpose();
    }
    ++row;
  };
  last_volume_ = nominal.density.dot(areas) / areas.sum();
  last_mass_ = mass_density_ * nominal.density.dot(volumes);
  put(last_volume_, volume_bound_, areas / areas.sum());
  if (settings_.mass_limit > 0) put(last_mass_, settings_.mass_limit, mass_density_ * volumes);
}

Evaluated ArmTopology::evaluate(const Eigen::VectorXd& x, bool with_derivatives) {
  Evaluated out;
  const int m = constraintCount();
  out.constraints.setZero(m);
  out.gradient.setZero(with_derivatives ? count_ : 0);
  out.jacobian.setZero(with_derivatives ? m : 0, count_);
  for (auto& variant : variants_) variant->density = variant->map->eval(x);
  if (!solveVariants(with_derivatives, out.message)) return out;
  int row = 0;
  for (const auto& variant : variants_) addVariant(x, *variant, row, with_derivatives, out);
  addSize(x, row, with_derivatives, out);
  retrace_wanted_ = false;
  const Variant& nominal = *variants_.front();
  last_grey_ = greyLevel(nominal.density);
  last_forces_.clear();
  for (const State& state : nominal.states) last_forces_.push_back(state.force);
  out.valid = std::isfinite(out.objective) && out.constraints.allFinite() && out.gradient.allFinite() &&
              out.jacobian.allFinite();
  if (!out.valid) out.message = "a value is not finite";
  return out;
}

}  // namespace snapwing::design
