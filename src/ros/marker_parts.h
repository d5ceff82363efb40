#pragma once
/// Small parts that markers are made of.

#include <visualization_msgs/Marker.h>

#include <string>

namespace snapwing::nodes {

std_msgs::ColorRGBA colour(double red, double green, double blue, double alpha = 1.0);
geometry_msgs::Point point(double x, double y, double z);

/// Blue (-1, compressed) over sand (0) to red (+1, stretched); clamped.
std_msgs::ColorRGBA strainColour(double relative_strain);

/// Marker with unit pose and scale 1, no frame and no stamp.
visualization_msgs::Marker makeMarker(const std::string& space, int id, int type, const std_msgs::ColorRGBA& colour);

void addTriangle(visualization_msgs::Marker& list, const geometry_msgs::Point& a, const geometry_msgs::Point& b,
                 const geometry_msgs::Point& c);

/// Both faces of a flat panel, each lit from its own side.
void addPanel(visualization_msgs::Marker& list, const geometry_msgs::Point& a, const geometry_msgs::Point& b,
              const geometry_msgs::Point& c, double thickness);

/// Flat ring around z with its mid-plane at z = 0. [m]
void addWasher(visualization_msgs::Marker& list, double inner_radius, double outer_radius, double thickness);

}  // namespace snapwing::nodes
