#pragma once
/// Values of a solid's cells, in their order: volumes, strains, and means over a fixed length. The strain of a
/// re-entrant corner grows without limit with smaller cells (as r^-0.46 at a right angle); its mean over a fixed length
/// has a limit.

#include <Eigen/SparseCore>

#include "snapwing/mpm/discretisation.h"

namespace snapwing::mpm {

/// Volume of the material that a cell holds at density 1. (cellCount x 1) [m3]
template <int D>
Eigen::VectorXd cellVolumes(const Discretisation<D>& solid);

/// weightedStrain (strain.h), with the largest principal stretch at each cell's centre. (cellCount x 1) [1]
/// @param u  [m], at least (dofCount x 1)
template <int D>
Eigen::VectorXd cellStrains(const Discretisation<D>& solid, const Eigen::VectorXd& u);

/// [m] Within it of a point the mean is taken that a material's strain limit is compared with. A material has such a
/// length of its own (theory of critical distances; for elastomers fracture energy / work to rupture, [Chen, Wang, Suo
/// 2017]). That of printed TPU is unknown; why this one: docs/decisions.md.
constexpr double STRAIN_RADIUS = 1e-3;

/// Means over the material within a radius of each cell's centre, as a matrix for values of the cells: row c holds
/// v_k rho_k V_k / sum_k v_k rho_k V_k. v_k: share of cell k within the disc (ball) about c's centre, V_k: its volume.
/// Only cells of c's body count. (cellCount x cellCount) [1]; rows of cells with no material around are empty.
/// @param radius  [m] > 0; in cells of twice that or more each mean is the cell's own value
/// @throws common::Error for a radius that is not above 0
template <int D>
Eigen::SparseMatrix<double, Eigen::RowMajor> meansWithin(const Discretisation<D>& solid, double radius);

}  // namespace snapwing::mpm
