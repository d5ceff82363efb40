#include "snapwing/design/arm_topology.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/statics/sensitivity.h"

namespace snapwing::design {

namespace {

constexpr int RETRACE_EVERY = 10;      ///< iterations: shows whether warm starts stayed on the path from rest
constexpr double TRACE_STEP = 0.0025;  ///< [m]

}  // namespace

/// Equilibrium at one travel with what the optimiser needs of it.
struct ArmTopology::State {
  double travel = 0;
  Eigen::VectorXd z;  ///< warm start; empty before the first trace
  double force = 0, stiffness = 0;
  Eigen::VectorXd by_density;  ///< dR/drho
};

struct ArmTopology::Variant {
  std::shared_ptr<const Chain> map;
  std::vector<State> states;
  State pulled;  ///< under the force -f
  Eigen::VectorXd density;
};

mpm::DensityField armDomain(const common::ArmSettings& arm, double cell_size, double density) {
  mpm::DensityField field;
  field.cell_size = cell_size;
  const auto whole = [&](double length, const char* name) {
    const double cells = length / cell_size;
    if (std::abs(cells - std::round(cells)) > 1e-6 || cells < 1) {
      throw common::Error("cell_size " + std::to_string(cell_size) + " m does not divide " + name + " = " +
                          std::to_string(length) + " m");
    }
    return static_cast<int>(std::lround(cells));
  };
  field.cells = {whole(arm.domain_length, "domain_length"), whole(arm.domain_height, "domain_height")};
  const int leg = whole(arm.leg_width, "leg_width"), bar = whole(arm.bar_height, "bar_height");
  for (int j = 0; j < field.cells[1]; ++j) {
    for (int i = 0; i < field.cells[0]; ++i) field.value.push_back(i < leg || j < bar ? density : -1.0);
  }
  return field;
}

ArmTopology::ArmTopology(const ArmDesignSettings& settings, double newton_tolerance)
    : settings_(settings), newton_tolerance_(newton_tolerance) {
  const common::Vehicle& v = settings_.vehicle;
  statics::ArmProblemSettings physics;
  physics.plane = settings_.plane;
  physics.threads = settings_.threads;
  physics.interpolation.threshold = settings_.void_threshold;
  const elasticity::Material material{v.material.youngs_modulus.value, v.material.poisson_ratio.value,
                                      v.material.mass_density.value};
  arm_ = std::make_unique<statics::ArmProblem>(v.arm, material, armDomain(v.arm, settings_.cell_size, 1.0), physics);
  statics::NewtonSettings newton;
  newton.relative_tolerance = newton_tolerance_;
  newton_ = std::make_unique<statics::Newton>(arm_->problem(), newton);
  count_ = arm_->problem().solid().cellCount();
  travels_ = {settings_.peak_travel, settings_.valley_travel};
  for (const auto* list : {&settings_.peak_travels, &settings_.valley_travels, &settings_.slope_travels}) {
    travels_.insert(travels_.end(), list->begin(), list->end());
  }
  std::sort(travels_.begin(), travels_.end());
  travels_.erase(std::unique(travels_.begin(), travels_.end(), [](double a, double b) { return b - a < 1e-9; }),
                 travels_.end());
  variants_.resize(settings_.thresholds.size());
  for (Variant& variant : variants_) {
    for (const double travel : travels_) {
      variant.states.emplace_back();
      variant.states.back().travel = travel;
    }
  }
  sharpness_ = settings_.sharpness_start;
  volume_bound_ = settings_.volume_start;
  buildMaps();
}

ArmTopology::~ArmTopology() = default;

void ArmTopology::buildMaps() {
  const auto& solid = arm_->problem().solid();
  if (!filter_) {
    std::vector<std::array<double, 2>> centres;
    Eigen::VectorXd held = Eigen::VectorXd::Constant(count_, -1);
    const common::ArmSettings& arm = settings_.vehicle.arm;
    for (int c = 0; c < count_; ++c) {
      const auto x = solid.grid(0).cellCentre(solid.cellAt(c));
      centres.push_back({x(0), x(1)});
      const bool at_pin = std::hypot(x(0) - arm.pin_x, x(1) - arm.pin_y) < settings_.pin_patch;
      const bool at_clamp = x(0) < settings_.clamp_patch && x(1) > arm.clamp_y_low && x(1) < arm.clamp_y_high;
      if (at_pin || at_clamp) held(c) = 1;
    }
    filter_ = std::make_shared<DensityFilter>(centres, settings_.filter_radius);
    patches_ = std::make_shared<Patches>(held);
  }
  for (std::size_t v = 0; v < variants_.size(); ++v) {
    const auto projection = std::make_shared<Projection>(sharpness_, settings_.thresholds[v]);
    variants_[v].map = std::make_shared<Chain>(
        std::vector<std::shared_ptr<const Parametrization>>{patches_, filter_, projection, patches_});
  }
}

int ArmTopology::constraintCount() const {
  const int slopes = std::max<int>(0, static_cast<int>(settings_.slope_travels.size()) - 1);
  const int each = static_cast<int>(settings_.peak_travels.size() + settings_.valley_travels.size()) + slopes;
  return each * static_cast<int>(variants_.size()) + 1;
}

void ArmTopology::beginIteration(int k, int total) {
  const double share = total > 1 ? static_cast<double>(k) / (total - 1) : 1;
  const ArmDesignSettings& s = settings_;
  const double way = std::clamp((share - s.sharpness_from) / std::max(1e-9, s.sharpness_to - s.sharpness_from), 0., 1.);
  sharpness_ = s.sharpness_start > 0 ? s.sharpness_start * std::pow(s.sharpness_end / s.sharpness_start, way)
                                     : way * s.sharpness_end;
  const double lowered = s.volume_until > 0 ? std::clamp(share / s.volume_until, 0., 1.) : 1;
  volume_bound_ = s.volume_start * std::pow(s.volume / s.volume_start, lowered);
  retrace_wanted_ = retrace_wanted_ || k % RETRACE_EVERY == 0;
  buildMaps();
}

Eigen::VectorXd ArmTopology::density(const Eigen::VectorXd& x, int variant) const {
  return variants_[variant].map->eval(x);
}

mpm::DensityField ArmTopology::field(const Eigen::VectorXd& x, int variant) const {
  mpm::DensityField field = armDomain(settings_.vehicle.arm, settings_.cell_size, 0);
  const Eigen::VectorXd rho = density(x, variant);
  const auto& solid = arm_->problem().solid();
  for (int c = 0; c < count_; ++c) {
    field.value[static_cast<std::size_t>(solid.cellAt(c)[1]) * field.cells[0] + solid.cellAt(c)[0]] = rho(c);
  }
  return field;
}

int ArmTopology::indexOf(double travel) const {
  for (std::size_t k = 0; k < travels_.size(); ++k) {
    if (std::abs(travels_[k] - travel) < 2e-9) return static_cast<int>(k);
  }
  throw common::Error("travel is not among the states");
}

bool ArmTopology::solveState(State& state, bool with_derivatives, std::string& why) {
  statics::Evaluation at;
  const statics::NewtonResult solved = newton_->solve(Eigen::VectorXd::Constant(1, state.travel), state.z, at);
  if (!solved.converged()) {
    std::ostringstream text;
    text << "no equilibrium at u = " << state.travel << " m: " << statics::statusName(solved.status);
    why = text.str();
    return false;
  }
  state.force = at.control_force(0);
  if (!with_derivatives) return true;
  statics::Cholesky& cholesky = newton_->cholesky();
  if (!cholesky.factorize(at.hessian) && cholesky.factorizeIndefinite(at.hessian) < 0) {
    why = "singular tangent at u = " + std::to_string(state.travel) + " m";
    return false;
  }
  Eigen::VectorXd free_part, control_part;
  arm_->problem().controlTangent(at, Eigen::VectorXd::Ones(1), free_part, control_part);
  state.stiffness = control_part(0) - free_part.dot(cholesky.solve(free_part));
  state.by_density = statics::Sensitivity<2>(arm_->problem(), cholesky, at).reaction();
  return true;
}

/// First travel on the path from rest that pulls with at least -f: its state is the start of a Newton on the travel.
bool ArmTopology::tracePulled(Variant& variant, std::string& why) {
  constexpr double LARGEST = 0.2;  // [m] of pull
  statics::PathSettings settings;
  settings.newton.relative_tolerance = newton_tolerance_;
  statics::PathFollower follower(arm_->problem(), settings);
  State& s = variant.pulled;
  s.travel = 0;
  s.z = Eigen::VectorXd::Zero(arm_->problem().freeCount());
  std::ostringstream text;
  text << "the arm does not hold the compliance force of " << settings_.compliance_force << " N up to u = ";
  while (s.travel > -LARGEST) {
    const statics::PathResult path = follower.follow(s.z, {s.travel, s.travel - TRACE_STEP});
    if (path.status != statics::SolveStatus::CONVERGED) {
      text << s.travel << " m: " << path.message;
      break;
    }
    s.travel -= TRACE_STEP;
    s.z = path.points.back().solution;
    if (path.points.back().force <= -settings_.compliance_force) return true;
  }
  if (s.travel <= -LARGEST) text << s.travel << " m";
  why = text.str();
  s.z.resize(0);
  return false;
}

/// Newton on the travel until R(u3) = -f, from the last design's state or else from the path.
bool ArmTopology::solvePulled(Variant& variant, std::string& why) {
  if (settings_.compliance_weight == 0 || settings_.compliance_force == 0) return true;
  State& s = variant.pulled;
  for (int attempt = s.z.size() == 0 ? 1 : 0; attempt < 2; ++attempt) {
    if (attempt == 1 && !tracePulled(variant, why)) return false;
    for (int k = 0; k < 30; ++k) {
      if (!solveState(s, true, why)) break;
      const double missing = -settings_.compliance_force - s.force;
      if (std::abs(missing) < 1e-7 * settings_.compliance_force) return true;
      if (!(s.stiffness > 0)) break;
      s.travel += std::clamp(missing / s.stiffness, -TRACE_STEP, TRACE_STEP);
    }
  }
  if (why.empty()) why = "no equilibrium under the compliance force was found near the path from rest";
  return false;
}

bool ArmTopology::retrace(Variant& variant, std::string& why) {
  ++retraces_;
  statics::PathSettings settings;
  settings.newton.relative_tolerance = newton_tolerance_;
  std::vector<double> targets{0.0};
  std::vector<std::size_t> place;
  for (const double travel : travels_) {
    while (targets.back() + TRACE_STEP < travel - 1e-6) targets.push_back(targets.back() + TRACE_STEP);
    place.push_back(targets.size());
    targets.push_back(travel);
  }
  const statics::PathResult path = statics::PathFollower(arm_->problem(), settings)
                                       .follow(Eigen::VectorXd::Zero(arm_->problem().freeCount()), targets);
  if (path.status != statics::SolveStatus::CONVERGED) {
    why = path.message;
    return false;
  }
  for (std::size_t k = 0; k < place.size(); ++k) variant.states[k].z = path.points[place[k]].solution;
  return true;
}

bool ArmTopology::solveVariant(Variant& variant, bool with_derivatives, std::string& why) {
  arm_->setDensities({variant.density.data(), variant.density.data() + variant.density.size()});
  const bool cold = variant.states.front().z.size() == 0;
  if ((cold || retrace_wanted_) && !retrace(variant, why)) return false;
  bool retraced = cold || retrace_wanted_;
  for (std::size_t k = 0; k < variant.states.size(); ++k) {
    if (solveState(variant.states[k], with_derivatives, why)) continue;
    if (retraced || !retrace(variant, why)) return false;
    retraced = true;
    k = static_cast<std::size_t>(-1);  // all states again, from rest
  }
  return solvePulled(variant, why);
}

/// Adds a variant's share of the objective and its constraints, from `row` on.
void ArmTopology::addVariant(const Eigen::VectorXd& x, const Variant& variant, int& row, bool with_derivatives,
                             Evaluated& out) const {
  const ArmDesignSettings& s = settings_;
  const auto back = [&](const Eigen::VectorXd& g) { return variant.map->applyJacobianTranspose(x, g); };
  const auto state = [&](double travel) -> const State& { return variant.states[indexOf(travel)]; };
  const double share = 1.0 / static_cast<double>(variants_.size());
  const double alpha = s.compliance_force > 0 ? s.compliance_weight : 0;
  const State &valley = state(s.valley_travel), &peak = state(s.peak_travel);
  out.objective += share * (valley.force - peak.force) / s.peak_bound;
  if (alpha > 0) out.objective -= share * alpha * s.compliance_force * variant.pulled.travel;
  if (with_derivatives) {
    Eigen::VectorXd g = (valley.by_density - peak.by_density) / s.peak_bound;
    if (alpha > 0) g += alpha * s.compliance_force / variant.pulled.stiffness * variant.pulled.by_density;
    out.gradient += share * back(g);
  }
  const auto put = [&](double value, const Eigen::VectorXd& g) {
    out.constraints(row) = value;
    if (with_derivatives) out.jacobian.row(row) = back(g).transpose();
    ++row;
  };
  const Eigen::VectorXd none;
  for (const double u : s.peak_travels) {
    put(state(u).force / s.peak_bound - 1, with_derivatives ? state(u).by_density / s.peak_bound : none);
  }
  for (const double u : s.valley_travels) {
    put(-state(u).force / s.valley_bound - 1, with_derivatives ? -state(u).by_density / s.valley_bound : none);
  }
  for (std::size_t k = 0; k + 1 < s.slope_travels.size(); ++k) {
    const State &a = state(s.slope_travels[k]), &b = state(s.slope_travels[k + 1]);
    const double scale = s.slope_bound * (b.travel - a.travel);
    put((a.force - b.force) / scale - 1, with_derivatives ? (a.by_density - b.by_density) / scale : none);
  }
}

Evaluated ArmTopology::evaluate(const Eigen::VectorXd& x, bool with_derivatives) {
  Evaluated out;
  const int m = constraintCount();
  out.constraints.setZero(m);
  out.gradient.setZero(with_derivatives ? count_ : 0);
  out.jacobian.setZero(with_derivatives ? m : 0, count_);
  int row = 0;
  for (Variant& variant : variants_) {
    variant.density = variant.map->eval(x);
    if (!solveVariant(variant, with_derivatives, out.message)) return out;
    addVariant(x, variant, row, with_derivatives, out);
  }
  retrace_wanted_ = false;
  const Variant& nominal = variants_.front();
  last_volume_ = nominal.density.mean();
  last_grey_ = greyLevel(nominal.density);
  last_forces_.clear();
  for (const State& state : nominal.states) last_forces_.push_back(state.force);
  // Ten times: a volume that is 1 % off counts as much as a force that is 10 % off.
  out.constraints(row) = 10 * (last_volume_ / volume_bound_ - 1);
  if (with_derivatives) {
    const Eigen::VectorXd g = Eigen::VectorXd::Constant(count_, 10 / (volume_bound_ * count_));
    out.jacobian.row(row) = nominal.map->applyJacobianTranspose(x, g).transpose();
  }
  out.valid = std::isfinite(out.objective) && out.constraints.allFinite() && out.gradient.allFinite() &&
              out.jacobian.allFinite();
  if (!out.valid) out.message = "a value is not finite";
  return out;
}

}  // namespace snapwing::design
