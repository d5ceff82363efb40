#include "snapwing/solver/tangent_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace snapwing::solver {

bool TangentSystem::factorizeDefinite(const std::vector<double>& hessian, std::shared_ptr<const ConstraintRows> rows) {
  rows_ = std::move(rows);
  return cholesky_->factorize(hessian) && formSchur() == 0;
}

int TangentSystem::factorize(const Evaluation& at) {
  rows_ = at.rows;
  if (cholesky_->factorize(at.hessian)) return formSchur() == 0 ? 0 : -1;
  const int negative = cholesky_->factorizeIndefinite(at.hessian);
  if (negative < 0) return -1;
  const int of_rows = formSchur();
  return of_rows < 0 || of_rows > negative ? -1 : negative - of_rows;
}

/// @return negative eigenvalues of S, -1 if it is singular
int TangentSystem::formSchur() {
  constexpr double SINGULAR = 1e-14;
  if (problem_->constraints() == nullptr) return 0;
  spread_ = cholesky_->solve(Eigen::MatrixXd(rows_->transpose()));
  const Eigen::MatrixXd schur = *rows_ * spread_;
  if (!schur.allFinite()) return -1;
  schur_.compute(0.5 * (schur + schur.transpose()));
  const Eigen::VectorXd& values = schur_.eigenvalues();
  const auto count = static_cast<int>(values.size());
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return std::abs(values(a)) < std::abs(values(b)); });
  divisors_ = values;
  for (int k = 0; k < problem_->constraints()->redundant(); ++k) {
    divisors_(order[k]) = std::numeric_limits<double>::infinity();
  }
  int negative = 0;
  for (int k = problem_->constraints()->redundant(); k < count; ++k) {
    if (std::abs(values(order[k])) < SINGULAR * values.cwiseAbs().maxCoeff()) return -1;
    negative += values(order[k]) < 0 ? 1 : 0;
  }
  return negative;
}

std::string TangentSystem::deadPoint() const {
  constexpr double SAME = 1e-12;  // of squares
  if (problem_->constraints() == nullptr || rows_ == nullptr) return "";
  const ConstraintRows across = rows_->transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> gram{Eigen::MatrixXd(*rows_ * across)};
  const Eigen::VectorXd& squares = gram.eigenvalues();
  std::vector<int> dependent;
  for (int k = problem_->constraints()->redundant(); k < squares.size(); ++k) {
    if (squares(k) > SAME * squares.maxCoeff()) break;
    const Eigen::VectorXd share = gram.eigenvectors().col(k).cwiseAbs();
    for (int row = 0; row < squares.size(); ++row) {
      if (share(row) > 0.3 * share.maxCoeff()) dependent.push_back(row);
    }
  }
  return dependent.empty()
             ? ""
             : "dead point: " + problem_->constraints()->nameRows(dependent) + " hold the same motion there";
}

template <class Dense>
void TangentSystem::solveAny(const Dense& f, const Dense& g, Dense& z, Dense& lambda) const {
  z = cholesky_->solve(f);
  lambda.resize(0, f.cols());
  if (problem_->constraints() == nullptr) return;
  const Dense gap = *rows_ * z - g;
  const Eigen::MatrixXd& basis = schur_.eigenvectors();
  Dense shares = basis.transpose() * gap;
  shares.array().colwise() /= divisors_.array();
  lambda = basis * shares;
  z -= spread_ * lambda;
}

void TangentSystem::solve(const Eigen::VectorXd& f, const Eigen::VectorXd& g, Eigen::VectorXd& z,
                          Eigen::VectorXd& lambda) const {
  solveAny(f, g, z, lambda);
}

void TangentSystem::solve(const Eigen::MatrixXd& f, const Eigen::MatrixXd& g, Eigen::MatrixXd& z,
                          Eigen::MatrixXd& lambda) const {
  solveAny(f, g, z, lambda);
}

}  // namespace snapwing::solver
