/// The bridge's loop allocates nothing: every allocation of the program is counted while it runs.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "link/loop_simulation.h"

namespace {
std::atomic<long> allocations{0};
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace snapwing::link {
namespace {

TEST(Allocation, NoneInTheLoopInAnyState) {
  test::Simulation s;
  s.arm();
  const auto measured = [&s](double seconds) {
    const long before = allocations;
    s.run(seconds);
    return allocations - before;
  };
  ASSERT_EQ(s.pulse(0.5, 0.2), Refusal::NONE);
  EXPECT_EQ(measured(1.0), 0) << "pulse and armed";
  s.operator_runs = false;
  EXPECT_EQ(measured(1.0), 0) << "fault";
  ASSERT_EQ(s.bridge->core().status().state, BridgeState::FAULT);
  s.line.plugged = false;
  s.line.unplug();
  EXPECT_EQ(measured(1.0), 0) << "line lost";
  s.line.plugged = true;
  EXPECT_EQ(measured(1.0), 0) << "connecting and reading the controller again";
  // The counter itself works.
  const long before = allocations;
  ::operator delete(::operator new(8));
  EXPECT_EQ(allocations - before, 1);
}

}  // namespace
}  // namespace snapwing::link
