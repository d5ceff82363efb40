// Newton on the saddle point, the augmented Lagrangian beside it, and derivatives through the solved equilibrium.
#include "snapwing/design/wing/linkage_elastic.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <sstream>

#include "linkage_elastic_model.h"
#include "snapwing/common/error.h"

namespace snapwing::design {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double FORCE_TOLERANCE = 1e-12;      ///< of EA; rounding of the residual is about 1e-15 EA
constexpr int CALM_ITERATIONS = 4;             ///< full steps before the energy is watched
constexpr double GAP_TOLERANCE = 1e-11;        ///< [m]
constexpr double MULTIPLIER_TOLERANCE = 1e-5;  ///< augmented Lagrangian: last change of the multipliers, relative

/// Residual and how far from converged it is; forces are compared with EA, moments with EA times a millimetre.
double residualSize(const VectorXd& r, double EA) {
  double worst = 0;
  for (int i = 0; i < r.size(); ++i) worst = std::max(worst, std::abs(r[i]) / (i % 3 == 2 ? 1e-3 * EA : EA));
  return worst;
}

}  // namespace

void ElasticSettings::validate() const {
  const auto demand = [](bool good, const char* key, double value, const char* allowed) {
    if (!good) throw common::SettingError("elastic linkage", key, std::to_string(value), allowed);
  };
  demand(elements_per_bar >= 1 && elements_per_bar <= 200, "elements_per_bar", elements_per_bar, "1 to 200");
  demand(overhang >= 0 && overhang <= 1, "overhang", overhang, "0 to 1");
  demand(driver_length > 0 && driver_length <= 1, "driver_length", driver_length, "above 0 to 1 m");
  demand(max_iterations >= 1, "max_iterations", max_iterations, "at least 1");
  for (const GroundPin& pin : ground_pins) {
    demand(pin.body >= 0 && pin.body <= 2, "ground_pins.body", pin.body, "0, 1, 2");
    demand(pin.bar >= 0 && pin.bar <= (pin.body == 2 ? 0 : 1), "ground_pins.bar", pin.bar, "a bar of that body");
    demand(pin.fraction >= 0 && pin.fraction <= 1, "ground_pins.fraction", pin.fraction, "0 to 1");
  }
}

ElasticLinkage::ElasticLinkage(const FourBar& bar, const WingBars& bars, const ElasticSettings& settings) {
  bar.validate();
  settings.validate();
  model_ = std::make_unique<Model>(bar, bars, settings);
}
ElasticLinkage::~ElasticLinkage() = default;
ElasticLinkage::ElasticLinkage(ElasticLinkage&&) noexcept = default;

ElasticLinkage::Terms ElasticLinkage::terms(const VectorXd& q) const { return model_->terms(q, true); }
int ElasticLinkage::unknowns() const { return model_->size(); }
const FourBar& ElasticLinkage::layout() const { return model_->bar; }
const MatrixXd& ElasticLinkage::joints() const { return model_->rows.H; }
int ElasticLinkage::tipIndex() const { return 3 * model_->mesh.tip; }
int ElasticLinkage::rotationIndex() const { return 3 * model_->mesh.wing2.b + 2; }

/// One solve: the state that moves and what does not change meanwhile.
class ElasticLinkage::Newton {
 public:
  Newton(const Model& m, double theta) : m_(m), f_(m.friction(theta)), h_(m.driven(theta)), H_(m.rows.H) {
    lambda_.setZero(H_.rows());
    augmented_ = m.settings.solver == JointSolver::AUGMENTED_LAGRANGIAN;
    // Weight of |H q - h|^2: as stiff as the bars; the multipliers do the rest.
    weight_ = augmented_ ? m.row_scale : 0;
  }

  void run(ElasticState* state) {
    VectorXd& q = state->q;
    for (int& k = state->iterations; k < m_.settings.max_iterations; ++k) {
      const Terms t = m_.terms(q, false);
      const VectorXd gap = H_ * q - h_;
      const double size = residualSize(residual(t.gradient, gap), m_.section.EA);
      if (!std::isfinite(size)) break;
      if (done(size, gap)) {
        state->status = ElasticStatus::CONVERGED;
        break;
      }
      if (!augmented_) {
        q += saddleStep(t, q, gap, k);
      } else if (size <= FORCE_TOLERANCE) {
        lambda_ += weight_ * gap;  // inner problem solved: the multipliers take over the penalty's force
      } else {
        q += penaltyStep(t, q, gap);
      }
    }
    state->forces = lambda_;
  }

 private:
  VectorXd residual(const VectorXd& gradient, const VectorXd& gap) const {
    return gradient - f_ + H_.transpose() * (lambda_ + weight_ * gap);
  }
  bool done(double size, const VectorXd& gap) const {
    const double open = gap.cwiseAbs().maxCoeff();
    const double forces = MULTIPLIER_TOLERANCE * lambda_.cwiseAbs().maxCoeff() + FORCE_TOLERANCE * m_.section.EA;
    return size <= FORCE_TOLERANCE && open <= GAP_TOLERANCE && weight_ * open <= forces;
  }
  /// What the step must lower: potential, and for the augmented Lagrangian its joints' terms.
  double merit(const VectorXd& q) const {
    const VectorXd gap = H_ * q - h_;
    return m_.terms(q, false).energy - f_.dot(q) +
           (augmented_ ? lambda_.dot(gap) + 0.5 * weight_ * gap.squaredNorm() : 0);
  }
  /// dq shortened until the merit falls; kept whole where the change drowns in rounding.
  VectorXd shortened(const VectorXd& q, const VectorXd& dq, double slope) const {
    const double before = merit(q), noise = 1e-13 * std::abs(before) + 1e-22 * m_.section.EA;
    double step = 1;
    for (int k = 0; k < 30 && !(merit(q + step * dq) <= before + 1e-4 * step * slope + noise); ++k) step *= 0.5;
    return step * dq;
  }
  /// Newton's step on the saddle point. The joints are linear, so that the first step closes them and later steps stay
  /// on them; from then on the energy must fall, with a shifted tangent where it is no minimum along the joints.
  VectorXd saddleStep(const Terms& t, const VectorXd& q, const VectorXd& gap, int iteration) {
    const int n = m_.size(), rows = static_cast<int>(H_.rows());
    const bool closed = gap.cwiseAbs().maxCoeff() <= 1e-9, careful = closed && iteration >= CALM_ITERATIONS;
    MatrixXd K = t.hessian;
    for (double shift = 1e-6 * m_.row_scale; careful && !m_.minimum(K); shift *= 10) {
      K = t.hessian + shift * MatrixXd::Identity(n, n);
    }
    VectorXd right(n + rows);
    right << -(t.gradient - f_), -m_.row_scale * gap;
    const VectorXd both = m_.saddle(K).solve(right);
    lambda_ = m_.row_scale * both.tail(rows);  // the full multiplier, since the right side was taken without it
    const VectorXd dq = both.head(n);
    return careful ? shortened(q, dq, (t.gradient - f_).dot(dq)) : dq;
  }
  VectorXd penaltyStep(const Terms& t, const VectorXd& q, const VectorXd& gap) const {
    const int n = m_.size();
    const MatrixXd K = t.hessian + weight_ * H_.transpose() * H_;
    Eigen::LLT<MatrixXd> factor(K);
    for (double shift = 1e-6 * m_.row_scale; factor.info() != Eigen::Success; shift *= 10) {
      factor.compute(K + shift * MatrixXd::Identity(n, n));
    }
    const VectorXd r = residual(t.gradient, gap);
    const VectorXd dq = -factor.solve(r);
    return shortened(q, dq, r.dot(dq));
  }

  const Model& m_;
  const VectorXd f_, h_;
  const MatrixXd& H_;
  VectorXd lambda_;
  bool augmented_ = false;
  double weight_ = 0;
};

ElasticState ElasticLinkage::solve(double theta, const ElasticState* guess) const {
  const Model& m = *model_;
  ElasticState state;
  state.theta = theta;
  if (m.rank < m.rows.H.rows()) {
    std::ostringstream text;
    text << "the joints' matrix H has rank " << m.rank << " of " << m.rows.H.rows()
         << ": some joints, pins or the driven port hold the same points of one element";
    state.status = ElasticStatus::RANK_DEFICIENT;
    state.message = text.str();
    return state;
  }
  if (guess != nullptr && guess->q.size() == m.size()) {
    state.q = guess->q;
  } else if (!m.rigidGuess(theta, &state.q)) {
    state.q.setZero(m.size());
  }
  Newton(m, theta).run(&state);
  if (!state.q.allFinite()) {
    state.status = ElasticStatus::NOT_CONVERGED;
    state.message = "Newton's method produced non-finite numbers at theta = " + std::to_string(theta) + " rad";
    return state;
  }
  m.describe(&state);
  if (state.status != ElasticStatus::CONVERGED) {
    state.status = ElasticStatus::NOT_CONVERGED;
    state.message = "no equilibrium after " + std::to_string(state.iterations) +
                    " iterations at theta = " + std::to_string(theta) + " rad";
  }
  return state;
}

Eigen::Vector4d ElasticLinkage::adjoint(const ElasticState& state, const VectorXd& L_q,
                                        const Eigen::Vector4d& L_X) const {
  if (state.status != ElasticStatus::CONVERGED)
    throw common::Error("elastic linkage: no derivative without equilibrium");
  if (L_q.size() != unknowns()) throw common::Error("elastic linkage: dL/dq has the wrong size");
  const Terms t = terms(state.q);
  VectorXd right = VectorXd::Zero(unknowns() + model_->rows.H.rows());
  right.head(unknowns()) = L_q;
  const VectorXd y = model_->saddle(t.hessian).solve(right).head(unknowns());
  return L_X - t.mixed.transpose() * y;
}

Eigen::Vector4d ElasticLinkage::gradient(const ElasticState& state, const StateSlopes& L) const {
  const Terms t = terms(state.q);
  VectorXd L_q = L.energy * t.gradient;
  L_q.segment<2>(tipIndex()) += L.tip;
  L_q[rotationIndex()] += L.wing_rotation;
  const auto add = [&](const Attachment& at, const Eigen::Vector2d& slope) {
    L_q.segment<2>(3 * at.a) += (1 - at.s) * slope;
    L_q.segment<2>(3 * at.b) += at.s * slope;
  };
  add(model_->mesh.wing1, L.joint1);
  add(model_->mesh.wing2, L.joint2);
  Eigen::Vector4d L_X = L.energy * t.by_X;
  L_X.head<2>() += L.joint1;
  L_X.tail<2>() += L.joint2;
  return adjoint(state, L_q, L_X);
}

ElasticSensitivity ElasticLinkage::sensitivity(const ElasticState& state) const {
  if (state.status != ElasticStatus::CONVERGED)
    throw common::Error("elastic linkage: no derivative without equilibrium");
  const Model& m = *model_;
  const Terms t = terms(state.q);
  MatrixXd right = MatrixXd::Zero(unknowns() + m.rows.H.rows(), 4);
  right.topRows(unknowns()) = -t.mixed;
  const MatrixXd dq = m.saddle(t.hessian).solve(right).topRows(unknowns());
  ElasticSensitivity s;
  const auto moved = [&](const Attachment& at) -> Eigen::Matrix<double, 2, 4> {
    return (1 - at.s) * dq.middleRows<2>(3 * at.a) + at.s * dq.middleRows<2>(3 * at.b);
  };
  s.joint1 = moved(m.mesh.wing1);
  s.joint2 = moved(m.mesh.wing2);
  s.joint1.leftCols<2>() += Eigen::Matrix2d::Identity();
  s.joint2.rightCols<2>() += Eigen::Matrix2d::Identity();
  s.tip = dq.middleRows<2>(tipIndex());
  s.wing_rotation = dq.row(rotationIndex());
  s.energy = t.by_X.transpose() + t.gradient.transpose() * dq;
  return s;
}

}  // namespace snapwing::design
