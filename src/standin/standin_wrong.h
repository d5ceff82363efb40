#pragma once
/// Ways in which a flight controller can be set wrongly, for the stand-in: each must be refused by the bridge with a
/// sentence that names the mend.

#include <string>
#include <vector>

#include "standin_controller.h"

namespace snapwing::standin {

/// Names that setWrongly() knows.
std::vector<std::string> wrongConfigurations();

/// @throws common::SettingError for an unknown name
void setWrongly(const std::string& name, StandinSettings& settings);

}  // namespace snapwing::standin
