#pragma once
/// Parts of one wing to make: flat bars with pin holes as STL (millimetres, for printing) and DXF (millimetres, for
/// cutting), and the list of all parts. A bar is a stadium: the straight line between two holes, widened by half the
/// bar's width, with round ends.

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "snapwing/design/wing/wing_layout.h"

namespace snapwing::design {

/// One flat bar between two holes.
struct FlatBar {
  double length = 0;         ///< between the holes' centres [m]
  double width = 0;          ///< [m]
  double thickness = 0;      ///< [m]
  double hole_diameter = 0;  ///< [m] less than width
};

struct WingPart {
  std::string name;  ///< file name without ending
  FlatBar bar;
  int count = 0;  ///< for both wings
  std::string use;
};

/// A triangle mesh, closed and oriented outward. [m]
struct PartMesh {
  std::vector<std::array<Eigen::Vector3d, 3>> triangles;
  double volume() const;  ///< signed, positive if oriented outward [m3]
};

/// Arm bar (axle to X1), wing plate (X1 to X2), edge plate (X2 along the leading edge, riveted to the wing plate and
/// to the rod) and rocker.
std::vector<WingPart> partsOf(const WingLayout& layout);
/// @param segments  per full circle, a multiple of 4, at least 8. @throws common::Error if the holes meet or break out
PartMesh meshOf(const FlatBar& bar, int segments = 64);
/// ASCII STL in millimetres.
std::string stlOf(const PartMesh& mesh, const std::string& name);
/// DXF R12 in millimetres: outline of lines and arcs on layer CUT, holes as circles.
std::string dxfOf(const FlatBar& bar);
/// CSV of every part, bought ones too (pins, leading-edge rod), lengths in millimetres, masses in grams.
/// @param plan  gives layer and lower face of each flat part and the lengths of the pins; without a found one these
///   columns are empty and pins are three bars long
std::string partList(const WingLayout& layout, const StackPlan& plan = {});
/// Writes all of these into a folder. @throws common::FileError
void saveParts(const WingLayout& layout, const StackPlan& plan, const std::string& folder);

}  // namespace snapwing::design
