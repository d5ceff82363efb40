#include "scene_constraints.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::scene {

using mpm::Vector;

namespace {

template <int D>
int strideOf(const mpm::Grid<D>& grid, int axis) {
  int stride = 1;
  for (int a = 0; a < axis; ++a) stride *= grid.nodesAlong(a);
  return stride;
}
template <int D>
int layerOf(const mpm::Grid<D>& grid, int number, int axis) {
  return number / strideOf(grid, axis) % grid.nodesAlong(axis);
}
/// Layers of nodes along an axis that carry the field at a coordinate, with their weights.
template <int D>
std::vector<std::pair<int, double>> layers(const mpm::Grid<D>& grid, int axis, double at) {
  const double scaled = (at - grid.origin(axis)) / grid.cell_size;
  if (scaled < -1e-6 || scaled > grid.cells[axis] + 1e-6) return {};
  const int cell = std::min(std::max(static_cast<int>(std::floor(scaled + 1e-6)), 0), grid.cells[axis] - 1);
  std::array<double, 3> value{}, slope{};
  mpm::axisKernel(grid.kernel, std::min(std::max(scaled - cell, 0.0), 1.0), value, slope);
  std::vector<std::pair<int, double>> result;
  for (int k = 0; k < mpm::nodesPerAxis(grid.kernel); ++k) {
    if (value[k] > 1e-6) result.emplace_back(cell + k, value[k]);
  }
  return result;
}

template <int D>
void addTerms(solver::Equation& equation, const std::vector<std::pair<int, double>>& group, int axis, double factor) {
  for (const auto& [node, weight] : group) equation.terms.emplace_back(D * node + axis, factor * weight);
}

}  // namespace

template <int D>
Constraints<D>::Constraints(const Scene& scene, const SceneCells<D>& cells)
    : scene_(scene), cells_(cells), solid_(*cells.solid()) {
  findGroups();
}

template <int D>
std::vector<solver::Equation> Constraints<D>::equations() const {
  std::vector<solver::Equation> list;
  for (const RigidGroup& group : groups_) moveRigidly(group, list);
  for (const SceneSupport& s : scene_.supports) hold(s, true, list);
  for (const SceneSupport& s : scene_.symmetry) hold(s, true, list);
  for (int axis = 0; axis < D; ++axis) {
    for (int body = 0; cells_.mirror().has(axis) && body < solid_.bodyCount(); ++body) {
      SceneSupport plane{cells_.mirror().name(axis), body, {}, {axis}};
      plane.region.low(axis) = plane.region.high(axis) = cells_.mirror().at[axis];
      hold(plane, false, list);
    }
  }
  std::size_t held = list.size();
  const auto markKeepable = [&] {
    for (; held < list.size(); ++held) list[held].keepable = true;
  };
  for (const ScenePort& port : scene_.ports) prescribe(port, list);
  markKeepable();
  for (const ScenePin& pin : scene_.pins) addPin(pin, list);
  held = list.size();
  for (const SceneJoint& joint : scene_.joints) addJoint(joint, list);
  markKeepable();
  return list;
}

template <int D>
void Constraints<D>::addGroup(const std::string& name, int body, std::vector<int> nodes,
                              std::vector<Eigen::Vector3d> axes) {
  RigidGroup group{name, body, std::move(nodes), Eigen::Vector3d::Zero(), 0, {}};
  for (const int node : group.nodes) group.centre.template head<D>() += solid_.position(node);
  group.centre /= static_cast<double>(group.nodes.size());
  double length = 0;
  for (const int node : group.nodes) {
    length = std::max(length, (solid_.position(node) - group.centre.template head<D>()).norm());
  }
  group.rotation.length = length > 0 ? length : scene_.cell_size;
  group.rotation.axes = std::move(axes);
  groups_.push_back(std::move(group));
}

template <int D>
const RigidGroup& Constraints<D>::groupOf(int body) const {
  return *std::find_if(groups_.begin(), groups_.end(), [&](const RigidGroup& g) { return g.body == body; });
}

template <int D>
typename Constraints<D>::Weights Constraints<D>::pointWeights(int body, const Vector<D>& point) const {
  if (scene_.bodies[body].hasCells()) return solid_.interpolate(body, point);
  const RigidGroup& group = groupOf(body);
  const Vector<D> arm = (point - group.centre.template head<D>()) / group.rotation.length;
  Weights result = {{group.translation / D, 1.0}};
  for (int j = 0; j < D; ++j) {
    if (arm(j) != 0) result.emplace_back(group.rotation.first / D + j, arm(j));
  }
  return result;
}

template <int D>
void Constraints<D>::findGroups() {
  using Eigen::Vector3d;
  for (int body = 0; body < static_cast<int>(scene_.bodies.size()); ++body) {
    if (!scene_.bodies[body].rigid) continue;
    std::vector<int> nodes;
    for (int node = 0; node < solid_.nodeCount(); ++node) {
      if (solid_.nodeBody(node) == body) nodes.push_back(node);
    }
    std::vector<Vector3d> axes = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
    if (D == 2) axes = {Vector3d::UnitZ()};
    const GivenMass& given = scene_.bodies[body].given;
    if (given.mass > 0) {
      RigidGroup group{scene_.bodies[body].name, body, {}, given.centre, 0, {}};
      group.rotation.length = std::max(std::sqrt(given.inertia.trace() / given.mass), scene_.cell_size);
      group.rotation.axes = axes;
      groups_.push_back(std::move(group));
      continue;
    }
    addGroup(scene_.bodies[body].name, body, nodes, axes);
  }
  for (const ScenePin& pin : scene_.pins) {
    if (pin.kind == PinKind::CYLINDER) makeCylinder(pin);
  }
  int next = solid_.dofCount();
  for (RigidGroup& group : groups_) {
    group.translation = next;
    next += D;
  }
  for (RigidGroup& group : groups_) {
    group.rotation.first = next;
    next += D * D;
  }
}

/// The nodes of a section become a group that may turn about the pin's axis only.
template <int D>
void Constraints<D>::makeCylinder(const ScenePin& pin) {
  for (RigidGroup& group : groups_) {
    if (group.body != pin.body || !scene_.bodies[pin.body].rigid) continue;
    group.rotation.axes = {Eigen::Vector3d::UnitZ()};  // a rigid body needs no section of its own
    return;
  }
  std::vector<int> nodes;
  for (int node = 0; node < solid_.nodeCount(); ++node) {
    if (solid_.nodeBody(node) != pin.body) continue;
    const auto& x = solid_.position(node);
    if (common::hypot(x(0) - pin.x, x(1) - pin.y) <= pin.radius * (1 + 1e-9)) nodes.push_back(node);
  }
  std::map<std::pair<long, long>, int> columns;
  for (const int node : nodes) {
    const auto& x = solid_.position(node);
    columns[{std::lround(x(0) / scene_.cell_size * 4), std::lround(x(1) / scene_.cell_size * 4)}] = node;
  }
  if (columns.size() < 3) {
    throw common::Error("'" + pin.name + "': radius " + common::toText(pin.radius) + " m holds " +
                        std::to_string(columns.size()) +
                        " of the grid's nodes in its section; allowed: at least 3 "
                        "(a radius of one cell_size, " +
                        common::toText(scene_.cell_size) + " m, within the material)");
  }
  addGroup(pin.name, pin.body, nodes, {Eigen::Vector3d::UnitZ()});
}

template <int D>
void Constraints<D>::moveRigidly(const RigidGroup& group, std::vector<solver::Equation>& list) const {
  const solver::Rotation& t = group.rotation;
  for (const int node : group.nodes) {
    const Vector<D> arm = (solid_.position(node) - group.centre.template head<D>()) / t.length;
    for (int i = 0; i < D; ++i) {
      solver::Equation equation;
      equation.name = group.name;
      equation.terms = {{D * node + i, 1.0}, {group.translation + i, -1.0}};
      for (int j = 0; j < D; ++j) equation.terms.emplace_back(t.first + i + D * j, -arm(j));
      list.push_back(equation);
    }
  }
}

template <int D>
solver::SplitEquations Constraints<D>::split(const std::vector<solver::Equation>& list) const {
  return solver::splitEquations(dofCount(), 1, list, scene_.enforcement != solver::Enforcement::ELIMINATION, keptFrom(),
                                static_cast<int>(groups_.size()), D * D);
}

template <int D>
std::vector<solver::Rotation> Constraints<D>::rotations(
    const std::vector<std::vector<solver::Equation>>& of_rotation) const {
  std::vector<solver::Rotation> result;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    result.push_back(groups_[g].rotation);
    result.back().axes = solver::openAxes<D>(result.back(), of_rotation[g], result.back().axes, groups_[g].name);
  }
  return result;
}

/// Groups of nodes whose weighted sum is the displacement of a line of the face (or of one node of a region).
template <int D>
std::vector<typename Constraints<D>::Weights> Constraints<D>::regionGroups(int body, const Box& region) const {
  const mpm::Grid<D>& grid = solid_.grid(body);
  const int axis = flatAxis<D>(region);
  std::vector<Weights> result;
  Vector<D> low = grid.origin, high = grid.origin;
  for (int a = 0; a < D; ++a) high(a) += grid.cell_size * grid.cells[a];
  Weights along;  // layers of nodes and their weights at the face
  if (axis >= 0) along = layers(grid, axis, region.low(axis));
  for (int number = 0; number < grid.nodeCount(); ++number) {
    const int node = solid_.findNode(body, number);
    if (node < 0) continue;
    // Nodes of the smooth kernel lie outside of the grid by half a cell: they count as on its faces.
    Point3 x = Point3::Zero();
    x.head<D>() = grid.nodePosition(number).cwiseMax(low).cwiseMin(high);
    if (axis >= 0) {
      if (along.empty() || layerOf(grid, number, axis) != along[0].first) continue;
      x(axis) = region.low(axis);
    }
    if (!region.contains(x, 1e-6 * grid.cell_size)) continue;
    Weights group;
    if (axis < 0) {
      group = {{node, 1.0}};
    } else {
      const int stride = strideOf(grid, axis);
      for (const auto& [layer, weight] : along) {
        const int other = solid_.findNode(body, number + (layer - along[0].first) * stride);
        if (other < 0) break;
        group.emplace_back(other, weight);
      }
      if (group.size() < along.size()) continue;
    }
    result.push_back(group);
  }
  return result;
}

template <int D>
std::vector<typename Constraints<D>::Weights> Constraints<D>::requireGroups(int body, const Box& region,
                                                                            const std::string& name) const {
  std::vector<Weights> result = regionGroups(body, region);
  if (result.empty())
    throw common::Error("'" + name + "' meets no material of body '" + scene_.bodies[body].name + "'");
  return result;
}

template <int D>
void Constraints<D>::hold(const SceneSupport& support, bool required, std::vector<solver::Equation>& list) const {
  std::vector<Weights> all;
  if (!scene_.bodies[support.body].hasCells()) {
    all = {pointWeights(support.body, support.at.head<D>())};
  } else {
    all = required ? requireGroups(support.body, support.region, support.name)
                   : regionGroups(support.body, support.region);
  }
  for (const Weights& group : all) {
    for (const int axis : support.axes) {
      solver::Equation equation;
      equation.name = support.name;
      addTerms<D>(equation, group, axis, 1);
      list.push_back(equation);
    }
  }
}

template <int D>
void Constraints<D>::prescribe(const ScenePort& port, std::vector<solver::Equation>& list) const {
  const std::vector<Weights> all = scene_.bodies[port.body].hasCells()
                                       ? requireGroups(port.body, port.region, port.name)
                                       : std::vector<Weights>{pointWeights(port.body, port.at.head<D>())};
  for (const Weights& group : all) {
    if (port.cross_free) {
      solver::Equation equation{{}, {{0, 1.0}}, 0, port.name};
      for (int a = 0; a < D; ++a) {
        if (port.direction(a) != 0) addTerms<D>(equation, group, a, port.direction(a));
      }
      list.push_back(equation);
      continue;
    }
    for (int a = 0; a < D; ++a) {
      solver::Equation equation{{}, {}, 0, port.name};
      if (port.direction(a) != 0) equation.control = {{0, port.direction(a)}};
      addTerms<D>(equation, group, a, 1);
      list.push_back(equation);
    }
  }
}

/// Weights of the displacement at (x, y), once per layer of nodes along z.
template <int D>
std::vector<typename Constraints<D>::Weights> Constraints<D>::axleLines(int body, double x, double y,
                                                                        const std::string& name,
                                                                        std::vector<double>& heights) const {
  const mpm::Grid<D>& grid = solid_.grid(body);
  Vector<D> point;
  point.setZero();
  point(0) = x, point(1) = y;
  std::vector<Weights> lines;
  if (D == 2) {
    const Weights w = pointWeights(body, point);
    if (!w.empty()) lines.push_back(w);
  } else if (!scene_.bodies[body].hasCells()) {
    const RigidGroup& group = groupOf(body);
    if (heights.empty()) heights = {group.centre(2) - group.rotation.length, group.centre(2) + group.rotation.length};
    for (const double height : heights) {
      point(D - 1) = height;
      lines.push_back(pointWeights(body, point));
    }
  } else {
    heights.clear();
    const auto in_x = layers(grid, 0, x), in_y = layers(grid, 1, y);
    const int stride_x = 1, stride_y = grid.nodesAlong(0), stride_z = grid.nodesAlong(0) * grid.nodesAlong(1);
    for (int k = 0; k < grid.nodesAlong(D - 1); ++k) {
      Weights w;
      for (const auto& [j, wy] : in_y) {
        for (const auto& [i, wx] : in_x) {
          const int node = solid_.findNode(body, i * stride_x + j * stride_y + k * stride_z);
          if (node >= 0) w.emplace_back(node, wx * wy);
        }
      }
      if (w.empty() || w.size() != in_x.size() * in_y.size()) continue;
      lines.push_back(w);
      heights.push_back(grid.nodePosition(k * stride_z)(D - 1));
    }
  }
  if (lines.empty()) throw common::Error("'" + name + "' lies outside of body '" + scene_.bodies[body].name + "'");
  return lines;
}

/// Mean over the particles within the axle's section.
template <int D>
typename Constraints<D>::Weights Constraints<D>::sectionMean(const ScenePin& pin) const {
  std::map<int, double> sum;
  double total = 0;
  for (int c = 0; c < solid_.cellCount(); ++c) {
    if (solid_.cellBody(c) != pin.body) continue;
    cells_.eachParticle(c, [&](const Vector<D>& x, const double* value, double w) {
      if (common::hypot(x(0) - pin.x, x(1) - pin.y) > pin.radius) return;
      total += w;
      for (int a = 0; a < solid_.stencil(); ++a) sum[solid_.cellNodes(c)[a]] += w * value[a];
    });
  }
  if (!(total > 0)) throw common::Error("'" + pin.name + "' has no material within its radius");
  Weights result;
  for (const auto& [node, weight] : sum) result.emplace_back(node, weight / total);
  return result;
}

template <int D>
void Constraints<D>::addPin(const ScenePin& pin, std::vector<solver::Equation>& list) const {
  std::vector<Weights> lines;
  if (pin.kind == PinKind::MEAN && scene_.bodies[pin.body].hasCells()) {
    lines = {sectionMean(pin)};
  } else {
    // All points of a rigid cylinder's axis move alike across it: the line says so once, the rest is dropped.
    std::vector<double> heights;
    lines = axleLines(pin.body, pin.x, pin.y, pin.name, heights);
  }
  for (const Weights& group : lines) {
    for (int a = 0; a < 2; ++a) {
      solver::Equation equation;
      equation.name = pin.name;
      addTerms<D>(equation, group, a, 1);
      list.push_back(equation);
    }
  }
}

template <int D>
Point3 Constraints<D>::inSecond(const SceneJoint& joint, const Point3& x) const {
  const Frame &first = scene_.bodies[joint.first].frame, &second = scene_.bodies[joint.second].frame;
  if (first.rotation == second.rotation && first.origin == second.origin) return x;
  return second.toOwn(first.toWorld(x));
}

/// Displacements are in the axes of each body; the equations are in those of the first.
template <int D>
void Constraints<D>::join(const SceneJoint& joint, const Weights& first, const Weights& second,
                          std::vector<solver::Equation>& list) const {
  const Frame &one = scene_.bodies[joint.first].frame, &other = scene_.bodies[joint.second].frame;
  const bool turned = one.rotation != other.rotation;
  const Eigen::Matrix3d turn = one.rotation.transpose() * other.rotation;
  for (int a = 0; a < D; ++a) {
    solver::Equation equation;
    equation.name = joint.name;
    addTerms<D>(equation, first, a, 1);
    for (int b = 0; b < D; ++b) {
      const double share = turned ? turn(a, b) : a == b ? 1 : 0;
      if (share != 0) addTerms<D>(equation, second, b, -share);
    }
    list.push_back(equation);
  }
}

/// At points of the segment that are not farther apart than a cell; all must lie in both bodies.
template <int D>
void Constraints<D>::tieSegment(const SceneJoint& joint, std::vector<solver::Equation>& list) const {
  const Point3 along = joint.to - joint.from;
  const int parts = static_cast<int>(std::ceil(along.norm() / scene_.cell_size - 1e-6));
  for (int k = 0; k <= parts; ++k) {
    const Point3 x = parts > 0 ? Point3(joint.from + along * (static_cast<double>(k) / parts)) : joint.from;
    Weights at[2];
    for (const int side : {0, 1}) {
      const int body = side == 0 ? joint.first : joint.second;
      const Point3 own = side == 0 ? x : inSecond(joint, x);
      at[side] = pointWeights(body, own.head<D>());
      if (at[side].empty()) {
        throw common::Error("'" + joint.name + "' lies outside of body '" + scene_.bodies[body].name + "' at (" +
                            std::to_string(x(0)) + ", " + std::to_string(x(1)) + ", " + std::to_string(x(2)) + ") m");
      }
    }
    join(joint, at[0], at[1], list);
  }
}

/// At points of the face where both bodies are, a cell of the first body apart.
template <int D>
void Constraints<D>::tieFace(const SceneJoint& joint, std::vector<solver::Equation>& list) const {
  const int axis = flatAxis<D>(joint.region);
  if (axis < 0) throw common::Error("'" + joint.name + "': the region of a joint must be flat along one axis");
  if (!scene_.bodies[joint.first].hasCells()) {
    throw common::Error("'" + joint.name + "': the first body of a glued face is '" + scene_.bodies[joint.first].name +
                        "', which has no cells; allowed: one with cells first");
  }
  const mpm::Grid<D>& grid = solid_.grid(joint.first);
  Vector<D> low, step;
  mpm::Index<D> count{};
  long points = 1;
  for (int a = 0; a < D; ++a) {
    low(a) = std::max(joint.region.low(a), a == axis ? joint.region.low(a) : grid.origin(a));
    const double high =
        std::min(joint.region.high(a), a == axis ? low(a) : grid.origin(a) + grid.cell_size * grid.cells[a]);
    const int parts = std::max(0, static_cast<int>(std::ceil((high - low(a)) / grid.cell_size - 1e-6)));
    step(a) = parts > 0 ? (high - low(a)) / parts : 0;
    count[a] = high < low(a) ? 0 : parts + 1;
    points *= count[a];
  }
  const std::size_t before = list.size();
  for (long n = 0; n < points; ++n) {
    Vector<D> x = low;
    long rest = n;
    for (int a = 0; a < D; ++a) {
      x(a) += step(a) * static_cast<double>(rest % count[a]);
      rest /= count[a];
    }
    Point3 own = Point3::Zero();
    own.head<D>() = x;
    const Weights first = solid_.interpolate(joint.first, x),
                  second = pointWeights(joint.second, inSecond(joint, own).template head<D>());
    if (!first.empty() && !second.empty()) join(joint, first, second, list);
  }
  if (list.size() == before) {
    throw common::Error("'" + joint.name + "' meets no place where both '" + scene_.bodies[joint.first].name +
                        "' and '" + scene_.bodies[joint.second].name + "' are");
  }
}

template <int D>
void Constraints<D>::addJoint(const SceneJoint& joint, std::vector<solver::Equation>& list) const {
  if (joint.kind == JointKind::SEGMENT) return tieSegment(joint, list);
  if (joint.kind == JointKind::FACE) return tieFace(joint, list);
  const Point3 there = inSecond(joint, Point3(joint.x, joint.y, 0));
  const Eigen::Vector3d along =
      scene_.bodies[joint.second].frame.rotation.transpose() * scene_.bodies[joint.first].frame.rotation.col(2);
  if (D == 3 && (along(2) != 1 || there(2) != 0)) {
    throw common::Error("'" + joint.name +
                        "': the frames of its bodies do not share the plane z = 0; allowed: those "
                        "that do, or give the joint as a segment, from and to");
  }
  // Of two bodies the one with cells tells the heights of its layers.
  std::vector<double> heights;
  const bool cells_first = scene_.bodies[joint.first].hasCells();
  std::vector<Weights> first, second;
  if (cells_first) first = axleLines(joint.first, joint.x, joint.y, joint.name, heights);
  second = axleLines(joint.second, there(0), there(1), joint.name, heights);
  if (!cells_first) first = axleLines(joint.first, joint.x, joint.y, joint.name, heights);
  if (first.size() != second.size()) {
    throw common::Error("'" + joint.name +
                        "': the joined bodies must have the same thickness there; or give the "
                        "joint as a segment, from and to");
  }
  for (std::size_t k = 0; k < first.size(); ++k) join(joint, first[k], second[k], list);
}

template class Constraints<2>;
template class Constraints<3>;

}  // namespace snapwing::scene
