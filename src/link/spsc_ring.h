#pragma once
/// Queue between exactly one writing and one reading thread, without locks and without allocation.

#include <array>
#include <atomic>
#include <cstddef>

#include "snapwing/common/loan.h"

namespace snapwing::link {

template <class Item, std::size_t CAPACITY>
class SpscRing : public common::Lender {
  static_assert((CAPACITY & (CAPACITY - 1)) == 0, "capacity is a power of two");

 public:
  /// Writer. @param keep_free  refuse unless this many places stay free afterwards. @return false if full
  bool push(const Item& item, std::size_t keep_free = 0) {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) + keep_free >= CAPACITY) return false;
    items_[head % CAPACITY] = item;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }
  /// Reader. @return false if empty
  bool pop(Item& item) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    item = items_[tail % CAPACITY];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

 private:
  std::array<Item, CAPACITY> items_{};
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace snapwing::link
