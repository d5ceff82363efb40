#include "snapwing/scene/rung.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "snapwing/common/enum_names.h"
#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::scene {

namespace {

bool boundedAlongZ(const Box& box) { return std::isfinite(box.low(2)) || std::isfinite(box.high(2)); }

[[noreturn]] void refuse(const std::string& what, const std::string& rung) {
  throw common::Error(what + ": it has no meaning on the " + rung + " rung");
}

/// @return NaN if the text is no number
double toNumber(const std::string& text) {
  double value = std::nan("");
  common::parseNumber(text, &value);
  return value;
}

void readTrade(const std::string& path, std::vector<TradeRow>& rows) {
  std::map<std::string, std::size_t> column;
  std::size_t width = 0;
  for (const common::TextRow& line : common::readCsv(path)) {
    const std::vector<std::string>& fields = line.fields;
    if (column.empty()) {
      width = fields.size();
      for (std::size_t k = 0; k < width; ++k) column.emplace(fields[k], k);
      for (const char* name : {"scene", "content_sha256", "rung", "kernel", "cell_size_m", "seconds"}) {
        if (!column.count(name)) return;
      }
      if (!column.count("error") && !column.count("error_percent")) return;
      if (column.size() != width) throw common::FileError(path, "has two columns of one name");
      continue;
    }
    if (fields.size() != width) {
      throw common::FileError(path, "line " + std::to_string(line.line) + " has " + std::to_string(fields.size()) +
                                        " fields; allowed: the " + std::to_string(width) + " of the header");
    }
    const auto field = [&](const std::string& name) {
      const auto found = column.find(name);
      return found == column.end() ? std::string() : fields[found->second];
    };
    TradeRow row{field("scene"), field("content_sha256"), field("rung"), field("kernel"),
                 std::filesystem::path(path).filename().string()};
    row.cell_size = toNumber(field("cell_size_m"));
    row.seconds = toNumber(field("seconds"));
    row.error = column.count("error") ? toNumber(field("error")) : 0.01 * toNumber(field("error_percent"));
    // Runs that failed were not measured.
    if (std::isfinite(row.cell_size + row.seconds + row.error)) rows.push_back(row);
  }
}

}  // namespace

Scene asPlanar(const Scene& scene, elasticity::Plane plane) {
  if (scene.dimension == 2) return scene;
  Scene result = scene;
  result.dimension = 2;
  result.plane = plane;
  for (const SceneBody& b : scene.bodies) {
    if (!b.extruded) refuse("body '" + b.name + "' is not an extrusion", "planar");
  }
  for (auto* list : {&result.supports, &result.symmetry}) {
    for (SceneSupport& s : *list) {
      if (boundedAlongZ(s.region)) refuse("'" + s.name + "' is bounded along z", "planar");
      s.axes.erase(std::remove(s.axes.begin(), s.axes.end(), 2), s.axes.end());
    }
  }
  for (const ScenePort& p : scene.ports) {
    if (p.direction(2) != 0 || boundedAlongZ(p.region)) refuse("port '" + p.name + "' needs z", "planar");
  }
  for (const SceneLoad& l : scene.loads) {
    if (l.force(2) != 0 || boundedAlongZ(l.region)) refuse("load '" + l.name + "' needs z", "planar");
  }
  if (result.kernel == SceneKernel::LINEAR_REDUCED && plane == elasticity::Plane::STRESS)
    result.kernel = SceneKernel::LINEAR;  // plane stress has no volumetric locking
  return result;
}

Scene asVolumetric(const Scene& scene) {
  Scene result = scene;
  result.dimension = 3;
  return result;
}

double cellSizeFor(const std::string& resolution, double scene_cell_size) {
  std::string text = resolution;
  const bool factor = !text.empty() && text[0] == 'x';
  double unit = 1;
  if (factor) text = text.substr(1);
  if (!factor && text.size() > 2 && text.compare(text.size() - 2, 2, "mm") == 0) {
    unit = 1e-3;
    text.resize(text.size() - 2);
  }
  const double value = toNumber(text);
  const double cell_size = factor ? scene_cell_size / value : unit * value;
  if (!(value > 0) || !(cell_size >= 1e-9 && cell_size <= 1e3)) {
    throw common::Error("--resolution is '" + resolution +
                        "'; allowed: a cell size as 0.4mm or 4e-4 [m], or x2 for cells of half the scene's size");
  }
  return cell_size;
}

namespace {
constexpr common::EnumNames<SceneKernel, 3> KERNELS("kernel", {"linear", "linear_reduced", "quadratic"});
}  // namespace

std::string kernelName(SceneKernel kernel) { return KERNELS.name(kernel); }

SceneKernel kernelFromName(const std::string& name) { return KERNELS.value(name); }

std::vector<TradeRow> loadTrade(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    if (entry.path().extension() == ".csv") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  std::vector<TradeRow> rows;
  for (const std::string& file : files) readTrade(file, rows);
  return rows;
}

TradeRow chooseRow(const std::vector<TradeRow>& rows, const Scene& scene, std::optional<double> error,
                   std::optional<double> seconds) {
  const TradeRow* best = nullptr;
  bool same_name = false;
  std::ostringstream measured;
  for (const TradeRow& row : rows) {
    if (row.content_sha256.empty() || row.content_sha256 != scene.content_sha256) {
      same_name = same_name || row.scene == scene.name;
      continue;
    }
    measured << "\n  " << row.rung << ", " << row.kernel << ", " << 1e3 * row.cell_size << " mm: error "
             << 100 * row.error << " %, " << row.seconds << " s (" << row.file << ")";
    if ((error && row.error > *error) || (seconds && row.seconds > *seconds)) continue;
    const bool better = best == nullptr || (error ? row.seconds < best->seconds : row.error < best->error);
    if (better) best = &row;
  }
  if (best != nullptr) return *best;
  if (!measured.str().empty()) {
    throw common::Error("no measured rung of scene '" + scene.name +
                        "' satisfies what is asked; measured:" + measured.str());
  }
  throw common::Error(
      "no error was measured on this scene's bodies, material and loads" +
      std::string(same_name ? ": what was measured under the name '" + scene.name + "' is another scene" : "") +
      ". Measure it: trace the scene with --cell-size h, h/2 and h/4, take the finest as the reference, and write a "
      "CSV file into a folder for --trade with the columns scene, content_sha256 (here " +
      (scene.content_sha256.empty() ? "none: a vehicle's arm cannot be measured so" : scene.content_sha256) +
      "), rung, kernel, cell_size_m, error, seconds. Or choose yourself with --rung and --resolution");
}

}  // namespace snapwing::scene
