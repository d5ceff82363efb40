#pragma once

#include <string>

namespace snapwing::test {

/// Root of the source tree, without a slash at its end. A function and not a macro, so that the objects of the tests
/// do not depend on where the tree lies and a compiler cache serves every clone.
std::string sourceDir();

}  // namespace snapwing::test
