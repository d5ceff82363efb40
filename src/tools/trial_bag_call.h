#pragma once
/// run.bag of a trial: the converter of the ROS floor as a program beside this one.

#include <string>

namespace snapwing::tools {

/// Path of trial_bag, which a build with ROS has beside `snapwing`. @throws common::Error saying what is missing
std::string bagProgram();

/// Runs it on a trial's folder. @throws common::Error if it fails
void callBagProgram(const std::string& program, const std::string& folder);

}  // namespace snapwing::tools
