/// libFuzzer: HDF5 files whose content is made of the input's bytes, through the readers of force tables, wing tables,
/// densities and arrays. The files are sound for libhdf5 (1.10 reads beyond the ends of damaged ones, which no reader
/// on top of it can mend); what the readers expect of names, ranks, types, units and attributes is not kept.
#include <hdf5.h>

#include <algorithm>
#include <cstring>
#include <iterator>

#include "array_file.h"
#include "fuzz_file.h"
#include "snapwing/common/hdf5_file.h"
#include "snapwing/mpm/density_file.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/wing_table.h"

using namespace snapwing;
using fuzz::taken;

namespace {

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : at_(data), end_(data + size) {}
  int pick(int most) { return at_ == end_ ? 0 : *at_++ % (most + 1); }
  double number() {
    const double common[] = {0, 1, -1, 0.5, 1.0000001, 1e300, NAN, 3};
    const int k = pick(15);
    if (k < 8) return common[k];
    double value = 0;
    const std::size_t size = std::min<std::size_t>(sizeof(value), end_ - at_);
    std::memcpy(&value, at_, size);
    at_ += size;
    return value;
  }
  std::string text() {
    const char* const known[] = {"m", "1", "N", "J", "rad", "N/m", "snapwing_wing_table_3", "", "\xc3\xa4", "mm"};
    const int k = pick(15);
    if (k < 10) return known[k];
    std::string other;
    for (int n = pick(6); n > 0; --n) other += static_cast<char>(pick(255));
    return other;
  }
  bool more() const { return at_ != end_; }

 private:
  const std::uint8_t *at_, *end_;
};

hid_t spaceOf(Bytes& bytes, hsize_t* count) {
  const int rank = bytes.pick(4);
  hsize_t size[3];
  for (hsize_t& s : size) s = static_cast<hsize_t>(bytes.pick(4));
  if (rank == 4) return *count = 0, H5Screate(H5S_NULL);
  *count = 1;
  for (int a = 0; a < rank; ++a) *count *= size[a];
  return rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, size, nullptr);
}

void addAttribute(hid_t object, const char* name, Bytes& bytes) {
  hsize_t count = 0;
  const int kind = bytes.pick(3);
  const bool single = bytes.pick(3) > 0;
  const hid_t space = single ? H5Screate(H5S_SCALAR) : spaceOf(bytes, &count);
  if (single) count = 1;
  std::string text = bytes.text();
  const hid_t type = kind > 1 ? H5Tcopy(kind == 2 ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT) : H5Tcopy(H5T_C_S1);
  if (kind == 0) H5Tset_size(type, H5T_VARIABLE);
  if (kind == 1) H5Tset_size(type, text.size() + (bytes.pick(1) == 0 || text.empty() ? 1 : 0));
  if (kind == 1) H5Tset_strpad(type, bytes.pick(1) == 0 ? H5T_STR_NULLTERM : H5T_STR_SPACEPAD);
  if (kind < 2) H5Tset_cset(type, bytes.pick(1) == 0 ? H5T_CSET_ASCII : H5T_CSET_UTF8);
  const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  if (attribute >= 0 && count > 0) {
    const std::vector<const char*> words(count, text.c_str());
    const std::vector<double> numbers(count, bytes.number());
    const std::string fixed(count * (text.size() + 1), 'x');
    if (kind == 0) H5Awrite(attribute, type, words.data());
    if (kind == 1) H5Awrite(attribute, type, fixed.data());
    if (kind > 1) H5Awrite(attribute, H5T_NATIVE_DOUBLE, numbers.data());
  }
  if (attribute >= 0) H5Aclose(attribute);
  H5Tclose(type);
  H5Sclose(space);
}

void addData(hid_t file, const char* name, Bytes& bytes) {
  hsize_t count = 0;
  const hid_t space = spaceOf(bytes, &count);
  const hid_t types[] = {H5T_NATIVE_DOUBLE, H5T_NATIVE_INT, H5T_IEEE_F32BE, H5T_STD_I64BE, H5T_STD_U8LE};
  const int kind = bytes.pick(6);
  const hid_t type = kind < 5 ? H5Tcopy(types[kind]) : H5Tcopy(H5T_C_S1);
  if (kind == 5) H5Tset_size(type, 3);
  if (kind == 6) H5Tset_size(type, H5T_VARIABLE);
  const hid_t data = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (data >= 0) {
    std::vector<double> values(count);
    for (double& value : values) value = bytes.number();
    if (kind < 5 && count > 0) H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    for (const char* attribute : {"unit", "note"}) {
      if (bytes.pick(7) > 0) addAttribute(data, attribute, bytes);
    }
    H5Dclose(data);
  }
  H5Tclose(type);
  H5Sclose(space);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const common::hdf5::QuietErrors quiet;
  Bytes bytes(data, size);
  const std::string path = fuzz::asFile(nullptr, 0, ".h5");
  // A good file of one kind, in which some of the content is replaced.
  const std::string start =
      bytes.pick(3) == 0 ? "" : std::string(SNAPWING_FUZZ_SEEDS) + (bytes.pick(1) == 0 ? "/table.h5" : "/wing.h5");
  std::FILE* from = start.empty() ? nullptr : std::fopen(start.c_str(), "rb");
  if (from != nullptr) {
    std::vector<std::uint8_t> good(1 << 16);
    good.resize(std::fread(good.data(), 1, good.size(), from));
    std::fclose(from);
    fuzz::asFile(good.data(), good.size(), ".h5");
  }
  const hid_t file = from != nullptr ? H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT)
                                     : H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  fuzz::require(file >= 0);
  const char* const names[] = {"density",    "format_version", "arm_count",    "travel",    "force",
                               "stiffness",  "energy",         "rotation",     "min_det_f", "stable",
                               "iterations", "force_back",     "arm_rotation", "other"};
  while (bytes.more()) {
    const char* name = names[bytes.pick(static_cast<int>(std::size(names)) - 1)];
    if (H5Lexists(file, name, H5P_DEFAULT) > 0) H5Ldelete(file, name, H5P_DEFAULT);
    if (bytes.pick(5) > 0) addData(file, name, bytes);
    if (bytes.pick(3) == 0) {
      const hid_t group = H5Lexists(file, "provenance", H5P_DEFAULT) > 0
                              ? H5Gopen2(file, "provenance", H5P_DEFAULT)
                              : H5Gcreate2(file, "provenance", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
      addAttribute(bytes.pick(1) == 0 ? group : file, names[bytes.pick(13)], bytes);
      H5Gclose(group);
    }
  }
  H5Fclose(file);
  taken([&] { vehicle::loadForceTable(path).validate(); });
  taken([&] { vehicle::loadWingTable(path).validate(); });
  taken([&] { design::loadArrays(path); });
  taken([&] {
    for (const double rho : mpm::loadDensityHdf5(path, "density", 3, 2).value)
      fuzz::require(rho == -1 || (rho >= 0 && rho <= 1));
  });
  return 0;
}
