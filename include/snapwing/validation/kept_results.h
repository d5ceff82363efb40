#pragma once
/// Results of a long validation, each in a file of its own as soon as it is there, so that a stopped run goes on.

#include <string>

#include "snapwing/validation/rung_trial.h"

namespace snapwing::validation {

class KeptResults {
 public:
  /// @param folder  of the files; made if it is not there. @throws common::FileError
  explicit KeptResults(std::string folder);
  /// @param key  hash of all that the result depends on. @return false if there is none, or of another key
  bool load(const std::string& name, const std::string& key, RungOutcome* outcome) const;
  void save(const std::string& name, const std::string& key, const RungOutcome& outcome) const;

 private:
  std::string path(const std::string& name) const;
  std::string folder_;
};

}  // namespace snapwing::validation
