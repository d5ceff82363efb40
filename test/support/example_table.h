#pragma once
/// Force table made from the study's curve (test/data/arms/arm_curve_plane_stress.csv): energy by integration,
/// stiffness by differences, and a stiff smooth continuation to u < 0 that keeps the curve's slope and curvature at u =
/// 0.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "snapwing/vehicle/force_table.h"
#include "support/paths.h"

namespace snapwing::testing {

inline vehicle::ForceTable exampleTable() {
  const std::string path = test::sourceDir() + "/test/data/arms/arm_curve_plane_stress.csv";
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::vector<double> u, r, rotation;
  for (std::string line; std::getline(file, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row(line);
    double a, b, c;
    if (row >> a >> b >> c) {
      u.push_back(1e-3 * a);
      r.push_back(b);
      rotation.push_back(c);
    }
  }
  if (u.size() != 81) throw std::runtime_error(path + ": expected 81 rows");
  vehicle::ForceTable table;
  table.arm_count = 4;
  // Slope and curvature at u = 0 from the first three points.
  const double h = u[1] - u[0];
  const double slope = (-1.5 * r[0] + 2.0 * r[1] - 0.5 * r[2]) / h;
  const double curvature = (r[0] - 2.0 * r[1] + r[2]) / (h * h);
  for (int k = -15; k < 0; ++k) {
    const double x = k * h;
    table.travel.push_back(x);
    table.force.push_back(x * (slope + 0.5 * curvature * x));
    table.rotation.push_back(rotation[1] * k);
  }
  table.travel.insert(table.travel.end(), u.begin(), u.end());
  table.force.insert(table.force.end(), r.begin(), r.end());
  table.rotation.insert(table.rotation.end(), rotation.begin(), rotation.end());
  const std::size_t n = table.travel.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t a = i == 0 ? 0 : i - 1, b = i + 1 == n ? i : i + 1;
    table.stiffness.push_back((table.force[b] - table.force[a]) / (table.travel[b] - table.travel[a]));
  }
  // Integral of the cubic through forces and stiffnesses, then E(0) = 0.
  table.energy.assign(n, 0.0);
  for (std::size_t i = 1; i < n; ++i) {
    table.energy[i] = table.energy[i - 1] + 0.5 * h * (table.force[i] + table.force[i - 1]) +
                      h * h / 12.0 * (table.stiffness[i - 1] - table.stiffness[i]);
  }
  const double rest = table.energy[15];
  for (double& e : table.energy) e -= rest;
  table.kinetic_mass.assign(n, 0.0);  // weightless
  table.coupled_mass.assign(n, 0.0);
  table.min_det_f.assign(n, 1.0);
  table.stable.assign(n, 1);
  table.iterations.assign(n, 0);
  table.validate();
  return table;
}

/// Inertia of one arm of 11 g against the travel, smooth and as large as the shipped one's: it rides with the centre by
/// half at rest, by nearly all at 12 mm and by a quarter in the second mode. [kg]
inline constexpr double EXAMPLE_ARM_MASS = 0.011;
inline double exampleArmShare(double u) {
  const double x = (u - 0.012) / 0.018;
  return 0.22 + 0.72 * std::exp(-x * x);
}
inline double exampleArmCoupled(double u) { return -EXAMPLE_ARM_MASS * exampleArmShare(u); }
inline double exampleArmKinetic(double u) {
  const double share = exampleArmShare(u);
  return EXAMPLE_ARM_MASS * (share * share + 0.15 + 2.0 * u);
}

/// The same curve with arms that have mass.
inline vehicle::ForceTable exampleTableWithMass() {
  vehicle::ForceTable table = exampleTable();
  table.mass = EXAMPLE_ARM_MASS;
  for (std::size_t i = 0; i < table.travel.size(); ++i) {
    table.kinetic_mass[i] = exampleArmKinetic(table.travel[i]);
    table.coupled_mass[i] = exampleArmCoupled(table.travel[i]);
  }
  table.validate();
  return table;
}

}  // namespace snapwing::testing
