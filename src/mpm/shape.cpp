#include "snapwing/mpm/shape.h"

#include <cmath>

#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"

namespace snapwing::mpm {

namespace {

class BoxShape : public Shape {
 public:
  explicit BoxShape(const Box& box) : box_(box) {}
  bool contains(const Point3& p) const override { return box_.contains(p); }
  Box bounds() const override { return box_; }
  const Box* asBox() const override { return &box_; }

 private:
  Box box_;
};

class Disc : public Shape {
 public:
  Disc(double x, double y, double radius) : x_(x), y_(y), radius_(radius) {}
  bool contains(const Point3& p) const override { return common::hypot(p(0) - x_, p(1) - y_) <= radius_; }
  Box bounds() const override {
    Box box;
    box.low.head<2>() = Eigen::Vector2d(x_ - radius_, y_ - radius_);
    box.high.head<2>() = Eigen::Vector2d(x_ + radius_, y_ + radius_);
    return box;
  }

 private:
  double x_, y_, radius_;
};

class Cylinder : public Shape {
 public:
  Cylinder(const Point3& from, const Point3& to, double radius)
      : from_(from), axis_((to - from).normalized()), length_((to - from).norm()), radius_(radius) {}
  bool contains(const Point3& p) const override {
    const double along = axis_.dot(p - from_);
    return along >= 0 && along <= length_ && (p - from_ - along * axis_).norm() <= radius_;
  }
  Box bounds() const override {
    // A disc with normal n reaches radius sqrt(1 - n_a^2) along axis a.
    const Point3 reach = radius_ * (Point3::Ones() - axis_.cwiseAbs2()).cwiseMax(0).cwiseSqrt();
    const Point3 to = from_ + length_ * axis_;
    return {from_.cwiseMin(to) - reach, from_.cwiseMax(to) + reach};
  }

 private:
  Point3 from_, axis_;
  double length_, radius_;
};

class Polygon : public Shape {
 public:
  explicit Polygon(const std::vector<Eigen::Vector2d>& corners) : corners_(corners) {
    if (corners.size() < 3) throw common::Error("a polygon needs at least three corners");
  }
  bool contains(const Point3& p) const override {
    bool inside = false;
    for (std::size_t k = 0, last = corners_.size() - 1; k < corners_.size(); last = k++) {
      const Eigen::Vector2d &a = corners_[k], &b = corners_[last];
      if ((a(1) > p(1)) == (b(1) > p(1))) continue;
      if (p(0) < a(0) + (b(0) - a(0)) * (p(1) - a(1)) / (b(1) - a(1))) inside = !inside;
    }
    return inside;
  }
  Box bounds() const override {
    Box box;
    box.low.head<2>() = box.high.head<2>() = corners_[0];
    for (const Eigen::Vector2d& c : corners_) {
      box.low.head<2>() = box.low.head<2>().cwiseMin(c);
      box.high.head<2>() = box.high.head<2>().cwiseMax(c);
    }
    return box;
  }

 private:
  std::vector<Eigen::Vector2d> corners_;
};

class CosineBeam : public Shape {
 public:
  CosineBeam(double span, const std::vector<double>& amplitudes, double thickness)
      : span_(span), amplitudes_(amplitudes), half_(0.5 * thickness) {
    lowest_ = highest_ = 0;
    for (int i = 0; i <= 1000; ++i) {
      const double y = height(span * i / 1000, 0);
      lowest_ = std::min(lowest_, y);
      highest_ = std::max(highest_, y);
    }
  }
  bool contains(const Point3& p) const override {
    if (p(0) < -1e-12 * span_ || p(0) > span_ * (1 + 1e-12)) return false;
    // Foot of the normal: stationary distance to the centre line, by Newton from straight above.
    double s = p(0);
    for (int i = 0; i < 30; ++i) {
      const double gap = height(s, 0) - p(1), slope = height(s, 1);
      const double value = s - p(0) + gap * slope, change = 1 + slope * slope + gap * height(s, 2);
      const double step = value / (change > 0.1 ? change : 1 + slope * slope);
      s = std::min(std::max(s - step, 0.0), span_);
      if (std::abs(step) < 1e-14 * span_) break;
    }
    return common::hypot(s - p(0), height(s, 0) - p(1)) <= half_;
  }
  Box bounds() const override {
    Box box;
    box.low.head<2>() = Eigen::Vector2d(0, lowest_ - half_);
    box.high.head<2>() = Eigen::Vector2d(span_, highest_ + half_);
    return box;
  }

 private:
  /// Centre line and its derivatives.
  double height(double x, int derivative) const {
    double sum = 0;
    for (std::size_t k = 0; k < amplitudes_.size(); ++k) {
      const double w = 2 * M_PI * static_cast<double>(k + 1) / span_;
      sum += amplitudes_[k] * (derivative == 0   ? 1 - common::cos(w * x)
                               : derivative == 1 ? w * common::sin(w * x)
                                                 : w * w * common::cos(w * x));
    }
    return sum;
  }
  double span_;
  std::vector<double> amplitudes_;
  double half_, lowest_, highest_;
};

enum class Operation { UNION, INTERSECTION, DIFFERENCE };

class Combined : public Shape {
 public:
  Combined(Operation operation, std::vector<ShapePtr> parts) : operation_(operation), parts_(std::move(parts)) {
    if (parts_.empty()) throw common::Error("a union, intersection or difference needs at least one shape");
  }
  bool contains(const Point3& p) const override {
    bool result = parts_[0]->contains(p);
    for (std::size_t k = 1; k < parts_.size(); ++k) {
      const bool in = parts_[k]->contains(p);
      if (operation_ == Operation::UNION) result = result || in;
      if (operation_ == Operation::INTERSECTION) result = result && in;
      if (operation_ == Operation::DIFFERENCE) result = result && !in;
    }
    return result;
  }
  Box bounds() const override {
    Box box = parts_[0]->bounds();
    for (std::size_t k = 1; k < parts_.size(); ++k) {
      const Box other = parts_[k]->bounds();
      if (operation_ == Operation::UNION) {
        box.low = box.low.cwiseMin(other.low);
        box.high = box.high.cwiseMax(other.high);
      } else if (operation_ == Operation::INTERSECTION) {
        box.low = box.low.cwiseMax(other.low);
        box.high = box.high.cwiseMin(other.high);
      }
    }
    return box;
  }

 private:
  Operation operation_;
  std::vector<ShapePtr> parts_;
};

}  // namespace

ShapePtr makeBox(const Box& box) { return std::make_shared<BoxShape>(box); }
ShapePtr makeDisc(double x, double y, double radius) { return std::make_shared<Disc>(x, y, radius); }
ShapePtr makeCylinder(const Point3& from, const Point3& to, double radius) {
  return std::make_shared<Cylinder>(from, to, radius);
}

ShapePtr makePolygon(const std::vector<Eigen::Vector2d>& corners) { return std::make_shared<Polygon>(corners); }
ShapePtr makeCosineBeam(double span, const std::vector<double>& amplitudes, double thickness) {
  return std::make_shared<CosineBeam>(span, amplitudes, thickness);
}
ShapePtr makeUnion(std::vector<ShapePtr> parts) {
  return std::make_shared<Combined>(Operation::UNION, std::move(parts));
}
ShapePtr makeIntersection(std::vector<ShapePtr> parts) {
  return std::make_shared<Combined>(Operation::INTERSECTION, std::move(parts));
}
ShapePtr makeDifference(std::vector<ShapePtr> parts) {
  return std::make_shared<Combined>(Operation::DIFFERENCE, std::move(parts));
}

}  // namespace snapwing::mpm
