#include "snapwing/mpm/density_field.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "snapwing/common/elementary.h"
#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"

namespace snapwing::mpm {

namespace {

/// Stiffness of a cell [1] below which it is a sliver that carries nothing.
constexpr double LEAST_STIFFNESS = 0.05;

constexpr int LARGEST_SIDE = 20000;         // cells: what no scene needs, and what a damaged file may claim
constexpr double LARGEST_COUNT = 30000000;  // cells: as many as a body may take on its grid

struct Entry {
  int i, j;
  double density;
};

std::vector<Entry> readEntries(const std::string& path) {
  const std::vector<common::TextRow> rows = common::readCsv(path);
  if (rows.empty() || rows[0].fields != std::vector<std::string>{"i", "j", "rho"}) {
    const std::string found = rows.empty() ? "the file has no line" : "it is '" + rows[0].text + "'";
    throw common::FileError(path, "first line is not 'i,j,rho': " + found);
  }
  std::vector<Entry> entries;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const std::vector<std::string>& fields = rows[k].fields;
    const auto refuse = [&](const std::string& why) {
      throw common::FileError(path, "line " + std::to_string(rows[k].line) + " is '" + rows[k].text + "'; " + why);
    };
    if (fields.size() != 3) {
      refuse("it has " + std::to_string(fields.size()) + " fields; allowed: i,j,rho, with a decimal point");
    }
    Entry e{};
    if (!common::parseInteger(fields[0], &e.i) || !common::parseInteger(fields[1], &e.j) ||
        !common::parseNumber(fields[2], &e.density)) {
      refuse("allowed: i,j,rho with whole numbers i and j and a number rho, nothing else");
    }
    if (e.i < 0 || e.j < 0 || e.i >= LARGEST_SIDE || e.j >= LARGEST_SIDE) {
      refuse("allowed: i and j in 0 .. " + std::to_string(LARGEST_SIDE - 1));
    }
    if (!(e.density >= 0 && e.density <= 1)) refuse("allowed: rho in 0 .. 1");
    entries.push_back(e);
  }
  if (entries.empty()) throw common::FileError(path, "holds no cells");
  return entries;
}

/// Cells of the domain: as stated, else told by the listed cells, which then must reach all four sides.
std::array<int, 2> cellsOf(const std::vector<Entry>& entries, std::array<int, 2> stated, const std::string& path) {
  std::array<int, 2> low = {LARGEST_SIDE, LARGEST_SIDE}, high = {0, 0};
  for (const Entry& e : entries) {
    low = {std::min(low[0], e.i), std::min(low[1], e.j)};
    high = {std::max(high[0], e.i + 1), std::max(high[1], e.j + 1)};
  }
  const auto size = [](const std::array<int, 2>& n) { return std::to_string(n[0]) + " x " + std::to_string(n[1]); };
  if (stated[0] > 0) {
    if (high[0] <= stated[0] && high[1] <= stated[1]) return stated;
    throw common::FileError(
        path, "lists cells up to " + size(high) + "; allowed: within the " + size(stated) + " cells that are stated");
  }
  if (low[0] == 0 && low[1] == 0) return high;
  throw common::FileError(path, "lists no cell with " + std::string(low[0] > 0 ? "i" : "j") +
                                    " = 0: with margins that are not listed, the number of cells of the domain cannot "
                                    "be told; allowed: state it as cells: [along x, along y] beside the file, or list "
                                    "the empty cells with rho 0");
}

}  // namespace

DensityField emptyDensity(const std::string& path, std::size_t columns, std::size_t rows, double length,
                          double height) {
  const std::string size = std::to_string(columns) + " x " + std::to_string(rows);
  if (columns < 1 || rows < 1 || columns > LARGEST_SIDE || rows > LARGEST_SIDE ||
      static_cast<double>(columns) * static_cast<double>(rows) > LARGEST_COUNT) {
    throw common::FileError(path, "holds " + size + " cells; allowed: 1 .. " + std::to_string(LARGEST_SIDE) +
                                      " a side, " + common::toText(LARGEST_COUNT) + " in all");
  }
  DensityField field;
  field.cells = {static_cast<int>(columns), static_cast<int>(rows)};
  field.cell_size = length / static_cast<double>(columns);
  if (!(std::abs(field.cell_size * static_cast<double>(rows) - height) <= 1e-6 * height)) {
    throw common::FileError(path, size + " cells are not square on a domain of " + common::toText(length) + " x " +
                                      common::toText(height) + " m");
  }
  field.value.assign(columns * rows, -1.0);
  return field;
}

DensityField loadDensityCsv(const std::string& path, double length, double height, std::array<int, 2> cells) {
  const std::vector<Entry> entries = readEntries(path);
  const std::array<int, 2> size = cellsOf(entries, cells, path);
  DensityField field = emptyDensity(path, size[0], size[1], length, height);
  for (const Entry& e : entries) {
    double& value = field.value[static_cast<std::size_t>(e.j) * field.cells[0] + e.i];
    if (value >= 0) {
      throw common::FileError(path, "cell " + std::to_string(e.i) + "," + std::to_string(e.j) + " is given twice");
    }
    value = e.density;
  }
  return field;
}

DensityField DensityField::resampled(double new_cell_size, double power) const {
  DensityField result;
  result.cell_size = new_cell_size;
  for (int a = 0; a < 2; ++a) {
    const double count = cells[a] * cell_size / new_cell_size;
    result.cells[a] = static_cast<int>(std::lround(count));
    if (result.cells[a] < 1 || std::abs(count - result.cells[a]) > 1e-6 * count) {
      throw common::Error("cell size " + common::toText(new_cell_size) +
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
          sum += wide * high * common::pow(at(si, sj), power);
        }
      }
      if (covered > 1e-9 * ratio * ratio) {
        if (power > 1 && sum < LEAST_STIFFNESS * ratio * ratio) continue;
        const double mean = common::pow(sum / (ratio * ratio), 1 / power);
        result.value[static_cast<std::size_t>(j) * result.cells[0] + i] = std::min(1.0, mean);
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
