#include "snapwing/solver/constraints.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::solver {

using Eigen::MatrixXd;
using Eigen::VectorXd;

RowRank rankOf(const ConstraintRows& rows, double threshold) {
  RowRank result;
  const auto count = rows.rows();
  if (count == 0 || count > rows.cols()) return result;
  // The singular values of C are those of the small triangle of C^T = Q R.
  const Eigen::HouseholderQR<MatrixXd> qr(MatrixXd(rows).transpose());
  const MatrixXd R = qr.matrixQR().topRows(count).template triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<MatrixXd> svd(R, Eigen::ComputeFullV);
  const VectorXd& values = svd.singularValues();
  result.smallest = values[0] > 0 ? values[count - 1] / values[0] : 0;
  for (Eigen::Index k = 0; k < count; ++k) result.rank += values[k] > threshold * values[0] ? 1 : 0;
  const VectorXd last = svd.matrixV().col(count - 1);
  for (Eigen::Index k = 0; k < count; ++k) {
    if (std::abs(last[k]) > 0.3 * last.cwiseAbs().maxCoeff()) result.dependent.push_back(static_cast<int>(k));
  }
  return result;
}

namespace {

LinearRows rowsOf(int full, int controls, const std::vector<Equation>& equations, const std::vector<int>& numbers) {
  LinearRows result;
  const auto count = static_cast<Eigen::Index>(equations.size());
  result.rows.resize(count, full);
  result.control = MatrixXd::Zero(count, controls);
  result.constant.resize(count);
  result.equation = numbers;
  std::vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < static_cast<int>(count); ++row) {
    const Equation& equation = equations[row];
    result.names.push_back(equation.name);
    result.constant(row) = equation.constant;
    for (const auto& [k, value] : equation.control) result.control(row, k) += value;
    for (const auto& [dof, value] : equation.terms) entries.emplace_back(row, dof, value);
  }
  result.rows.setFromTriplets(entries.begin(), entries.end());
  return result;
}

std::string quoted(const std::vector<std::string>& names, const std::vector<int>& rows) {
  std::set<std::string> once;
  std::string text;
  for (const int row : rows) {
    if (!once.insert(names[row]).second) continue;
    text += (text.empty() ? "'" : ", '") + names[row] + "'";
  }
  return text;
}

}  // namespace

LinearRows LinearRows::onFree(const Reduction& reduction) const {
  LinearRows result = *this;
  const VectorXd still = VectorXd::Zero(reduction.freeCount());
  result.constant -= rows * reduction.expand(still, VectorXd::Zero(reduction.controlCount()));
  for (int k = 0; k < reduction.controlCount(); ++k) {
    result.control.col(k) -= rows * reduction.expandDirection(still, VectorXd::Unit(reduction.controlCount(), k));
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < count(); ++row) {
    for (ConstraintRows::InnerIterator at(rows, row); at; ++at) {
      for (const auto& [z, factor] : reduction.terms(static_cast<int>(at.col()))) {
        entries.emplace_back(row, reduction.dofOfFree(z), at.value() * factor);
      }
    }
  }
  result.rows.setFromTriplets(entries.begin(), entries.end());
  return result;
}

Constraints::Constraints(LinearRows rows, Enforcement enforcement, double penalty, double tolerance, int redundant)
    : rows_(std::move(rows)),
      enforcement_(enforcement),
      penalty_(penalty),
      tolerance_(tolerance),
      redundant_(redundant) {
  const bool augmented = enforcement == Enforcement::AUGMENTED_LAGRANGIAN;
  if (enforcement == Enforcement::ELIMINATION) {
    throw common::Error("constraints: enforcement is 'elimination'; allowed: augmented_lagrangian, multipliers");
  }
  if (!(penalty >= 0 && std::isfinite(penalty)) || (augmented && penalty == 0) || !(tolerance > 0)) {
    throw common::Error("penalty and tolerance of constraints are " + common::toText(penalty) + " N/m and " +
                        common::toText(tolerance) +
                        " m; allowed: >= 0 (above 0 for the augmented Lagrangian), and > 0");
  }
  if (rows_.rows.rows() != count() || rows_.control.rows() != count() ||
      static_cast<int>(rows_.names.size()) != count() || redundant < 0 || redundant > count()) {
    throw common::Error("constraints: " + std::to_string(rows_.rows.rows()) + " rows, " +
                        std::to_string(rows_.control.rows()) + " rows of the controls, " + std::to_string(count()) +
                        " constants, " + std::to_string(rows_.names.size()) + " names, " + std::to_string(redundant) +
                        " redundant; allowed: as many of each, and no more redundant");
  }
}

Constraints Constraints::onFree(const Reduction& reduction) const {
  Constraints result = *this;
  result.rows_ = rows_.onFree(reduction);
  return result;
}

std::string Constraints::nameRows(const std::vector<int>& rows) const { return quoted(rows_.names, rows); }

SplitEquations splitEquations(int full, int controls, const std::vector<Equation>& equations, bool keep,
                              int first_entry, int rotations, int entries) {
  std::vector<Equation> order = equations, held;
  std::vector<int> number(equations.size());
  for (std::size_t n = 0; n < number.size(); ++n) number[n] = static_cast<int>(n);
  if (keep) {
    const auto kept = [&](int n) { return !equations[n].keepable; };
    std::stable_partition(number.begin(), number.end(), kept);
    for (std::size_t n = 0; n < number.size(); ++n) order[n] = equations[number[n]];
    for (const Equation& e : order) {
      if (!e.keepable) held.push_back(e);
    }
  }
  // Eliminating everything finds out which are independent, and refuses contradictions.
  const Reduction all(full, controls, order, first_entry);
  std::vector<bool> independent(order.size(), true);
  for (const int n : all.redundantNumbers()) independent[n] = false;
  SplitEquations result{keep ? Reduction(full, controls, held, first_entry) : all, {}, {}};
  result.of_rotation.resize(rotations);
  std::vector<Equation> rest;
  std::vector<int> origin;
  for (std::size_t n = 0; keep && n < order.size(); ++n) {
    if (!independent[n] || !order[n].keepable) continue;
    rest.push_back(order[n]);
    origin.push_back(number[n]);
  }
  std::vector<Equation> chains;
  for (const Equation& equation : all.kept()) {
    const int one = (equation.terms.front().first - first_entry) / entries;
    const auto other = [&](const std::pair<int, double>& t) { return (t.first - first_entry) / entries != one; };
    const bool driven = !equation.control.empty() || std::abs(equation.constant) > 1e-12;
    if (driven || std::any_of(equation.terms.begin(), equation.terms.end(), other)) {
      chains.push_back(equation);
    } else {
      result.of_rotation[one].push_back(equation);
    }
  }
  if (!chains.empty()) {
    const Reduction repeated(full, controls, chains);
    std::vector<bool> says_more(chains.size(), true);
    for (const int n : repeated.redundantNumbers()) says_more[n] = false;
    for (std::size_t n = 0; n < chains.size(); ++n) {
      if (!says_more[n]) continue;
      rest.push_back(chains[n]);
      origin.push_back(-1);
    }
  }
  result.kept = rowsOf(full, controls, rest, origin).onFree(result.eliminated);
  return result;
}

namespace {

/// Looks for places where the equations hold, and at their rank there.
class Mobility {
 public:
  Mobility(const Coordinates& coordinates, const LinearRows& rows) : coordinates_(coordinates), rows_(rows) {}

  /// Turns every rotation a little and closes the equations from there (Levenberg and Marquardt).
  bool close(double travel) {
    constexpr double TURN = 0.03, LARGEST = 0.3;  // [rad]
    constexpr int ITERATIONS = 200;
    z_ = VectorXd::Zero(coordinates_.freeCount());
    const auto turns = coordinates_.rotationLengths();  // of the last coordinates
    const Eigen::Index first = z_.size() - turns.size();
    for (Eigen::Index k = 0; k < turns.size(); ++k) {
      z_(first + k) = TURN * turns(k) * common::sin(2.4 * static_cast<double>(k) + 0.7);  // nothing lies so by chance
    }
    const double length = turns.size() > 0 ? turns.minCoeff() : std::abs(travel);
    const VectorXd p = VectorXd::Constant(coordinates_.controlCount(), travel);
    for (int iteration = 0; iteration < ITERATIONS; ++iteration) {
      coordinates_.at(z_, p, nullptr, place_);
      gap_ = rows_.residual(place_.y, p);
      const ConstraintRows a = coordinates_.pullBack(place_, rows_.rows);
      gram_ = MatrixXd(a * ConstraintRows(a.transpose()));
      const double away = gap_.cwiseAbs().maxCoeff() / length;
      if (away < 1e-12) return true;
      const double largest = gram_.diagonal().maxCoeff();
      MatrixXd damped = gram_;
      damped.diagonal().array() += largest * std::max(1e-14, std::min(1.0, away * away));
      VectorXd step = -(a.transpose() * damped.ldlt().solve(gap_));
      const double turn = turns.size() > 0 ? (step.tail(turns.size()).array() / turns.array()).abs().maxCoeff() : 0;
      if (turn > LARGEST) step *= LARGEST / turn;
      z_ += step;
      if (!z_.allFinite()) return false;
    }
    return false;
  }
  int rank() const {
    constexpr double THRESHOLD = 1e-10;  // of squares: 1e-5 of what a row says, turned by some hundredths
    const VectorXd values = Eigen::SelfAdjointEigenSolver<MatrixXd>(gram_, Eigen::EigenvaluesOnly).eigenvalues();
    return static_cast<int>((values.array() > THRESHOLD * values.maxCoeff()).count());
  }
  /// Rows that stayed open.
  std::vector<int> open() const {
    std::vector<int> rows;
    for (int k = 0; k < rows_.count(); ++k) {
      if (std::abs(gap_(k)) > 0.1 * gap_.cwiseAbs().maxCoeff()) rows.push_back(k);
    }
    return rows;
  }

 private:
  const Coordinates& coordinates_;
  const LinearRows& rows_;
  Coordinates::Place place_;
  VectorXd z_, gap_;
  MatrixXd gram_;
};

}  // namespace

int redundantRows(const Coordinates& coordinates, const LinearRows& rows, double travel) {
  if (rows.count() == 0 || coordinates.rotationCount() == 0) return 0;
  Mobility mobility(coordinates, rows);
  for (const double way : {travel, -travel}) {
    if (mobility.close(way)) return rows.count() - mobility.rank();
  }
  throw common::Error(quoted(rows.names, mobility.open()) +
                      " contradict each other: the rigid bodies between them leave no such motion; allowed: "
                      "constraints that can all hold, and that driven ports can move");
}

}  // namespace snapwing::solver
