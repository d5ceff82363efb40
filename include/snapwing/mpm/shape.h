#pragma once
/// Constructive solid geometry: point sets with a bounding box. Lengths in m. Planar shapes ignore z.

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <vector>

namespace snapwing::mpm {

using Point3 = Eigen::Vector3d;

/// Axis-parallel box [m]; unbounded by default.
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
  /// A box that contains the shape, as small as known; infinite along z for planar shapes.
  virtual Box bounds() const = 0;
  /// The box, if the shape is an axis-parallel box; else null.
  virtual const Box* asBox() const { return nullptr; }
};
using ShapePtr = std::shared_ptr<const Shape>;

ShapePtr makeBox(const Box& box);
/// Circular cylinder along z (a disc, if planar), unbounded along z. @param radius  [m] > 0
ShapePtr makeDisc(double x, double y, double radius);
/// Circular cylinder. @param from, to  different centres of its end faces [m]; @param radius  [m] > 0
ShapePtr makeCylinder(const Point3& from, const Point3& to, double radius);
/// Simple polygon, unbounded along z. @param corners  in order [m]. @throws common::Error for less than three
ShapePtr makePolygon(const std::vector<Eigen::Vector2d>& corners);
/// Curved beam with the centre line y = sum_k a_k (1 - cos(2 pi (k+1) x / span)), 0 <= x <= span, and constant
/// thickness along its normal.
/// @param span  [m]; @param amplitudes  a_k [m]; @param thickness  [m]
ShapePtr makeCosineBeam(double span, const std::vector<double>& amplitudes, double thickness);
/// Boolean operations. @throws common::Error for no parts
ShapePtr makeUnion(std::vector<ShapePtr> parts);
ShapePtr makeIntersection(std::vector<ShapePtr> parts);
/// The first part minus all others.
ShapePtr makeDifference(std::vector<ShapePtr> parts);

}  // namespace snapwing::mpm
