#include "snapwing/solver/coordinates.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "snapwing/common/error.h"

namespace snapwing::solver {

namespace {

Eigen::Matrix3d matrixOf(const Rotation& rotation, const Eigen::VectorXd& entries) {
  const int d = entries.size() == 4 ? 2 : 3;
  Eigen::Matrix3d r = Eigen::Matrix3d::Identity();
  for (int j = 0; j < d; ++j) {
    for (int i = 0; i < d; ++i) r(i, j) += entries(i + d * j) / rotation.length;
  }
  return r;
}

}  // namespace

Coordinates::Coordinates(Reduction linear, int dimension, std::vector<Rotation> rotations)
    : linear_(std::move(linear)), dimension_(dimension) {
  free_ = linear_.freeCount();
  if (rotations.empty()) return;
  const int entries = dimension * dimension;
  std::map<int, int> inner_of_dof;
  for (int w = 0; w < linear_.freeCount(); ++w) inner_of_dof[linear_.dofOfFree(w)] = w;
  plain_.assign(linear_.freeCount(), 0);
  entry_of_.assign(linear_.freeCount(), {-1, -1});
  for (Rotation& rotation : rotations) {
    Group group;
    group.rotation = std::move(rotation);
    for (int e = 0; e < entries; ++e) {
      const auto found = inner_of_dof.find(group.rotation.first + e);
      if (found == inner_of_dof.end()) {
        throw common::Error("coordinate " + std::to_string(group.rotation.first + e) +
                            " is an entry of a rotation and eliminated by an equation; allowed: free ones");
      }
      group.inner.push_back(found->second);
      plain_[group.inner.back()] = -1;
      entry_of_[group.inner.back()] = {static_cast<int>(groups_.size()), e};
    }
    groups_.push_back(std::move(group));
  }
  free_ = 0;
  for (int& own : plain_) {
    if (own == 0) own = free_++;
  }
  for (Group& group : groups_) {
    group.first = free_;
    free_ += group.params();
  }
}

Eigen::VectorXd Coordinates::inner(const Eigen::VectorXd& z, const std::vector<RotationValue>& values) const {
  Eigen::VectorXd w(static_cast<Eigen::Index>(plain_.size()));
  for (std::size_t k = 0; k < plain_.size(); ++k) {
    if (plain_[k] >= 0) w(static_cast<Eigen::Index>(k)) = z(plain_[k]);
  }
  for (std::size_t n = 0; n < groups_.size(); ++n) {
    const Group& g = groups_[n];
    for (std::size_t e = 0; e < g.inner.size(); ++e) w(g.inner[e]) = values[n].value(static_cast<Eigen::Index>(e));
  }
  return w;
}

void Coordinates::at(const Eigen::VectorXd& z, const Eigen::VectorXd& p, const References* references,
                     Place& out) const {
  if (groups_.empty()) {
    out.y = linear_.expand(z, p);
    return;
  }
  out.rotations.clear();
  for (std::size_t n = 0; n < groups_.size(); ++n) {
    const Group& g = groups_[n];
    out.rotations.push_back(rotate(g.rotation, dimension_, z.segment(g.first, g.params()),
                                   references != nullptr ? &references->rotation[n] : nullptr));
  }
  out.y = linear_.expand(inner(z, out.rotations), p);
}

Eigen::VectorXd Coordinates::expand(const Eigen::VectorXd& z, const Eigen::VectorXd& p,
                                    const References* references) const {
  Place place;
  at(z, p, references, place);
  return std::move(place.y);
}

int Coordinates::freeOf(int dof) const {
  const auto& terms = linear_.terms(dof);
  if (terms.size() != 1 || linear_.dofOfFree(terms.front().first) != dof) return -1;
  return plain_.empty() ? terms.front().first : plain_[terms.front().first];
}

Eigen::VectorXd Coordinates::freePart(const Eigen::VectorXd& y, const Eigen::VectorXd& rotations) const {
  const Eigen::VectorXd own = linear_.freePart(y);
  if (groups_.empty()) return own;
  Eigen::VectorXd z(free_);
  for (std::size_t k = 0; k < plain_.size(); ++k) {
    if (plain_[k] >= 0) z(plain_[k]) = own(static_cast<Eigen::Index>(k));
  }
  z.tail(rotations.size()) = rotations;
  return z;
}

Eigen::VectorXd Coordinates::pullBackInner(const Eigen::VectorXd& inner,
                                           const std::vector<RotationValue>& values) const {
  Eigen::VectorXd own = Eigen::VectorXd::Zero(free_);
  for (std::size_t w = 0; w < plain_.size(); ++w) {
    if (plain_[w] >= 0) own(plain_[w]) = inner(static_cast<Eigen::Index>(w));
  }
  for (std::size_t n = 0; n < groups_.size(); ++n) {
    const Group& g = groups_[n];
    if (g.params() == 0) continue;  // held: its slope has no entry that a row could begin at
    for (std::size_t e = 0; e < g.inner.size(); ++e) {
      own.segment(g.first, g.params()) +=
          inner(g.inner[e]) * values[n].slope.row(static_cast<Eigen::Index>(e)).transpose();
    }
  }
  return own;
}

Eigen::VectorXd Coordinates::pullBack(const Place& at, const Eigen::VectorXd& full) const {
  Eigen::VectorXd inner = linear_.restrictToFree(full);
  if (groups_.empty()) return inner;
  return pullBackInner(inner, at.rotations);
}

ConstraintRows Coordinates::pullBack(const Place& at, const ConstraintRows& rows) const {
  std::vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < rows.rows(); ++row) {
    for (ConstraintRows::InnerIterator own(rows, row); own; ++own) {
      for (const auto& [w, factor] : linear_.terms(static_cast<int>(own.col()))) {
        const double value = own.value() * factor;
        if (plain_.empty() || plain_[w] >= 0) {
          entries.emplace_back(row, plain_.empty() ? w : plain_[w], value);
          continue;
        }
        const auto& [rotation, entry] = entry_of_[w];
        const Group& g = groups_[rotation];
        for (int k = 0; k < g.params(); ++k) {
          entries.emplace_back(row, g.first + k, value * at.rotations[rotation].slope(entry, k));
        }
      }
    }
  }
  ConstraintRows result(rows.rows(), free_);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

Eigen::VectorXd Coordinates::rotationLengths() const {
  Eigen::VectorXd lengths(groups_.empty() ? 0 : free_ - groups_.front().first);
  for (const Group& g : groups_) {
    lengths.segment(g.first - groups_.front().first, g.params()).setConstant(g.rotation.length);
  }
  return lengths;
}

Eigen::VectorXd Coordinates::pullBackMean(const Place& start, const Place& end, const Eigen::VectorXd& full) const {
  if (groups_.empty()) return linear_.restrictToFree(full);
  std::vector<RotationValue> mean = end.rotations;
  for (std::size_t n = 0; n < groups_.size(); ++n) {
    const Rotation& r = groups_[n].rotation;
    const Eigen::Matrix3d middle = 0.5 * (matrixOf(r, start.rotations[n].value) + matrixOf(r, end.rotations[n].value));
    for (int k = 0; k < groups_[n].params(); ++k) {
      const Eigen::Matrix3d turned = skewOf(r.axes[k]) * middle;
      for (int j = 0; j < dimension_; ++j) {
        for (int i = 0; i < dimension_; ++i) mean[n].slope(i + dimension_ * j, k) = turned(i, j);
      }
    }
  }
  return pullBackInner(linear_.restrictToFree(full), mean);
}

Eigen::VectorXd Coordinates::rotationRates(const Place& at, const Eigen::VectorXd& v) const {
  Eigen::VectorXd rates = Eigen::VectorXd::Zero(groups_.empty() ? 0 : free_ - groups_.front().first);
  for (std::size_t n = 0; n < groups_.size(); ++n) {
    const Group& g = groups_[n];
    if (g.params() == 0) continue;
    const Eigen::MatrixXd& slope = at.rotations[n].slope;
    const Eigen::VectorXd entries = v.segment(g.rotation.first, slope.rows());
    rates.segment(g.first - groups_.front().first, g.params()) =
        (slope.transpose() * slope).ldlt().solve(slope.transpose() * entries);
  }
  return rates;
}

Eigen::VectorXd Coordinates::push(const Place& at, const Eigen::VectorXd& dz, const Eigen::VectorXd& dp) const {
  if (groups_.empty()) return linear_.expandDirection(dz, dp);
  Eigen::VectorXd w(static_cast<Eigen::Index>(plain_.size()));
  for (std::size_t k = 0; k < plain_.size(); ++k) {
    if (plain_[k] >= 0) w(static_cast<Eigen::Index>(k)) = dz(plain_[k]);
  }
  for (std::size_t n = 0; n < groups_.size(); ++n) {
    const Group& g = groups_[n];
    const Eigen::VectorXd moved = at.rotations[n].slope * dz.segment(g.first, g.params());
    for (std::size_t e = 0; e < g.inner.size(); ++e) w(g.inner[e]) = moved(static_cast<Eigen::Index>(e));
  }
  return linear_.expandDirection(w, dp);
}

std::shared_ptr<const References> Coordinates::renew(Eigen::VectorXd& z, const References* references) const {
  auto fresh = std::make_shared<References>();
  for (std::size_t n = 0; n < groups_.size(); ++n) {
    const Group& g = groups_[n];
    const RotationValue value = rotate(g.rotation, dimension_, z.segment(g.first, g.params()),
                                       references != nullptr ? &references->rotation[n] : nullptr);
    // The nearest rotation, so that rounding does not add up over many turns.
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrixOf(g.rotation, value.value),
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    fresh->rotation.push_back(svd.matrixU() * svd.matrixV().transpose());
    z.segment(g.first, g.params()).setZero();
  }
  return fresh;
}

HessianPullBack::HessianPullBack(std::shared_ptr<const Coordinates> coordinates, const HessianLayout& layout)
    : shared_(std::move(coordinates)), coordinates_(*shared_) {
  buildInner(layout);
  if (!coordinates_.groups_.empty()) buildTurned();
}

/// T^T H T. Most entries of H go to one place with factor 1; the rest is listed in mixed_, after an item without a
/// source for each place that has none with factor 1. So the copy of most need not ask.
void HessianPullBack::buildInner(const HessianLayout& layout) {
  struct Entry {
    int column, row, source;
    double factor;
  };
  std::vector<Entry> entries;
  entries.reserve(layout.entries());
  const Reduction& linear = coordinates_.linear_;
  layout.each([&](int row, int column, int source) {
    const bool off_diagonal = row != column;
    for (const auto& [zr, fr] : linear.terms(row)) {
      for (const auto& [zc, fc] : linear.terms(column)) {
        if (!off_diagonal && zr < zc) continue;
        // The mirrored entry adds the same again where both ends meet in one coordinate.
        const double factor = fr * fc * (off_diagonal && zr == zc ? 2 : 1);
        entries.push_back({std::min(zr, zc), std::max(zr, zc), source, factor});
      }
    }
  });
  // Coordinates that no energy knows have their place on the diagonal as well.
  std::vector<bool> known(linear.freeCount(), false);
  for (const Entry& entry : entries) {
    if (entry.row == entry.column) known[entry.row] = true;
  }
  for (int w = 0; w < linear.freeCount(); ++w) {
    if (!known[w]) entries.push_back({w, w, -1, 1.0});
  }
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.column != b.column ? a.column < b.column : a.row < b.row;
  });
  inner_.size = linear.freeCount();
  inner_.start.assign(inner_.size + 1, 0);
  for (std::size_t n = 0; n < entries.size(); ++n) {
    const Entry& entry = entries[n];
    const bool fresh = n == 0 || entries[n - 1].column != entry.column || entries[n - 1].row != entry.row;
    if (fresh) {
      inner_.row.push_back(entry.row);
      ++inner_.start[entry.column + 1];
      const bool whole = entry.factor == 1.0 && entry.source >= 0;
      source_.push_back(whole ? entry.source : 0);
      if (whole) continue;
      mixed_.push_back({inner_.entries() - 1, -1, 0});  // begins at zero, whatever was copied there
      if (entry.source < 0) continue;
    }
    mixed_.push_back({inner_.entries() - 1, entry.source, entry.factor});
  }
  for (int c = 0; c < inner_.size; ++c) inner_.start[c + 1] += inner_.start[c];
}

void HessianPullBack::buildTurned() {
  const auto& plain = coordinates_.plain_;
  // Own coordinates that an inner one depends on: (coordinate, place of the slope).
  std::vector<std::vector<std::pair<int, int>>> users(plain.size());
  for (std::size_t w = 0; w < plain.size(); ++w) {
    if (plain[w] >= 0) users[w] = {{plain[w], 0}};
  }
  for (const Coordinates::Group& g : coordinates_.groups_) {
    slope_of_group_.push_back(slopes_);
    for (std::size_t e = 0; e < g.inner.size(); ++e) {
      for (int k = 0; k < g.params(); ++k) users[g.inner[e]].emplace_back(g.first + k, slopes_++);
    }
  }
  std::vector<std::vector<int>> rows(coordinates_.free_);
  const auto each = [&](const auto& visit) {
    for (int c = 0; c < inner_.size; ++c) {
      for (int k = inner_.start[c]; k < inner_.start[c + 1]; ++k) {
        const int r = inner_.row[k];
        for (const auto& [row, row_slope] : users[r]) {
          for (const auto& [column, column_slope] : users[c]) {
            // A diagonal entry meets each pair twice; an entry off the diagonal stands for two.
            if (r == c && row < column) continue;
            visit(std::max(row, column), std::min(row, column), k, row_slope, column_slope,
                  r != c && row == column ? 2 : 1);
          }
        }
      }
    }
  };
  each([&](int row, int column, int, int, int, int) { rows[column].push_back(row); });
  for (const Coordinates::Group& g : coordinates_.groups_) {
    for (int a = 0; a < g.params(); ++a) {
      for (int b = 0; b <= a; ++b) rows[g.first + b].push_back(g.first + a);
    }
  }
  pattern_.size = coordinates_.free_;
  pattern_.start.assign(1, 0);
  for (std::vector<int>& column : rows) {
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    pattern_.row.insert(pattern_.row.end(), column.begin(), column.end());
    pattern_.start.push_back(pattern_.entries());
  }
  each([&](int row, int column, int source, int row_slope, int column_slope, double times) {
    items_.push_back({pattern_.find(row, column), source, row_slope, column_slope, times});
  });
}

namespace {

/// to[k] = from[number[k]]
void gather(const std::vector<int>& number, const std::vector<double>& from, std::vector<double>& to) {
  if (from.empty()) return std::fill(to.begin(), to.end(), 0.0);
  const int *numbers = number.data(), count = static_cast<int>(number.size());
  const double* source = from.data();
  double* target = to.data();
#pragma GCC unroll 8
  for (int k = 0; k < count; ++k) target[k] = source[numbers[k]];
}

}  // namespace

void HessianPullBack::apply(const std::vector<double>& full, const Coordinates::Place& at,
                            const Eigen::VectorXd& gradient, bool projected, std::vector<double>& values) const {
  values.resize(source_.size());
  gather(source_, full, values);
  for (const Mixed& m : mixed_) values[m.target] = m.source < 0 ? 0 : values[m.target] + m.factor * full[m.source];
  if (coordinates_.groups_.empty()) return;
  std::vector<double> slope(slopes_, 1.0);
  for (std::size_t n = 0; n < coordinates_.groups_.size(); ++n) {
    const Eigen::MatrixXd& own = at.rotations[n].slope;
    for (Eigen::Index e = 0; e < own.rows(); ++e) {
      for (Eigen::Index k = 0; k < own.cols(); ++k) slope[slope_of_group_[n] + e * own.cols() + k] = own(e, k);
    }
  }
  std::vector<double> own(pattern_.entries(), 0.0);
  for (const Item& i : items_) own[i.target] += i.times * slope[i.row] * slope[i.column] * values[i.source];
  const Eigen::VectorXd inner = coordinates_.linear_.restrictToFree(gradient);
  for (std::size_t n = 0; n < coordinates_.groups_.size(); ++n) {
    const Coordinates::Group& g = coordinates_.groups_[n];
    const int params = g.params();
    if (params == 0) continue;
    Eigen::MatrixXd geometric = Eigen::MatrixXd::Zero(params, params);
    for (std::size_t e = 0; e < g.inner.size(); ++e) geometric += inner(g.inner[e]) * at.rotations[n].second[e];
    if (projected) {
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(geometric);
      geometric =
          eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
    }
    for (int a = 0; a < params; ++a) {
      for (int b = 0; b <= a; ++b) own[pattern_.find(g.first + a, g.first + b)] += geometric(a, b);
    }
  }
  values.swap(own);
}

}  // namespace snapwing::solver
