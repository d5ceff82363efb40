#include "snapwing/design/arm/arm_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "snapwing/common/elementary.h"

namespace snapwing::design {

namespace {

/// One pass of Laplacian smoothing with a factor; points stay in order.
void relax(Loop& loop, double factor) {
  const std::size_t n = loop.size();
  const Loop old = loop;
  for (std::size_t k = 0; k < n; ++k) {
    for (int a = 0; a < 2; ++a) {
      const double mean = 0.5 * (old[(k + n - 1) % n][a] + old[(k + 1) % n][a]);
      loop[k][a] = old[k][a] + factor * (mean - old[k][a]);
    }
  }
}

double segmentDistance(const std::array<double, 2>& a, const std::array<double, 2>& b, double x, double y) {
  const double dx = b[0] - a[0], dy = b[1] - a[1];
  const double length = dx * dx + dy * dy;
  const double t = length > 0 ? std::clamp(((x - a[0]) * dx + (y - a[1]) * dy) / length, 0.0, 1.0) : 0.0;
  const double off_x = x - a[0] - t * dx, off_y = y - a[1] - t * dy;
  return std::sqrt(off_x * off_x + off_y * off_y);
}

}  // namespace

double loopArea(const Loop& loop) {
  double twice = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const auto &a = loop[k], &b = loop[(k + 1) % loop.size()];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return 0.5 * twice;
}

ArmShape::ArmShape(const mpm::DensityField& field, int smoothing) : loops_(mpm::outline(field, 0.5)) {
  // Taubin: a shrinking and a growing pass, so that the thin parts keep their thickness.
  for (Loop& loop : loops_) {
    for (int pass = 0; pass < smoothing; ++pass) {
      relax(loop, 0.33);
      relax(loop, -0.34);
    }
  }
  // The largest outer loop, and holes of more than four cells in it; islands carry no load.
  const double speck = 4 * field.cell_size * field.cell_size;
  double largest = 0;
  Loop outer;
  for (const Loop& loop : loops_) {
    if (std::abs(loopArea(loop)) > std::abs(largest)) largest = loopArea(loop), outer = loop;
  }
  std::vector<Loop> kept;
  if (!outer.empty()) kept.push_back(outer);
  const ArmShape filled(kept);
  for (const Loop& loop : loops_) {
    const bool hole = loopArea(loop) * largest < 0;
    if (hole && std::abs(loopArea(loop)) > speck && filled.signedDistance(loop[0][0], loop[0][1]) < 0) {
      kept.push_back(loop);
    }
  }
  loops_ = kept;
}

double ArmShape::area() const {
  double sum = 0;
  for (const Loop& loop : loops_) sum += loopArea(loop);
  return std::abs(sum);
}

double ArmShape::signedDistance(double x, double y) const {
  double distance = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (const Loop& loop : loops_) {
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const auto &a = loop[k], &b = loop[(k + 1) % loop.size()];
      distance = std::min(distance, segmentDistance(a, b, x, y));
      if ((a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) inside = !inside;
    }
  }
  return inside ? -distance : distance;
}

mpm::DensityField ArmShape::cover(const mpm::DensityField& domain, double offset, double power, double pin_x,
                                  double pin_y) const {
  constexpr double LEAST = 0.05;  // of a cell: slivers below carry nothing and only spoil the numbers
  mpm::DensityField result = domain;
  const double h = domain.cell_size;
  const int nx = domain.cells[0], ny = domain.cells[1];
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      double& value = result.value[static_cast<std::size_t>(j) * nx + i];
      if (value < 0) continue;
      const double distance = signedDistance((i + 0.5) * h, (j + 0.5) * h) - offset;
      const double share = std::clamp(0.5 - distance / h, 0.0, 1.0);
      value = share < LEAST ? -1 : common::pow(share, 1 / power);
    }
  }
  // Flood from the pin over faces.
  std::vector<char> reached(result.value.size(), 0);
  std::vector<std::array<int, 2>> open;
  const auto visit = [&](int i, int j) {
    if (!result.present(i, j) || reached[static_cast<std::size_t>(j) * nx + i]) return;
    reached[static_cast<std::size_t>(j) * nx + i] = 1;
    open.push_back({i, j});
  };
  // A point on the domain's far edge belongs to the last cell.
  visit(std::min(nx - 1, static_cast<int>(pin_x / h + 1e-9)), std::min(ny - 1, static_cast<int>(pin_y / h + 1e-9)));
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    visit(i + 1, j), visit(i - 1, j), visit(i, j + 1), visit(i, j - 1);
  }
  for (std::size_t k = 0; k < reached.size(); ++k) {
    if (!reached[k]) result.value[k] = -1;
  }
  return result;
}

}  // namespace snapwing::design
