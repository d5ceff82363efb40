#pragma once
/// Fills background grids with the bodies of a scene (internal to the layer).

#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include "scene_symmetry.h"
#include "snapwing/mpm/discretisation.h"
#include "snapwing/scene/scene.h"

namespace snapwing::scene {

/// Model of one scene in D dimensions: cells, and tests of what lies in a body.
template <int D>
class SceneCells {
 public:
  /// @param mirror  only what lies above its planes is built
  SceneCells(const Scene& scene, const Mirror& mirror);

  std::shared_ptr<mpm::Discretisation<D>> solid() const { return solid_; }
  const Mirror& mirror() const { return mirror_; }
  /// The whole is this many times what was built: by the mirror, and by the planes that the scene states.
  double multiplicity() const {
    return mirror_.multiplicity() * std::ldexp(1.0, static_cast<int>(scene_.symmetry.size()));
  }
  bool contains(int body, const mpm::Vector<D>& point) const;
  /// Calls visit(position [m], kernel values of the cell's nodes, volume [m3]) for all particles of a cell.
  template <class Visit>
  void eachParticle(int cell, const Visit& visit) const {
    const mpm::Grid<D>& grid = solid_->grid(solid_->cellBody(cell));
    const mpm::QuadratureRule<D>& rule = solid_->rule(cell_rule_[cell]);
    const mpm::Vector<D> low = grid.cellCentre(solid_->cellAt(cell)) - mpm::Vector<D>::Constant(0.5 * grid.cell_size);
    for (int p = 0; p < rule.size(); ++p) {
      const mpm::Vector<D> x = low + grid.cell_size * rule.local[p];
      visit(x, rule.valueOf(p), rule.weight[p] * solid_->cell(cell).measure);
    }
  }
  /// Number of each cell's quadrature rule, rigid bodies' too.
  const std::vector<int>& rules() const { return cell_rule_; }
  double droppedShare() const { return total_ > 0 ? dropped_ / total_ : 0; }
  /// Volume of the material that the cells hold, rho V summed, of what was built [m3].
  double volume() const { return volume_; }
  /// The same of the bodies themselves, whatever the cells are: by far finer samples, which costs up to seconds.
  double bodyVolume() const;

 private:
  mpm::Grid<D> makeGrid(int body) const;
  void addBody(int body);
  double fillCorrection(const SceneBody& body, const mpm::Vector<D>& centre, double sampled) const;
  int fillAround(int body, const mpm::Index<D>& at) const;
  double volumeOfSolid(int body) const;
  double volumeOfSlice(int body) const;
  double volumeOfDensity(int body) const;
  /// Terms of a kind of cell, and the rule of all its particles.
  struct Kind {
    int kind = 0, rule = 0;
  };
  void addFullKind(const mpm::Grid<D>& grid);
  Kind addKind(std::vector<mpm::Term> terms);
  Kind cutKind(const mpm::Grid<D>& grid, const std::vector<bool>& inside);
  std::vector<int> addModels(const SceneBody& body);
  bool reduced() const { return scene_.kernel == SceneKernel::LINEAR_REDUCED; }

  const Scene& scene_;
  Mirror mirror_;
  std::shared_ptr<mpm::Discretisation<D>> solid_;
  std::vector<mpm::DensityField> fields_;  ///< per body, on the scene's cells; empty for shapes
  std::vector<int> models_;                ///< of the body at work: whole, or shear and volume
  bool rigid_ = false;                     ///< the body at work stores no energy
  Kind full_kind_;
  std::map<std::vector<bool>, Kind> cut_kinds_;
  std::vector<int> cell_rule_;
  std::vector<mpm::Vector<D>> samples_;
  double total_ = 0, dropped_ = 0, volume_ = 0;
};

}  // namespace snapwing::scene
