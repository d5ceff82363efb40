#pragma once
/// Deformed cells for ParaView (internal to the layer).

#include <string>
#include <vector>

#include "snapwing/mpm/discretisation.h"
#include "snapwing/scene/scene.h"

namespace snapwing::scene {

/// Text of an unstructured grid: cells with their corners moved; corners are shared within a body.
/// @param u       nodal displacements in the axes of their bodies [m], (dofCount x 1)
/// @param frames  of the bodies
template <int D>
std::string vtuText(const mpm::Discretisation<D>& solid, const Eigen::VectorXd& u, const std::vector<Frame>& frames);

}  // namespace snapwing::scene
