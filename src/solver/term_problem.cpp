#include "snapwing/solver/term_problem.h"

#include "snapwing/common/error.h"
#include "snapwing/solver/elastic_term.h"

namespace snapwing::solver {

namespace {

std::vector<int> addCouples(const Term& term, HessianLayout& layout) {
  if (term.region() >= layout.regionCount()) {
    throw common::Error("term '" + term.name() + "' writes to region " + std::to_string(term.region()) +
                        "; allowed: -1 (none) .. " + std::to_string(layout.regionCount() - 1));
  }
  std::vector<int> places;
  for (const std::vector<int>& couple : term.couples()) places.push_back(layout.addCouple(couple));
  return places;
}

std::shared_ptr<const Constraints> onFree(const Constraints* constraints, const Coordinates& coordinates) {
  if (constraints == nullptr || constraints->count() == 0) return nullptr;
  const LinearRows& own = constraints->linear();
  if (own.rows.cols() != coordinates.fullCount() || own.control.cols() != coordinates.controlCount()) {
    throw common::Error("constraints have " + std::to_string(own.rows.cols()) + " coordinates and " +
                        std::to_string(own.control.cols()) + " controls; allowed: " +
                        std::to_string(coordinates.fullCount()) + " and " + std::to_string(coordinates.controlCount()));
  }
  return std::make_shared<const Constraints>(constraints->onFree(coordinates.linear()));
}

/// The point as the k-th term sees it.
Point pointOf(Point at, std::size_t k) {
  if (at.step != nullptr && !at.step->kept.empty()) at.kept = at.step->kept[k].get();
  return at;
}

}  // namespace

HessianLayout TermProblem::wholeLayout() {
  HessianLayout layout = parts_.layout;
  for (const auto& term : parts_.terms) couples_.push_back(addCouples(*term, layout));
  if (constraint_) couples_.push_back(addCouples(*constraint_, layout));
  return layout;
}

TermProblem::TermProblem(Parts parts)
    : parts_(std::move(parts)),
      coordinates_(parts_.coordinates),
      constraints_(onFree(parts_.constraints.get(), *coordinates_)),
      constraint_(constraints_ ? std::make_unique<const ConstraintTerm>(constraints_) : nullptr),
      layout_(wholeLayout()),
      pull_back_(coordinates_, layout_) {
  if (constraints_ && coordinates_->rotationCount() == 0) {
    constant_rows_ = std::make_shared<const ConstraintRows>(
        coordinates_->pullBack(Coordinates::Place(), constraints_->linear().rows));
  }
  if (layout_.fullCount() != coordinates_->fullCount()) {
    throw common::Error("the layout has " + std::to_string(layout_.fullCount()) + " coordinates; allowed: " +
                        std::to_string(coordinates_->fullCount()) + ", as the problem's coordinates");
  }
}

void TermProblem::sumTerms(const Point& at, Order order, Sum& sum) const {
  for (std::size_t k = 0; k < parts_.terms.size(); ++k) {
    const Term& term = *parts_.terms[k];
    if (at.step != nullptr && !at.step->path.empty() && term.role() == Term::Role::STORED) continue;
    sum.couples = &couples_[k];
    term.evaluate(pointOf(at, k), order, sum);
  }
  if (!constraint_) return;
  sum.couples = &couples_.back();
  constraint_->evaluate(at, order, sum);
}

/// Sum over the path's points of w (E(y0 + s d) - E(y0)) / s, whose slope is w g and whose second derivative w s H.
void TermProblem::averageStored(const Point& at, const StepContext& context, Order order, Evaluation& out) const {
  Sum& sum = out.sum;
  out.along.resize(1);
  Sum& along = out.along.front();
  const Eigen::VectorXd d = at.y - at.step->y0;
  for (const auto& [share, weight] : at.step->path) {
    const Eigen::VectorXd y = at.step->y0 + share * d;
    along.reset(layout_, controlCount(), order);
    for (std::size_t k = 0; k < parts_.terms.size(); ++k) {
      if (parts_.terms[k]->role() != Term::Role::STORED) continue;
      along.couples = &couples_[k];
      parts_.terms[k]->evaluate(pointOf({y, at.p, at.step, at.threads}, k), order, along);
    }
    const double energy = weight * (along.stored - context.stored_at_start) / share;
    sum.energy += energy;
    sum.stored += energy;
    sum.noteForce(along.force);
    sum.noteRounding(along.rounding);
    sum.finite = sum.finite && along.finite;
    if (along.min_det_f < sum.min_det_f) {
      sum.min_det_f = along.min_det_f;
      sum.min_det_f_cell = along.min_det_f_cell;
      sum.worst = along.worst;
    }
    if (order == Order::ENERGY || !along.finite) continue;
    sum.gradient += weight * along.gradient;
    sum.control += weight * along.control;
    if (!elasticity::withTangent(order)) continue;
    for (std::size_t k = 0; k < sum.hessian.size(); ++k) sum.hessian[k] += weight * share * along.hessian[k];
  }
}

void TermProblem::evaluateAt(const Eigen::VectorXd& z, const Eigen::VectorXd& p, const References* references,
                             const StepContext* context, Order order, Evaluation& out,
                             const Eigen::VectorXd* multipliers) const {
  coordinates_->at(z, p, references, out.place);
  const Step* step = context != nullptr ? &context->step : nullptr;
  Point point{out.place.y, p, step, parts_.threads};
  point.multipliers = multipliers;
  out.control = p;
  out.step = step;
  Sum& sum = out.sum;
  sum.reset(layout_, controlCount(), order);
  if (step != nullptr && !step->path.empty()) averageStored(point, *context, order, out);
  sumTerms(point, order, sum);
  out.finite = sum.finite;
  out.energy = sum.energy;
  out.elastic_energy = sum.stored;
  out.force_scale = sum.force;
  out.rounding = sum.rounding;
  out.min_det_f = sum.min_det_f;
  out.min_det_f_cell = sum.min_det_f_cell;
  if (constraints_) out.constraint_residual = constraints_->residual(out.place.y, p);
  if (order == Order::ENERGY || !out.finite) return;
  const bool mean = context != nullptr && context->mean_with != nullptr;
  out.potential = !mean || coordinates_->rotationCount() == 0;
  out.residual = mean ? coordinates_->pullBackMean(*context->mean_with, out.place, sum.gradient)
                      : coordinates_->pullBack(out.place, sum.gradient);
  out.control_force = coordinates_->toControls(sum.gradient);
  out.control_force += sum.control;
  if (!elasticity::withTangent(order)) return;
  if (constraints_) {
    out.rows =
        constant_rows_
            ? constant_rows_
            : std::make_shared<const ConstraintRows>(coordinates_->pullBack(out.place, constraints_->linear().rows));
  }
  pull_back_.apply(sum.hessian, out.place, sum.gradient, order == Order::PROJECTED, out.hessian);
}

namespace {

template <int D>
void addRotations(const ElasticTerm<D>& term, const Coordinates& coordinates, const Eigen::VectorXd& y,
                  std::vector<NodeRotation>& nodes) {
  const mpm::Discretisation<D>& solid = term.solid();
  const auto rotations = solid.nodeRotations(y.segment(term.first(), solid.dofCount()));
  for (int n = 0; n < solid.nodeCount(); ++n) {
    NodeRotation node{{-1, -1, -1}, Eigen::Matrix3d::Identity()};
    for (int a = 0; a < D; ++a) node.free[a] = coordinates.freeOf(term.first() + D * n + a);
    node.rotation.topLeftCorner<D, D>() = rotations[n];
    nodes.push_back(node);
  }
}

}  // namespace

std::vector<NodeRotation> TermProblem::nodeRotations(const Evaluation& at) const {
  std::vector<NodeRotation> nodes;
  for (const auto& term : parts_.terms) {
    if (const auto* planar = dynamic_cast<const ElasticTerm<2>*>(term.get())) {
      addRotations(*planar, *coordinates_, at.place.y, nodes);
    } else if (const auto* solid = dynamic_cast<const ElasticTerm<3>*>(term.get())) {
      addRotations(*solid, *coordinates_, at.place.y, nodes);
    }
  }
  return nodes;
}

namespace {

/// Along linear coordinates, y = T z + B p + c.
class TermSeries : public ResidualSeries {
 public:
  TermSeries(std::shared_ptr<const Coordinates> coordinates, std::vector<std::unique_ptr<ForceSeries>> terms)
      : coordinates_(std::move(coordinates)), terms_(std::move(terms)) {}
  void start(const Eigen::VectorXd& z, const Eigen::VectorXd& p) override {
    const Eigen::VectorXd y = coordinates_->expand(z, p);
    for (const auto& term : terms_) term->start(y);
  }
  Eigen::VectorXd advance(int k, const Eigen::VectorXd& z, const Eigen::VectorXd& p) override {
    const Eigen::VectorXd y = coordinates_->linear().expandDirection(z, p);
    Eigen::VectorXd force = Eigen::VectorXd::Zero(y.size());
    for (const auto& term : terms_) term->advance(k, y, force);
    return coordinates_->linear().restrictToFree(force);
  }

 private:
  std::shared_ptr<const Coordinates> coordinates_;
  std::vector<std::unique_ptr<ForceSeries>> terms_;
};

}  // namespace

std::unique_ptr<ResidualSeries> TermProblem::series(int order, std::string& why) const {
  if (constraints_ != nullptr) why = "constraints kept as equations";
  if (coordinates_->rotationCount() > 0) why = "a rigid body that turns";
  std::vector<std::unique_ptr<ForceSeries>> terms;
  for (const auto& term : parts_.terms) {
    if (!why.empty()) break;
    if (term->linearInStatics()) continue;
    terms.push_back(term->series(order));
    if (terms.back() == nullptr) why = "the term '" + term->name() + "'";
  }
  if (!why.empty()) return nullptr;
  return std::make_unique<TermSeries>(coordinates_, std::move(terms));
}

void TermProblem::controlTangent(const Evaluation& at, const Eigen::VectorXd& dp, Eigen::VectorXd& free_part,
                                 Eigen::VectorXd& control_part) const {
  const Eigen::VectorXd dy = coordinates_->push(at.place, Eigen::VectorXd::Zero(freeCount()), dp);
  Eigen::VectorXd by_y = layout_.multiply(at.sum.hessian, dy);
  Eigen::VectorXd by_p = Eigen::VectorXd::Zero(controlCount());
  for (const auto& term : parts_.terms) {
    term->controlTangent({at.place.y, at.control, at.step, parts_.threads}, dy, dp, by_y, by_p);
  }
  if (constraint_) constraint_->controlTangent({at.place.y, at.control}, dy, dp, by_y, by_p);
  free_part = coordinates_->pullBack(at.place, by_y);
  control_part = coordinates_->toControls(by_y);
  control_part += by_p;
}

std::string TermProblem::describeCell(int cell) const {
  if (cell < 0) return "no cell";
  for (const auto& term : parts_.terms) {
    if (term->region() >= 0 && term->role() == Term::Role::STORED) return term->describe(cell);
  }
  return "place " + std::to_string(cell);
}

std::vector<std::shared_ptr<const Memory>> TermProblem::keep(const Eigen::VectorXd& y, const Eigen::VectorXd& p) const {
  std::vector<std::shared_ptr<const Memory>> kept;
  bool any = false;
  for (const auto& term : parts_.terms) {
    kept.push_back(term->keep({y, p, nullptr, parts_.threads}));
    any = any || kept.back() != nullptr;
  }
  if (!any) kept.clear();
  return kept;
}

void TermProblem::evaluateTerm(std::size_t term, const Point& at, Order order, Sum& sum) const {
  sum.reset(layout_, controlCount(), order);
  sum.couples = &couples_[term];
  parts_.terms[term]->evaluate(pointOf(at, term), order, sum);
}

std::shared_ptr<const TermProblem> TermProblem::with(const std::vector<std::shared_ptr<const Term>>& more) const {
  Parts parts = parts_;
  parts.terms.insert(parts.terms.end(), more.begin(), more.end());
  return std::make_shared<const TermProblem>(std::move(parts));
}

Eigen::VectorXd TermProblem::densityDerivative(const Evaluation& at, const Eigen::VectorXd* v, int cells) const {
  Eigen::VectorXd by_cell = Eigen::VectorXd::Zero(cells);
  for (const auto& term : parts_.terms) {
    term->densityDerivative({at.place.y, at.control, at.step, parts_.threads}, v, by_cell);
  }
  return by_cell;
}

template <int D>
TermProblem::Parts solidParts(std::shared_ptr<const mpm::Discretisation<D>> solid,
                              std::shared_ptr<const Coordinates> coordinates, int threads, double force_floor) {
  HessianLayout layout(coordinates->fullCount());
  layout.addRegion(0, solid->pattern());
  TermProblem::Parts parts{std::move(layout), std::move(coordinates), {}, threads, force_floor, 0, nullptr};
  parts.terms.push_back(std::make_shared<const ElasticTerm<D>>(std::move(solid)));
  return parts;
}

template TermProblem::Parts solidParts(std::shared_ptr<const mpm::Discretisation<2>>,
                                       std::shared_ptr<const Coordinates>, int, double);
template TermProblem::Parts solidParts(std::shared_ptr<const mpm::Discretisation<3>>,
                                       std::shared_ptr<const Coordinates>, int, double);

}  // namespace snapwing::solver
