#pragma once
/// Equations and loads of a scene on its cells (internal to the layer).

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "scene_cells.h"
#include "snapwing/solver/constraints.h"
#include "snapwing/solver/rotation.h"

namespace snapwing::scene {

/// Nodes that follow one rigid motion: a rigid body, or the section of a pin. Its dofs stand behind those of the nodes.
/// A rigid body without cells has no nodes. The D-vectors c and the columns of E then take the part of nodes: full
/// coordinates are D-vectors throughout, so that a point of any body is a weighted sum of "nodes".
struct RigidGroup {
  std::string name;
  int body = 0;
  std::vector<int> nodes;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< X_c [m]
  int translation = 0;                               ///< dof of c_0
  solver::Rotation rotation;                         ///< axes: what it may turn about if nothing else holds it
};

/// The axis along which a region is flat, or -1.
template <int D>
int flatAxis(const Box& region) {
  for (int a = 0; a < D; ++a) {
    if (std::isfinite(region.low(a)) && region.low(a) == region.high(a)) return a;
  }
  return -1;
}

template <int D>
class Constraints {
 public:
  using Weights = std::vector<std::pair<int, double>>;  ///< (node, or D-vector of a rigid group behind them; weight)

  Constraints(const Scene& scene, const SceneCells<D>& cells);

  std::vector<solver::Equation> equations() const;
  /// Nodal forces per unit of the control, (dofs of the nodes x 1); empty if the scene has no such loads.
  Eigen::MatrixXd loads() const;
  /// Nodal forces of constant loads, without the weight; zero if there are none.
  Eigen::VectorXd constantLoad() const;

  /// Displacement of a point in the axes of its body; empty if it lies outside.
  Weights pointWeights(int body, const mpm::Vector<D>& point) const;
  /// Rigid group of a body without cells.
  const RigidGroup& groupOf(int body) const;

  int dofCount() const { return keptFrom() + D * D * static_cast<int>(groups_.size()); }
  /// First dof that may not be eliminated: the entries of the rigid groups' rotations.
  int keptFrom() const { return solid_.dofCount() + D * static_cast<int>(groups_.size()); }
  /// Into what is eliminated and what is kept, as the scene enforces them.
  solver::SplitEquations split(const std::vector<solver::Equation>& list) const;
  /// How the rigid groups may turn, given what equations say of each one's rotation.
  /// @throws common::Error for what cannot be told
  std::vector<solver::Rotation> rotations(const std::vector<std::vector<solver::Equation>>& of_rotation) const;

 private:
  void addGroup(const std::string& name, int body, std::vector<int> nodes, std::vector<Eigen::Vector3d> axes);
  void findGroups();
  void makeCylinder(const ScenePin& pin);
  void moveRigidly(const RigidGroup& group, std::vector<solver::Equation>& list) const;
  std::vector<Weights> regionGroups(int body, const Box& region) const;
  std::vector<Weights> requireGroups(int body, const Box& region, const std::string& name) const;
  void hold(const SceneSupport& support, bool required, std::vector<solver::Equation>& list) const;
  void prescribe(const ScenePort& port, std::vector<solver::Equation>& list) const;
  /// Displacements of an axle along z, one per layer of nodes. @param heights  their z [m]; of a body without cells
  /// those that are wanted, or two if there are none
  std::vector<Weights> axleLines(int body, double x, double y, const std::string& name,
                                 std::vector<double>& heights) const;
  Weights sectionMean(const ScenePin& pin) const;
  void addPin(const ScenePin& pin, std::vector<solver::Equation>& list) const;
  void join(const SceneJoint& joint, const Weights& first, const Weights& second,
            std::vector<solver::Equation>& list) const;
  /// A place of the first body of a joint in the coordinates of the second.
  Point3 inSecond(const SceneJoint& joint, const Point3& x) const;
  void tieSegment(const SceneJoint& joint, std::vector<solver::Equation>& list) const;
  void tieFace(const SceneJoint& joint, std::vector<solver::Equation>& list) const;
  void addJoint(const SceneJoint& joint, std::vector<solver::Equation>& list) const;
  Eigen::VectorXd faceWeights(const SceneLoad& load) const;
  Weights loadWeights(const SceneLoad& load) const;
  int loadSize() const;

  const Scene& scene_;
  const SceneCells<D>& cells_;
  const mpm::Discretisation<D>& solid_;
  std::vector<RigidGroup> groups_;
};

}  // namespace snapwing::scene
