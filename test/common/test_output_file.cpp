#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "snapwing/common/error.h"
#include "snapwing/common/output_file.h"
#include "snapwing/common/provenance.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/wing_table.h"

namespace snapwing::common {
namespace {

namespace fs = std::filesystem;

class OutputFile : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::TempDir() + "output_XXXXXX";
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name + "/";
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string in(const std::string& name) const { return folder_ + name; }
  std::string with(const std::string& name, const std::string& bytes) const {
    std::ofstream(in(name), std::ios::binary) << bytes;
    return in(name);
  }
  std::size_t count() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), {})); }
  std::string folder_;
};

template <class Action>
std::string messageOf(const Action& action) {
  try {
    action();
  } catch (const FileError& e) {
    return e.what();
  }
  return "";
}

vehicle::ForceTable anyTable() {
  vehicle::ForceTable t;
  for (int k = 0; k < 400; ++k) {
    const double u = 1e-4 * k;
    t.travel.push_back(u), t.force.push_back(100 * u), t.stiffness.push_back(100), t.energy.push_back(50 * u * u);
    t.rotation.push_back(u), t.kinetic_mass.push_back(0), t.coupled_mass.push_back(0), t.min_det_f.push_back(1),
        t.stable.push_back(1), t.iterations.push_back(1);
  }
  return t;
}

TEST_F(OutputFile, IsReplacedWholeAndKeepsItsMode) {
  const std::string path = with("a", "old");
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_write);
  writeFileAtomically(path, "new");
  EXPECT_EQ(readFile(path), "new");
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_write);
  EXPECT_EQ(count(), 1u);
}

TEST_F(OutputFile, FollowsLinksToTheFileThatTheyMean) {
  with("real", "old");
  fs::create_symlink("real", in("link"));
  fs::create_symlink("not_yet", in("dangling"));
  fs::create_symlink("link", in("twice"));
  writeFileAtomically(in("twice"), "new");
  writeFileAtomically(in("dangling"), "first");
  EXPECT_EQ(readFile(in("real")), "new");
  EXPECT_EQ(readFile(in("not_yet")), "first");
  for (const char* name : {"link", "twice", "dangling"}) EXPECT_TRUE(fs::is_symlink(in(name))) << name;
  fs::create_symlink("circle", in("circle"));
  EXPECT_NE(messageOf([&] { writeFileAtomically(in("circle"), "x"); }).find("circle"), std::string::npos);
}

TEST_F(OutputFile, PipesAndDevicesAreWrittenThrough) {
  ASSERT_EQ(::mkfifo(in("pipe").c_str(), 0600), 0);
  std::string got;
  std::thread reader([&] { got = readFile(in("pipe")); });
  writeFileAtomically(in("pipe"), "through");
  reader.join();
  EXPECT_EQ(got, "through");
  EXPECT_TRUE(fs::is_fifo(in("pipe")));
  fs::create_symlink("/dev/null", in("sink"));
  writeFileAtomically(in("sink"), "away");
  EXPECT_TRUE(fs::is_symlink(in("sink")));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  if (fs::exists("/dev/full")) {
    EXPECT_NE(messageOf([] { writeFileAtomically("/dev/full", "x"); }).find("No space"), std::string::npos);
  }
}

/// What is printed into a file must not be lost when an option names the same file, e.g. as /dev/stdout.
TEST_F(OutputFile, TheFileBehindTheStandardOutputIsAppendedTo) {
  const int before = ::dup(1);
  const int file = ::open(in("log").c_str(), O_WRONLY | O_CREAT, 0600);
  std::fflush(stdout);
  ASSERT_GE(::dup2(file, 1), 0);
  std::printf("first\n");
  writeFileAtomically("/dev/stdout", "second\n");
  writeFileAtomically(in("log"), "third\n");
  std::printf("fourth\n");
  std::fflush(stdout);
  ::dup2(before, 1);
  ::close(before), ::close(file);
  EXPECT_EQ(readFile(in("log")), "first\nsecond\nthird\nfourth\n");
}

TEST_F(OutputFile, RefusalsNameTheFileAndNoOther) {
  const std::string missing = messageOf([&] { writeFileAtomically(in("no/such/x"), "bytes"); });
  EXPECT_NE(missing.find("no/such/x: its folder does not exist"), std::string::npos) << missing;
  EXPECT_NE(messageOf([&] { writeFileAtomically(folder_, "bytes"); }).find("is a folder"), std::string::npos);
  EXPECT_EQ(messageOf([&] { requireWritable(in("fine")); }), "");
  EXPECT_EQ(messageOf([] { requireWritable("result.h5"); }), "");
}

/// A limit on the size stands for a full disk: writing stops in the middle, in the same call.
class Limited {
 public:
  explicit Limited(rlim_t bytes) {
    before_ = std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &limit_);
    const struct rlimit less { bytes, limit_.rlim_max };
    ::setrlimit(RLIMIT_FSIZE, &less);
  }
  ~Limited() {
    ::setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, before_);
  }

 private:
  struct rlimit limit_ {};
  void (*before_)(int);
};

TEST_F(OutputFile, WhatDoesNotFitLeavesTheOldFileAndNothingElse) {
  const std::string path = with("a", "old"), table = with("t.h5", "old table"), wing = with("w.h5", "old wing");
  {
    const Limited limited(4096);
    const std::string why = messageOf([&] { writeFileAtomically(path, std::string(10000, 'x')); });
    EXPECT_NE(why.find(path + ": cannot be written: File too large"), std::string::npos) << why;
    // HDF5 crashed when it closed a file that it could not write.
    const std::string h5 = messageOf([&] { vehicle::saveForceTable(anyTable(), table); });
    EXPECT_NE(h5.find(table + ": cannot be written: File too large"), std::string::npos) << h5;
  }
  EXPECT_EQ(readFile(path), "old");
  EXPECT_EQ(readFile(table), "old table");
  EXPECT_EQ(count(), 3u);
  vehicle::saveForceTable(anyTable(), table);
  EXPECT_EQ(vehicle::loadForceTable(table).travel, anyTable().travel);
}

TEST_F(OutputFile, NoOutputIsAnInputWhateverItsName) {
  const std::string scene = with("scene.yaml", "a: 1");
  fs::create_symlink("scene.yaml", in("link"));
  fs::create_hard_link(scene, in("hard"));
  for (const std::string& name : {scene, in("link"), in("hard"), in("./scene.yaml"), in("x/../scene.yaml")}) {
    fs::create_directory(in("x"));
    OutputFiles files;
    files.reads(scene, "the scene");
    const std::string why = messageOf([&] { files.writes(name, "--summary"); });
    EXPECT_NE(why.find("--summary would overwrite the scene"), std::string::npos) << name << why;
  }
}

TEST_F(OutputFile, NoTwoOutputsAreOneFileAndFoldersAreLookedAt) {
  OutputFiles files;
  files.writes(in("a.csv"), "--csv");
  EXPECT_NE(messageOf([&] { files.writes(in("./a.csv"), "--output"); }).find("--output and --csv are one file"),
            std::string::npos);
  files.writes("/dev/null", "--summary");
  EXPECT_EQ(messageOf([&] { files.writes("/dev/null", "--plot"); }), "");
  EXPECT_EQ(messageOf([&] { files.fills(in("new/folder"), "--vtu"); }), "");
  EXPECT_EQ(messageOf([&] { files.writes(in("new/folder/a.csv"), "--vtu"); }), "") << "the folder is to be made";
  EXPECT_NE(messageOf([&] { files.writes(in("new/other/a.csv"), "--csv"); }).find("does not exist"), std::string::npos);
  EXPECT_EQ(messageOf([&] { files.fills(in("late") + "/", "--output"); }), "");
  EXPECT_EQ(messageOf([&] { files.writes(in("late/a.csv"), "--output"); }), "");
  EXPECT_FALSE(fs::exists(in("new")));
  with("file", "");
  EXPECT_NE(messageOf([&] { files.fills(in("file/folder"), "--vtu"); }).find("is not a folder"), std::string::npos);
  EXPECT_NE(messageOf([&] { makeFolder(in("file/folder")); }).find("cannot be made"), std::string::npos);
}

}  // namespace
}  // namespace snapwing::common
