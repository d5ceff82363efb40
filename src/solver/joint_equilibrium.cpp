#include "snapwing/solver/joint_equilibrium.h"

#include <set>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/solver/term_problem.h"

namespace snapwing::solver {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double NO_SCALE = 1e-15;  ///< relative tolerance: the forces' own decides

/// H u = h with the values of h as controls.
LinearRows rowsOf(const ConstraintRows& H, std::vector<std::string> names) {
  LinearRows result;
  const auto count = H.rows();
  result.rows = H;
  result.control = MatrixXd::Identity(count, count);
  result.constant = VectorXd::Zero(count);
  result.names = std::move(names);
  for (int row = 0; row < count; ++row) result.equation.push_back(row);
  return result;
}

void check(const ConstraintRows& H, int dofs, std::size_t names, const JointSettings& s) {
  if (H.cols() != dofs || H.rows() != static_cast<Eigen::Index>(names)) {
    throw common::Error("joint equilibrium: H is " + std::to_string(H.rows()) + " x " + std::to_string(H.cols()) +
                        ", wanted " + std::to_string(names) + " x " + std::to_string(dofs));
  }
  if (!(s.stiffness > 0) || s.max_iterations < 1) {
    throw common::Error("joint equilibrium: stiffness must be above 0 and max_iterations at least 1");
  }
  if (s.enforcement == Enforcement::ELIMINATION) {
    throw common::Error("joint equilibrium: drive is 'elimination'; allowed: augmented_lagrangian, multipliers");
  }
}

}  // namespace

template <int D>
JointEquilibrium<D>::JointEquilibrium(std::shared_ptr<const mpm::Discretisation<D>> solid, const ConstraintRows& H,
                                      std::vector<std::string> names, const JointSettings& settings)
    : names_(std::move(names)) {
  const int dofs = solid->dofCount();
  check(H, dofs, names_.size(), settings);
  const auto rows = static_cast<int>(H.rows());
  rank_ = rankOf(H);
  load_ = std::make_shared<LoadTerm>(VectorXd(), MatrixXd());
  TermProblem::Parts parts =
      solidParts<D>(std::move(solid), std::make_shared<const Coordinates>(Reduction(dofs, rows, {})), settings.threads,
                    settings.force_tolerance);
  parts.terms.push_back(load_);
  parts.energy_floor = settings.energy_floor;
  parts.constraints = std::make_shared<const Constraints>(rowsOf(H, names_), settings.enforcement, settings.stiffness,
                                                          settings.gap_tolerance);
  problem_ = std::make_shared<const TermProblem>(std::move(parts));
  NewtonSettings newton;
  newton.max_iterations = settings.max_iterations;
  newton.relative_tolerance = NO_SCALE;
  solver_ =
      std::make_unique<EquilibriumSolver>(*problem_, newton, ControlLine{VectorXd::Zero(rows), VectorXd::Zero(rows)});
}

template <int D>
std::string JointEquilibrium<D>::refusal() const {
  const auto rows = static_cast<int>(names_.size());
  if (rank_.rank == rows) return "";
  std::set<std::string> dependent;
  for (const int row : rank_.dependent) dependent.insert(names_[row]);
  std::ostringstream text;
  text << "the joints' matrix H has rank " << rank_.rank << " of " << rows << " (smallest singular value "
       << rank_.smallest << " of the largest): these hold the same displacements:";
  for (const std::string& name : dependent) text << " '" << name << "'";
  return text.str();
}

template <int D>
JointResult JointEquilibrium<D>::solve(const VectorXd& f, const VectorXd& h, const VectorXd& guess) {
  JointResult result;
  result.message = refusal();
  if (!result.message.empty()) {
    result.status = JointStatus::RANK_DEFICIENT;
    return result;
  }
  load_->setDead(f);
  solver_->setLine({h, VectorXd::Zero(h.size())});
  Equilibrium x = solver_->start(guess, 0);
  const NewtonResult newton = solver_->minimise(x);
  result.status = newton.converged() ? JointStatus::CONVERGED : JointStatus::NOT_CONVERGED;
  result.constraint_residual = x.at.constraint_residual.cwiseAbs().maxCoeff();
  result.residual = newton.residual;
  result.iterations = newton.iterations;
  result.stable = newton.converged() && solver_->system().factorize(x.at) == 0;
  if (!newton.converged()) result.message = "no equilibrium: " + statusName(newton.status) + ", " + newton.message;
  result.u = std::move(x.z);
  result.multipliers = std::move(x.multipliers);
  result.at = std::move(x.at);
  return result;
}

template <int D>
Evaluation JointEquilibrium<D>::linearise(const VectorXd& u) {
  Evaluation at;
  problem_->evaluate(u, VectorXd::Zero(problem_->controlCount()), Order::TANGENT, at);
  return at;
}

template <int D>
void JointEquilibrium<D>::solveTangent(const Evaluation& at, const MatrixXd& f, const MatrixXd& g, MatrixXd* x,
                                       MatrixXd* y) {
  if (!refusal().empty() || at.hessian.empty() || solver_->system().factorize(at) != 0) {
    throw common::Error("joint equilibrium: no derivative without a stable equilibrium");
  }
  // The Hessian holds rho H^T H as well, which acts on x where H x = g is not zero.
  const MatrixXd held = f + problem_->constraints()->penalty() * (at.rows->transpose() * g);
  solver_->system().solve(held, g, *x, *y);
}

template class JointEquilibrium<2>;
template class JointEquilibrium<3>;

}  // namespace snapwing::solver
