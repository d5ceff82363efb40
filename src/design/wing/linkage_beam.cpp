#include "linkage_beam.h"

#include <algorithm>
#include <cmath>

namespace snapwing::design {

using Eigen::Vector2d;

namespace {

/// Ends of bars, as affine functions of X.
BeamNode fixedAt(const Vector2d& p) { return {p, 0, 0}; }
BeamNode joint1() { return {Vector2d::Zero(), 1, 0}; }
BeamNode joint2() { return {Vector2d::Zero(), 0, 1}; }
BeamNode between(const BeamNode& a, const BeamNode& b, double t) {
  return {(1 - t) * a.constant + t * b.constant, (1 - t) * a.on1 + t * b.on1, (1 - t) * a.on2 + t * b.on2};
}

/// Adds bars to a mesh, one body after the other.
class Mesher {
 public:
  Mesher(BeamMesh* mesh, int elements) : mesh_(mesh), elements_(elements) {}

  void beginBody() {
    ++body_;
    last_ = -1;
  }
  /// A bar from a to b; with `first` it starts a chain, else it is welded to the end of the bar before.
  void addBar(const BeamNode& a, const BeamNode& b, double before, double after) {
    Bar bar{before, after, static_cast<int>(mesh_->nodes.size())};
    if (last_ >= 0) bar.first = last_;
    const double length = 1 + before + after;
    for (int k = last_ >= 0 ? 1 : 0; k <= elements_; ++k) addNode(between(a, b, -before + length * k / elements_));
    int previous = bar.first;
    const int next = static_cast<int>(mesh_->nodes.size()) - elements_;
    for (int k = 0; k < elements_; ++k) {
      mesh_->elements.push_back({previous, next + k});
      previous = next + k;
    }
    last_ = previous;
    bar.next = next;
    bars_.push_back(bar);
  }
  /// Where the point at t (0 at a, 1 at b) of a bar sits.
  Attachment at(std::size_t index, double t) const {
    const Bar& bar = bars_[index];
    const double position = (t + bar.before) / (1 + bar.before + bar.after) * elements_;
    const int k = std::clamp(static_cast<int>(std::floor(position)), 0, elements_ - 1);
    return {k == 0 ? bar.first : bar.next + k - 1, bar.next + k, position - k};
  }
  int lastNode() const { return last_; }

 private:
  struct Bar {
    double before, after;
    int first, next = 0;
  };
  void addNode(const BeamNode& node) {
    mesh_->nodes.push_back(node);
    mesh_->body_of_node.push_back(body_);
  }
  BeamMesh* mesh_;
  int elements_, body_ = -1, last_ = -1;
  std::vector<Bar> bars_;
};

void put(Eigen::MatrixXd* H, int row, const Attachment& at, double sign) {
  for (int k = 0; k < 2; ++k) {
    (*H)(row + k, 3 * at.a + k) += sign * (1 - at.s);
    (*H)(row + k, 3 * at.b + k) += sign * at.s;
  }
}

struct Strain {
  Jet<6> axial, shear, bend, length;
};

Strain strainOf(const Eigen::Matrix<double, 6, 1>& at) {
  using J = Jet<6>;
  J v[6];
  for (int i = 0; i < 6; ++i) v[i] = J::variable(at[i], i);
  const J middle = 0.5 * (v[2] + v[3]), c = cos(middle), s = sin(middle);
  const J tx = c * v[4] - s * v[5], ty = s * v[4] + c * v[5];
  const J px = v[4] + v[0], py = v[5] + v[1];
  const J square = v[4] * v[4] + v[5] * v[5], length = sqrt(square);
  return {(px * tx + py * ty) / square - 1.0, (py * tx - px * ty) / square, (v[3] - v[2]) / length, length};
}

}  // namespace

BeamSection::BeamSection(const WingBars& bars) {
  const double area = bars.width * bars.thickness;
  modulus = bars.youngs_modulus;
  half_width = 0.5 * bars.width;
  EA = modulus * area;
  GA = 5.0 / 6.0 * modulus / (2 * (1 + bars.poisson_ratio)) * area;
  EI = modulus * bars.thickness * bars.width * bars.width * bars.width / 12;
}

BeamMesh::BeamMesh(const FourBar& bar, const ElasticSettings& s) {
  Mesher mesher(this, s.elements_per_bar);
  mesher.beginBody();  // arm: bars 0 (port to axle) and 1 (axle to X1)
  mesher.addBar(fixedAt({-s.driver_length, 0}), fixedAt(Vector2d::Zero()), 0, 0);
  mesher.addBar(fixedAt(Vector2d::Zero()), joint1(), 0, s.overhang);
  mesher.beginBody();  // wing: bars 2 (X1 to X2) and 3 (X2 to tip)
  mesher.addBar(joint1(), joint2(), s.overhang, 0);
  mesher.addBar(joint2(), fixedAt(bar.tip), 0, 0);
  tip = mesher.lastNode();
  mesher.beginBody();  // rocker: bar 4 (auxiliary to X2)
  mesher.addBar(fixedAt(bar.auxiliary), joint2(), s.overhang, s.overhang);
  port = mesher.at(0, 0);
  axle = mesher.at(0, 1);
  arm1 = mesher.at(1, 1);
  wing1 = mesher.at(2, 0);
  wing2 = mesher.at(2, 1);
  rocker2 = mesher.at(4, 1);
  auxiliary = mesher.at(4, 0);
  for (const GroundPin& pin : s.ground_pins) {
    const int first_bar = pin.body == 0 ? 0 : pin.body == 1 ? 2 : 4;
    pins.push_back(mesher.at(static_cast<std::size_t>(first_bar) + static_cast<std::size_t>(pin.bar), pin.fraction));
  }
}

JointRows::JointRows(const BeamMesh& mesh) {
  names = {"driven port", "axle", "joint X1", "joint X2", "auxiliary joint"};
  for (std::size_t i = 0; i < mesh.pins.size(); ++i) names.push_back("ground pin " + std::to_string(i));
  H.setZero(2 * static_cast<int>(names.size()), 3 * static_cast<int>(mesh.nodes.size()));
  put(&H, 0, mesh.port, 1);
  put(&H, 2, mesh.axle, 1);
  put(&H, 4, mesh.arm1, 1);
  put(&H, 4, mesh.wing1, -1);
  put(&H, 6, mesh.wing2, 1);
  put(&H, 6, mesh.rocker2, -1);
  put(&H, 8, mesh.auxiliary, 1);
  int row = 10;
  for (const Attachment& pin : mesh.pins) {
    put(&H, row, pin, 1);
    row += 2;
  }
}

Jet<6> elementEnergy(const BeamSection& section, const Eigen::Matrix<double, 6, 1>& at) {
  const Strain e = strainOf(at);
  return 0.5 * e.length *
         (section.EA * (e.axial * e.axial) + section.GA * (e.shear * e.shear) + section.EI * (e.bend * e.bend));
}

double elementStress(const BeamSection& section, const Eigen::Matrix<double, 6, 1>& at) {
  const Strain e = strainOf(at);
  return section.modulus * (std::abs(e.axial.value) + std::abs(e.bend.value) * section.half_width);
}

}  // namespace snapwing::design
