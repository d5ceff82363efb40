#pragma once
/// The time that work will still take, as words of a line of progress.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>

#include "snapwing/pipeline/time_left.h"

namespace snapwing::tools {

class TimeShown {
 public:
  /// ", about 3 min left"; empty as long as nothing is known. @param share  that is done
  std::string after(double share) {
    const double now = std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    const double left = left_.after(share, now);
    if (std::isnan(left)) return "";
    char text[40];
    if (left < 90) {
      std::snprintf(text, sizeof text, ", about %.0f s left", left);
    } else {
      std::snprintf(text, sizeof text, ", about %.0f min left", left / 60);
    }
    return text;
  }

 private:
  pipeline::TimeLeft left_;
};

}  // namespace snapwing::tools
