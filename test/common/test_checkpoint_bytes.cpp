// A checkpoint is of one program and of one owner; which program computes is read from its code.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "snapwing/common/checkpoint_bytes.h"
#include "snapwing/common/program_code.h"
#include "snapwing/common/provenance.h"
#include "support/own_folder.h"

namespace snapwing::common {
namespace {

const std::string KIND = "snapwing test checkpoint 2\n", OWNER(64, 'a'), PATH = "another test";
const char HERE = 0, ALSO_HERE = 1;

/// What a reader says of the file: "" if it takes it.
std::string said(const std::string& path, const std::string& kind, const std::string& program,
                 const std::string& owner) {
  try {
    EXPECT_EQ(loadCheckpointBytes(path, kind, program, owner, PATH), "bytes\nof it");
    return "";
  } catch (const OtherProgramError& e) {
    return std::string("anew: ") + e.what();
  } catch (const FileError& e) {
    return e.what();
  }
}

TEST(CheckpointBytes, AreOfOneProgramAndOneOwner) {
  const std::string path = test::ownFolder() + "checkpoint";
  saveCheckpointBytes("bytes\nof it", KIND, "0.1.0+aa", OWNER, path);
  EXPECT_EQ(said(path, KIND, "0.1.0+aa", OWNER), "");
  EXPECT_NE(said(path, KIND, "0.1.0+bb", OWNER).find("anew: "), std::string::npos);
  EXPECT_NE(said(path, KIND, "0.1.0+bb", OWNER).find("another program (0.1.0+aa, this is 0.1.0+bb)"),
            std::string::npos);
  EXPECT_NE(said(path, KIND, "0.1.0+aa", std::string(64, 'b')).find("belongs to another test"), std::string::npos);
  EXPECT_NE(said(path, "snapwing test checkpoint 3\n", "0.1.0+aa", OWNER).find("anew: "), std::string::npos)
      << "an earlier format is another program's";
  EXPECT_NE(said(path, "another kind 2\n", "0.1.0+aa", OWNER).find("no checkpoint of this kind"), std::string::npos);
  std::string file = readFile(path);
  file.back() ^= 1;
  writeFileAtomically(path, file);
  EXPECT_NE(said(path, KIND, "0.1.0+aa", OWNER).find("damaged"), std::string::npos);
  for (const std::string& start : {std::string(), KIND, KIND + "0.1.0+aa\n" + OWNER, KIND + std::string(300, 'x')}) {
    writeFileAtomically(path, start);
    EXPECT_NE(said(path, KIND, "0.1.0+aa", OWNER), "") << start;
  }
}

TEST(CheckpointBytes, EveryDamagedByteIsFound) {
  const std::string path = test::ownFolder() + "damaged", bytes = "bytes\nof it";
  saveCheckpointBytes(bytes, KIND, "0.1.0+aa", OWNER, path);
  const std::string good = readFile(path), more =
                                               "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ,.-+#*/"
                                               "%$!?0123456789abcdefghijklmnopqrstuvwxyzAB";
  for (std::size_t k = 1; k <= 64 + bytes.size(); ++k) {
    std::string file = good;
    file[file.size() - k] ^= 4;
    writeFileAtomically(path, file);
    EXPECT_NE(said(path, KIND, "0.1.0+aa", OWNER).find("damaged"), std::string::npos) << k;
  }
  for (const std::string& file : {good + std::string(1, 0), good.substr(0, good.size() - 1)}) {
    writeFileAtomically(path, file);
    EXPECT_NE(said(path, KIND, "0.1.0+aa", OWNER).find("damaged"), std::string::npos);
  }
  // Words of one column in another order.
  saveCheckpointBytes(more, KIND, "0.1.0+aa", OWNER, path);
  std::string file = readFile(path);
  std::swap_ranges(file.end() - 100, file.end() - 92, file.end() - 68);
  writeFileAtomically(path, file);
  EXPECT_THROW(loadCheckpointBytes(path, KIND, "0.1.0+aa", OWNER, PATH), FileError);
}

TEST(ProgramCode, IsOfTheObjectThatHoldsTheAddress) {
  EXPECT_EQ(programOf(&HERE), programOf(&ALSO_HERE));
  EXPECT_EQ(programOf(&HERE).substr(0, version().size() + 1), version() + "+");
  EXPECT_EQ(programOf(&HERE).size(), version().size() + 1 + 16);
  EXPECT_NE(programOf(&HERE), programOf(stderr)) << "the C library";
  EXPECT_THROW(programOf(nullptr), Error);
}

}  // namespace
}  // namespace snapwing::common
