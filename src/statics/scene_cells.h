#pragma once
/// Fills background grids with the bodies of a scene (internal to the statics floor).

#include <map>
#include <memory>
#include <vector>

#include "snapwing/mpm/discretisation.h"
#include "snapwing/statics/scene.h"

namespace snapwing::statics {

/// Model of one scene in D dimensions: cells, and tests of what lies in a body.
template <int D>
class SceneCells {
 public:
  /// @param half  volumetric and symmetric about z = 0: only z >= 0 is built
  SceneCells(const Scene& scene, bool half);

  std::shared_ptr<mpm::Discretisation<D>> solid() const { return solid_; }
  bool contains(int body, const mpm::Vector<D>& point) const;
  double droppedShare() const { return total_ > 0 ? dropped_ / total_ : 0; }

 private:
  mpm::Grid<D> makeGrid(int body) const;
  void addBody(int body);
  void addFullKind(const mpm::Grid<D>& grid);
  int cutKind(const mpm::Grid<D>& grid, const std::vector<bool>& inside);
  std::vector<int> addModels(const SceneBody& body);
  bool reduced() const { return scene_.kernel == SceneKernel::LINEAR_REDUCED; }

  const Scene& scene_;
  bool half_;
  std::shared_ptr<mpm::Discretisation<D>> solid_;
  std::vector<mpm::DensityField> fields_;  ///< per body, on the scene's cells; empty for shapes
  std::vector<int> models_;                ///< of the body at work: whole, or shear and volume
  int full_kind_ = 0;
  std::map<std::vector<bool>, int> cut_kinds_;
  std::vector<mpm::Vector<D>> samples_;
  double total_ = 0, dropped_ = 0;
};

}  // namespace snapwing::statics
