#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "snapwing/common/error.h"
#include "snapwing/common/folder_lock.h"

namespace snapwing::common {
namespace {

class Folder : public testing::Test {
 protected:
  void SetUp() override {
    path_ = testing::TempDir() + "lock_XXXXXX";
    ASSERT_NE(::mkdtemp(path_.data()), nullptr);
  }
  void TearDown() override { std::filesystem::remove_all(path_); }
  std::string path_;
};

TEST_F(Folder, OneRunAtATimeAndNothingIsLeftInIt) {
  {
    const FolderLock lock(path_);
    EXPECT_THROW(FolderLock{path_}, FileError);
    EXPECT_TRUE(std::filesystem::is_empty(path_));
  }
  EXPECT_NO_THROW(FolderLock{path_});
  EXPECT_THROW(FolderLock{path_ + "/none"}, FileError);
}

TEST_F(Folder, AKilledRunLetsGo) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t other = ::fork();
  if (other == 0) {
    const FolderLock lock(path_);
    const ssize_t told = ::write(ready[1], "x", 1);
    for (;;) ::usleep(told > 0 ? 1000000 : 1000);
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_THROW(FolderLock{path_}, FileError);
  ::kill(other, SIGKILL);
  ::waitpid(other, nullptr, 0);
  EXPECT_NO_THROW(FolderLock{path_});
}

}  // namespace
}  // namespace snapwing::common
