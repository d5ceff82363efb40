// Stages that were done are kept as long as their inputs and files are what they were, and only then.
#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"
#include "snapwing/pipeline/stages.h"
#include "support/own_folder.h"

namespace snapwing::pipeline {
namespace {

namespace fs = std::filesystem;
using validation::Verdict;

class StagesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = test::ownFolder() + "made";
    fs::remove_all(folder_);
  }

  /// One session with one stage that writes `text`.
  StageResult session(const Inputs& inputs, const std::string& text = "a", bool dies = false) {
    told_.clear();
    Stages stages(folder_, 1, [this](const StageProgress& p) { told_.push_back(p); });
    return stages.run("first", inputs, [&](bool goes_on) {
      ++done_, went_on_ = goes_on;
      if (dies) throw std::runtime_error("killed");
      common::writeFileAtomically(stages.path("file"), text);
      StageResult result;
      result.verdict = Verdict::UNDECIDED;
      result.words = "a word";
      result.files = {"file"};
      return result;
    });
  }

  std::string folder_;
  int done_ = 0;
  bool went_on_ = false;
  std::vector<StageProgress> told_;
};

TEST_F(StagesTest, WhatIsDoneIsKeptWithItsVerdict) {
  const StageResult first = session({{"x", "1"}});
  EXPECT_FALSE(first.kept);
  EXPECT_FALSE(went_on_);
  const StageResult again = session({{"x", "1"}});
  EXPECT_EQ(done_, 1);
  EXPECT_TRUE(again.kept);
  EXPECT_EQ(again.verdict, Verdict::UNDECIDED);
  EXPECT_EQ(again.words, "a word");
  EXPECT_EQ(again.files, std::vector<std::string>{"file"});
  ASSERT_EQ(told_.size(), 1U);
  EXPECT_EQ(told_[0].what, StageProgress::What::KEPT);
  EXPECT_EQ(told_[0].number, 1);
  EXPECT_EQ(told_[0].count, 1);
}

TEST_F(StagesTest, ChangedInputsAreNamed) {
  session({{"x", "1"}, {"y", "1"}});
  session({{"x", "1"}, {"y", "2"}});
  EXPECT_EQ(done_, 2);
  EXPECT_FALSE(went_on_);
  EXPECT_EQ(told_.front().words, "anew: changed since it was done: y");
}

TEST_F(StagesTest, AFileThatIsNotWhatItWasIsNamed) {
  session({{"x", "1"}});
  common::writeFileAtomically(folder_ + "/file", "by hand");
  session({{"x", "1"}});
  EXPECT_EQ(done_, 2);
  EXPECT_EQ(told_.front().words, "anew: file is not what this stage left");
  fs::remove(folder_ + "/file");
  session({{"x", "1"}});
  EXPECT_EQ(done_, 3);
  EXPECT_EQ(told_.front().words, "anew: file no longer exists");
}

TEST_F(StagesTest, WhatWasBegunGoesOnWithTheSameInputsOnly) {
  EXPECT_THROW(session({{"x", "1"}}, "a", true), std::runtime_error);
  EXPECT_FALSE(went_on_);
  EXPECT_THROW(session({{"x", "1"}}, "a", true), std::runtime_error);
  EXPECT_TRUE(went_on_);
  EXPECT_EQ(told_.front().words, "goes on");
  session({{"x", "2"}});
  EXPECT_FALSE(went_on_);
  EXPECT_EQ(told_.front().words, "anew: changed since it was begun: x");
}

TEST_F(StagesTest, AStageThatIsDoneAnewHasNoNoteUntilItIsDone) {
  session({{"x", "1"}});
  EXPECT_THROW(session({{"x", "2"}}, "b", true), std::runtime_error);
  session({{"x", "1"}});
  EXPECT_EQ(done_, 3) << "the note of x = 1 was of files that x = 2 may have changed";
}

TEST_F(StagesTest, AFolderOfSomethingElseIsRefused) {
  fs::create_directories(folder_);
  common::writeFileAtomically(folder_ + "/mine", "a");
  EXPECT_THROW(Stages(folder_, 1, {}), common::FileError);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(StagesTest, ASecondRunInTheFolderIsRefused) {
  {
    const Stages first(folder_, 1, {});
    EXPECT_THROW(Stages(folder_, 1, {}), common::FileError);
  }
  EXPECT_NO_THROW(Stages(folder_, 1, {}));
}

TEST_F(StagesTest, ADamagedNoteIsNone) {
  session({{"x", "1"}});
  common::writeFileAtomically(folder_ + "/stages/first.json", "{\"key\": 3");
  session({{"x", "1"}});
  EXPECT_EQ(done_, 2);
}

}  // namespace
}  // namespace snapwing::pipeline
