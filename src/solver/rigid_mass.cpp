// Mass moments of a rigid body: apart from its term, since the readers of scenes check them too.
#include <Eigen/Eigenvalues>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/solver/rigid_inertia_term.h"

namespace snapwing::solver {

RigidMass RigidMass::of(double mass, const Eigen::Vector3d& centre, const Eigen::Matrix3d& inertia) {
  if (!(mass > 0)) throw common::Error("mass is " + common::toText(mass) + " kg; allowed: above 0");
  if (!inertia.allFinite() || !centre.allFinite() || (inertia - inertia.transpose()).norm() > 1e-12 * inertia.norm()) {
    throw common::Error("the inertia is not symmetric or not finite; allowed: a symmetric tensor in kg m2");
  }
  // J = tr(S) 1 - S about the centre.
  const Eigen::Matrix3d about_centre = 0.5 * inertia.trace() * Eigen::Matrix3d::Identity() - inertia;
  const double least =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(about_centre, Eigen::EigenvaluesOnly).eigenvalues()(0);
  if (least < -1e-9 * about_centre.norm()) {
    throw common::Error("principal moments of inertia violate the triangle inequality by " +
                        common::toText(-2 * least) + " kg m2; allowed: each at most the sum of the others");
  }
  return {mass, mass * centre, about_centre + mass * centre * centre.transpose()};
}

}  // namespace snapwing::solver
