#pragma once
/// Results of long work, each in a file of its own as soon as it is there, so that a stopped run resumes.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "snapwing/validation/rung_trial.h"

namespace snapwing::validation {

class KeptResults {
 public:
  /// @param folder  of the files; made if it is not there. @throws common::FileError
  explicit KeptResults(std::string folder);
  /// @param key  hash of all that the result depends on. @return the result; none if there is none, or of another
  /// key, or a damaged one
  std::optional<nlohmann::ordered_json> load(const std::string& name, const std::string& key) const;
  /// The result, whatever its key.
  std::optional<nlohmann::ordered_json> loadAny(const std::string& name) const;
  /// @param result  an object. @throws common::FileError
  void save(const std::string& name, const std::string& key, const nlohmann::ordered_json& result) const;
  void forget(const std::string& name) const;

 private:
  std::string path(const std::string& name) const;
  std::string folder_;
};

/// A trial's outcome as it is kept; NaN is null.
nlohmann::ordered_json keptOutcome(const RungOutcome& outcome);
/// @return false if it is none; `outcome` is then as it was
bool readOutcome(const nlohmann::ordered_json& kept, RungOutcome* outcome);

}  // namespace snapwing::validation
