#pragma once
/// Markers that show the vehicle: ring, rotors with thrust arrows, housing, arms as the statics computed them at the
/// given travel, wings, and a label with the mode. It draws its inputs; it estimates nothing.
///
/// Frames: the ring frame has its origin in the ring's centre, z along the thrust. The housing frame is below and
/// moves by -u along z. An arm's coordinates (x outward, y up) lie in the vertical plane through the ring's axis:
/// radius = housing_radius + x, z = -axle_below_ring + (y - pin_y).

#include <visualization_msgs/MarkerArray.h>

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/mode.h"
#include "snapwing/vehicle/vehicle.h"
#include "snapwing/vehicle/wing_table.h"
#include "triangulation.h"

namespace snapwing::nodes {

struct PictureSettings {
  std::string ring_frame = "base_link";
  std::string housing_frame = "housing";
  double strain_scale = 0.10;  ///< [1] strain of the outline shown in full colour
};

struct PictureState {
  double travel = 0;                            ///< u [m]
  vehicle::Mode mode = vehicle::Mode::UNKNOWN;  ///< colours the label
  std::string label;                            ///< text over the vehicle
  double alpha = 1;                             ///< [0, 1] of everything, less where the mode is not known
  double ghost_travel = NAN;                    ///< u [m] of a second picture beside it, faint; NaN = none
  double wing_left = NAN, wing_right = NAN;     ///< u [m] at which the table has that wing so; NaN = at `travel`
  std::vector<double> thrust;                   ///< share of full thrust [0, 1] of each rotor; may be empty
  ros::Time stamp;
};

class VehiclePicture {
 public:
  VehiclePicture(const vehicle::Vehicle& vehicle, const vehicle::ForceTable& table, const PictureSettings& settings);

  /// Shows the designed wings; without them no wings are shown. @param wing  with a blade
  void useWing(const vehicle::WingTable& wing) { wing_ = wing; }

  /// Same namespaces and ids on every call, so that each call replaces the last picture.
  visualization_msgs::MarkerArray draw(const PictureState& state) const;

  /// Height of the housing's centre in the ring frame at travel u. [m]
  double housingHeight(double travel) const;
  /// Outline of an arm at travel u, between the two nearest computed ones. Arm coordinates [m]
  std::vector<Loop> outline(double travel) const;
  /// Change of length of the outline around each of its points, relative to rest. [1]
  std::vector<std::vector<double>> outlineStrain(const std::vector<Loop>& moved) const;

 private:
  /// A computed shape with the triangles that fill it.
  struct Shape {
    double travel;
    std::vector<Loop> loops;
    std::vector<std::array<VertexId, 3>> triangles;
  };
  std::size_t nearest(double travel) const;
  void drawFrame(visualization_msgs::MarkerArray& out, const PictureState& state) const;
  void drawRotors(visualization_msgs::MarkerArray& out, const PictureState& state) const;
  void drawArms(visualization_msgs::MarkerArray& out, const PictureState& state) const;
  void drawMoving(visualization_msgs::MarkerArray& out, const PictureState& state) const;
  /// Arms, wings and housing at the ghost's travel, under names of their own that go out by themselves.
  void drawGhost(visualization_msgs::MarkerArray& out, const PictureState& state) const;
  void drawLabel(visualization_msgs::MarkerArray& out, const PictureState& state) const;
  geometry_msgs::Point place(double azimuth, double x, double y, double across) const;

  vehicle::Vehicle vehicle_;
  PictureSettings settings_;
  std::vector<Loop> rest_;
  std::vector<Shape> shapes_;
  std::optional<vehicle::WingTable> wing_;
};

}  // namespace snapwing::nodes
