#pragma once
/// One goal of the action optimize_design as the part that serves it sees it.

#include <snapwing/OptimizeDesignFeedback.h>
#include <snapwing/OptimizeDesignGoal.h>
#include <snapwing/OptimizeDesignResult.h>

#include <functional>
#include <string>

namespace snapwing::nodes {

struct DesignJob {
  OptimizeDesignGoal goal;
  std::string settings_file;  ///< resolved
  std::string store_folder;   ///< results live in store_folder/<hash of their inputs>
  std::function<void(const OptimizeDesignFeedback&)> feedback;
  std::function<bool()> preempted;  ///< asked often; true: stop soon and answer PREEMPTED
};

}  // namespace snapwing::nodes
