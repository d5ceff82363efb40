#include "snapwing/solver/reduction.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::solver {

namespace {

/// u_dof = sum terms + sum control p + constant
struct Affine {
  std::map<int, double> terms;
  std::map<int, double> control;
  double constant = 0;

  void add(const Affine& other, double factor) {
    for (const auto& [dof, value] : other.terms) terms[dof] += factor * value;
    for (const auto& [k, value] : other.control) control[k] += factor * value;
    constant += factor * other.constant;
  }
};

class Elimination {
 public:
  explicit Elimination(int kept_from) : kept_from_(kept_from) {}

  /// @return false if the equation followed from earlier ones, or left only kept dofs
  bool add(const Equation& equation) {
    Affine rest;  // sum terms - control - constant = 0
    double size = 0;
    for (const auto& [dof, value] : equation.terms) {
      size = std::max(size, std::abs(value));
      const auto slave = slaves_.find(dof);
      if (slave == slaves_.end()) {
        rest.terms[dof] += value;
      } else {
        rest.add(slave->second, value);
      }
    }
    for (const auto& [k, value] : equation.control) rest.control[k] -= value;
    rest.constant -= equation.constant;
    const int pivot = choosePivot(rest, size);
    if (pivot < 0) {
      if (!keepsRest(rest, size, equation)) checkConsistent(rest, equation);
      return false;
    }
    eliminate(pivot, rest, size);
    return true;
  }
  const std::map<int, Affine>& slaves() const { return slaves_; }
  const std::vector<Equation>& kept() const { return kept_; }

 private:
  static constexpr double ROUNDING = 1e-10;

  /// Stores what is left in kept dofs, if anything.
  bool keepsRest(const Affine& rest, double size, const Equation& equation) {
    Equation left;
    left.name = equation.name;
    for (const auto& [dof, value] : rest.terms) {
      if (std::abs(value) > ROUNDING * size) left.terms.emplace_back(dof, value);
    }
    if (left.terms.empty()) return false;
    for (const auto& [k, value] : rest.control) {
      if (std::abs(value) > ROUNDING * size) left.control.emplace_back(k, -value);
    }
    left.constant = -rest.constant;
    kept_.push_back(std::move(left));
    return true;
  }

  int choosePivot(const Affine& rest, double size) const {
    int pivot = -1;
    double best = ROUNDING * size;
    for (const auto& [dof, value] : rest.terms) {
      if (dof < kept_from_ && std::abs(value) > best * (1 + 1e-9)) {
        best = std::abs(value);
        pivot = dof;
      }
    }
    return pivot;
  }

  static void checkConsistent(const Affine& rest, const Equation& equation) {
    for (const auto& [k, value] : rest.control) {
      if (std::abs(value) > 1e-9) {
        throw common::Error("'" + equation.name + "' contradicts another support or port: the driven displacement " +
                            std::to_string(k) + " is held there already");
      }
    }
    if (std::abs(rest.constant) > 1e-12) {
      throw common::Error("'" + equation.name + "' contradicts another support by " + common::toText(rest.constant) +
                          " m");
    }
  }

  void eliminate(int pivot, const Affine& rest, double size) {
    Affine slave;
    const double scale = -1 / rest.terms.at(pivot);
    for (const auto& [dof, value] : rest.terms) {
      if (dof != pivot && std::abs(value) > ROUNDING * size) slave.terms[dof] = scale * value;
    }
    for (const auto& [k, value] : rest.control) slave.control[k] = scale * value;
    slave.constant = scale * rest.constant;
    for (const int user : users_[pivot]) {
      Affine& other = slaves_.at(user);
      const auto found = other.terms.find(pivot);
      if (found == other.terms.end()) continue;
      const double factor = found->second;
      other.terms.erase(found);
      other.add(slave, factor);
      for (const auto& [dof, value] : slave.terms) users_[dof].insert(user);
    }
    users_.erase(pivot);
    for (const auto& [dof, value] : slave.terms) users_[dof].insert(pivot);
    slaves_.emplace(pivot, std::move(slave));
  }

  int kept_from_;
  std::vector<Equation> kept_;
  std::map<int, Affine> slaves_;
  std::map<int, std::set<int>> users_;  ///< free dof -> slaves that depend on it
};

}  // namespace

Reduction::Reduction(int dofs, int controls, const std::vector<Equation>& equations, int kept_from)
    : dofs_(dofs), controls_(controls) {
  Elimination elimination(kept_from < 0 ? dofs : kept_from);
  for (std::size_t n = 0; n < equations.size(); ++n) {
    if (elimination.add(equations[n])) continue;
    redundant_.push_back(equations[n].name);
    redundant_numbers_.push_back(static_cast<int>(n));
  }
  kept_ = elimination.kept();
  std::vector<int> free_of_dof(dofs, -1);
  for (int dof = 0; dof < dofs; ++dof) {
    if (elimination.slaves().count(dof)) continue;
    free_of_dof[dof] = freeCount();
    dof_of_free_.push_back(dof);
  }
  terms_.resize(dofs);
  for (int z = 0; z < freeCount(); ++z) terms_[dof_of_free_[z]] = {{z, 1.0}};
  for (const auto& [dof, affine] : elimination.slaves()) {
    slaves_.push_back(dof);
    for (const auto& [other, value] : affine.terms) {
      if (value != 0) terms_[dof].emplace_back(free_of_dof[other], value);
    }
    control_.emplace_back(affine.control.begin(), affine.control.end());
    constant_.push_back(affine.constant);
  }
}

Eigen::VectorXd Reduction::expandDirection(const Eigen::VectorXd& dz, const Eigen::VectorXd& dp) const {
  Eigen::VectorXd u(dofs_);  // a dof is either free or a slave
  for (int z = 0; z < freeCount(); ++z) u(dof_of_free_[z]) = dz(z);
  for (std::size_t s = 0; s < slaves_.size(); ++s) {
    double value = 0;
    for (const auto& [z, factor] : terms_[slaves_[s]]) value += factor * dz(z);
    for (const auto& [k, factor] : control_[s]) value += factor * dp(k);
    u(slaves_[s]) = value;
  }
  return u;
}

Eigen::VectorXd Reduction::expand(const Eigen::VectorXd& z, const Eigen::VectorXd& p) const {
  Eigen::VectorXd u = expandDirection(z, p);
  for (std::size_t s = 0; s < slaves_.size(); ++s) u(slaves_[s]) += constant_[s];
  return u;
}

Eigen::VectorXd Reduction::restrictToFree(const Eigen::VectorXd& f) const {
  Eigen::VectorXd r(freeCount());
  for (int z = 0; z < freeCount(); ++z) r(z) = f(dof_of_free_[z]);
  for (const int dof : slaves_) {
    for (const auto& [z, factor] : terms_[dof]) r(z) += factor * f(dof);
  }
  return r;
}

Eigen::VectorXd Reduction::restrictToControl(const Eigen::VectorXd& f) const {
  Eigen::VectorXd r = Eigen::VectorXd::Zero(controls_);
  for (std::size_t s = 0; s < slaves_.size(); ++s) {
    for (const auto& [k, factor] : control_[s]) r(k) += factor * f(slaves_[s]);
  }
  return r;
}

Eigen::VectorXd Reduction::freePart(const Eigen::VectorXd& u) const {
  Eigen::VectorXd z(freeCount());
  for (int k = 0; k < freeCount(); ++k) z(k) = u(dof_of_free_[k]);
  return z;
}

}  // namespace snapwing::solver
