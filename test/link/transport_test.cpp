// What lines are made of, and that making one harms nobody's file.
#include "snapwing/link/transport.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "snapwing/common/error.h"

namespace snapwing::link {
namespace {

namespace fs = std::filesystem;

class Line : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  std::string in(const char* name) const { return folder_ + "/" + name; }
  const std::string folder_ = ::testing::TempDir() + "snapwing_lines";
};

TEST_F(Line, APseudoTerminalReplacesNoFileAndNoOtherLink) {
  std::ofstream(in("key")) << "a key";
  fs::create_symlink(in("key"), in("device"));
  fs::create_directory(in("folder"));
  for (const char* name : {"key", "device", "folder"}) {
    EXPECT_THROW(makeTransport("pty:" + in(name), {}), common::FileError) << name;
    EXPECT_TRUE(fs::exists(in(name))) << name;
  }
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(in("key"))));
  EXPECT_EQ(fs::read_symlink(in("device")), in("key"));
}

TEST_F(Line, APseudoTerminalReplacesTheLinkOfAnEarlierOneAndTakesItsOwnAway) {
  fs::create_symlink("/dev/pts/987654", in("line"));  // of a program that was killed
  auto first = makeTransport("pty:" + in("line"), {});
  const fs::path of_first = fs::read_symlink(in("line"));
  EXPECT_NE(of_first, "/dev/pts/987654");
  const auto second = makeTransport("pty:" + in("line"), {});
  const fs::path of_second = fs::read_symlink(in("line"));
  EXPECT_NE(of_first, of_second);
  first.reset();
  EXPECT_EQ(fs::read_symlink(in("line")), of_second) << "the first one's end leaves the second one's link";
}

TEST_F(Line, PortsAreWholeNumbersThatFit) {
  EXPECT_EQ(portNumber("5761"), 5761);
  EXPECT_EQ(portNumber("0"), 0);
  EXPECT_EQ(portNumber("65535"), 65535);
  for (const char* bad : {"", "65536", "99999", "1000000", "-1", "5761x", " 5761", "telnet"}) {
    EXPECT_EQ(portNumber(bad), std::nullopt) << bad;
    EXPECT_THROW(makeTransport(std::string("tcp:127.0.0.1:") + bad, {}), common::SettingError) << bad;
  }
  EXPECT_THROW(makeTransport("tcp:127.0.0.1:0", {}), common::SettingError);
}

}  // namespace
}  // namespace snapwing::link
