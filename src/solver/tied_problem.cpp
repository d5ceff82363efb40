#include "snapwing/solver/tied_problem.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::solver {

RowRank rankOf(const ConstraintRows& rows, double threshold) {
  RowRank result;
  const auto count = rows.rows();
  if (count == 0 || count > rows.cols()) return result;
  // The singular values of C are those of the small triangle of C^T = Q R.
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(Eigen::MatrixXd(rows).transpose());
  const Eigen::MatrixXd R = qr.matrixQR().topRows(count).template triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(R, Eigen::ComputeFullV);
  const Eigen::VectorXd& values = svd.singularValues();
  result.smallest = values[0] > 0 ? values[count - 1] / values[0] : 0;
  for (Eigen::Index k = 0; k < count; ++k) result.rank += values[k] > threshold * values[0] ? 1 : 0;
  const Eigen::VectorXd last = svd.matrixV().col(count - 1);
  for (Eigen::Index k = 0; k < count; ++k) {
    if (std::abs(last[k]) > 0.3 * last.cwiseAbs().maxCoeff()) result.culprits.push_back(static_cast<int>(k));
  }
  return result;
}

Eigen::VectorXd Ties::gap(const Eigen::VectorXd& z, const Eigen::VectorXd& p) const {
  return rows * z - control * p - constant;
}

Ties makeTies(int dofs, int controls, const std::vector<Equation>& equations, const Reduction& held) {
  // Eliminating everything once finds out which ties are independent, and refuses contradictions.
  std::vector<Equation> order;
  std::vector<int> number;
  for (const bool tie : {false, true}) {
    for (std::size_t n = 0; n < equations.size(); ++n) {
      if (equations[n].tie != tie) continue;
      order.push_back(equations[n]);
      number.push_back(static_cast<int>(n));
    }
  }
  const Reduction all(dofs, controls, order);
  std::vector<bool> redundant(order.size(), false);
  for (const int n : all.redundantNumbers()) redundant[n] = true;
  Ties ties;
  for (std::size_t n = 0; n < order.size(); ++n) {
    if (order[n].tie && !redundant[n]) ties.equation.push_back(number[n]);
  }
  const int count = static_cast<int>(ties.equation.size());
  ties.rows.resize(count, held.freeCount());
  ties.control = Eigen::MatrixXd::Zero(count, controls);
  ties.constant = Eigen::VectorXd::Zero(count);
  const Eigen::VectorXd no_z = Eigen::VectorXd::Zero(held.freeCount());
  const Eigen::VectorXd offset = held.expand(no_z, Eigen::VectorXd::Zero(controls));
  std::vector<Eigen::Triplet<double>> triplets;
  for (int row = 0; row < count; ++row) {
    const Equation& equation = equations[ties.equation[row]];
    ties.constant(row) = equation.constant;
    for (const auto& [k, value] : equation.control) ties.control(row, k) += value;
    for (const auto& [dof, value] : equation.terms) {
      for (const auto& [z, factor] : held.terms(dof)) triplets.emplace_back(row, z, value * factor);
      ties.constant(row) -= value * offset(dof);
    }
  }
  for (int k = 0; k < controls; ++k) {
    const Eigen::VectorXd moved = held.expandDirection(no_z, Eigen::VectorXd::Unit(controls, k));
    for (int row = 0; row < count; ++row) {
      for (const auto& [dof, value] : equations[ties.equation[row]].terms) ties.control(row, k) -= value * moved(dof);
    }
  }
  ties.rows.setFromTriplets(triplets.begin(), triplets.end());
  return ties;
}

double meanStiffness(const Problem& problem) {
  Evaluation rest;
  problem.evaluate(Eigen::VectorXd::Zero(problem.freeCount()), Eigen::VectorXd::Zero(problem.controlCount()),
                   Order::TANGENT, rest);
  double sum = 0;
  for (int c = 0; c < problem.freeCount(); ++c) sum += rest.hessian[problem.pattern().start[c]];
  return sum / std::max(problem.freeCount(), 1);
}

TiedProblem::TiedProblem(std::shared_ptr<const Problem> base, Ties ties, Drive drive, double penalty,
                         double gap_tolerance)
    : base_(std::move(base)), multipliers_(Eigen::VectorXd::Zero(ties.count())), constant_(ties.constant) {
  auto shared = std::make_shared<Shared>();
  shared->ties = std::move(ties);
  shared->drive = drive;
  shared->gap_tolerance = gap_tolerance;
  shared->rho = penalty;
  if (!(penalty > 0) || !(gap_tolerance > 0)) {
    throw common::Error("penalty and gap_tolerance of ties are " + common::toText(penalty) + " N/m and " +
                        common::toText(gap_tolerance) + " m; allowed: > 0, on a problem with stiffness");
  }
  buildPattern(*shared);
  shared_ = shared;
}

void TiedProblem::buildPattern(Shared& shared) const {
  const SparsePattern& base = base_->pattern();
  std::vector<std::map<int, double>> columns(base.size);  // row -> entry of C^T C
  for (int tie = 0; tie < shared.ties.count(); ++tie) {
    using Row = Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator;
    for (Row a(shared.ties.rows, tie); a; ++a) {
      for (Row b(shared.ties.rows, tie); b; ++b) {
        if (b.col() >= a.col()) columns[a.col()][static_cast<int>(b.col())] += a.value() * b.value();
      }
    }
  }
  SparsePattern& pattern = shared.pattern;
  pattern.size = base.size;
  pattern.start = {0};
  shared.place.resize(base.row.size());
  for (int c = 0; c < base.size; ++c) {
    auto extra = columns[c].begin();
    const auto addExtra = [&] {
      shared.penalty_terms.emplace_back(pattern.entries(), extra->second);
      ++extra;
    };
    for (int k = base.start[c]; k < base.start[c + 1]; ++k) {
      while (extra != columns[c].end() && extra->first < base.row[k]) {
        const int row = extra->first;
        addExtra();
        pattern.row.push_back(row);
      }
      if (extra != columns[c].end() && extra->first == base.row[k]) addExtra();
      shared.place[k] = pattern.entries();
      pattern.row.push_back(base.row[k]);
    }
    while (extra != columns[c].end()) {
      const int row = extra->first;
      addExtra();
      pattern.row.push_back(row);
    }
    pattern.start.push_back(pattern.entries());
  }
}

Eigen::VectorXd TiedProblem::gap(const Eigen::VectorXd& z, const Eigen::VectorXd& p) const {
  return shared_->ties.rows * z - shared_->ties.control * p - constant_;
}

void TiedProblem::evaluate(const Eigen::VectorXd& z, const Eigen::VectorXd& p, Order order, Evaluation& out) const {
  base_->evaluate(z, p, order, out);
  const Shared& s = *shared_;
  const Eigen::VectorXd gap = this->gap(z, p);
  out.energy += multipliers_.dot(gap) + 0.5 * s.rho * gap.squaredNorm();
  if (order == Order::ENERGY || !out.finite) return;
  const Eigen::VectorXd force = multipliers_ + s.rho * gap;
  out.residual += s.ties.rows.transpose() * force;
  out.control_force -= s.ties.control.transpose() * force;
  if (!elasticity::withTangent(order)) return;
  std::vector<double> hessian(s.pattern.row.size(), 0.0);
  for (std::size_t k = 0; k < s.place.size(); ++k) hessian[s.place[k]] = out.hessian[k];
  for (const auto& [entry, value] : s.penalty_terms) hessian[entry] += s.rho * value;
  out.hessian = std::move(hessian);
}

void TiedProblem::controlTangent(const Evaluation& at, const Eigen::VectorXd& dp, Eigen::VectorXd& free_part,
                                 Eigen::VectorXd& control_part) const {
  base_->controlTangent(at, dp, free_part, control_part);
  const Eigen::VectorXd moved = shared_->rho * (shared_->ties.control * dp);
  free_part -= shared_->ties.rows.transpose() * moved;
  control_part += shared_->ties.control.transpose() * moved;
}

}  // namespace snapwing::solver
