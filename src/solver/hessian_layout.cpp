#include "snapwing/solver/hessian_layout.h"

#include <set>
#include <string>

#include "snapwing/common/error.h"

namespace snapwing::solver {

template <int D>
int HessianLayout::addRegion(int first, const mpm::BlockPattern<D>& blocks) {
  if (first < 0 || first + D * blocks.nodes() > full_) {
    throw common::Error("a region of " + std::to_string(D * blocks.nodes()) + " coordinates begins at " +
                        std::to_string(first) + "; allowed: within the " + std::to_string(full_) + " that there are");
  }
  if (!couples_.empty()) throw common::Error("regions are added before couples");
  regions_.push_back({first, D, blocks.nodes(), entries_, blocks.start(), blocks.row()});
  entries_ += blocks.blocks() * D * D;
  return regionCount() - 1;
}

int HessianLayout::addCouple(std::vector<int> coordinates) {
  const std::set<int> different(coordinates.begin(), coordinates.end());
  if (different.size() != coordinates.size() ||
      (!different.empty() && (*different.begin() < 0 || *different.rbegin() >= full_))) {
    throw common::Error("a term couples coordinates that do not exist or repeat; allowed: different ones, 0 .. " +
                        std::to_string(full_ - 1));
  }
  const int count = static_cast<int>(coordinates.size()), place = entries_;
  couples_.push_back({std::move(coordinates), place});
  entries_ += count * (count + 1) / 2;
  return place;
}

void HessianLayout::each(const std::function<void(int, int, int)>& visit) const {
  for (const Region& r : regions_) {
    const int d = r.dimension;
    for (int column = 0; column < r.nodes; ++column) {
      for (int b = r.start[column]; b < r.start[column + 1]; ++b) {
        const int row = r.row[b];
        for (int k = 0; k < d; ++k) {
          for (int i = row == column ? k : 0; i < d; ++i) {
            visit(r.first + d * row + i, r.first + d * column + k, r.place + b * d * d + i + d * k);
          }
        }
      }
    }
  }
  for (const Couple& c : couples_) {
    int place = c.place;
    for (std::size_t column = 0; column < c.coordinates.size(); ++column) {
      for (std::size_t row = column; row < c.coordinates.size(); ++row) {
        visit(c.coordinates[row], c.coordinates[column], place++);
      }
    }
  }
}

namespace {

/// Whether each node moves in x.
template <int D>
std::vector<char> movingNodes(std::size_t nodes, const double* x) {
  std::vector<char> moving(nodes);
  for (std::size_t n = 0; n < nodes; ++n)
    moving[n] = !Eigen::Map<const Eigen::Matrix<double, D, 1>>(x + D * n).isZero(0);
  return moving;
}

/// y += H x for node blocks by columns, of which the lower ones are there. Blocks that meet no motion are passed over:
/// a control moves few nodes by itself (TermProblem::controlTangent), and H is not in the caches.
template <int D>
void addBlocks(const std::vector<int>& start, const std::vector<int>& row, const double* values, const double* x,
               double* y) {
  using Node = Eigen::Matrix<double, D, 1>;
  const std::vector<char> moving = movingNodes<D>(start.size() - 1, x);
  for (std::size_t column = 0; column + 1 < start.size(); ++column) {
    const Node from = Eigen::Map<const Node>(x + D * column);
    const bool own = moving[column];
    Node sum = Node::Zero();
    for (int b = start[column]; b < start[column + 1]; ++b) {
      const Eigen::Map<const Eigen::Matrix<double, D, D>> block(values + static_cast<std::size_t>(b) * D * D);
      const std::size_t node = row[b], at = D * node;
      if (own) Eigen::Map<Node>(y + at) += block * from;
      if (moving[node] && node != column) sum += block.transpose() * Eigen::Map<const Node>(x + at);
    }
    Eigen::Map<Node>(y + D * column) += sum;
  }
}

}  // namespace

Eigen::VectorXd HessianLayout::multiply(const std::vector<double>& values, const Eigen::VectorXd& x) const {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(full_);
  for (const Region& r : regions_) {
    const auto add = r.dimension == 2 ? addBlocks<2> : addBlocks<3>;
    add(r.start, r.row, values.data() + r.place, x.data() + r.first, y.data() + r.first);
  }
  for (const Couple& c : couples_) {
    int place = c.place;
    for (std::size_t column = 0; column < c.coordinates.size(); ++column) {
      for (std::size_t row = column; row < c.coordinates.size(); ++row) {
        const double value = values[place++];
        y(c.coordinates[row]) += value * x(c.coordinates[column]);
        if (row != column) y(c.coordinates[column]) += value * x(c.coordinates[row]);
      }
    }
  }
  return y;
}

template int HessianLayout::addRegion<2>(int, const mpm::BlockPattern<2>&);
template int HessianLayout::addRegion<3>(int, const mpm::BlockPattern<3>&);

}  // namespace snapwing::solver
