// Triangles from STL files, binary or text.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/common/provenance.h"
#include "snapwing/mpm/triangle_mesh.h"

namespace snapwing::mpm {

namespace {

using common::FileError;

/// Gathers corners; equal places share a number.
class Welder {
 public:
  explicit Welder(double unit) : unit_(unit) {}
  int add(const std::array<float, 3>& corner) {
    // -0 and 0 are the same place.
    const std::array<float, 3> key = {corner[0] + 0.0f, corner[1] + 0.0f, corner[2] + 0.0f};
    const auto [entry, fresh] = numbers_.emplace(key, static_cast<int>(mesh.vertices.size()));
    if (fresh) mesh.vertices.push_back(unit_ * Point3(corner[0], corner[1], corner[2]));
    return entry->second;
  }
  TriangleMesh mesh;

 private:
  double unit_;
  std::map<std::array<float, 3>, int> numbers_;
};

bool finite(const std::array<float, 3>& p) { return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]); }

TriangleMesh readBinary(const std::string& path, const std::string& bytes, double unit) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  Welder welder(unit);
  for (std::uint32_t t = 0; t < count; ++t) {
    std::array<int, 3> triangle{};
    for (int k = 0; k < 3; ++k) {
      std::array<float, 3> corner{};
      std::memcpy(corner.data(), bytes.data() + 84 + 50 * static_cast<std::size_t>(t) + 12 + 12 * k, 12);
      if (!finite(corner)) throw FileError(path, "triangle " + std::to_string(t) + " has a corner that is not finite");
      triangle[k] = welder.add(corner);
    }
    welder.mesh.triangles.push_back(triangle);
  }
  return std::move(welder.mesh);
}

std::string small(std::string word) {
  for (char& c : word) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return word;
}

/// Reads statement by statement. Letters may be large or small, blanks and line ends anywhere between words; what
/// follows `solid` and `endsolid` in their line is a name.
class TextReader {
 public:
  TextReader(const std::string& path, double unit) : path_(path), welder_(unit) {}

  TriangleMesh read(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      ++number_;
      line_ = line;
      std::istringstream words(line);
      for (std::string word; words >> word;) statement(small(word), word, words);
    }
    if (in_solid_ || in_facet_) throw FileError(path_, "ends in the middle: no 'endsolid'");
    return std::move(welder_.mesh);
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw FileError(path_, "line " + std::to_string(number_) + " is '" + line_.substr(0, 80) + "'; " + why);
  }
  void require(bool good, const std::string& why) const {
    if (!good) refuse(why);
  }
  static void skipLine(std::istringstream& words) { words.ignore(std::numeric_limits<std::streamsize>::max()); }

  void statement(const std::string& word, const std::string& written, std::istringstream& words) {
    if (word == "solid") {
      require(!in_solid_, "'endsolid' is wanted before the next solid");
      in_solid_ = true;
      skipLine(words);
    } else if (word == "endsolid") {
      require(in_solid_ && !in_facet_, "it ends no solid, or one in the middle of a facet");
      in_solid_ = false;
      skipLine(words);
    } else if (word == "facet") {
      require(in_solid_ && !in_facet_, "a facet is wanted within a solid and after 'endfacet'");
      in_facet_ = true;
      std::string skipped;  // the normal follows from the corners
      for (int k = 0; k < 4; ++k) words >> skipped;
    } else if (word == "outer") {
      std::string loop;
      require(words >> loop && small(loop) == "loop", "wanted 'outer loop'");
    } else if (word == "vertex") {
      vertex(words);
    } else if (word == "endfacet") {
      endFacet();
    } else {
      require(word == "endloop", "the word '" + written.substr(0, 40) +
                                     "' is not understood; allowed: solid, facet normal, outer loop, vertex x y z, "
                                     "endloop, endfacet, endsolid");
    }
  }
  void vertex(std::istringstream& words) {
    require(in_facet_, "a vertex outside of a facet");
    std::array<float, 3> corner{};
    for (float& x : corner) {
      std::string word;
      double value = 0;
      require(words >> word && common::parseNumber(word, &value) && std::isfinite(static_cast<float>(value)),
              "wanted vertex x y z");
      x = static_cast<float>(value);
    }
    corners_.push_back(welder_.add(corner));
  }
  void endFacet() {
    if (corners_.size() != 3) {
      throw FileError(path_, "the facet that ends in line " + std::to_string(number_) + " has " +
                                 std::to_string(corners_.size()) + " corners; allowed: 3");
    }
    welder_.mesh.triangles.push_back({corners_[0], corners_[1], corners_[2]});
    corners_.clear();
    in_facet_ = false;
  }

  const std::string& path_;
  Welder welder_;
  std::vector<int> corners_;
  std::string line_;
  int number_ = 0;
  bool in_solid_ = false, in_facet_ = false;
};

/// A text file begins with the word solid, after blanks and the mark of UTF-8.
bool beginsAsText(const std::string& bytes) {
  const std::size_t mark = bytes.compare(0, 3, "\xef\xbb\xbf") == 0 ? 3 : 0;
  const std::size_t first = bytes.find_first_not_of(" \t\r\n", mark);
  return first != std::string::npos && small(bytes.substr(first, 5)) == "solid";
}

}  // namespace

TriangleMesh readStl(const std::string& path, double unit) {
  const std::string bytes = common::readFile(path);
  // Binary files may begin with "solid", too: their length decides.
  std::uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, bytes.data() + 80, 4);
  const std::size_t wanted = 84 + 50 * static_cast<std::size_t>(count);
  TriangleMesh mesh;
  if (bytes.size() >= 84 && bytes.size() == wanted) {
    mesh = readBinary(path, bytes, unit);
  } else if (beginsAsText(bytes) && bytes.find('\0') == std::string::npos) {
    mesh = TextReader(path, unit).read(common::plainText(bytes, path));
  } else {
    throw FileError(path,
                    "is not an STL: neither text that begins with 'solid', nor binary of the length that its header "
                    "states (" +
                        std::to_string(count) + " triangles take " + std::to_string(wanted) + " bytes, the file has " +
                        std::to_string(bytes.size()) + ")");
  }
  if (mesh.triangles.empty()) throw FileError(path, "holds no triangles");
  return mesh;
}

}  // namespace snapwing::mpm
