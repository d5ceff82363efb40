#include "snapwing/design/design_program.h"

#include "snapwing/common/program_code.h"

namespace snapwing::design {

std::string designProgram() {
  static const char here = 0;
  return common::programOf(&here);
}

}  // namespace snapwing::design
