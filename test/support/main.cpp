// Runs the tests of a program in a folder of its own: ctest starts every case as a process, several at a time, and the
// same cases once more with sanitizers, so files of equal names in one folder would be written by several at once.
#include <gtest/gtest.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <string>

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  std::string folder = ::testing::TempDir() + "snapwing_test_XXXXXX";
  if (mkdtemp(folder.data()) == nullptr) {
    std::cerr << "cannot make " << folder << ": " << std::strerror(errno) << "\n";
    return EXIT_FAILURE;
  }
  setenv("TEST_TMPDIR", (folder + "/").c_str(), 1);  // what TempDir() gives from here on
  const int status = RUN_ALL_TESTS();
  std::error_code left;  // a test that takes away its own rights must not hide what it found
  std::filesystem::remove_all(folder, left);
  return status;
}
