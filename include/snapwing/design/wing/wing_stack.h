#pragma once
/// Layers of a flat linkage: an order in which its pieces lie over each other so that nothing collides on the way.
///
/// Pieces are stadiums that move in parallel planes, pins are discs through several of them. Over all samples of the
/// travel, with l(i) the layer of piece i, 1 nearest to the ring, and a pin reaching from its lowest piece (grounded:
/// 0) to its highest:
///   pieces whose projections come closer than the clearance lie in different layers;
///   no piece lies in the reach of a pin that it comes too close to and is not held by;
///   no two pins that come too close have a layer in common;
///   pieces that are fixed to each other lie in neighbouring layers.
/// That is colouring a graph whose colours have an order; with few pieces all colourings are tried. The one taken has
/// the fewest layers, then the shortest pins.

#include <Eigen/Core>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "snapwing/design/wing/wing_settings.h"

namespace snapwing::design {

struct WingLayout;

/// A straight bar with round ends. All pieces and pins of one stack have the same number of samples.
struct StackPiece {
  std::string name;
  double half_width = 0, thickness = 0;              ///< [m] > 0
  std::vector<std::array<Eigen::Vector2d, 2>> ends;  ///< of its middle line, per sample [m]
};

struct StackPin {
  std::string name;
  double radius = 0;                   ///< [m] > 0
  std::vector<int> pieces;             ///< that it goes through
  bool grounded = false;               ///< held by the ring, below layer 1
  std::vector<Eigen::Vector2d> place;  ///< per sample [m]
};

struct Stack {
  std::vector<StackPiece> pieces;  ///< at most 8
  std::vector<StackPin> pins;
  std::vector<std::pair<int, int>> fixed;  ///< pieces that are fixed to each other
};

/// Two that come too close in projection.
struct Meeting {
  int first = 0, second = 0;  ///< pieces; pin and piece; or pins
  double gap = 0;             ///< [m] least distance of the outlines; negative: so deep in each other
  int sample = 0;             ///< where
};

struct PlacedPiece {
  std::string name;
  int layer = 0;  ///< from 1; 0: none
  double z = 0;   ///< lower face over the ring's side [m]
};

struct PlacedPin {
  std::string name;
  double low = 0, high = 0;  ///< ends over the ring's side [m]
  bool grounded = false;     ///< continues into the ring
};

struct StackPlan {
  bool found = false;
  std::string message;  ///< why there is none, and which single rules stand in the way
  int layers = 0;
  std::vector<PlacedPiece> pieces;
  std::vector<PlacedPin> pins;
  std::vector<Meeting> over;       ///< pieces over pieces
  std::vector<Meeting> in_way;     ///< pins in the way of pieces that they do not hold
  std::vector<Meeting> pin_pairs;  ///< pins in each other's way

  /// Null if it has no such piece, or no layers.
  const PlacedPiece* find(const std::string& name) const;
};

/// @throws common::Error for a stack or settings that make no sense
StackPlan planStack(const Stack& stack, const WingStackSettings& settings);

/// The pieces of one wing over its travel: arm bar, wing plate, edge plate, leading-edge rod and rocker, with the axle,
/// the auxiliary joint and X1, X2 as pins. The blade's panels rise out of the plane and are not among them.
/// @param samples  of the travel, evenly in the arm's rotation, at least 2
/// @throws common::Error if the loop does not close
constexpr char LEADING_EDGE_ROD[] = "leading_edge_rod";
Stack stackOf(const WingLayout& layout, int samples = 1001);

}  // namespace snapwing::design
