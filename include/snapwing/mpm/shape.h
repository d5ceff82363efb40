#pragma once
/// Constructive solid geometry: sets of points with a bounding box. Planar shapes ignore z.

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <vector>

namespace snapwing::mpm {

using Point3 = Eigen::Vector3d;

struct Box {
  Point3 low = Point3::Constant(-std::numeric_limits<double>::infinity());
  Point3 high = Point3::Constant(std::numeric_limits<double>::infinity());
  bool contains(const Point3& p, double slack = 0) const {
    return (p.array() >= low.array() - slack).all() && (p.array() <= high.array() + slack).all();
  }
};

class Shape {
 public:
  virtual ~Shape() = default;
  virtual bool contains(const Point3& point) const = 0;
  /// Smallest box known to hold the shape; infinite along z for planar shapes.
  virtual Box bounds() const = 0;
  /// The box that the shape is, axes along x, y and z; null if it is another shape.
  virtual const Box* asBox() const { return nullptr; }
};
using ShapePtr = std::shared_ptr<const Shape>;

ShapePtr makeBox(const Box& box);
/// Circular cylinder along z (a disc, if planar), unbounded along z. @param radius  [m] > 0
ShapePtr makeDisc(double x, double y, double radius);
/// Circular cylinder between the centres of its end faces, which differ. @param radius  [m] > 0
ShapePtr makeCylinder(const Point3& from, const Point3& to, double radius);
/// Simple polygon by its corners in order, unbounded along z. @throws common::Error below three corners
ShapePtr makePolygon(const std::vector<Eigen::Vector2d>& corners);
/// Curved beam of constant thickness t along the normal of y = sum_k a_k (1 - cos(2 pi (k+1) x / span)), 0 <= x <=
/// span.
/// @param amplitudes  a_k [m]
ShapePtr makeCosineBeam(double span, const std::vector<double>& amplitudes, double thickness);
ShapePtr makeUnion(std::vector<ShapePtr> parts);
ShapePtr makeIntersection(std::vector<ShapePtr> parts);
/// The first part less all others.
ShapePtr makeDifference(std::vector<ShapePtr> parts);

}  // namespace snapwing::mpm
