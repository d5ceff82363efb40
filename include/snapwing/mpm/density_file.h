#pragma once
/// Density fields from PNG images and HDF5 files (CSV: density_field.h).

#include <string>

#include "snapwing/mpm/density_field.h"

namespace snapwing::mpm {

/// Reads a greyscale PNG, 1 to 16 bits per pixel, no alpha. One pixel is one cell; the lowest row lies at y = 0.
/// @param length, height  extent [m]: pixels must be square and fill it
/// @param dark_is_solid   black is density 1; else white is
/// @throws common::FileError if the file is missing, damaged, in colours, with a palette or with alpha
DensityField loadDensityPng(const std::string& path, double length, double height, bool dark_is_solid);

/// Reads a two-dimensional dataset (rows along y from y = 0, columns along x) of densities 0 .. 1; negative: no cell.
/// @param length, height  extent [m]: cells must be square and fill it
/// @throws common::FileError if it is missing, has another rank, or a value above 1 or not finite
DensityField loadDensityHdf5(const std::string& path, const std::string& dataset, double length, double height);

}  // namespace snapwing::mpm
