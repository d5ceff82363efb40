#pragma once
/// Independent tasks in parallel.

#include <functional>

namespace snapwing::common {

/// Calls body(0) .. body(count - 1), started in that order, on at most `threads` threads, the caller's included. Tasks
/// must not depend on each other, so that the result does not depend on the number of threads.
/// @throws the exception of the first task in that order that threw; later tasks may not have been started
void parallelFor(int count, int threads, const std::function<void(int)>& body);

}  // namespace snapwing::common
