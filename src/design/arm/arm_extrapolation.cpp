#include "arm_extrapolation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace snapwing::design {

namespace {

bool counts(const ArmCheckCase& c) { return c.traced && c.offset == 0 && c.name != "grey"; }

/// The bodies of each kernel, finest first.
std::map<std::string, std::vector<const ArmCheckCase*>> byKernel(const ArmCheck& check, bool solid) {
  std::map<std::string, std::vector<const ArmCheckCase*>> series;
  for (const ArmCheckCase& c : check.cases) {
    if (counts(c) && c.solid == solid) series[c.rung].push_back(&c);
  }
  for (auto& [rung, cases] : series) {
    std::sort(cases.begin(), cases.end(), [](auto* a, auto* b) { return a->cell_size < b->cell_size; });
  }
  return series;
}

/// What is added to the finer value to reach the limit, as a share of the difference to the coarser one.
double gain(const ArmCheckCase& fine, const ArmCheckCase& coarse) {
  return 1 / (coarse.cell_size / fine.cell_size - 1);
}

std::vector<double> beyond(const std::vector<double>& fine, const std::vector<double>& coarse, double gain) {
  std::vector<double> result(fine.size());
  for (std::size_t k = 0; k < fine.size(); ++k) result[k] = fine[k] + gain * (fine[k] - coarse[k]);
  return result;
}

/// Limits of single numbers may be together what no motion can have: K M >= S^2 [Cauchy-Schwarz].
void keepInertiaPossible(vehicle::ForceTable* table) {
  if (!(table->mass > 0)) return;
  for (std::size_t k = 0; k < table->kinetic_mass.size(); ++k) {
    const double coupled = table->coupled_mass[k];
    table->kinetic_mass[k] = std::max(table->kinetic_mass[k], coupled * coupled / table->mass);
  }
}

}  // namespace

ArmEstimate estimate(const ArmCheck& check, bool solid, double (*quantity)(const ArmCheckCase&)) {
  std::vector<double> limits;
  double correction = 0;
  for (const auto& [rung, cases] : byKernel(check, solid)) {
    if (cases.size() < 2) continue;
    const double fine = quantity(*cases[0]), coarse = quantity(*cases[1]);
    const double step = gain(*cases[0], *cases[1]) * (fine - coarse);
    if (!std::isfinite(step)) return {};
    limits.push_back(fine + step);
    correction = std::max(correction, std::abs(step));
  }
  if (limits.empty()) return {};
  const auto [low, high] = std::minmax_element(limits.begin(), limits.end());
  ArmEstimate result;
  result.value = 0;
  for (const double limit : limits) result.value += limit / static_cast<double>(limits.size());
  result.error = std::max(0.5 * (*high - *low), DOUBT_OF_CORRECTION * correction);
  return result;
}

vehicle::ForceTable extrapolatedTable(const ArmCheck& check) {
  for (const auto& [rung, cases] : byKernel(check, false)) {
    if (cases[0]->rung != PLANAR_LINEAR || cases.size() < 2) continue;
    const vehicle::ForceTable &fine = cases[0]->table, &coarse = cases[1]->table;
    if (fine.travel != coarse.travel) return {};
    const double g = gain(*cases[0], *cases[1]);
    vehicle::ForceTable table = fine;
    table.force = beyond(fine.force, coarse.force, g);
    table.stiffness = beyond(fine.stiffness, coarse.stiffness, g);
    table.energy = beyond(fine.energy, coarse.energy, g);
    table.rotation = beyond(fine.rotation, coarse.rotation, g);
    table.kinetic_mass = beyond(fine.kinetic_mass, coarse.kinetic_mass, g);
    table.coupled_mass = beyond(fine.coupled_mass, coarse.coupled_mass, g);
    table.mass = fine.mass + g * (fine.mass - coarse.mass);
    keepInertiaPossible(&table);
    const bool both = fine.force_back.size() == coarse.force_back.size();
    table.force_back = both ? beyond(fine.force_back, coarse.force_back, g) : std::vector<double>();
    for (std::size_t k = 0; k < table.travel.size(); ++k) {
      table.min_det_f[k] = std::min(fine.min_det_f[k], coarse.min_det_f[k]);
      table.stable[k] = fine.stable[k] && coarse.stable[k] ? 1 : 0;
      table.iterations[k] = fine.iterations[k] + coarse.iterations[k];
    }
    return table;
  }
  return {};
}

}  // namespace snapwing::design
