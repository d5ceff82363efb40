#pragma once
/// Mesh of the elastic linkage and the energy of one beam element; see snapwing/design/wing/linkage_elastic.h.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "linkage_jet.h"
#include "snapwing/design/wing/linkage_elastic.h"

namespace snapwing::design {

/// Rest position = constant + on1 X1 + on2 X2: the material follows the joints.
struct BeamNode {
  Eigen::Vector2d constant;
  double on1 = 0, on2 = 0;
};

struct BeamElement {
  int a = 0, b = 0;
};

/// A material point within an element: displacement (1 - s) u_a + s u_b.
struct Attachment {
  int a = 0, b = 0;
  double s = 0;
};

/// Section stiffness of a bar.
struct BeamSection {
  double EA = 0, GA = 0, EI = 0;  ///< [N], [N], [N m2]
  double half_width = 0, modulus = 0;
  explicit BeamSection(const WingBars& bars);
};

struct BeamMesh {
  std::vector<BeamNode> nodes;
  std::vector<BeamElement> elements;
  std::vector<int> body_of_node;
  Attachment port, axle, arm1, wing1, wing2, rocker2, auxiliary;
  std::vector<Attachment> pins;
  int tip = 0;
  BeamMesh(const FourBar& bar, const ElasticSettings& settings);
};

/// H and the names of its rows (two rows, x and y, per name), in the order port, axle, X1, X2, auxiliary, pins.
struct JointRows {
  Eigen::MatrixXd H;
  std::vector<std::string> names;
  explicit JointRows(const BeamMesh& mesh);
};

/// Energy of one element: variables d = u_b - u_a (2), theta_a, theta_b, D = rest b - rest a (2).
///   p = D + d, t = R((theta_a + theta_b) / 2) D / L, n = t turned left:
///   E = L / 2 (EA (p.t / L - 1)^2 + GA (p.n / L)^2 + EI ((theta_b - theta_a) / L)^2)
Jet<6> elementEnergy(const BeamSection& section, const Eigen::Matrix<double, 6, 1>& at);
/// |axial| + |bending| stress at the bar's edge [Pa]
double elementStress(const BeamSection& section, const Eigen::Matrix<double, 6, 1>& at);

}  // namespace snapwing::design
