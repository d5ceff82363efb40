#pragma once
/// A validation as one page of HTML with everything inside it, and as JSON.

#include <string>

#include "snapwing/validation/validation.h"

namespace snapwing::validation {

/// What the page is about, as the caller knows it.
struct ReportHead {
  std::string vehicle, vehicle_file, vehicle_sha256, table_file, body_file, command, version;
};

/// Verdict, checks, pictures of curve and travel; no script, nothing fetched.
std::string reportHtml(const Validation& found, const vehicle::ForceTable& table, const ReportHead& head);

/// The checks and outcomes, without series. NaN becomes null.
std::string reportJson(const Validation& found, const ReportHead& head);

}  // namespace snapwing::validation
