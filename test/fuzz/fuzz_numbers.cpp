/// libFuzzer: the strict numbers against the C library's, which takes more, and texts that must read back.
#include <clocale>
#include <cmath>
#include <cstring>

#include "fuzz_file.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/scene/rung.h"
#include "snapwing/solver/enforcement.h"

using namespace snapwing;

namespace snapwing::statics {
solver::Enforcement enforcementFromName(const std::string&) { return solver::Enforcement::ELIMINATION; }
std::string enforcementName(solver::Enforcement) { return "elimination"; }
}  // namespace snapwing::statics

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  double value = 0;
  if (common::parseNumber(text, &value)) {
    char* end = nullptr;
    const double other = std::strtod(text.c_str(), &end);
    fuzz::require(*end == '\0' && end == text.c_str() + text.size());
    fuzz::require(value == other || (value == 0 && std::abs(other) < 2.3e-308));
  }
  int whole = 0;
  if (common::parseInteger(text, &whole)) fuzz::require(common::parseNumber(text, &value) && value == whole);
  fuzz::taken([&] { fuzz::require(scene::cellSizeFor(text, 1e-3) > 0); });
  if (size >= sizeof(double)) {
    std::memcpy(&value, data, sizeof(double));
    double back = 0;
    const std::string shown = common::toText(value);
    if (std::isfinite(value))
      fuzz::require(common::parseNumber(shown, &back) && (back == value || std::abs(value) < 2.3e-308));
  }
  return 0;
}
