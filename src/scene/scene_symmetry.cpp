#include "scene_symmetry.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "snapwing/common/elementary.h"

namespace snapwing::scene {

namespace {

/// Images along one axis at a plane.
class Image {
 public:
  Image(const Scene& scene, int axis, double at)
      : scene_(scene), axis_(axis), at_(at), slack_(1e-9 * std::max(1.0, std::abs(at)) * scene.cell_size) {}

  bool wholeScene() const {
    for (const SceneBody& body : scene_.bodies) {
      if (!same(body)) return false;
    }
    for (const SceneSupport& s : scene_.supports) {
      if (!hasImage(s)) return false;
    }
    for (const SceneSupport& s : scene_.symmetry) {
      if (s.axes[0] == axis_ || !same(s.region)) return false;
    }
    for (const ScenePin& pin : scene_.pins) {
      // Half a section's mean is not half of the mean.
      if (axis_ < 2 && (pin.kind == PinKind::MEAN || !same(axis_ == 0 ? pin.x : pin.y))) return false;
    }
    for (const SceneJoint& joint : scene_.joints) {
      if (!hasImage(joint)) return false;
    }
    for (const ScenePort& port : scene_.ports) {
      if (!same(port.region) || port.direction(axis_) != 0) return false;
    }
    for (const SceneLoad& load : scene_.loads) {
      if (!same(load.region) || load.force(axis_) != 0 || load.region.low(axis_) == load.region.high(axis_))
        return false;
    }
    for (const SceneMonitor& m : scene_.monitors) {
      if (axis_ < 2 && m.radius > 0) return false;
    }
    return scene_.gravity(axis_) == 0;
  }

 private:
  bool same(double x) const { return std::abs(x - at_) <= slack_; }
  bool same(const Box& b) const {
    const double low = b.low(axis_), high = b.high(axis_);
    if (!std::isfinite(low) && !std::isfinite(high)) return true;
    return std::isfinite(low) && std::isfinite(high) && same(0.5 * (low + high));
  }
  Point3 image(Point3 p) const {
    p(axis_) = 2 * at_ - p(axis_);
    return p;
  }
  bool images(const Box& b, const Box& other) const {
    for (int a = 0; a < 3; ++a) {
      const bool mirrored = a == axis_;
      const double low = mirrored ? 2 * at_ - b.high(a) : b.low(a), high = mirrored ? 2 * at_ - b.low(a) : b.high(a);
      const auto equal = [&](double x, double y) { return x == y || std::abs(x - y) <= slack_; };
      if (!equal(other.low(a), low) || !equal(other.high(a), high)) return false;
    }
    return true;
  }
  bool hasImage(const SceneSupport& s) const {
    if (same(s.region)) return true;
    return std::any_of(scene_.supports.begin(), scene_.supports.end(), [&](const SceneSupport& other) {
      return other.body == s.body && other.axes == s.axes && images(s.region, other.region);
    });
  }
  bool hasImage(const SceneJoint& joint) const {
    if (joint.kind == JointKind::SEGMENT) {
      // In the plane, or square to it with its middle there.
      Point3 along = joint.to - joint.from;
      const bool middle = same(0.5 * (joint.from(axis_) + joint.to(axis_)));
      along(axis_) = 0;
      return middle && (same(joint.from(axis_)) || along.norm() <= slack_);
    }
    if (joint.kind == JointKind::LINE) return axis_ == 2 || same(axis_ == 0 ? joint.x : joint.y);
    if (same(joint.region)) return true;
    return std::any_of(scene_.joints.begin(), scene_.joints.end(), [&](const SceneJoint& other) {
      return other.kind == JointKind::FACE && other.first == joint.first && other.second == joint.second &&
             images(joint.region, other.region);
    });
  }

  /// By comparing samples, none of which lies on a face of a shape on the grid.
  bool same(const SceneBody& body) const {
    if (axis_ == 2 && body.extruded) return true;
    if (!body.shape) return false;  // densities are read from a corner: no plane in the middle of their cells
    Box box = body.shape->bounds();
    if (body.extruded) box.low(2) = -(box.high(2) = 0.25 * body.thickness);
    const int axes = body.extruded ? 2 : 3;
    double count = 1;
    for (int a = 0; a < axes; ++a) count *= std::max(1.0, (box.high(a) - box.low(a)) / (0.5 * scene_.cell_size));
    const double step = 0.5 * scene_.cell_size * std::max(1.0, common::pow(count / 4e5, 1.0 / axes));
    std::array<int, 3> n{1, 1, 1};
    for (int a = 0; a < axes; ++a) n[a] = std::max(1, static_cast<int>((box.high(a) - box.low(a)) / step) + 1);
    for (int k = 0; k < n[2]; ++k) {
      for (int j = 0; j < n[1]; ++j) {
        for (int i = 0; i < n[0]; ++i) {
          const Point3 p = box.low + step * Point3(i + 0.37134, j + 0.29183, axes == 3 ? k + 0.41213 : 0);
          const Point3 q = image(p);
          const bool inside = body.shape->contains(p);
          if (inside != body.shape->contains(q)) return false;
          if (inside && body.thicknessAt(p(0), p(1)) != body.thicknessAt(q(0), q(1))) return false;
        }
      }
    }
    return true;
  }

  const Scene& scene_;
  int axis_;
  double at_, slack_;
};

/// Extent of a body along an axis.
std::array<double, 2> extent(const SceneBody& body, int axis) {
  if (axis == 2 && body.extruded) {
    double thickest = body.thickness;
    for (const auto& [region, value] : body.thickness_in) thickest = std::max(thickest, value);
    return {-0.5 * thickest, 0.5 * thickest};
  }
  if (!body.shape) return {0, body.density.cells[axis] * body.density.cell_size};
  return {body.shape->bounds().low(axis), body.shape->bounds().high(axis)};
}

/// Half a grid is the half of the whole one only if the plane lies between its cells.
bool betweenCells(const Scene& scene, int axis, double at) {
  if (scene.use_symmetry == SymmetryUse::MIDDLE) return true;  // the half is what is wanted, whatever the whole is
  return std::all_of(scene.bodies.begin(), scene.bodies.end(), [&](const SceneBody& body) {
    const double cells = (at - extent(body, axis)[0]) / scene.cell_size;
    return std::abs(cells - std::round(cells)) < 1e-6 * std::max(1.0, std::abs(cells));
  });
}

double middle(const Scene& scene, int axis) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const SceneBody& body : scene.bodies) {
    low = std::min(low, extent(body, axis)[0]);
    high = std::max(high, extent(body, axis)[1]);
  }
  return 0.5 * (low + high);
}

}  // namespace

std::string Mirror::name(int axis) const {
  std::ostringstream text;
  text << "mirror plane "
       << "xyz"[axis] << " = " << at[axis] << " m";
  return text.str();
}

Mirror findMirrors(const Scene& scene) {
  Mirror mirror;
  if (scene.use_symmetry == SymmetryUse::NONE) return mirror;
  bool moved = false;
  for (const SceneBody& body : scene.bodies) {
    if (!body.hasCells()) return mirror;
    moved = moved || body.frame.moved();
    // Bodies that turn about z and move across it keep planes of equal z.
    if (body.frame.rotation(2, 2) != 1 || body.frame.origin(2) != 0) return mirror;
  }
  for (int axis = scene.use_symmetry == SymmetryUse::ALL && !moved ? 0 : 2; axis < scene.dimension; ++axis) {
    const double at = middle(scene, axis);
    if (std::isfinite(at) && betweenCells(scene, axis, at) && Image(scene, axis, at).wholeScene()) mirror.at[axis] = at;
  }
  return mirror;
}

Scene halved(const Scene& scene, const Mirror& mirror) {
  Scene half = scene;
  for (int axis = 0; axis < 3; ++axis) {
    if (!mirror.has(axis)) continue;
    const double at = mirror.at[axis];
    const auto beyond = [&](const auto& entry) { return entry.region.high(axis) < at; };
    half.supports.erase(std::remove_if(half.supports.begin(), half.supports.end(), beyond), half.supports.end());
    half.joints.erase(std::remove_if(half.joints.begin(), half.joints.end(), beyond), half.joints.end());
    for (SceneJoint& joint : half.joints) {
      if (joint.kind != JointKind::SEGMENT) continue;
      joint.from(axis) = std::max(joint.from(axis), at);
      joint.to(axis) = std::max(joint.to(axis), at);
    }
    for (SceneMonitor& m : half.monitors) {
      if (m.at(axis) >= at) continue;
      m.at(axis) = 2 * at - m.at(axis);
      m.direction(axis) = -m.direction(axis);
    }
  }
  return half;
}

}  // namespace snapwing::scene
