#include "snapwing/mpm/density_file.h"

#include <png.h>

#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>

#include "snapwing/common/error.h"
#include "snapwing/common/hdf5_file.h"
#include "snapwing/common/plain_text.h"
#include "snapwing/common/provenance.h"

namespace snapwing::mpm {

namespace {

using common::FileError;

/// What libpng keeps while it reads from memory. Its errors jump back to `leave`; nothing with a destructor may be made
/// between setjmp and the jump.
struct PngReading {
  const std::string* bytes = nullptr;
  std::size_t at = 0;
  char message[128] = "";
  png_structp png = nullptr;
  png_infop info = nullptr;
  bool transparent = false;  ///< one grey counts as transparent

  ~PngReading() {
    if (png) png_destroy_read_struct(&png, info ? &info : nullptr, nullptr);
  }
  static void take(png_structp png, png_bytep to, std::size_t count) {
    auto* self = static_cast<PngReading*>(png_get_io_ptr(png));
    if (self->bytes->size() - self->at < count) png_error(png, "the file ends too early");
    std::memcpy(to, self->bytes->data() + self->at, count);
    self->at += count;
  }
  [[noreturn]] static void fail(png_structp png, png_const_charp what) {
    auto* self = static_cast<PngReading*>(png_get_error_ptr(png));
    std::snprintf(self->message, sizeof(self->message), "%s", what);
    png_longjmp(png, 1);
  }
  static void ignore(png_structp, png_const_charp) {}

  /// Steps between which C++ objects are made; each returns false with a message.
  bool readHeader() {
    if (setjmp(png_jmpbuf(png))) return false;
    png_set_read_fn(png, this, take);
    png_read_info(png, info);
    transparent = png_get_valid(png, info, PNG_INFO_tRNS) != 0;
    if (png_get_color_type(png, info) != PNG_COLOR_TYPE_GRAY) return true;
    png_set_expand_gray_1_2_4_to_8(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    return true;
  }
  bool readRows(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png))) return false;
    png_read_image(png, rows);
    png_read_end(png, nullptr);
    return true;
  }
};

std::string colourName(int type) {
  if (type == PNG_COLOR_TYPE_PALETTE) return "a palette";
  if (type == PNG_COLOR_TYPE_GRAY_ALPHA) return "grey with alpha";
  return "colours";
}

/// Refuses what is no grid of numbers of rank 2. @return rows, columns
std::array<hsize_t, 2> shapeOf(hid_t data, const std::string& path, const std::string& name) {
  const common::hdf5::Handle space(H5Dget_space(data), H5Sclose, path, "open the space of " + name);
  std::array<hsize_t, 2> size{};
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank != 2) {
    throw FileError(path,
                    "dataset '" + name + "' has " + std::to_string(rank) + " dimensions; allowed: 2 (rows along y)");
  }
  H5Sget_simple_extent_dims(space, size.data(), nullptr);
  const common::hdf5::Handle type(H5Dget_type(data), H5Tclose, path, "open the type of " + name);
  const H5T_class_t kind = H5Tget_class(type);
  if (kind != H5T_FLOAT && kind != H5T_INTEGER) throw FileError(path, "dataset '" + name + "' holds no numbers");
  return size;
}

}  // namespace

DensityField loadDensityPng(const std::string& path, double length, double height, bool dark_is_solid) {
  const std::string bytes = common::readFile(path);
  PngReading reading;
  reading.bytes = &bytes;
  reading.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reading, PngReading::fail, PngReading::ignore);
  if (reading.png) reading.info = png_create_info_struct(reading.png);
  if (!reading.info) throw FileError(path, "libpng is out of memory");
  if (!reading.readHeader()) throw FileError(path, std::string("is not a readable PNG: ") + reading.message);
  const int type = png_get_color_type(reading.png, reading.info);
  if (type != PNG_COLOR_TYPE_GRAY) throw FileError(path, "has " + colourName(type) + "; allowed: grey without alpha");
  if (reading.transparent) {
    throw FileError(path, "has a grey that counts as transparent (tRNS); allowed: grey without transparency");
  }
  const std::size_t columns = png_get_image_width(reading.png, reading.info),
                    rows = png_get_image_height(reading.png, reading.info);
  DensityField field = emptyDensity(path, columns, rows, length, height);
  const bool wide = png_get_bit_depth(reading.png, reading.info) == 16;
  const std::size_t row_bytes = png_get_rowbytes(reading.png, reading.info);
  std::vector<png_byte> pixels(row_bytes * rows);
  std::vector<png_bytep> row_starts(rows);
  for (std::size_t j = 0; j < rows; ++j) row_starts[j] = pixels.data() + j * row_bytes;
  if (!reading.readRows(row_starts.data())) throw FileError(path, std::string("is damaged: ") + reading.message);
  for (std::size_t j = 0; j < rows; ++j) {
    for (std::size_t i = 0; i < columns; ++i) {
      const png_byte* p = row_starts[rows - 1 - j] + (wide ? 2 * i : i);
      const double light = wide ? (256.0 * p[0] + p[1]) / 65535.0 : p[0] / 255.0;
      field.value[j * columns + i] = dark_is_solid ? 1 - light : light;
    }
  }
  return field;
}

DensityField loadDensityHdf5(const std::string& path, const std::string& dataset, double length, double height) {
  const common::hdf5::QuietErrors quiet;
  const common::hdf5::Handle file(common::hdf5::openFile(path), H5Fclose, path, "open the file");
  const common::hdf5::Handle data(H5Dopen2(file, dataset.c_str(), H5P_DEFAULT), H5Dclose, path,
                                  "find dataset '" + dataset + "'");
  const std::array<hsize_t, 2> size = shapeOf(data, path, dataset);
  DensityField field = emptyDensity(path, size[1], size[0], length, height);
  common::hdf5::readAll(data, H5T_NATIVE_DOUBLE, field.value.data(), dataset, path);
  for (std::size_t k = 0; k < field.value.size(); ++k) {
    double& value = field.value[k];
    if (!(value <= 1)) {
      throw FileError(path, "dataset '" + dataset + "' is " + common::toText(value) + " at row " +
                                std::to_string(k / size[1]) + ", column " + std::to_string(k % size[1]) +
                                "; allowed: 0 .. 1, or negative where there is no cell");
    }
    if (value < 0) value = -1;
  }
  return field;
}

}  // namespace snapwing::mpm
