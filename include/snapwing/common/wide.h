#pragma once
/// SNAPWING_WIDE before a function compiles it for several widths of vectors; the processor's is chosen when the
/// program starts. Its source must be compiled with -ffp-contract=off: multiply and add are never fused, so the bits
/// stay the same everywhere.

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define SNAPWING_WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#define SNAPWING_BY_PROCESSOR  // functions may be written once for each width by hand, too
#else
#define SNAPWING_WIDE
#endif
