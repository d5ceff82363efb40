// Losses of a vehicle along its axis: what the file's damping ratio makes of each law, and the material's memory.
#include <cmath>

#include "snapwing/common/enum_names.h"
#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/motion/axis_vehicle.h"
#include "snapwing/solver/elastic_term.h"
#include "snapwing/solver/material_damping.h"
#include "snapwing/solver/prony_term.h"
#include "snapwing/solver/row_terms.h"

namespace snapwing::motion {

using solver::Term;

namespace {

constexpr common::EnumNames<DampingLaw, 4> DAMPING("damping",
                                                   {"travel", "rayleigh", "rayleigh_projected", "kelvin_voigt"});

}  // namespace

DampingLaw dampingFromName(const std::string& name) { return DAMPING.value(name); }

std::string dampingName(DampingLaw law) { return DAMPING.name(law); }

template <int D>
std::shared_ptr<const Term> AxisVehicle::materialDampingIn(DampingLaw law, double beta) const {
  auto solid = std::dynamic_pointer_cast<const solver::ElasticTerm<D>>(problem_->terms().front())->sharedSolid();
  if (law == DampingLaw::KELVIN_VOIGT) {
    return std::make_shared<const solver::KelvinVoigtTerm<D>>(std::move(solid), beta);
  }
  const bool exact = law == DampingLaw::RAYLEIGH;
  return std::make_shared<const solver::RayleighTerm<D>>(
      std::move(solid), nullptr, 0, beta, exact ? solver::LaggedTangent::EXACT : solver::LaggedTangent::PROJECTED);
}

std::shared_ptr<const Term> AxisVehicle::materialDamping(DampingLaw law, double beta) const {
  return settings_.dimension == 2 ? materialDampingIn<2>(law, beta) : materialDampingIn<3>(law, beta);
}

std::shared_ptr<const Term> AxisVehicle::memory() const {
  const Term& solid = *problem_->terms().front();
  if (settings_.dimension == 2) {
    return std::make_shared<const solver::PronyTerm<2>>(
        dynamic_cast<const solver::ElasticTerm<2>&>(solid).sharedSolid(), series_);
  }
  return std::make_shared<const solver::PronyTerm<3>>(dynamic_cast<const solver::ElasticTerm<3>&>(solid).sharedSolid(),
                                                      series_);
}

/// The frequency is the one of the damping ratio: undamped, of the relative motion in Q.
double AxisVehicle::lossOfMemory(const vehicle::VehicleParameters& p) const {
  if (series_.empty()) return 0;
  const double reduced = p.ring_mass * p.centre_mass / (p.ring_mass + p.centre_mass);
  const double omega = std::sqrt(curve_->at(curve_->second()).stiffness / share_ / reduced);
  return series_.viscousTime(omega) * lossOf(*materialDamping(DampingLaw::KELVIN_VOIGT, 1)) / share_;
}

/// What is left of the file's damping ratio for the viscous law.
double AxisVehicle::restOfDamping(const vehicle::VehicleParameters& p) const {
  const double taken = lossOfMemory(p);
  if (taken > p.damping) {
    throw common::Error("material.relaxation makes a loss in Q of " + common::toText(taken) + " N s/m, more than the " +
                        common::toText(p.damping) +
                        " N s/m of damping_ratio; allowed: at most that, or a larger damping_ratio");
  }
  return p.damping - taken;
}

/// c of the travel that a material's law with beta = 1 makes in Q [N s/m per s], of the problem: twice the potential of
/// a small step along the static path, times h, over its travel squared.
double AxisVehicle::lossOf(const Term& term) const {
  constexpr double SMALL = 1e-6;  // [m]
  const StaticPoint q = curve_->at(curve_->second());
  const solver::Coordinates& own = scene_->terms().coordinates();
  const auto place = [&](double shift) {
    Eigen::VectorXd y = Eigen::VectorXd::Zero(centre_ + 1);
    y.head(nodes_) = own.expand(q.z + shift * q.slope, Eigen::VectorXd::Constant(1, q.control + shift));
    return y;
  };
  solver::Step step;
  step.h = 1;
  step.y0 = place(0);
  step.v0 = Eigen::VectorXd::Zero(centre_ + 1);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(controlCount()), moved = place(SMALL);
  const auto kept = term.keep({step.y0, none, nullptr, settings_.threads});
  solver::Sum sum;
  sum.reset(layout(), controlCount(), solver::Order::ENERGY);
  term.evaluate({moved, none, &step, settings_.threads, kept.get()}, solver::Order::ENERGY, sum);
  return 2 * sum.energy / (SMALL * SMALL);
}

std::shared_ptr<const Term> AxisVehicle::damping(double c) {
  if (settings_.damping == DampingLaw::TRAVEL) {
    return std::make_shared<solver::RowDamper>("damping of the travel", travelRow(), share_ * c);
  }
  const double unit = lossOf(*materialDamping(settings_.damping, 1));
  if (!(unit > 0)) {
    throw common::Error("damping is " + dampingName(settings_.damping) +
                        ": the material's law has no loss in Q at these cells; allowed: travel");
  }
  material_time_ = share_ * c / unit;
  return materialDamping(settings_.damping, material_time_);
}

}  // namespace snapwing::motion
