#pragma once
/// Identity of the program that computes. Stored results contain it, so that another build of the same version does not
/// resume them.

#include <string>

namespace snapwing::common {

/// snapwing's version and 16 digits of a hash of the computing code, e.g. "0.1.0+3f2a91c04be1d2aa". The code is the
/// library or program that contains `inside`, with all snapwing libraries that it links, directly or through others. A
/// tool that was rebuilt beside it is not included, nor are other libraries (BLAS, C), which only change last digits.
/// The linker's build ids are read from memory; an object without one is hashed as a file.
/// @param inside  address of an object with static storage in the caller's own library or program
/// @throws Error if no loaded object contains the address
std::string programOf(const void* inside);

}  // namespace snapwing::common
