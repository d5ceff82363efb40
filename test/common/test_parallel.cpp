#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "snapwing/common/parallel.h"

namespace snapwing::common {
namespace {

TEST(Parallel, RunsEachTaskOnce) {
  for (const int threads : {0, 1, 2, 5, 100}) {
    std::vector<int> runs(40, 0);
    parallelFor(40, threads, [&](int i) { ++runs[i]; });
    EXPECT_EQ(runs, std::vector<int>(40, 1)) << threads;
  }
  parallelFor(0, 2, [](int) { FAIL(); });
}

TEST(Parallel, UsesTheThreadsThatItMay) {
  std::atomic<int> together{0};
  parallelFor(2, 2, [&](int) {  // each waits for the other: with one thread this would not end well
    ++together;
    for (int k = 0; k < 10000 && together < 2; ++k) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_EQ(together, 2);
  });
}

TEST(Parallel, ThrowsWhatTheFirstFailedTaskThrew) {
  for (const int threads : {1, 2, 4}) {
    for (int repeat = 0; repeat < 50; ++repeat) {
      try {
        parallelFor(20, threads, [](int i) {
          if (i == 5 || i == 6 || i == 13) throw std::runtime_error(std::to_string(i));
        });
        FAIL() << "nothing thrown";
      } catch (const std::runtime_error& e) {
        EXPECT_STREQ(e.what(), "5");
      }
    }
  }
}

}  // namespace
}  // namespace snapwing::common
