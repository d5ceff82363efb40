#pragma once
/// What `snapwing curve` says of a curve: JSON for programs, a few lines for people. The lines are made from the JSON.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "snapwing/statics/features.h"
#include "snapwing/vehicle/force_table.h"

namespace snapwing::tools {

nlohmann::json orNull(double value);

/// Outcome, counts and seconds of a path or of an arm's curve, with those of its features.
template <class Result>
nlohmann::json costsOf(const Result& result, const statics::LocatedFeatures& located) {
  nlohmann::json j;
  j["status"] = solver::statusName(result.status);
  j["message"] = result.message;
  j["iterations"] = result.iterations;
  j["factorizations"] = result.factorizations + located.factorizations;
  j["factorizations_of_features"] = located.factorizations;
  j["projections"] = result.projections;
  j["step_halvings"] = result.halvings;
  j["series"] = result.series;
  j["no_series"] = result.no_series;
  j["seconds"] = {{"total", result.seconds + located.seconds}, {"assembly", result.seconds_assembly},
                  {"factorization", result.seconds_factor},    {"solve", result.seconds_solve},
                  {"analysis", result.seconds_analysis},       {"features", located.seconds}};
  return j;
}

/// Peak, valley, equilibria and barriers of the force that is needed to go away from travel 0, whatever the sign of the
/// travel and the direction in which it was followed. Solved for if `located` is complete, else interpolated between
/// the points, and marked so.
/// @param table      the curve; what it does not hold are the arms or copies in `factor`
/// @param factor     of forces and energies in `located`
/// @param preloaded  loads act beside the driven port: the elastic energy then tells no barriers
void addFeatures(const vehicle::ForceTable& table, const statics::LocatedFeatures& located, double factor,
                 bool preloaded, nlohmann::json& j);

/// Every feature that was solved for, as it is.
void addLocated(const std::vector<statics::Feature>& found, double factor, nlohmann::json& j);

/// How many points are unstable while the control is held, and if it is let go (the force falls along the travel).
/// @param driven  the control is a travel; else a load, which cannot be held
void countStable(const std::vector<int>& stable, const std::vector<double>& stiffness, bool driven, nlohmann::json& j);

/// The answer on the terminal. @param files  that were written
std::string curveAnswer(const nlohmann::json& summary, const std::vector<std::string>& files);

}  // namespace snapwing::tools
