// Results that are kept are those of one program, and of the inputs that they were made of.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "snapwing/common/output_file.h"
#include "snapwing/validation/kept_results.h"
#include "support/own_folder.h"

namespace snapwing::validation {
namespace {

using nlohmann::ordered_json;

TEST(KeptResults, AreThoseOfOneProgram) {
  const std::string folder = test::ownFolder() + "kept";
  std::filesystem::remove_all(folder);
  const KeptResults own(folder, "0.1.0+aa"), other(folder, "0.1.0+bb");
  const ordered_json result = {{"x", 1}};
  own.save("a", "key", result);
  EXPECT_EQ(own.load("a", "key"), result);
  EXPECT_FALSE(own.load("a", "other").has_value());
  EXPECT_EQ(own.otherProgram("a", "key"), "");
  EXPECT_FALSE(other.load("a", "key").has_value());
  EXPECT_EQ(other.otherProgram("a", "key"), "left by another program (0.1.0+aa, this is 0.1.0+bb)");
  EXPECT_EQ(other.otherProgram("a", "other"), "") << "it would not be taken in any case";
  EXPECT_EQ(other.otherProgram("b", "key"), "");
  EXPECT_EQ(other.loadAny("a"), result);
}

TEST(KeptResults, OfProgramsThatDidNotNameThemselvesAreNotTaken) {
  const std::string folder = test::ownFolder() + "kept_old";
  std::filesystem::remove_all(folder);
  const KeptResults own(folder, "0.1.0+aa");
  common::writeFileAtomically(folder + "/a.json", R"({"key": "key", "outcome": {"x": 1}})");
  EXPECT_FALSE(own.load("a", "key").has_value());
  EXPECT_EQ(own.otherProgram("a", "key"), "left by another program (an earlier one, this is 0.1.0+aa)");
}

}  // namespace
}  // namespace snapwing::validation
