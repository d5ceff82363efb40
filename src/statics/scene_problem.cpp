#include "snapwing/statics/scene_problem.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <sstream>

#include "scene_cells.h"
#include "snapwing/common/error.h"
#include "snapwing/statics/tied_problem.h"

namespace snapwing::statics {

namespace {

using mpm::Index;
using mpm::Vector;
using Weights = std::vector<std::pair<int, double>>;  // (node, weight)

/// The axis along which a region is flat, or -1.
template <int D>
int flatAxis(const Box& region) {
  for (int a = 0; a < D; ++a) {
    if (std::isfinite(region.low(a)) && region.low(a) == region.high(a)) return a;
  }
  return -1;
}

/// Equations and loads of a scene on its cells.
template <int D>
class Constraints {
 public:
  Constraints(const Scene& scene, const SceneCells<D>& cells) : scene_(scene), cells_(cells), solid_(*cells.solid()) {}

  std::vector<Equation> equations(bool half) const {
    std::vector<Equation> list;
    for (const SceneSupport& s : scene_.supports) hold(s, list);
    for (const SceneSupport& s : scene_.symmetry) hold(s, list);
    if (half) {
      for (int body = 0; body < solid_.bodyCount(); ++body) {
        SceneSupport mid{"symmetry about z = 0", body, {}, {2}};
        mid.region.low(2) = mid.region.high(2) = 0;
        hold(mid, list);
      }
    }
    std::size_t held = list.size();
    const auto markTies = [&] {
      for (; held < list.size(); ++held) list[held].tie = true;
    };
    for (const ScenePort& port : scene_.ports) drive(port, list);
    markTies();
    for (const ScenePin& pin : scene_.pins) addPin(pin, list);
    held = list.size();
    for (const SceneJoint& joint : scene_.joints) addJoint(joint, list);
    markTies();
    return list;
  }

  Eigen::MatrixXd loads() const {
    if (scene_.loads.empty()) return {};
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(solid_.dofCount(), 1);
    for (const SceneLoad& load : scene_.loads) addLoad(load, result);
    return result;
  }

 private:
  /// Groups of nodes whose weighted sum is the displacement of a line of the face (or of one node of a region).
  std::vector<Weights> groups(int body, const Box& region, const std::string& name) const {
    const mpm::Grid<D>& grid = solid_.grid(body);
    const int axis = flatAxis<D>(region);
    std::vector<Weights> result;
    Vector<D> low = grid.origin, high = grid.origin;
    for (int a = 0; a < D; ++a) high(a) += grid.cell_size * grid.cells[a];
    std::vector<std::pair<int, double>> along;  // layers of nodes and their weights at the face
    if (axis >= 0) along = layers(grid, axis, region.low(axis));
    for (int number = 0; number < grid.nodeCount(); ++number) {
      const int node = solid_.findNode(body, number);
      if (node < 0) continue;
      // Nodes of the smooth kernel lie outside of the grid by half a cell: they count as on its faces.
      Point3 x = Point3::Zero();
      x.head<D>() = grid.nodePosition(number).cwiseMax(low).cwiseMin(high);
      if (axis >= 0) {
        const int layer = layerOf(grid, number, axis);
        if (along.empty() || layer != along[0].first) continue;
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
    if (result.empty())
      throw common::Error("'" + name + "' meets no material of body '" + scene_.bodies[body].name + "'");
    return result;
  }

  static int strideOf(const mpm::Grid<D>& grid, int axis) {
    int stride = 1;
    for (int a = 0; a < axis; ++a) stride *= grid.nodesAlong(a);
    return stride;
  }
  static int layerOf(const mpm::Grid<D>& grid, int number, int axis) {
    return number / strideOf(grid, axis) % grid.nodesAlong(axis);
  }
  static std::vector<std::pair<int, double>> layers(const mpm::Grid<D>& grid, int axis, double at) {
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

  static void addTerms(Equation& equation, const Weights& group, int axis, double factor) {
    for (const auto& [node, weight] : group) equation.terms.emplace_back(D * node + axis, factor * weight);
  }

  void hold(const SceneSupport& support, std::vector<Equation>& list) const {
    for (const Weights& group : groups(support.body, support.region, support.name)) {
      for (const int axis : support.axes) {
        Equation equation;
        equation.name = support.name;
        addTerms(equation, group, axis, 1);
        list.push_back(equation);
      }
    }
  }

  void drive(const ScenePort& port, std::vector<Equation>& list) const {
    for (const Weights& group : groups(port.body, port.region, port.name)) {
      if (port.cross_free) {
        Equation equation{{}, {{0, 1.0}}, 0, port.name};
        for (int a = 0; a < D; ++a) {
          if (port.direction(a) != 0) addTerms(equation, group, a, port.direction(a));
        }
        list.push_back(equation);
        continue;
      }
      for (int a = 0; a < D; ++a) {
        Equation equation{{}, {}, 0, port.name};
        if (port.direction(a) != 0) equation.control = {{0, port.direction(a)}};
        addTerms(equation, group, a, 1);
        list.push_back(equation);
      }
    }
  }

  /// Weights of the displacement at (x, y), once per layer of nodes along z.
  std::vector<Weights> axleLines(int body, double x, double y, const std::string& name) const {
    const mpm::Grid<D>& grid = solid_.grid(body);
    Vector<D> point;
    point.setZero();
    point(0) = x, point(1) = y;
    std::vector<Weights> lines;
    if (D == 2) {
      const Weights w = solid_.interpolate(body, point);
      if (!w.empty()) lines.push_back(w);
    } else {
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
        if (!w.empty() && w.size() == in_x.size() * in_y.size()) lines.push_back(w);
      }
    }
    if (lines.empty()) throw common::Error("'" + name + "' lies outside of body '" + scene_.bodies[body].name + "'");
    return lines;
  }

  /// Mean over the particles within the axle's section.
  Weights sectionMean(const ScenePin& pin) const {
    std::map<int, double> sum;
    double total = 0;
    const mpm::Grid<D>& grid = solid_.grid(pin.body);
    for (int c = 0; c < solid_.cellCount(); ++c) {
      if (solid_.cellBody(c) != pin.body) continue;
      const mpm::QuadratureRule<D>& rule = solid_.rule(solid_.terms(solid_.cell(c).kind)[0].rule);
      const Vector<D> low = grid.cellCentre(solid_.cellAt(c)) - Vector<D>::Constant(0.5 * grid.cell_size);
      for (int p = 0; p < rule.size(); ++p) {
        const Vector<D> x = low + grid.cell_size * rule.local[p];
        if (std::hypot(x(0) - pin.x, x(1) - pin.y) > pin.radius) continue;
        const double w = rule.weight[p] * solid_.cell(c).measure;
        total += w;
        for (int a = 0; a < solid_.stencil(); ++a) sum[solid_.cellNodes(c)[a]] += w * rule.valueOf(p)[a];
      }
    }
    if (!(total > 0)) throw common::Error("'" + pin.name + "' has no material within its radius");
    Weights result;
    for (const auto& [node, weight] : sum) result.emplace_back(node, weight / total);
    return result;
  }

  void addPin(const ScenePin& pin, std::vector<Equation>& list) const {
    std::vector<Weights> lines;
    if (pin.kind == PinKind::LINE) {
      lines = axleLines(pin.body, pin.x, pin.y, pin.name);
    } else {
      lines = {sectionMean(pin)};
    }
    for (const Weights& group : lines) {
      for (int a = 0; a < 2; ++a) {
        Equation equation;
        equation.name = pin.name;
        addTerms(equation, group, a, 1);
        list.push_back(equation);
      }
    }
  }

  void addJoint(const SceneJoint& joint, std::vector<Equation>& list) const {
    const auto first = axleLines(joint.first, joint.x, joint.y, joint.name);
    const auto second = axleLines(joint.second, joint.x, joint.y, joint.name);
    if (first.size() != second.size()) {
      throw common::Error("'" + joint.name + "': the joined bodies must have the same thickness there");
    }
    for (std::size_t k = 0; k < first.size(); ++k) {
      for (int a = 0; a < D; ++a) {
        Equation equation;
        equation.name = joint.name;
        addTerms(equation, first[k], a, 1);
        addTerms(equation, second[k], a, -1);
        list.push_back(equation);
      }
    }
  }

  /// Consistent nodal forces of a uniform traction, by samples on the part of the face that bounds material.
  void addLoad(const SceneLoad& load, Eigen::MatrixXd& result) const {
    const int axis = flatAxis<D>(load.region);
    if (axis < 0) throw common::Error("'" + load.name + "': the region of a load must be flat along one axis");
    const mpm::Grid<D>& grid = solid_.grid(load.body);
    const int n = 4;
    const int samples = D == 2 ? n : n * n;
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(solid_.nodeCount()), value;
    Eigen::Matrix<double, D, Eigen::Dynamic> slope;
    double total = 0;
    for (int c = 0; c < solid_.cellCount(); ++c) {
      if (solid_.cellBody(c) != load.body) continue;
      const Vector<D> low = grid.cellCentre(solid_.cellAt(c)) - Vector<D>::Constant(0.5 * grid.cell_size);
      const double along = (load.region.low(axis) - low(axis)) / grid.cell_size;
      const bool last = solid_.cellAt(c)[axis] == grid.cells[axis] - 1;
      if (along < -1e-6 || along > 1 + (last ? 1e-6 : -1e-6)) continue;
      for (int s = 0; s < samples; ++s) {
        Vector<D> local;
        for (int a = 0, rest = s; a < D; ++a) {
          if (a == axis) continue;
          local(a) = (rest % n + 0.5) / n;
          rest /= n;
        }
        local(axis) = std::min(std::max(along, 0.0), 1.0);
        Vector<D> x = low + grid.cell_size * local;
        Point3 p = Point3::Zero();
        p.head<D>() = x;
        if (!load.region.contains(p, 1e-6 * grid.cell_size)) continue;
        x(axis) += (last ? -1e-6 : 1e-6) * grid.cell_size;  // just inside
        if (!cells_.contains(load.body, x)) continue;
        grid.weights(local, value, slope);
        for (int a = 0; a < solid_.stencil(); ++a) weights(solid_.cellNodes(c)[a]) += value(a);
        total += 1;
      }
    }
    if (!(total > 0))
      throw common::Error("'" + load.name + "' meets no material of body '" + scene_.bodies[load.body].name + "'");
    for (int node = 0; node < solid_.nodeCount(); ++node) {
      for (int a = 0; a < D; ++a) result(D * node + a, 0) += weights(node) / total * load.force(a);
    }
  }

  const Scene& scene_;
  const SceneCells<D>& cells_;
  const mpm::Discretisation<D>& solid_;
};

template <int D>
class CompiledSceneOf : public CompiledScene {
 public:
  CompiledSceneOf(const Scene& scene, int threads) : scene_(scene) {
    const bool half = D == 3 && scene.use_symmetry && symmetricAboutZ();
    const SceneCells<D> cells(scene_, half);
    dropped_ = cells.droppedShare();
    const Constraints<D> constraints(scene_, cells);
    Eigen::MatrixXd loads = constraints.loads();
    for (const SceneSupport& plane : scene.symmetry) {
      multiplicity_ *= 2;
      symmetry_ += (symmetry_.empty() ? "" : ", ") + plane.name;
    }
    if (half) {
      multiplicity_ *= 2;
      symmetry_ += (symmetry_.empty() ? "" : ", ") + std::string("half thickness (mirror plane z = 0)");
    }
    loads /= multiplicity_;
    if (symmetry_.empty()) symmetry_ = "none";
    const std::vector<Equation> equations = constraints.equations(half);
    const int dofs = cells.solid()->dofCount();
    std::vector<Equation> eliminated = equations;
    if (scene.drive != Drive::ELIMINATION) {
      const auto tie = [](const Equation& e) { return e.tie; };
      eliminated.erase(std::remove_if(eliminated.begin(), eliminated.end(), tie), eliminated.end());
    }
    problem_ = std::make_shared<SolidProblem<D>>(cells.solid(), Reduction(dofs, 1, eliminated), std::move(loads),
                                                 threads, forceFloor());
    if (scene.drive == Drive::ELIMINATION) return;
    constexpr double PENALTY = 100, GAP = 1e-10;  // of the mean stiffness of a node, of a cell
    tied_ = std::make_unique<TiedProblem>(problem_, makeTies(dofs, 1, equations, problem_->reduction()), scene.drive,
                                          PENALTY, GAP * scene.cell_size);
  }

  const Problem& problem() const override {
    if (tied_) return *tied_;
    return *problem_;
  }
  double multiplicity() const override { return multiplicity_; }
  const std::string& symmetry() const override { return symmetry_; }
  int cellCount() const override { return problem_->solid().cellCount(); }
  double droppedShare() const override { return dropped_; }

  std::vector<double> monitors(const Eigen::VectorXd& z, double p) const override {
    const Eigen::VectorXd u = problem_->reduction().expand(z, Eigen::VectorXd::Constant(1, p));
    std::vector<double> values;
    for (const SceneMonitor& m : scene_.monitors) {
      values.push_back(m.radius > 0 ? rotation(m, u) : displacement(m, u));
    }
    return values;
  }

  std::string vtu(const Eigen::VectorXd& z, double p) const override;

 private:
  bool symmetricAboutZ() const {
    const auto free = [](const Box& b) { return !std::isfinite(b.low(2)) && !std::isfinite(b.high(2)); };
    bool good = true;
    for (const SceneBody& b : scene_.bodies) good = good && b.extruded;
    for (const auto& s : scene_.supports) good = good && free(s.region);
    for (const auto& s : scene_.ports) good = good && free(s.region) && s.direction(2) == 0;
    for (const auto& s : scene_.loads) good = good && free(s.region) && s.force(2) == 0;
    for (const auto& s : scene_.symmetry) good = good && s.axes[0] != 2;
    return good;
  }

  double forceFloor() const {
    // Rounding of the deformation gradient times the stiffest modulus: no residual can be told from zero below that.
    double stiffest = 0;
    for (const SceneBody& b : scene_.bodies) stiffest = std::max(stiffest, b.material.lambda() + 2 * b.material.mu());
    const double across = D == 2 ? scene_.bodies[0].thickness : scene_.cell_size;
    return 1e-13 * stiffest * scene_.cell_size * across;
  }

  double displacement(const SceneMonitor& m, const Eigen::VectorXd& u) const {
    const Vector<D> at = m.at.head<D>();
    if (problem_->solid().interpolate(m.body, at).empty()) {
      throw common::Error("monitor '" + m.name + "' lies outside of body '" + scene_.bodies[m.body].name + "'");
    }
    return problem_->solid().displacementAt(m.body, at, u).dot(m.direction.head<D>());
  }

  double rotation(const SceneMonitor& m, const Eigen::VectorXd& u) const {
    const mpm::Discretisation<D>& solid = problem_->solid();
    double sine = 0, cosine = 0;
    for (int node = 0; node < solid.nodeCount(); ++node) {
      const Eigen::Vector2d rest = solid.position(node).template head<2>() - m.at.head<2>();
      if (solid.nodeBody(node) != m.body || rest.norm() > m.radius * (1 + 1e-9)) continue;
      const Eigen::Vector2d moved = rest + u.template segment<2>(D * node);
      sine += rest(0) * moved(1) - rest(1) * moved(0);
      cosine += rest.dot(moved);
    }
    return std::atan2(sine, cosine);
  }

  Scene scene_;
  double multiplicity_ = 1, dropped_ = 0;
  std::string symmetry_;
  std::shared_ptr<SolidProblem<D>> problem_;
  std::unique_ptr<TiedProblem> tied_;  ///< if ports and joints are kept as equations
};

/// Cells with their corners moved; corners are shared within a body.
template <int D>
std::string CompiledSceneOf<D>::vtu(const Eigen::VectorXd& z, double p) const {
  const mpm::Discretisation<D>& solid = problem_->solid();
  const Eigen::VectorXd u = problem_->reduction().expand(z, Eigen::VectorXd::Constant(1, p));
  std::map<std::vector<int>, int> number;
  std::ostringstream points, moved, connect, offsets, types, density, det;
  const int order2[] = {0, 1, 3, 2}, order3[] = {0, 1, 3, 2, 4, 5, 7, 6};
  for (int c = 0; c < solid.cellCount(); ++c) {
    const mpm::Grid<D>& grid = solid.grid(solid.cellBody(c));
    for (int k = 0; k < (1 << D); ++k) {
      const int corner = D == 2 ? order2[k] : order3[k];
      std::vector<int> key = {solid.cellBody(c)};
      Vector<D> x = grid.origin, local;
      for (int a = 0; a < D; ++a) {
        const int i = solid.cellAt(c)[a] + (corner >> a & 1);
        key.push_back(i);
        x(a) += grid.cell_size * i;
        local(a) = corner >> a & 1;
      }
      const auto [entry, fresh] = number.emplace(key, static_cast<int>(number.size()));
      connect << entry->second << " ";
      if (!fresh) continue;
      Eigen::VectorXd value;
      Eigen::Matrix<double, D, Eigen::Dynamic> slope;
      grid.weights(local, value, slope);
      Vector<D> d = Vector<D>::Zero();
      for (int a = 0; a < solid.stencil(); ++a) d += value(a) * u.template segment<D>(D * solid.cellNodes(c)[a]);
      points << x(0) << " " << x(1) << " " << (D == 3 ? x(D - 1) : 0.0) << "\n";
      moved << d(0) << " " << d(1) << " " << (D == 3 ? d(D - 1) : 0.0) << "\n";
    }
    offsets << (c + 1) * (1 << D) << " ";
    types << (D == 2 ? 9 : 12) << " ";
    density << solid.cell(c).density << " ";
    det << solid.deformationGradient(c, u).determinant() << " ";
  }
  std::ostringstream text;
  const auto array = [&](const char* type, const char* name, int components, const std::string& values) {
    text << "<DataArray type=\"" << type << "\" Name=\"" << name << "\" NumberOfComponents=\"" << components
         << "\" format=\"ascii\">\n"
         << values << "\n</DataArray>\n";
  };
  text << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
       << "<UnstructuredGrid>\n<Piece NumberOfPoints=\"" << number.size() << "\" NumberOfCells=\"" << solid.cellCount()
       << "\">\n<PointData Vectors=\"displacement_m\">\n";
  array("Float64", "displacement_m", 3, moved.str());
  text << "</PointData>\n<CellData>\n";
  array("Float64", "density", 1, density.str());
  array("Float64", "det_f", 1, det.str());
  text << "</CellData>\n<Points>\n";
  array("Float64", "rest_position_m", 3, points.str());
  text << "</Points>\n<Cells>\n";
  array("Int32", "connectivity", 1, connect.str());
  array("Int32", "offsets", 1, offsets.str());
  array("UInt8", "types", 1, types.str());
  text << "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return text.str();
}

}  // namespace

std::unique_ptr<CompiledScene> compileScene(const Scene& scene, int threads) {
  if (scene.dimension == 2) return std::make_unique<CompiledSceneOf<2>>(scene, threads);
  return std::make_unique<CompiledSceneOf<3>>(scene, threads);
}

}  // namespace snapwing::statics
