#include "snapwing/design/arm/mechanism.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>

#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"
#include "snapwing/mpm/strain.h"
#include "snapwing/solver/sensitivity.h"

namespace snapwing::design {

Mechanism::Mechanism(const scene::Scene& scene, int body, int threads)
    : compiled_(scene::compileScene(scene, threads)), body_(body) {
  if (compiled_->problem().constraints() != nullptr || compiled_->terms().coordinates().rotationCount() > 0) {
    throw common::Error("a scene with rigid bodies or cylinder pins cannot be designed");
  }
  rotation_ = scene::rotationMonitor(scene);
  compiled_->planar() ? build(*compiled_->planar(), scene) : build(*compiled_->volumetric(), scene);
}

Mechanism::~Mechanism() = default;

template <int D>
void Mechanism::build(const mpm::Discretisation<D>& solid, const scene::Scene& scene) {
  const mpm::Grid<D>& grid = solid.grid(body_);
  const scene::SceneBody& designed = scene.bodies[body_];
  if (std::abs(grid.origin(0)) > 1e-9 || std::abs(grid.origin(1)) > 1e-9) {
    throw common::Error("the designed body '" + designed.name + "' must have its lower corner at x = y = 0");
  }
  cell_size_ = grid.cell_size;
  cells_ = {grid.cells[0], grid.cells[1]};
  std::map<std::array<int, 2>, int> number;  // by rows, so that planar columns keep the order of cells
  for (int c = 0; c < solid.cellCount(); ++c) {
    if (solid.cellBody(c) == body_) number[{solid.cellAt(c)[1], solid.cellAt(c)[0]}] = 0;
  }
  for (auto& [place, column] : number) {
    column = columnCount();
    columns_.push_back({place[1], place[0]});
  }
  volumes_ = Eigen::VectorXd::Zero(columnCount());
  for (int c = 0; c < solid.cellCount(); ++c) {
    const mpm::Cell& cell = solid.cell(c);
    cell_densities_.push_back(cell.density);
    const bool mine = solid.cellBody(c) == body_;
    column_of_cell_.push_back(mine ? number[{solid.cellAt(c)[1], solid.cellAt(c)[0]}] : -1);
    if (!mine) continue;
    double filled = 0;
    for (const double w : solid.rule(solid.terms(cell.kind)[0].rule).weight) filled += w;
    volumes_(column_of_cell_[c]) += compiled_->multiplicity() * filled * cell.measure;
  }
  areas_ = volumes_;
  for (int k = 0; k < columnCount(); ++k) {
    const double thickness = designed.thicknessAt(centre(k)[0], centre(k)[1]);
    areas_(k) /= thickness > 0 ? thickness : volumes_.maxCoeff() / (cell_size_ * cell_size_);
  }
}

std::array<double, 2> Mechanism::centre(int column) const {
  return {(columns_[column][0] + 0.5) * cell_size_, (columns_[column][1] + 0.5) * cell_size_};
}

void Mechanism::setDensities(const Eigen::VectorXd& rho) {
  for (std::size_t c = 0; c < column_of_cell_.size(); ++c) {
    if (column_of_cell_[c] >= 0) cell_densities_[c] = rho(column_of_cell_[c]);
  }
  compiled_->setDensities(cell_densities_);
}

mpm::DensityField Mechanism::field(const Eigen::VectorXd& rho) const {
  mpm::DensityField field;
  field.cell_size = cell_size_;
  field.cells = cells_;
  field.value.assign(static_cast<std::size_t>(cells_[0]) * cells_[1], -1.0);
  for (int k = 0; k < columnCount(); ++k) {
    field.value[static_cast<std::size_t>(columns_[k][1]) * cells_[0] + columns_[k][0]] = rho(k);
  }
  return field;
}

Eigen::VectorXd Mechanism::columnsOf(const mpm::DensityField& field, double fallback) const {
  Eigen::VectorXd rho(columnCount());
  for (int k = 0; k < columnCount(); ++k) {
    const auto& [i, j] = columns_[k];
    rho(k) = field.present(i, j) ? field.at(i, j) : fallback;
  }
  return rho;
}

Eigen::VectorXd Mechanism::sumColumns(const Eigen::VectorXd& by_cell) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(columnCount());
  for (std::size_t c = 0; c < column_of_cell_.size(); ++c) {
    if (column_of_cell_[c] >= 0) sum(column_of_cell_[c]) += by_cell(static_cast<Eigen::Index>(c));
  }
  return sum;
}

Eigen::VectorXd Mechanism::forceByDensity(const solver::TangentSystem& system, const solver::Evaluation& at,
                                          const Eigen::VectorXd& slope) const {
  const solver::Sensitivity adjoint = sensitivity(system, at);
  return multiplicity() * sumColumns(adjoint.reaction(adjoint.tangent(slope)));
}

Mechanism::Sensed Mechanism::rotation(const solver::TangentSystem* system, const solver::Evaluation& at) const {
  if (!turns()) throw common::Error("the mechanism has no monitor of a rotation");
  Sensed result;
  Eigen::VectorXd slope;
  result.value = compiled_->monitor(rotation_, at.place.y, system ? &slope : nullptr);
  if (!system) return result;
  const solver::Sensitivity adjoint = sensitivity(*system, at);
  result.by_density = sumColumns(adjoint.displacement(adjoint.adjoint(slope)));
  return result;
}

Mechanism::Sensed Mechanism::potential(const solver::TangentSystem* system, const solver::Evaluation& at) const {
  Sensed result;
  result.value = multiplicity() * at.energy;
  if (!system) return result;
  result.by_density = multiplicity() * sumColumns(sensitivity(*system, at).potential());
  return result;
}

Mechanism::Strain Mechanism::strain(double power, const solver::TangentSystem* system,
                                    const solver::Evaluation& at) const {
  return compiled_->planar() ? strainOf(*compiled_->planar(), power, system, at)
                             : strainOf(*compiled_->volumetric(), power, system, at);
}

template <int D>
Mechanism::Strain Mechanism::strainOf(const mpm::Discretisation<D>& solid, double power,
                                      const solver::TangentSystem* system, const solver::Evaluation& at) const {
  Strain result;
  Eigen::VectorXd s = Eigen::VectorXd::Zero(solid.cellCount());
  std::vector<elasticity::Matrix<D>> turn(solid.cellCount());  // d stretch / dF
  for (int c = 0; c < solid.cellCount(); ++c) {
    if (column_of_cell_[c] < 0) continue;
    const Eigen::JacobiSVD<elasticity::Matrix<D>> svd(solid.deformationGradient(c, at.place.y),
                                                      Eigen::ComputeFullU | Eigen::ComputeFullV);
    s(c) = mpm::weightedStrain(solid.cell(c).density, svd.singularValues()(0));
    turn[c] = svd.matrixU().col(0) * svd.matrixV().col(0).transpose();
  }
  result.largest = s.maxCoeff();
  if (!(result.largest > 0)) {
    if (system) result.by_density = Eigen::VectorXd::Zero(columnCount());
    return result;
  }
  const Eigen::ArrayXd scaled = s.array() / result.largest;  // powers of it do not overflow
  const auto raised = [](const Eigen::ArrayXd& base, double exponent) -> Eigen::ArrayXd {
    return base.unaryExpr([exponent](double value) { return common::pow(value, exponent); });
  };
  result.value = result.largest * common::pow(raised(scaled, power).sum(), 1 / power);
  if (!system) return result;
  const Eigen::ArrayXd weight = raised(s.array() / result.value, power - 1);  // dS/ds
  Eigen::VectorXd functional = Eigen::VectorXd::Zero(solid.dofCount()),
                  direct = Eigen::VectorXd::Zero(solid.cellCount());
  Eigen::VectorXd value;
  Eigen::Matrix<double, D, Eigen::Dynamic> slope;
  solid.grid(body_).weights(mpm::Vector<D>::Constant(0.5), value, slope);
  for (int c = 0; c < solid.cellCount(); ++c) {
    if (!(s(c) > 0)) continue;
    const double rho = solid.cell(c).density;
    direct(c) = weight(c) * s(c) / (2 * rho);
    for (int a = 0; a < solid.stencil(); ++a) {
      functional.template segment<D>(D * solid.cellNodes(c)[a]) +=
          weight(c) * std::sqrt(rho) * (turn[c] * slope.col(a));
    }
  }
  const solver::Sensitivity adjoint = sensitivity(*system, at);
  result.by_density = sumColumns(direct + adjoint.displacement(adjoint.adjoint(functional)));
  return result;
}

}  // namespace snapwing::design
