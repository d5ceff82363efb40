#pragma once
/// Arguments of the programs that roslaunch may start.

#include <string>
#include <vector>

/// Arguments without the remappings (name:=value) that roslaunch adds to whatever it starts; last first, as CLI11
/// wants.
inline std::vector<std::string> ownArguments(int argc, char** argv) {
  std::vector<std::string> own;
  for (int i = argc - 1; i > 0; --i) {
    if (std::string(argv[i]).find(":=") == std::string::npos) own.emplace_back(argv[i]);
  }
  return own;
}
