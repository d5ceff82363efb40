#include <gtest/gtest.h>

#include <filesystem>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"

namespace snapwing::common {
namespace {

TEST(Provenance, Sha256OfTheStandardsExample) {
  // FIPS 180-2, appendix B.1
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Provenance, FilesAreReadWhole) {
  const std::string path = testing::TempDir() + "atomic.txt";
  writeFileAtomically(path, "bytes");
  EXPECT_EQ(readFile(path), "bytes");
  std::filesystem::remove(path);
  EXPECT_THROW(readFile(path), FileError);
  EXPECT_THROW(readFile(testing::TempDir()), FileError);
}

}  // namespace
}  // namespace snapwing::common
