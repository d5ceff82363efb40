#pragma once
/// Mirror planes of a scene, found from its contents (internal to the layer).

#include <array>
#include <limits>
#include <string>

#include "snapwing/scene/scene.h"

namespace snapwing::scene {

/// What lies above each plane is built, the rest is its image.
struct Mirror {
  static constexpr double NONE = -std::numeric_limits<double>::infinity();
  std::array<double, 3> at{NONE, NONE, NONE};  ///< [m]

  bool has(int axis) const { return at[axis] > NONE; }
  double multiplicity() const { return (has(0) ? 2.0 : 1.0) * (has(1) ? 2.0 : 1.0) * (has(2) ? 2.0 : 1.0); }
  /// "mirror plane x = 0.04 m"
  std::string name(int axis) const;
};

/// Planes across which all bodies, supports, pins, joints, ports, loads and monitors are their own images, and that lie
/// between cells (but for SymmetryUse::MIDDLE), so that half the cells say exactly what all of them would. A symmetric
/// scene may still move asymmetrically: planes along x and y are looked for only if the scene asks for them.
Mirror findMirrors(const Scene& scene);

/// The scene without what is only image: supports beyond the planes are left out, monitors are mirrored.
Scene halved(const Scene& scene, const Mirror& mirror);

}  // namespace snapwing::scene
