#pragma once
/// Deformed cells for ParaView (internal to the statics floor).

#include <string>

#include "snapwing/mpm/discretisation.h"

namespace snapwing::scene {

/// Text of an unstructured grid: cells with their corners moved; corners are shared within a body.
/// @param u  nodal displacements [m], (dofCount x 1)
template <int D>
std::string vtuText(const mpm::Discretisation<D>& solid, const Eigen::VectorXd& u);

}  // namespace snapwing::scene
