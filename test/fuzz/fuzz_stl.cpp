/// libFuzzer: STL in both forms, then the body that it encloses. A mutation of a binary file mends its length.
#include <algorithm>
#include <cstring>

#include "fuzz_file.h"
#include "snapwing/mpm/triangle_mesh.h"

using namespace snapwing;

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned int seed) {
  const bool binary = size >= 84 && (size - 84) % 50 == 0;
  size = LLVMFuzzerMutate(data, size, most);
  if (!binary || size < 84 || seed % 8 == 0) return size;
  const auto count = static_cast<std::uint32_t>((size - 84) / 50);
  std::memcpy(data + 80, &count, 4);
  return 84 + 50 * static_cast<std::size_t>(count);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = fuzz::asFile(data, size, ".stl");
  fuzz::taken([&] {
    const mpm::TriangleMesh mesh = mpm::readStl(path, 1e-3);
    for (const auto& t : mesh.triangles) {
      for (const int v : t) fuzz::require(v >= 0 && v < static_cast<int>(mesh.vertices.size()));
    }
    const mpm::ShapePtr shape = mpm::makeMesh(mesh, path);
    const mpm::Box box = shape->bounds();
    for (const double share : {-0.5, 0.0, 0.3, 0.5, 1.0, 1.5}) {
      const mpm::Point3 p = box.low + share * (box.high - box.low);
      if (shape->contains(p)) fuzz::require(box.contains(p));
    }
  });
  return 0;
}
