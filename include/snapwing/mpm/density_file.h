#pragma once
/// Density fields from pictures and HDF5 files (CSV: density_field.h).

#include <string>

#include "snapwing/mpm/density_field.h"

namespace snapwing::mpm {

/// Grey PNG, 1 to 16 bits a pixel, no alpha: one pixel is one cell, the picture's lowest row lies at y = 0.
/// @param length, height  extent [m]: pixels must be square and fill it
/// @param dark_is_solid   black is density 1; else white is
/// @throws common::FileError if the file is missing, damaged, in colours, with a palette or with alpha
DensityField loadDensityPng(const std::string& path, double length, double height, bool dark_is_solid);

/// Two-dimensional dataset (rows along y from y = 0, columns along x) of densities 0..1; negative: no cell.
/// @throws common::FileError if it is missing, has another rank, or a value above 1 or not finite
DensityField loadDensityHdf5(const std::string& path, const std::string& dataset, double length, double height);

}  // namespace snapwing::mpm
