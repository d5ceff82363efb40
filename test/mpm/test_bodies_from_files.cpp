// Shapes and densities from files: STL, PNG, HDF5; what is wrong with them is said.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <png.h>

#include <Eigen/Geometry>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/mpm/density_file.h"
#include "snapwing/mpm/triangle_mesh.h"

namespace snapwing::mpm {
namespace {

std::string temporary(const std::string& name) { return ::testing::TempDir() + "snapwing_bodies_" + name; }

std::string reasonOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const common::Error& e) {
    return e.what();
  }
  return "accepted";
}

/// Box [0, 2] x [0, 1] x [0, 3] less nothing: twelve triangles turned outwards.
TriangleMesh boxMesh() {
  TriangleMesh mesh;
  for (int k = 0; k < 8; ++k) mesh.vertices.emplace_back(2.0 * (k & 1), 1.0 * (k >> 1 & 1), 3.0 * (k >> 2 & 1));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// Sphere by subdividing an octahedron.
TriangleMesh sphereMesh(int rings) {
  TriangleMesh mesh;
  const int around = 2 * rings;
  mesh.vertices = {Point3(0, 0, 1), Point3(0, 0, -1)};
  for (int i = 1; i < rings; ++i) {
    for (int j = 0; j < around; ++j) {
      const double polar = M_PI * i / rings, turn = 2 * M_PI * j / around;
      mesh.vertices.emplace_back(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar));
    }
  }
  const auto at = [&](int i, int j) { return i == 0 ? 0 : i == rings ? 1 : 2 + (i - 1) * around + j % around; };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < around; ++j) {
      if (i > 0) mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i < rings - 1) mesh.triangles.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
    }
  }
  return mesh;
}

std::string writeStl(const std::string& name, const TriangleMesh& mesh, bool binary) {
  const std::string path = temporary(name);
  std::ofstream file(path, std::ios::binary);
  if (binary) {
    std::string bytes = "solid is how this binary file begins, too";
    bytes.resize(80, ' ');
    const auto add = [&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); };
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    add(&count, 4);
    for (const auto& t : mesh.triangles) {
      bytes.append(12, '\0');
      for (const int v : t) {
        const std::array<float, 3> p = {static_cast<float>(mesh.vertices[v](0)),
                                        static_cast<float>(mesh.vertices[v](1)),
                                        static_cast<float>(mesh.vertices[v](2))};
        add(p.data(), 12);
      }
      bytes.append(2, '\0');
    }
    file << bytes;
  } else {
    file << "solid body\n";
    for (const auto& t : mesh.triangles) {
      file << " facet normal 0 0 0\n  outer loop\n";
      for (const int v : t) file << "   vertex " << mesh.vertices[v].transpose() << "\n";
      file << "  endloop\n endfacet\n";
    }
    file << "endsolid body\n";
  }
  return path;
}

TEST(Stl, BoxIsTheBoxInBothFormats) {
  for (const bool binary : {false, true}) {
    const ShapePtr shape = loadStl(writeStl("box.stl", boxMesh(), binary), 1e-3);
    EXPECT_LT((shape->bounds().high - Point3(2e-3, 1e-3, 3e-3)).norm(), 1e-12);
    int inside = 0;
    // Samples on the diagonals and edges of triangles, too: the shadows tile the plane.
    for (int k = -2; k < 9; ++k) {
      for (int j = -2; j < 7; ++j) {
        for (int i = -2; i < 11; ++i) {
          const Point3 p(0.25e-3 * i, 0.25e-3 * j, 0.5e-3 * k + 0.1e-3);
          const bool within = i >= 0 && i < 8 && j >= 0 && j < 4 && k >= 0 && k < 6;
          EXPECT_EQ(shape->contains(p), within) << p.transpose();
          inside += within ? 1 : 0;
        }
      }
    }
    EXPECT_EQ(inside, 8 * 4 * 6);
  }
}

TEST(Stl, SphereHasItsVolume) {
  const TriangleMesh mesh = sphereMesh(40);
  double exact = 0;
  for (const auto& t : mesh.triangles)
    exact += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]])) / 6;
  EXPECT_NEAR(exact, 4 * M_PI / 3, 0.02);
  const ShapePtr shape = makeMesh(mesh, "sphere");
  const int n = 50;
  int inside = 0;
  for (int c = 0; c < n * n * n; ++c) {
    const int i = c % n, j = c / n % n, k = c / (n * n);
    const Point3 p((i + 0.5) / n * 2 - 1, (j + 0.5) / n * 2 - 1, (k + 0.5) / n * 2 - 1);
    inside += shape->contains(p) ? 1 : 0;
  }
  EXPECT_NEAR(8.0 * inside / (n * n * n), exact, 2e-3 * exact);
}

TEST(Stl, DefectsAreCounted) {
  TriangleMesh mesh = boxMesh();
  mesh.triangles.pop_back();
  EXPECT_NE(reasonOf([&] { makeMesh(mesh, "part.stl"); }).find("part.stl encloses no volume: 3 open edges"),
            std::string::npos);
  mesh = boxMesh();
  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
  EXPECT_EQ(findDefects(mesh).turned, 3);
  mesh = boxMesh();
  mesh.triangles.push_back({0, 3, 5});
  EXPECT_EQ(findDefects(mesh).open + findDefects(mesh).shared_more, 3);
  mesh = boxMesh();
  mesh.triangles.push_back({0, 0, 5});
  EXPECT_EQ(findDefects(mesh).degenerate, 1);
}

/// A copy of a mesh, smaller by `factor`, moved, perhaps turned inside out.
TriangleMesh with(TriangleMesh mesh, const TriangleMesh& other, double factor, const Point3& shift, bool turned) {
  const int first = static_cast<int>(mesh.vertices.size());
  for (const Point3& v : other.vertices) mesh.vertices.push_back(factor * v + shift);
  for (std::array<int, 3> t : other.triangles) {
    if (turned) std::swap(t[1], t[2]);
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return mesh;
}

TEST(Stl, ShellsOfEqualSenseAreTheirUnion) {
  const Point3 within(0.5, 0.25, 0.75), middle = within + 0.5 * Point3(0.9, 0.4, 1.3), shell(0.1, 0.1, 0.1);
  const ShapePtr both = makeMesh(with(boxMesh(), boxMesh(), 0.5, within, false), "nested");
  EXPECT_TRUE(both->contains(middle));
  EXPECT_TRUE(both->contains(shell));
  const ShapePtr hole = makeMesh(with(boxMesh(), boxMesh(), 0.5, within, true), "hole");
  EXPECT_FALSE(hole->contains(middle));
  EXPECT_TRUE(hole->contains(shell));
  // Two that overlap, and an island within the hole.
  const ShapePtr overlapping = makeMesh(with(boxMesh(), boxMesh(), 1, Point3(1, 0.5, 1), false), "overlapping");
  EXPECT_TRUE(overlapping->contains(Point3(1.5, 0.7, 2)));
  EXPECT_TRUE(overlapping->contains(Point3(2.5, 1.2, 2)));
  EXPECT_FALSE(overlapping->contains(Point3(2.5, 0.2, 2)));
  const ShapePtr island =
      makeMesh(with(with(boxMesh(), boxMesh(), 0.5, within, true), boxMesh(), 0.1, middle, false), "island");
  EXPECT_TRUE(island->contains(middle + Point3(0.1, 0.05, 0.1)));
  EXPECT_FALSE(island->contains(middle - Point3(0.1, 0.05, 0.1)));
  // Inside out as a whole: the same body.
  TriangleMesh turned = with(boxMesh(), boxMesh(), 0.5, within, true);
  for (std::array<int, 3>& t : turned.triangles) std::swap(t[1], t[2]);
  EXPECT_FALSE(makeMesh(turned, "turned")->contains(middle));
  EXPECT_TRUE(makeMesh(turned, "turned")->contains(shell));
  EXPECT_NE(reasonOf([&] {
              makeMesh(with(boxMesh(), boxMesh(), 0.5, Point3(5, 0, 0), true), "lost.stl");
            }).find("lost.stl: the shell with a corner at (5, 0, 0) m is turned inside out and lies in no other"),
            std::string::npos);
}

/// Text as other programs write it: capitals, blanks and tabs before words, line ends of other systems, several solids,
/// a name with words of its own, no name.
TEST(Stl, TextFormsOfOtherProgramsAreRead) {
  std::ifstream in(writeStl("plain.stl", boxMesh(), false));
  std::stringstream bytes;
  bytes << in.rdbuf();
  const std::string plain = bytes.str();
  std::string capitals = plain, tabs, carriage, single, named = plain, one_line;
  for (char& c : capitals) c = static_cast<char>(std::toupper(c));
  for (const char c : plain) {
    tabs += c == '\n' ? " \t\n" : c == ' ' ? "\t " : std::string(1, c);
    carriage += c == '\n' ? "\r\n" : std::string(1, c);
    single += c == '\n' ? '\r' : c;
  }
  named.replace(0, 10, "solid facet of vertex 7");
  named.replace(named.find("endsolid body"), 13, "endsolid");
  std::string two = plain;
  two.insert(two.find(" facet", 400), "endsolid body\nsolid rest\n");
  const std::string path = temporary("form.stl");
  const TriangleMesh expected = readStl(writeStl("same.stl", boxMesh(), true), 1);
  for (const std::string& form :
       {capitals, tabs, carriage, single, named, two, " \t\n" + plain, "\xef\xbb\xbf" + plain}) {
    std::ofstream(path, std::ios::binary) << form;
    const TriangleMesh mesh = readStl(path, 1);
    EXPECT_EQ(mesh.triangles, expected.triangles) << form.substr(0, 60);
    EXPECT_EQ(mesh.vertices.size(), 8u) << form.substr(0, 60);
  }
  const auto refusal = [&](const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
    return reasonOf([&] { readStl(path, 1); });
  };
  std::string wrong = plain;
  wrong.replace(wrong.find("outer loop"), 10, "innen ring");
  EXPECT_NE(refusal(wrong).find("line 3"), std::string::npos) << refusal(wrong);
  EXPECT_NE(refusal(wrong).find("the word 'innen' is not understood"), std::string::npos) << refusal(wrong);
  wrong = plain;
  wrong.replace(wrong.find("vertex 0 0 0"), 12, "vertex 0,0 0");
  EXPECT_NE(refusal(wrong).find("line 4"), std::string::npos) << refusal(wrong);
  wrong = plain;
  wrong.insert(wrong.find("endsolid"), "solid again\n");
  EXPECT_NE(refusal(wrong).find("'endsolid' is wanted"), std::string::npos) << refusal(wrong);
}

TEST(Stl, DamagedFilesAreRefused) {
  const std::string good = writeStl("cut.stl", boxMesh(), true);
  std::ifstream in(good, std::ios::binary);
  std::stringstream bytes;
  bytes << in.rdbuf();
  for (const std::size_t length : {std::size_t(0), std::size_t(50), std::size_t(84), bytes.str().size() - 7}) {
    std::ofstream(good, std::ios::binary) << bytes.str().substr(0, length);
    EXPECT_THROW(loadStl(good, 1), common::FileError) << length;
  }
  const std::string text = temporary("bad.stl");
  std::ofstream(text) << "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nendloop\nendfacet\nendsolid a\n";
  EXPECT_NE(reasonOf([&] { loadStl(text, 1); }).find("line 4"), std::string::npos);
  std::ofstream(text) << "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n";
  EXPECT_THROW(loadStl(text, 1), common::FileError);
  EXPECT_THROW(loadStl(temporary("none.stl"), 1), common::FileError);
}

/// @param values  bytes of rows from the top, big-endian if 16 bits
std::string writePng(const std::string& name, int columns, int rows, int depth, int type, std::vector<png_byte> values,
                     bool transparent = false) {
  const std::string path = temporary(name);
  std::FILE* file = std::fopen(path.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_IHDR(png, info, columns, rows, depth, type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  const png_color black_and_white[] = {{0, 0, 0}, {255, 255, 255}};
  if (type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, black_and_white, 2);
  png_color_16 grey{};
  if (transparent) png_set_tRNS(png, info, nullptr, 1, &grey);
  png_write_info(png, info);
  const std::size_t row_bytes = values.size() / rows;
  for (int j = 0; j < rows; ++j) png_write_row(png, values.data() + j * row_bytes);
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  std::fclose(file);
  return path;
}

TEST(Png, GreyIsDensityWithItsLowestRowAtTheBottom) {
  const std::string path = writePng("grey.png", 3, 2, 8, PNG_COLOR_TYPE_GRAY, {0, 51, 255, 255, 255, 102});
  const DensityField dark = loadDensityPng(path, 3e-3, 2e-3, true), light = loadDensityPng(path, 3e-3, 2e-3, false);
  EXPECT_DOUBLE_EQ(dark.cell_size, 1e-3);
  EXPECT_DOUBLE_EQ(dark.at(0, 1), 1);
  EXPECT_DOUBLE_EQ(dark.at(1, 1), 0.8);
  EXPECT_DOUBLE_EQ(dark.at(0, 0), 0);
  EXPECT_DOUBLE_EQ(dark.at(2, 0), 0.6);
  for (int k = 0; k < 6; ++k) EXPECT_DOUBLE_EQ(dark.value[k] + light.value[k], 1);
  const std::string wide = writePng("wide.png", 2, 1, 16, PNG_COLOR_TYPE_GRAY, {0x80, 0x00, 0xff, 0xff});
  EXPECT_DOUBLE_EQ(loadDensityPng(wide, 2, 1, false).at(0, 0), 32768.0 / 65535);
  const std::string bits = writePng("bits.png", 8, 1, 1, PNG_COLOR_TYPE_GRAY, {0xa0});
  EXPECT_DOUBLE_EQ(loadDensityPng(bits, 8, 1, false).at(2, 0), 1);
  EXPECT_DOUBLE_EQ(loadDensityPng(bits, 8, 1, false).at(1, 0), 0);
}

TEST(Png, WhatIsNotGreyOrNotWholeIsRefused) {
  const auto refusal = [](const std::string& path) { return reasonOf([&] { loadDensityPng(path, 2, 1, true); }); };
  const std::string colours = writePng("rgb.png", 2, 1, 8, PNG_COLOR_TYPE_RGB, {0, 0, 0, 9, 9, 9});
  EXPECT_NE(refusal(colours).find("has colours; allowed: grey"), std::string::npos) << refusal(colours);
  EXPECT_NE(refusal(writePng("palette.png", 2, 1, 8, PNG_COLOR_TYPE_PALETTE, {0, 1})).find("palette"),
            std::string::npos);
  EXPECT_NE(refusal(writePng("alpha.png", 2, 1, 8, PNG_COLOR_TYPE_GRAY_ALPHA, {0, 9, 0, 9})).find("alpha"),
            std::string::npos);
  const std::string transparent = writePng("trns.png", 2, 1, 8, PNG_COLOR_TYPE_GRAY, {0, 9}, true);
  EXPECT_NE(refusal(transparent).find("transparent (tRNS)"), std::string::npos) << refusal(transparent);
  EXPECT_NE(refusal(writePng("shape.png", 1, 1, 8, PNG_COLOR_TYPE_GRAY, {0})).find("not square"), std::string::npos);
  const std::string good = writePng("cut.png", 2, 1, 8, PNG_COLOR_TYPE_GRAY, {0, 9});
  std::ifstream in(good, std::ios::binary);
  std::stringstream bytes;
  bytes << in.rdbuf();
  for (std::size_t length = 0; length + 12 < bytes.str().size(); length += 5) {
    std::ofstream(good, std::ios::binary) << bytes.str().substr(0, length);
    EXPECT_THROW(loadDensityPng(good, 2, 1, true), common::FileError) << length;
  }
}

std::string writeHdf5(const std::string& name, const std::vector<hsize_t>& size, const std::vector<double>& values) {
  const std::string path = temporary(name);
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t space = H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr);
  const hid_t data = H5Dcreate2(file, "density", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Dclose(data);
  H5Sclose(space);
  H5Fclose(file);
  return path;
}

TEST(Hdf5Density, RowsLieAlongY) {
  const DensityField field =
      loadDensityHdf5(writeHdf5("d.h5", {2, 3}, {0, 0.5, 1, -7, 0.25, 1}), "density", 6e-3, 4e-3);
  EXPECT_DOUBLE_EQ(field.cell_size, 2e-3);
  EXPECT_DOUBLE_EQ(field.at(1, 0), 0.5);
  EXPECT_DOUBLE_EQ(field.at(1, 1), 0.25);
  EXPECT_FALSE(field.present(0, 1));
}

TEST(Hdf5Density, WrongDataIsRefused) {
  const auto refusal = [](const std::string& path, const std::string& name) {
    return reasonOf([&] { loadDensityHdf5(path, name, 2, 1); });
  };
  EXPECT_NE(refusal(writeHdf5("r.h5", {2}, {0, 1}), "density").find("1 dimensions"), std::string::npos);
  EXPECT_NE(refusal(writeHdf5("v.h5", {1, 2}, {0, 1.5}), "density").find("row 0, column 1"), std::string::npos);
  const std::string above = refusal(writeHdf5("v.h5", {1, 2}, {0, 1.0000001}), "density");
  EXPECT_NE(above.find("1.0000001"), std::string::npos) << above;
  EXPECT_NE(refusal(writeHdf5("v.h5", {1, 2}, {0, NAN}), "density").find("nan"), std::string::npos);
  EXPECT_NE(refusal(writeHdf5("n.h5", {1, 2}, {0, 1}), "rho").find("'rho'"), std::string::npos);
  EXPECT_NE(refusal(writeHdf5("s.h5", {1, 3}, {0, 1, 1}), "density").find("not square"), std::string::npos);
  EXPECT_THROW(loadDensityHdf5(temporary("none.h5"), "density", 2, 1), common::FileError);
}

TEST(Cylinder, LiesAboutItsAxis) {
  const ShapePtr shape = makeCylinder(Point3(1, 1, 1), Point3(3, 3, 1), 0.5);
  EXPECT_TRUE(shape->contains(Point3(2, 2, 1.49)));
  EXPECT_FALSE(shape->contains(Point3(2, 2, 1.51)));
  EXPECT_FALSE(shape->contains(Point3(0.99, 0.99, 1)));
  const double reach = 0.5 * std::sqrt(0.5);
  EXPECT_LT((shape->bounds().low - Point3(1 - reach, 1 - reach, 0.5)).norm(), 1e-12);
  EXPECT_LT((shape->bounds().high - Point3(3 + reach, 3 + reach, 1.5)).norm(), 1e-12);
}

}  // namespace
}  // namespace snapwing::mpm
