#include "snapwing/solver/enforcement.h"

#include "snapwing/common/enum_names.h"

namespace snapwing::solver {

namespace {
constexpr common::EnumNames<Enforcement, 3> NAMES("drive", {"elimination", "augmented_lagrangian", "multipliers"});
}  // namespace

Enforcement enforcementFromName(const std::string& name) { return NAMES.value(name); }

std::string enforcementName(Enforcement enforcement) { return NAMES.name(enforcement); }

}  // namespace snapwing::solver
