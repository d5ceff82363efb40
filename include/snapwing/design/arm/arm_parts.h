#pragma once
/// Parts of the vehicle that follow from an arm's outline: the arm as a printable solid, its outline for cutting, and
/// ring and housing plates to match. Files are in millimetres.

#include <array>
#include <string>
#include <vector>

#include "snapwing/design/arm/arm_shape.h"
#include "snapwing/vehicle/vehicle.h"

namespace snapwing::design {

/// Triangles that share vertices. [m]
struct SolidMesh {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise seen from outside

  double volume() const;  ///< [m3], positive if oriented outward
  /// Every directed edge once, and its opposite once: closed, oriented, each edge between exactly two triangles.
  bool watertight() const;
  std::array<double, 3> extent() const;  ///< of the bounding box
};

/// The shape, extruded to both sides of the plane z = 0: leg_thickness for x < leg_width, bar_thickness beyond.
/// Contoured on a grid with a grid line at x = leg_width. @param cell  of the contouring grid [m], must divide
/// leg_width
SolidMesh extrudeArm(const vehicle::ArmSettings& arm, const ArmShape& shape, double cell);

std::string stlOf(const SolidMesh& mesh, const std::string& name);  ///< binary STL
/// DXF R12: closed polylines on layer CUT. @param circles  x, y, radius [m]
std::string dxfOf(const std::vector<Loop>& loops, const std::vector<std::array<double, 3>>& circles);
/// SVG at scale 1:1.
std::string svgOf(const std::vector<Loop>& loops, const std::vector<std::array<double, 3>>& circles);

struct ArmPartsReport {
  double volume = 0;  ///< [m3] of one arm
  double mass = 0;    ///< [kg]
  std::array<double, 3> extent{};
  int triangles = 0;
  bool watertight = false;
};

/// Writes arm.stl, arm.dxf, arm.svg, ring.dxf/svg, housing.dxf/svg. @throws common::FileError
ArmPartsReport saveArmParts(const vehicle::Vehicle& vehicle, const ArmShape& shape, const std::string& folder);

/// Writes outline.dxf and outline.svg of a mechanism that is no arm. @throws common::FileError
void saveOutline(const ArmShape& shape, const std::string& folder);

}  // namespace snapwing::design
