#pragma once
/// Which program designs: checkpoints and stored designs of another one are not taken.

#include <string>

namespace snapwing::design {

/// This library with what it links, by common::programOf().
std::string designProgram();

}  // namespace snapwing::design
