#pragma once
/// Nodes of a cell (private to the layer), for loops of a fixed length.

namespace snapwing::mpm {

template <int D>
constexpr int LINEAR_STENCIL = D == 2 ? 4 : 8;
template <int D>
constexpr int QUADRATIC_STENCIL = D == 2 ? 9 : 27;

}  // namespace snapwing::mpm
