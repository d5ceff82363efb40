#pragma once
/// The same scene asked of another rung: planar or volumetric, coarser or finer, or the cheapest one that was measured
/// to be good enough.

#include <optional>
#include <string>
#include <vector>

#include "snapwing/scene/scene.h"

namespace snapwing::scene {

/// @param plane  how a solid's slice behaves when it becomes planar
/// @throws common::Error naming what has no meaning on that rung
Scene asPlanar(const Scene& scene, elasticity::Plane plane);
Scene asVolumetric(const Scene& scene);

/// "0.4mm" or "4e-4" (metres): that cell size; "x2": cells of half the scene's size. @return cell size [m]
/// @throws common::Error
double cellSizeFor(const std::string& resolution, double scene_cell_size);

std::string kernelName(SceneKernel kernel);
/// @throws common::Error
SceneKernel kernelFromName(const std::string& name);

/// One measured way to trace a scene.
struct TradeRow {
  std::string scene, content_sha256, rung, kernel, file;
  double cell_size = 0;  ///< [m]
  double error = 0;      ///< share of the reference [1]
  double seconds = 0;    ///< of the whole curve, where it was measured
};

/// All rows of the tables `*.csv` in a folder that have the columns scene, content_sha256, rung, kernel, cell_size_m,
/// error (or error_percent) and seconds, in any order; files without them are left alone. Empty if there is no such
/// folder.
std::vector<TradeRow> loadTrade(const std::string& folder);

/// The cheapest row of a scene with at most that error, or the most accurate one within the time; both may be asked.
/// Rows belong to what they were measured on by its content, not by its name.
/// @throws common::Error saying what was measured, if nothing satisfies it
TradeRow chooseRow(const std::vector<TradeRow>& rows, const Scene& scene, std::optional<double> error,
                   std::optional<double> seconds);

}  // namespace snapwing::scene
