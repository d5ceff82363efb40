#pragma once
/// Change of a scene's fidelity (rung): planar or volumetric, another cell size, or the cheapest one whose measured
/// error is small enough.

#include <optional>
#include <string>
#include <vector>

#include "snapwing/scene/scene.h"

namespace snapwing::scene {

/// The planar scene; a planar one is returned as it is.
/// @param plane  plane stress or plane strain of a volumetric scene's slice
/// @throws common::Error naming the body, support, port or load that is not extruded along z
Scene asPlanar(const Scene& scene, elasticity::Plane plane);
/// The volumetric scene.
Scene asVolumetric(const Scene& scene);

/// Cell size [m] of the option --resolution: "0.4mm" or "4e-4" (metres), or "x2" for half the scene's cell size.
/// @param scene_cell_size  [m]. @throws common::Error for other text, or a size outside 1e-9 .. 1e3 m
double cellSizeFor(const std::string& resolution, double scene_cell_size);

/// linear, linear_reduced or quadratic.
std::string kernelName(SceneKernel kernel);
/// @throws common::Error
SceneKernel kernelFromName(const std::string& name);

/// Measured error and cost of one discretisation of a scene. `file`: name of the table.
struct TradeRow {
  std::string scene, content_sha256, rung, kernel, file;
  double cell_size = 0;  ///< [m]
  double error = 0;      ///< relative to the reference [1]
  double seconds = 0;    ///< [s] of the whole curve, on the machine of the measurement
};

/// All rows of the tables `*.csv` in a folder that have the columns scene, content_sha256, rung, kernel, cell_size_m,
/// error (or error_percent) and seconds, in any order. Other files, and rows with numbers that are not finite, are
/// ignored. Empty if there is no such folder. @throws common::FileError for a row of another length
std::vector<TradeRow> loadTrade(const std::string& folder);

/// The fastest row of a scene with at most this error, or, if no error is given, the most accurate one within the time.
/// Both limits may be given. Rows are matched by content_sha256, not by name.
/// @param error  [1]; @param seconds  [s]. @throws common::Error with the measured rows, if none satisfies the limits
TradeRow chooseRow(const std::vector<TradeRow>& rows, const Scene& scene, std::optional<double> error,
                   std::optional<double> seconds);

}  // namespace snapwing::scene
