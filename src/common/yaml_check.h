#pragma once
/// What yaml-cpp takes and other readers do not, or what would make it run in circles (internal to common).

#include <string>

namespace snapwing::common {

/// Looks through the text before a tree is made of it. Refused with the line: more than one document, an alias of a
/// node that holds itself, merge keys (<<), more than 100 levels, aliases that unfold to more than a million entries.
/// @throws FileError; YAML::Exception for what is no YAML
void checkYaml(const std::string& text, const std::string& where);

}  // namespace snapwing::common
