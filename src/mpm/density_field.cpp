#include "snapwing/mpm/density_field.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"

namespace snapwing::mpm {

namespace {

struct Entry {
  int i, j;
  double density;
};

std::vector<Entry> readEntries(const std::string& path) {
  std::istringstream text(common::readFile(path));
  std::vector<Entry> entries;
  std::string line;
  bool header = true;
  for (int number = 1; std::getline(text, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    if (header) {
      if (line.rfind("i,j,rho", 0) != 0) throw common::FileError(path, "first line is not 'i,j,rho'");
      header = false;
      continue;
    }
    std::istringstream fields(line);
    Entry e{};
    char comma1 = 0, comma2 = 0;
    fields >> e.i >> comma1 >> e.j >> comma2 >> e.density;
    if (fields.fail() || comma1 != ',' || comma2 != ',' || e.i < 0 || e.j < 0 || e.i > 100000 || e.j > 100000 ||
        !(e.density >= 0 && e.density <= 1)) {
      throw common::FileError(path,
                              "line " + std::to_string(number) + " is '" + line + "'; wanted i,j,rho with rho in 0..1");
    }
    entries.push_back(e);
  }
  if (entries.empty()) throw common::FileError(path, "holds no cells");
  return entries;
}

}  // namespace

DensityField loadDensityCsv(const std::string& path, double length, double height) {
  const std::vector<Entry> entries = readEntries(path);
  DensityField field;
  for (const Entry& e : entries) {
    field.cells[0] = std::max(field.cells[0], e.i + 1);
    field.cells[1] = std::max(field.cells[1], e.j + 1);
  }
  field.cell_size = length / field.cells[0];
  if (std::abs(field.cell_size * field.cells[1] - height) > 1e-6 * height) {
    throw common::FileError(path, std::to_string(field.cells[0]) + " x " + std::to_string(field.cells[1]) +
                                      " cells are not square on a domain of " + std::to_string(length) + " x " +
                                      std::to_string(height) + " m");
  }
  field.value.assign(static_cast<std::size_t>(field.cells[0]) * field.cells[1], -1.0);
  for (const Entry& e : entries) {
    double& value = field.value[static_cast<std::size_t>(e.j) * field.cells[0] + e.i];
    if (value >= 0) {
      throw common::FileError(path, "cell " + std::to_string(e.i) + "," + std::to_string(e.j) + " is given twice");
    }
    value = e.density;
  }
  return field;
}

DensityField DensityField::resampled(double new_cell_size) const {
  DensityField result;
  result.cell_size = new_cell_size;
  for (int a = 0; a < 2; ++a) {
    const double count = cells[a] * cell_size / new_cell_size;
    result.cells[a] = static_cast<int>(std::lround(count));
    if (result.cells[a] < 1 || std::abs(count - result.cells[a]) > 1e-6 * count) {
      throw common::Error("cell size " + std::to_string(new_cell_size) +
                          " m does not divide the domain; allowed: its extent over a whole number");
    }
  }
  const double ratio = new_cell_size / cell_size;
  result.value.assign(static_cast<std::size_t>(result.cells[0]) * result.cells[1], -1.0);
  for (int j = 0; j < result.cells[1]; ++j) {
    for (int i = 0; i < result.cells[0]; ++i) {
      double covered = 0, sum = 0;
      for (int sj = static_cast<int>(j * ratio); sj < (j + 1) * ratio - 1e-9; ++sj) {
        for (int si = static_cast<int>(i * ratio); si < (i + 1) * ratio - 1e-9; ++si) {
          if (!present(si, sj)) continue;
          const double wide = std::min<double>(si + 1, (i + 1) * ratio) - std::max<double>(si, i * ratio);
          const double high = std::min<double>(sj + 1, (j + 1) * ratio) - std::max<double>(sj, j * ratio);
          if (wide <= 0 || high <= 0) continue;
          covered += wide * high;
          sum += wide * high * at(si, sj);
        }
      }
      if (covered > 0.5 * ratio * ratio) {
        result.value[static_cast<std::size_t>(j) * result.cells[0] + i] = std::min(1.0, sum / covered);
      }
    }
  }
  return result;
}

std::vector<std::vector<std::array<double, 2>>> outline(const DensityField& field, double level) {
  // Marching squares over cell centres, with a ring of void around. A crossing is named by the grid edge it lies on,
  // so that segments join to loops exactly.
  const auto value = [&](int i, int j) { return field.present(i, j) ? field.at(i, j) : 0.0; };
  using Edge = std::array<int, 3>;  // i, j, axis
  std::map<Edge, Edge> next;
  const auto crossing = [&](const Edge& e) {
    const double a = value(e[0], e[1]), b = value(e[0] + (e[2] == 0), e[1] + (e[2] == 1));
    const double t = (level - a) / (b - a);
    return std::array<double, 2>{(e[0] + 0.5 + (e[2] == 0 ? t : 0)) * field.cell_size,
                                 (e[1] + 0.5 + (e[2] == 1 ? t : 0)) * field.cell_size};
  };
  for (int j = -1; j < field.cells[1]; ++j) {
    for (int i = -1; i < field.cells[0]; ++i) {
      // Corners and edges counter-clockwise; material is kept on the left.
      const bool in[4] = {value(i, j) >= level, value(i + 1, j) >= level, value(i + 1, j + 1) >= level,
                          value(i, j + 1) >= level};
      const Edge edges[4] = {{i, j, 0}, {i + 1, j, 1}, {i, j + 1, 0}, {i, j, 1}};
      for (int k = 0; k < 4; ++k) {
        if (!(in[k] && !in[(k + 1) % 4])) continue;  // the boundary enters the square here ...
        for (int m = 1; m < 4; ++m) {
          const int out = (k + 4 - m) % 4;  // ... and leaves at the nearest edge back around the material
          if (!in[out] && in[(out + 1) % 4]) {
            next[edges[k]] = edges[out];
            break;
          }
        }
      }
    }
  }
  std::vector<std::vector<std::array<double, 2>>> loops;
  while (!next.empty()) {
    std::vector<std::array<double, 2>> loop;
    Edge edge = next.begin()->first;
    for (auto found = next.find(edge); found != next.end(); found = next.find(edge)) {
      loop.push_back(crossing(edge));
      edge = found->second;
      next.erase(found);
    }
    if (loop.size() >= 3) loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace snapwing::mpm
