#pragma once
/// Results of long work, each in a file of its own as soon as it is there, so that a stopped run resumes.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "snapwing/validation/rung_trial.h"

namespace snapwing::validation {

class KeptResults {
 public:
  /// @param folder  of the files; made if it is not there. @param program  that computes, of common::programOf()
  /// @throws common::FileError
  KeptResults(std::string folder, std::string program);
  /// @param key  hash of all that the result depends on beside the program. @return the result; none if there is none,
  /// or of another key or program, or a damaged one
  std::optional<nlohmann::ordered_json> load(const std::string& name, const std::string& key) const;
  /// Why a result that is there is not taken although its key is right: another program left it. Empty: no such result.
  std::string otherProgram(const std::string& name, const std::string& key) const;
  /// The result, whatever its key and program.
  std::optional<nlohmann::ordered_json> loadAny(const std::string& name) const;
  /// @param result  an object. @throws common::FileError
  void save(const std::string& name, const std::string& key, const nlohmann::ordered_json& result) const;
  void forget(const std::string& name) const;

 private:
  std::string path(const std::string& name) const;
  std::string folder_, program_;
};

/// A trial's outcome as it is kept; NaN is null.
nlohmann::ordered_json keptOutcome(const RungOutcome& outcome);
/// @return false if it is none; `outcome` is then as it was
bool readOutcome(const nlohmann::ordered_json& kept, RungOutcome* outcome);

}  // namespace snapwing::validation
