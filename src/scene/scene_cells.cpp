#include "scene_cells.h"

#include <algorithm>
#include <cmath>

#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/elasticity/neo_hookean.h"

namespace snapwing::scene {

using elasticity::Part;
using mpm::Vector;

template <int D>
SceneCells<D>::SceneCells(const Scene& scene, const Mirror& mirror)
    : scene_(scene), mirror_(mirror), solid_(std::make_shared<mpm::Discretisation<D>>()) {
  const int n = scene.particles;
  int count = 1;
  for (int a = 0; a < D; ++a) count *= n;
  for (int s = 0; s < count; ++s) {
    Vector<D> local;
    for (int a = 0, rest = s; a < D; ++a, rest /= n) local(a) = (rest % n + 0.5) / n;
    samples_.push_back(local);
  }
  for (const SceneBody& body : scene.bodies) {
    fields_.push_back(body.density.value.empty() ? mpm::DensityField() : body.density.resampled(scene.cell_size));
  }
  for (int body = 0; body < static_cast<int>(scene.bodies.size()); ++body) addBody(body);
  solid_->finish();
}

template <int D>
bool SceneCells<D>::contains(int body, const Vector<D>& point) const {
  const SceneBody& b = scene_.bodies[body];
  Point3 p = Point3::Zero();
  p.head<D>() = point;
  const mpm::DensityField& field = fields_[body];
  if (!field.value.empty()) {
    const int i = static_cast<int>(std::floor(p(0) / field.cell_size)),
              j = static_cast<int>(std::floor(p(1) / field.cell_size));
    if (!field.present(i, j)) return false;
    // The region of a cell's thickness is that of its centre, so that no cell has a step in it.
    p(0) = (i + 0.5) * field.cell_size;
    p(1) = (j + 0.5) * field.cell_size;
  } else if (!b.shape->contains(p)) {
    return false;
  }
  return D == 2 || !b.extruded || std::abs(p(2)) <= 0.5 * b.thicknessAt(p(0), p(1)) * (1 + 1e-12);
}

template <int D>
mpm::Grid<D> SceneCells<D>::makeGrid(int number) const {
  const SceneBody& body = scene_.bodies[number];
  Box box;
  if (!body.hasCells()) {
    box.low = body.given.centre - Point3::Constant(0.5 * scene_.cell_size);
    box.high = body.given.centre + Point3::Constant(0.5 * scene_.cell_size);
  } else if (body.shape) {
    box = body.shape->bounds();
  } else {
    box.low.head<2>().setZero();
    for (int a = 0; a < 2; ++a) box.high(a) = fields_[number].cells[a] * fields_[number].cell_size;
  }
  if (body.extruded) {
    double thickest = body.thickness;
    for (const auto& [region, value] : body.thickness_in) thickest = std::max(thickest, value);
    box.high(2) = 0.5 * thickest;
    box.low(2) = -box.high(2);
  }
  for (int a = 0; a < D; ++a) {
    if (mirror_.has(a)) box.low(a) = mirror_.at[a];
  }
  mpm::Grid<D> grid;
  grid.kernel = scene_.kernel == SceneKernel::QUADRATIC ? mpm::Kernel::QUADRATIC : mpm::Kernel::LINEAR;
  grid.cell_size = scene_.cell_size;
  double count = 1;
  for (int a = 0; a < D; ++a) {
    grid.origin(a) = box.low(a);
    const double cells = std::ceil((box.high(a) - box.low(a)) / scene_.cell_size - 1e-6);
    count *= cells;
    if (!(count >= 1 && count <= 3e7)) {
      throw common::Error("body '" + body.name + "' would take " + common::toText(count) +
                          " background cells; allowed: 1 .. 3e7 (cell_size too small, or shape empty)");
    }
    grid.cells[a] = static_cast<int>(cells);
  }
  return grid;
}

template <int D>
std::vector<int> SceneCells<D>::addModels(const SceneBody& body) {
  const auto add = [&](Part part) {
    return solid_->addModel(
        std::make_shared<elasticity::NeoHookean<D>>(body.material, scene_.interpolation, scene_.plane, part));
  };
  if (reduced()) return {add(Part::SHEAR), add(Part::VOLUME)};
  return {add(Part::ALL)};
}

template <int D>
void SceneCells<D>::addFullKind(const mpm::Grid<D>& grid) {
  // Quadratic cells need three points per axis in the plane; in space two serve, at a third of the cost.
  const int points = scene_.kernel == SceneKernel::QUADRATIC && D == 2 ? 3 : 2;
  std::vector<mpm::Term> terms = {{solid_->addRule(mpm::gaussRule<D>(grid, points)), models_[0]}};
  if (reduced()) terms.push_back({solid_->addRule(mpm::gaussRule<D>(grid, 1)), models_[1]});
  full_kind_ = addKind(terms);
}

template <int D>
typename SceneCells<D>::Kind SceneCells<D>::addKind(std::vector<mpm::Term> terms) {
  const int rule = terms[0].rule;
  if (rigid_) terms.clear();
  return {solid_->addKind(terms), rule};
}

template <int D>
typename SceneCells<D>::Kind SceneCells<D>::cutKind(const mpm::Grid<D>& grid, const std::vector<bool>& inside) {
  const auto found = cut_kinds_.find(inside);
  if (found != cut_kinds_.end()) return found->second;
  std::vector<Vector<D>> local;
  Vector<D> centroid = Vector<D>::Zero();
  for (std::size_t s = 0; s < samples_.size(); ++s) {
    if (!inside[s]) continue;
    local.push_back(samples_[s]);
    centroid += samples_[s];
  }
  const double share = 1.0 / static_cast<double>(samples_.size());
  std::vector<mpm::Term> terms = {
      {solid_->addRule(mpm::makeRule<D>(grid, local, std::vector<double>(local.size(), share))), models_[0]}};
  if (reduced()) {
    centroid /= static_cast<double>(local.size());
    terms.push_back(
        {solid_->addRule(mpm::makeRule<D>(grid, {centroid}, {share * static_cast<double>(local.size())})), models_[1]});
  }
  return cut_kinds_[inside] = addKind(terms);
}

/// Filled share of a cell over that of its samples, where it is known: along z for extrusions, along all axes for
/// boxes. Samples know a length to a part of a cell only: 5 mm would else be 5.33 mm of 2 mm cells with three samples.
template <int D>
double SceneCells<D>::fillCorrection(const SceneBody& body, const Vector<D>& centre, double sampled) const {
  const double h = scene_.cell_size;
  const double thickness = body.thicknessAt(centre(0), centre(1));
  for (const int corner : {0, 1, 2, 3}) {
    // Of a cell with a step of the thickness in it only the samples know.
    const double x = centre(0) + (corner % 2 == 0 ? -0.499 : 0.499) * h,
                 y = centre(1) + (corner < 2 ? -0.499 : 0.499) * h;
    if (body.shape && body.thicknessAt(x, y) != thickness) return 1;
  }
  const auto filled = [&](int axis, double low, double high) {
    const double start = centre(axis) - 0.5 * h;
    return std::max(0.0, (std::min(start + h, high) - std::max(start, low)) / h);
  };
  const auto ratio = [](double exact, double share) {
    return share > 0 && exact > 0 && std::abs(exact - share) > 1e-9 ? exact / share : 1.0;
  };
  const double half = 0.5 * thickness;
  const Box* box = body.shape ? body.shape->asBox() : nullptr;
  const bool half_bounded =
      box != nullptr && body.extruded && (std::isfinite(box->low(2)) || std::isfinite(box->high(2)));
  if (box != nullptr && !half_bounded) {
    double share = 1;
    for (int a = 0; a < D; ++a) {
      const bool across = a == 2 && body.extruded;
      share *= across ? filled(a, -half, half) : filled(a, box->low(a), box->high(a));
    }
    return ratio(share, sampled);
  }
  if (D == 2 || !body.extruded) return 1;
  int layers = 0;
  for (int k = 0; k < scene_.particles; ++k) {
    const double z = centre(D - 1) - 0.5 * h + h * (k + 0.5) / scene_.particles;
    layers += std::abs(z) <= half * (1 + 1e-12) ? 1 : 0;
  }
  return ratio(filled(D - 1, -half, half), static_cast<double>(layers) / scene_.particles);
}

template <int D>
void SceneCells<D>::addBody(int number) {
  const SceneBody& body = scene_.bodies[number];
  const mpm::Grid<D> grid = makeGrid(number);
  rigid_ = body.rigid;
  models_ = addModels(body);
  cut_kinds_.clear();
  addFullKind(grid);
  solid_->addBody(grid);
  if (!body.hasCells()) return;
  const double cell_volume = common::pow(grid.cell_size, D);
  std::vector<bool> inside(samples_.size());
  int added = 0;
  for (int c = 0; c < grid.cellCount(); ++c) {
    const mpm::Index<D> at = grid.cellIndex(c);
    const Vector<D> low = grid.cellCentre(at) - Vector<D>::Constant(0.5 * grid.cell_size);
    int count = 0;
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      inside[s] = contains(number, low + grid.cell_size * samples_[s]);
      count += inside[s] ? 1 : 0;
    }
    if (count == 0) continue;
    const double fraction = static_cast<double>(count) / static_cast<double>(samples_.size());
    const Vector<D> centre = grid.cellCentre(at);
    const double measure =
        cell_volume * fillCorrection(body, centre, fraction) * (D == 2 ? body.thicknessAt(centre(0), centre(1)) : 1.0);
    total_ += fraction * measure;
    if (fraction < scene_.smallest_fraction) {
      dropped_ += fraction * measure;
      continue;
    }
    const bool full = count == static_cast<int>(samples_.size());
    const double density = fields_[number].value.empty() ? 1.0 : fields_[number].at(at[0], at[1]);
    const Kind kind = full ? full_kind_ : cutKind(grid, inside);
    solid_->addCell(at, {kind.kind, density, measure});
    volume_ += density * fraction * measure;
    cell_rule_.push_back(kind.rule);
    ++added;
  }
  if (added == 0)
    throw common::Error("body '" + body.name + "' fills no cell: cell_size is too large or the shape is empty");
}

template class SceneCells<2>;
template class SceneCells<3>;

}  // namespace snapwing::scene
