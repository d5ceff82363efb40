#include "support/paths.h"

namespace snapwing::test {

std::string sourceDir() { return SNAPWING_SOURCE_DIR; }

}  // namespace snapwing::test
