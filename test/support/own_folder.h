#pragma once
/// A folder that no other test writes to, though many run side by side.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

namespace snapwing::test {

/// Of the test that runs, made if it is not there; ends with a slash.
inline std::string ownFolder() {
  const ::testing::TestInfo& test = *::testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string(test.test_suite_name()) + "." + test.name();
  std::replace(name.begin(), name.end(), '/', '_');  // parameterised tests
  const std::string folder = ::testing::TempDir() + name + "/";
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace snapwing::test
