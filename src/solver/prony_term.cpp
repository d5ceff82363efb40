#include "snapwing/solver/prony_term.h"

#include "snapwing/common/error.h"

namespace snapwing::solver {

using elasticity::Matrix;
using elasticity::RelaxationStep;

namespace {

template <int D>
Matrix<D> unpack(const double* c) {
  Matrix<D> q;
  for (int i = 0; i < D; ++i) q(i, i) = c[i];
  for (int i = 0; i < D - 1; ++i) q(i, i + 1) = q(i + 1, i) = c[D + i];
  if constexpr (D == 3) q(0, 2) = q(2, 0) = c[5];
  return q;
}

template <int D>
void pack(const Matrix<D>& q, double* c) {
  for (int i = 0; i < D; ++i) c[i] = q(i, i);
  for (int i = 0; i < D - 1; ++i) c[D + i] = q(i, i + 1);
  if constexpr (D == 3) c[5] = q(0, 2);
}

}  // namespace

template <int D>
struct PronyTerm<D>::Start : Memory {
  std::vector<Matrix<D>> green;
  Eigen::VectorXd history;
};

template <int D>
PronyTerm<D>::PronyTerm(std::shared_ptr<const mpm::Discretisation<D>> solid, elasticity::PronySeries series, int region,
                        int first)
    : particles_(std::move(solid), region, first), series_(std::move(series)) {
  series_.validate();
}

template <int D>
int PronyTerm<D>::historyCount() const {
  return place(particles_.count(), 0);
}

template <int D>
std::shared_ptr<const Memory> PronyTerm<D>::keepWith(const Point& start, const Eigen::VectorXd& history) const {
  if (history.size() != historyCount()) {
    throw common::Error("memory of the material has " + std::to_string(history.size()) +
                        " values; allowed: " + std::to_string(historyCount()));
  }
  auto kept = std::make_shared<Start>();
  kept->history = history;
  kept->green.reserve(particles_.count());
  particles_.each([&](const auto& p) { kept->green.push_back(particles_.strain(start.y, p)); });
  return kept;
}

template <int D>
void PronyTerm<D>::evaluate(const Point& at, Order order, Sum& sum) const {
  if (at.step == nullptr || at.kept == nullptr) return;
  const auto& start = *static_cast<const Start*>(at.kept);
  const Step& step = *at.step;
  std::vector<std::pair<double, double>> path = step.path;
  if (path.empty()) path = {{1.0, 1.0}};
  Eigen::VectorXd past(branches());
  for (const auto& [share, weight] : path) {
    double now = 0;
    for (int k = 0; k < branches(); ++k) {
      const double x = step.h / series_.branches[k].time, w = weightOf(k);
      if (step.path.size() == 1) {
        const RelaxationStep whole(x);
        past(k) = w * whole.mean;
        now += w * whole.ramp / share;
      } else {
        const RelaxationStep until(share * x);
        past(k) = w * until.decay;
        now += w * until.mean;
      }
    }
    evaluateAt(share == 1 ? at.y : Eigen::VectorXd(step.y0 + share * (at.y - step.y0)), start, share, weight, past, now,
               order, sum);
  }
}

template <int D>
void PronyTerm<D>::evaluateAt(const Eigen::VectorXd& y, const Start& start, double share, double weight,
                              const Eigen::VectorXd& past, double now, Order order, Sum& sum) const {
  auto target = particles_.target(order, sum);
  particles_.each([&](const auto& p) {
    Eigen::Matrix<double, COMPONENTS, 1> held = Eigen::Matrix<double, COMPONENTS, 1>::Zero();
    for (int k = 0; k < branches(); ++k) {
      held += past(k) * start.history.template segment<COMPONENTS>(place(p.number, k));
    }
    const Matrix<D> h = particles_.gradient(y, p);
    const Matrix<D> d = elasticity::greenStrain<D>(h) - start.green[p.number];
    const Matrix<D> before = p.moduli->stress(unpack<D>(held.data())), grown = now * p.moduli->stress(d);
    const double volume = weight * p.measure;
    sum.energy += volume / share * (before.cwiseProduct(d).sum() + 0.5 * grown.cwiseProduct(d).sum());
    particles_.add(p, h, before + grown, now, volume, volume * share, target);
  });
  if (order != Order::ENERGY) target.finish();
}

template <int D>
HistoryTerm::Passed PronyTerm<D>::pass(const Point& end) const {
  const auto& start = *static_cast<const Start*>(end.kept);
  std::vector<RelaxationStep> steps;
  for (const auto& branch : series_.branches) steps.emplace_back(end.step->h / branch.time);
  Passed out;
  out.history.resize(historyCount());
  particles_.each([&](const auto& p) {
    const Matrix<D> d = particles_.strain(end.y, p) - start.green[p.number], stress = p.moduli->stress(d);
    const double square = stress.cwiseProduct(d).sum();
    for (int k = 0; k < branches(); ++k) {
      const RelaxationStep& step = steps[k];
      const int at = place(p.number, k);
      const Matrix<D> q = unpack<D>(start.history.data() + at);
      pack<D>(step.decay * q + step.mean * d, out.history.data() + at);
      out.loss += weightOf(k) * p.measure *
                  (step.first * p.moduli->stress(q).cwiseProduct(q).sum() +
                   2 * step.mixed * stress.cwiseProduct(q).sum() + step.last * square);
    }
  });
  out.stored = storedIn(out.history);
  return out;
}

template <int D>
double PronyTerm<D>::storedIn(const Eigen::VectorXd& history) const {
  double energy = 0;
  particles_.each([&](const auto& p) {
    for (int k = 0; k < branches(); ++k) {
      const Matrix<D> q = unpack<D>(history.data() + place(p.number, k));
      energy += 0.5 * weightOf(k) * p.measure * p.moduli->stress(q).cwiseProduct(q).sum();
    }
  });
  return energy;
}

template class PronyTerm<2>;
template class PronyTerm<3>;

}  // namespace snapwing::solver
