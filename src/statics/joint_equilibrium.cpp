#include "snapwing/statics/joint_equilibrium.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "snapwing/common/error.h"

namespace snapwing::statics {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using elasticity::Order;

namespace {

constexpr double CLOSED = 1e-9;  ///< [m] joints closer than this are closed: from then on the energy must fall
constexpr int HALVINGS = 30;

double largest(const VectorXd& v) { return v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0.0; }

}  // namespace

template <int D>
JointEquilibrium<D>::JointEquilibrium(std::shared_ptr<const mpm::Discretisation<D>> solid, ConstraintRows H,
                                      std::vector<std::string> names, JointSettings settings)
    : solid_(std::move(solid)),
      names_(std::move(names)),
      settings_(settings),
      rank_(rankOf(H)),
      saddle_(solid_->pattern(), H, settings.stiffness) {
  if (H.cols() != solid_->dofCount() || H.rows() != static_cast<Eigen::Index>(names_.size())) {
    throw common::Error("joint equilibrium: H is " + std::to_string(H.rows()) + " x " + std::to_string(H.cols()) +
                        ", wanted " + std::to_string(names_.size()) + " x " + std::to_string(solid_->dofCount()));
  }
  if (!(settings.stiffness > 0) || settings.max_iterations < 1) {
    throw common::Error("joint equilibrium: stiffness must be above 0 and max_iterations at least 1");
  }
}

template <int D>
std::string JointEquilibrium<D>::refusal() const {
  const auto rows = static_cast<int>(names_.size());
  if (rank_.rank == rows) return "";
  std::set<std::string> culprits;
  for (const int row : rank_.culprits) culprits.insert(names_[row]);
  std::ostringstream text;
  text << "the joints' matrix H has rank " << rank_.rank << " of " << rows << " (smallest singular value "
       << rank_.smallest << " of the largest): these hold the same displacements:";
  for (const std::string& name : culprits) text << " '" << name << "'";
  return text.str();
}

template <int D>
double JointEquilibrium<D>::potential(const VectorXd& u, const VectorXd& f, const VectorXd& h,
                                      const VectorXd& multipliers) const {
  mpm::Assembly at;
  solid_->assemble(u, Order::ENERGY, settings_.threads, at);
  if (!at.finite) return std::numeric_limits<double>::infinity();
  double sum = at.energy - f.dot(u);
  if (augmented()) {
    const VectorXd gap = rows() * u - h;
    sum += multipliers.dot(gap) + 0.5 * settings_.stiffness * gap.squaredNorm();
  }
  return sum;
}

/// du halved until the potential falls. Where the promised fall drowns in rounding the step only has to stay finite;
/// so also while joints are open (`slope` = +inf), because closing them may cost energy.
template <int D>
VectorXd JointEquilibrium<D>::shortened(const JointResult& at, const VectorXd& f, const VectorXd& h, const VectorXd& du,
                                        double slope) const {
  const double before = potential(at.u, f, h, at.multipliers);
  const double noise = settings_.energy_floor + 1e-14 * std::abs(before);
  const bool must_fall = std::isfinite(slope) && slope < -noise;
  double share = 1;
  for (int k = 0; k < HALVINGS; ++k, share *= 0.5) {
    const double after = potential(at.u + share * du, f, h, at.multipliers);
    if (std::isfinite(after) && (!must_fall || after <= before + 1e-4 * share * slope + noise)) break;
  }
  return share * du;
}

template <int D>
void JointEquilibrium<D>::factorizeShifted(const std::vector<double>& blocks) {
  for (double shift = 0; !saddle_.factorize(blocks, shift);) {
    shift = shift == 0 ? 1e-6 * settings_.stiffness : 10 * shift;
    if (!(shift < 1e6 * settings_.stiffness)) throw common::Error("joint equilibrium: tangent is not finite");
  }
}

template <int D>
VectorXd JointEquilibrium<D>::step(const VectorXd& f, const VectorXd& h, const VectorXd& gap, JointResult* at) {
  factorizeShifted(at->assembly.blocks);
  const VectorXd pull = f - at->assembly.gradient;
  if (augmented()) {
    const VectorXd r = pull - rows().transpose() * (at->multipliers + settings_.stiffness * gap);
    const VectorXd du = saddle_.solvePenalty(r);
    return shortened(*at, f, h, du, -r.dot(du));
  }
  MatrixXd du, multipliers;
  saddle_.solve(pull, -gap, &du, &multipliers);
  at->multipliers = multipliers;
  const bool closed = largest(gap) <= CLOSED;
  return shortened(*at, f, h, du, closed ? -pull.dot(du.col(0)) : std::numeric_limits<double>::infinity());
}

template <int D>
JointResult JointEquilibrium<D>::solve(const VectorXd& f, const VectorXd& h, const VectorXd& guess) {
  JointResult at;
  at.u = guess;
  at.multipliers = VectorXd::Zero(rows().rows());
  at.message = refusal();
  if (!at.message.empty()) {
    at.status = JointStatus::RANK_DEFICIENT;
    return at;
  }
  at.status = JointStatus::NOT_CONVERGED;
  for (; at.iterations < settings_.max_iterations; ++at.iterations) {
    solid_->assemble(at.u, Order::TANGENT, settings_.threads, at.assembly);
    if (!at.assembly.finite) break;
    const VectorXd gap = rows() * at.u - h;
    at.gap = largest(gap);
    const double w = augmented() ? settings_.stiffness : 0;
    at.residual = largest(at.assembly.gradient - f + rows().transpose() * (at.multipliers + w * gap));
    const bool balanced = at.residual <= settings_.force_tolerance;
    const double open = settings_.multiplier_tolerance * largest(at.multipliers) + settings_.force_tolerance;
    if (balanced && at.gap <= settings_.gap_tolerance && w * at.gap <= open) {
      at.status = JointStatus::CONVERGED;
      at.stable = saddle_.factorize(at.assembly.blocks);
      return at;
    }
    if (augmented() && balanced) {
      at.multipliers += w * gap;  // the inner problem is solved: multipliers take over the penalty's force
    } else {
      at.u += step(f, h, gap, &at);
    }
  }
  std::ostringstream text;
  text << "no equilibrium after " << at.iterations << " iterations: residual " << at.residual << " N (allowed "
       << settings_.force_tolerance << "), gap " << at.gap << " m";
  if (!at.assembly.finite) text << "; cell " << at.assembly.min_det_f_cell << " is turned inside out";
  at.message = text.str();
  return at;
}

template <int D>
void JointEquilibrium<D>::solveTangent(const JointResult& at, const MatrixXd& f, const MatrixXd& g, MatrixXd* x,
                                       MatrixXd* y) {
  if (at.status != JointStatus::CONVERGED || !saddle_.factorize(at.assembly.blocks)) {
    throw common::Error("joint equilibrium: no derivative without a stable equilibrium");
  }
  saddle_.solve(f, g, x, y);
}

template class JointEquilibrium<2>;
template class JointEquilibrium<3>;

}  // namespace snapwing::statics
