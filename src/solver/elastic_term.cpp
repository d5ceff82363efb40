#include "snapwing/solver/elastic_term.h"

#include <sstream>

#include "snapwing/mpm/solid_series.h"

namespace snapwing::solver {

template <int D>
void ElasticTerm<D>::evaluate(const Point& at, Order order, Sum& sum) const {
  mpm::Assembly& own = sum.solids[region_];
  const bool only = first_ == 0 && region_ == 0, tangent = elasticity::withTangent(order);
  // A single region's blocks are summed where they are wanted.
  own.add_blocks = only && tangent;
  if (own.add_blocks) own.blocks.swap(sum.hessian);
  // Coordinates behind the solid's own do no harm to the cells, which find theirs by number.
  if (first_ == 0) {
    solid_->assemble(at.y, order, at.threads, own);
  } else {
    solid_->assemble(at.y.segment(first_, solid_->dofCount()), order, at.threads, own);
  }
  if (own.add_blocks) own.blocks.swap(sum.hessian);
  sum.energy += own.energy;
  sum.stored += own.energy;
  sum.noteForce(own.force_scale);
  sum.finite = sum.finite && own.finite;
  if (own.min_det_f < sum.min_det_f || std::isnan(own.min_det_f)) {
    sum.min_det_f = own.min_det_f;
    sum.min_det_f_cell = own.min_det_f_cell;
    sum.worst = this;
  }
  if (order == Order::ENERGY || !own.finite) return;
  sum.gradient.segment(first_, solid_->dofCount()) += own.gradient;
  if (tangent && !only) {
    double* values = sum.hessian.data() + sum.region_place[region_];
    for (std::size_t k = 0; k < own.blocks.size(); ++k) values[k] += own.blocks[k];
  }
}

namespace {

template <int D>
class ElasticSeries : public ForceSeries {
 public:
  ElasticSeries(std::shared_ptr<const mpm::Discretisation<D>> solid, int first, int order)
      : solid_(std::move(solid)), first_(first), series_(*solid_, order) {}
  void start(const Eigen::VectorXd& y) override { series_.start(y.segment(first_, solid_->dofCount())); }
  double bytes() const { return series_.bytes(); }
  void advance(int k, const Eigen::VectorXd& y, Eigen::VectorXd& force) override {
    own_.setZero(solid_->dofCount());
    series_.advance(k, y.segment(first_, solid_->dofCount()), own_);
    force.segment(first_, solid_->dofCount()) += own_;
  }

 private:
  std::shared_ptr<const mpm::Discretisation<D>> solid_;
  int first_;
  mpm::SolidSeries<D> series_;
  Eigen::VectorXd own_;
};

}  // namespace

template <int D>
std::unique_ptr<ForceSeries> ElasticTerm<D>::series(int order) const {
  constexpr double LARGEST = 2e9;  // [bytes] that a user will not miss
  if (!mpm::SolidSeries<D>::possible(*solid_)) return nullptr;
  auto series = std::make_unique<ElasticSeries<D>>(solid_, first_, order);
  if (series->bytes() > LARGEST) return nullptr;
  return series;
}

template <int D>
void ElasticTerm<D>::densityDerivative(const Point& at, const Eigen::VectorXd* v, Eigen::VectorXd& by_cell) const {
  const int dofs = solid_->dofCount();
  const Eigen::VectorXd along = v != nullptr ? Eigen::VectorXd(v->segment(first_, dofs)) : Eigen::VectorXd();
  by_cell += solid_->densityDerivative(at.y.segment(first_, dofs), along);
}

template <int D>
std::string ElasticTerm<D>::describe(int cell) const {
  const int body = solid_->cellBody(cell);
  const auto centre = solid_->grid(body).cellCentre(solid_->cellAt(cell));
  std::ostringstream text;
  text << "cell " << cell << " of body " << body << " at (" << centre.transpose() << ") m";
  return text.str();
}

template class ElasticTerm<2>;
template class ElasticTerm<3>;

}  // namespace snapwing::solver
