#pragma once
/// Which program computes. Results that are kept name it, so that no other build of the same version resumes them.

#include <string>

namespace snapwing::common {

/// snapwing's version and 16 digits of a hash over the code that computes, e.g. "0.1.0+3f2a91c04be1d2aa". The code is
/// the library or program that holds `inside`, with all snapwing libraries that it links, directly or through others:
/// a tool that was rebuilt beside it does not count. Other libraries (BLAS, C) do not count either: they move last
/// digits. Reads the linker's build ids from memory; an object without one is hashed as a file.
/// @param inside  address of an object with static storage in the caller's own library or program
/// @throws Error if no loaded object holds the address
std::string programOf(const void* inside);

}  // namespace snapwing::common
