#pragma once
/// Stages of a long run in one folder. Each leaves its files there, and a note of its inputs and of its files'
/// hashes. An interrupted run resumes: a stage whose inputs and files are still those of its note is kept, any other is
/// repeated and says why.

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "snapwing/common/folder_lock.h"
#include "snapwing/validation/check.h"
#include "snapwing/validation/kept_results.h"

namespace snapwing::pipeline {

/// An input of a stage: a name for the reader, and a hash or a value.
using Inputs = std::vector<std::pair<std::string, std::string>>;

struct StageProgress {
  enum class What { BEGUN, WORKING, KEPT, DONE };
  What what = What::BEGUN;
  int number = 0, count = 0;  ///< stage n of m, from 1
  std::string stage;
  std::string words;                                            ///< why it begins, what it works on, or its result
  double share = std::numeric_limits<double>::quiet_NaN();      ///< of this stage that is done; NaN = not known
  validation::Verdict verdict = validation::Verdict::REPORTED;  ///< of KEPT and DONE
};

/// Results of a stage.
struct StageResult {
  std::string stage;
  validation::Verdict verdict = validation::Verdict::PASS;
  bool ends = false;               ///< nothing can follow
  std::string words;               ///< the result, one line
  std::vector<std::string> files;  ///< relative to the folder
  bool kept = false;
};

class Stages {
 public:
  /// @param folder  new, empty, or begun by an earlier run. @param count  of the stages
  /// @throws common::FileError for a folder with foreign files, or one in which another run works now
  Stages(std::string folder, int count, std::function<void(const StageProgress&)> told);

  /// Keeps the stage or does it. @param work  gets whether an earlier run has begun it with the same inputs; returns
  /// its results. After an exception there is no note
  StageResult run(const std::string& stage, const Inputs& inputs, const std::function<StageResult(bool goes_on)>& work);
  /// Of the stage that runs now. @param share  NaN = not known
  void working(const std::string& words, double share);
  /// Hash that a file of the folder had when its stage was done; empty if there is no note of it.
  std::string notedHash(const std::string& stage, const std::string& file) const;
  std::string path(const std::string& file) const { return folder_ + "/" + file; }

 private:
  void tell(StageProgress::What what, const std::string& words, validation::Verdict verdict, double share);
  std::string whyAnew(const std::string& stage, const Inputs& inputs) const;

  std::string folder_;
  validation::KeptResults kept_;
  common::FolderLock lock_;
  int number_ = 0, count_;
  std::string stage_;
  std::function<void(const StageProgress&)> told_;
};

}  // namespace snapwing::pipeline
