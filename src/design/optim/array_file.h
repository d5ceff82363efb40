#pragma once
/// Named arrays of numbers in an HDF5 file, with text attributes: history and checkpoints of a design.

#include <Eigen/Core>
#include <map>
#include <string>

namespace snapwing::design {

struct ArrayFile {
  std::map<std::string, Eigen::VectorXd> arrays;
  std::map<std::string, std::string> notes;  ///< units, provenance
};

/// Writes atomically. @throws common::FileError
void saveArrays(const ArrayFile& file, const std::string& path);
/// @throws common::FileError if missing or no such file
ArrayFile loadArrays(const std::string& path);

}  // namespace snapwing::design
