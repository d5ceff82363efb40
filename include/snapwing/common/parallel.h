#pragma once
/// Independent tasks side by side.

#include <functional>

namespace snapwing::common {

/// body(0) .. body(count - 1), begun in that order, on at most so many threads, the caller's among them. What a task
/// leaves must not depend on the others, so that the number of threads does not change the result.
/// @throws what the first task in that order threw; tasks after it may not have been begun
void parallelFor(int count, int threads, const std::function<void(int)>& body);

}  // namespace snapwing::common
