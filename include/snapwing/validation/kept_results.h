#pragma once
/// Results of long work, each in a file of its own as soon as it is there, so that a stopped run goes on.

#include <optional>
#include <string>

#include "snapwing/validation/rung_trial.h"

namespace snapwing::validation {

class KeptResults {
 public:
  /// @param folder  of the files; made if it is not there. @throws common::FileError
  explicit KeptResults(std::string folder);
  /// @param key  hash of all that the result depends on. @return the result, JSON; none if there is none, or of another
  /// key, or a damaged one
  std::optional<std::string> load(const std::string& name, const std::string& key) const;
  /// The result, whatever its key.
  std::optional<std::string> loadAny(const std::string& name) const;
  /// @param json  an object. @throws common::FileError
  void save(const std::string& name, const std::string& key, const std::string& json) const;
  void forget(const std::string& name) const;

 private:
  std::string path(const std::string& name) const;
  std::string folder_;
};

/// A trial's outcome as it is kept; NaN is null.
std::string outcomeText(const RungOutcome& outcome);
/// @return false if the text is none; `outcome` is then as it was
bool readOutcome(const std::string& text, RungOutcome* outcome);

}  // namespace snapwing::validation
