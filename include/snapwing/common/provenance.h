#pragma once
/// Hashes and versions that identify the inputs of a result.

#include <string>
#include <vector>

#include "snapwing/common/output_file.h"

namespace snapwing::common {

/// SHA-256 of bytes, as 64 hexadecimal digits.
std::string sha256(const std::string& bytes);
/// SHA-256 of a file's bytes. @throws FileError
std::string sha256OfFile(const std::string& path);
/// SHA-256 of a settings file and the files that it names, in their order; if it names none, that of the file alone.
/// @throws FileError
std::string sha256OfInputs(const std::string& path, const std::vector<std::string>& named);
/// snapwing's version, e.g. "0.1.0".
std::string version();
/// Whole file as bytes. @throws FileError
std::string readFile(const std::string& path);

}  // namespace snapwing::common
