#include "snapwing/statics/arm_problem.h"

#include <cmath>

#include "snapwing/common/error.h"
#include "snapwing/elasticity/neo_hookean.h"

namespace snapwing::statics {

namespace {

using mpm::Vector;

/// All cells that the design has, full, with the thickness of their region.
std::shared_ptr<mpm::Discretisation<2>> makeSolid(const vehicle::ArmSettings& arm, const elasticity::Material& material,
                                                  const mpm::DensityField& field, const ArmProblemSettings& settings) {
  auto solid = std::make_shared<mpm::Discretisation<2>>();
  mpm::Grid<2> grid;
  grid.cell_size = field.cell_size;
  grid.cells = field.cells;
  const int model =
      solid->addModel(std::make_shared<elasticity::NeoHookean<2>>(material, settings.interpolation, settings.plane));
  const int rule = solid->addRule(mpm::gaussRule<2>(grid, 2));
  const int kind = solid->addKind({{rule, model}});
  solid->addBody(grid);
  for (int j = 0; j < field.cells[1]; ++j) {
    for (int i = 0; i < field.cells[0]; ++i) {
      if (!field.present(i, j)) continue;
      const double x = (i + 0.5) * field.cell_size;
      const double thickness = x < arm.leg_width ? arm.leg_thickness : arm.bar_thickness;
      solid->addCell({i, j}, {kind, field.at(i, j), field.cell_size * field.cell_size * thickness});
    }
  }
  solid->finish();
  return solid;
}

std::vector<solver::Equation> makeEquations(const vehicle::ArmSettings& arm, const mpm::Discretisation<2>& solid) {
  std::vector<solver::Equation> equations;
  const double slack = 1e-6 * solid.grid(0).cell_size;
  for (int node = 0; node < solid.nodeCount(); ++node) {
    const Vector<2> x = solid.position(node);
    if (std::abs(x(0)) > slack || x(1) < arm.clamp_y_low - slack || x(1) > arm.clamp_y_high + slack) continue;
    equations.push_back({{{2 * node, 1.0}}, {}, 0, "housing"});
    equations.push_back({{{2 * node + 1, 1.0}}, {{0, -1.0}}, 0, "housing"});
  }
  if (equations.empty())
    throw common::Error("arm: no cell of the design meets the housing (clamp_y_low .. clamp_y_high)");
  const auto pin = solid.interpolate(0, Vector<2>(arm.pin_x, arm.pin_y));
  if (pin.empty()) throw common::Error("arm: the pin lies outside of the design (pin_x, pin_y)");
  for (int axis = 0; axis < 2; ++axis) {
    solver::Equation equation;
    for (const auto& [node, weight] : pin) equation.terms.emplace_back(2 * node + axis, weight);
    equation.name = "axle";
    equations.push_back(equation);
  }
  return equations;
}

}  // namespace

ArmProblem::ArmProblem(const vehicle::ArmSettings& arm, const elasticity::Material& material,
                       const mpm::DensityField& design, const ArmProblemSettings& settings)
    : arm_(arm), mass_density_(material.mass_density) {
  const bool same =
      settings.cell_size <= 0 || std::abs(settings.cell_size - design.cell_size) < 1e-9 * design.cell_size;
  field_ = same ? design : design.resampled(settings.cell_size);
  solid_ = makeSolid(arm, material, field_, settings);
  solver::Reduction reduction(solid_->dofCount(), 1, makeEquations(arm, *solid_));
  // Rounding of the deformation gradient times the modulus: no residual can be told from zero below that.
  const double modulus = material.lambda() + 2 * material.mu();
  const double floor = 1e-13 * modulus * field_.cell_size * arm.leg_thickness;
  problem_ = std::make_unique<solver::TermProblem>(solver::solidParts<2>(
      solid_, std::make_shared<const solver::Coordinates>(std::move(reduction), 2), settings.threads, floor));
}

void ArmProblem::setDensities(const std::vector<double>& densities) {
  solid_->setDensities(densities);
  for (int c = 0; c < solid_->cellCount(); ++c) {
    const mpm::Index<2>& at = solid_->cellAt(c);
    field_.value[static_cast<std::size_t>(at[1]) * field_.cells[0] + at[0]] = densities[c];
  }
}

Eigen::VectorXd ArmProblem::displacements(const Eigen::VectorXd& z, double travel) const {
  return problem_->coordinates().expand(z, Eigen::VectorXd::Constant(1, travel));
}

mpm::MovingMass ArmProblem::movingMass(const Eigen::VectorXd& slope) const {
  const Eigen::VectorXd rate = problem_->coordinates().linear().expandDirection(slope, Eigen::VectorXd::Ones(1));
  return mpm::movingMass<2>(*solid_, {mass_density_}, rate, Vector<2>(0, 1));
}

double ArmProblem::rotation(const Eigen::VectorXd& z, double travel) const {
  constexpr double REACH = 0.004;
  const Eigen::VectorXd u = displacements(z, travel);
  const mpm::Discretisation<2>& solid = *solid_;
  const Vector<2> pin(arm_.pin_x, arm_.pin_y);
  double sine = 0, cosine = 0;
  for (int node = 0; node < solid.nodeCount(); ++node) {
    const Vector<2> rest = solid.position(node) - pin;
    if (rest.norm() > REACH * (1 + 1e-9)) continue;
    const Vector<2> moved = rest + u.segment<2>(2 * node);
    sine += rest(0) * moved(1) - rest(1) * moved(0);
    cosine += rest.dot(moved);
  }
  return std::atan2(sine, cosine);
}

std::vector<std::vector<std::array<double, 2>>> ArmProblem::movedShapes(const Eigen::VectorXd& z, double travel) const {
  const Eigen::VectorXd u = displacements(z, travel);
  auto loops = restShapes();
  for (auto& loop : loops) {
    for (auto& point : loop) {
      const Vector<2> moved = solid_->displacementAt(0, Vector<2>(point[0], point[1]), u);
      point = {point[0] + moved(0), point[1] + moved(1)};
    }
  }
  return loops;
}

}  // namespace snapwing::statics
