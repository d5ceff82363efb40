# Precompiled headers: parsing Eigen, the standard library, googletest and roscpp is half of the work of most sources.
# Each holder compiles its header once; targets of the same kind take it over with snapwing_precompile(target kind).
# A source must still include what it uses: -DSNAPWING_PCH=OFF builds without.
option(SNAPWING_PCH "Use precompiled headers" ON)

set(SNAPWING_PCH_STANDARD <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory>
    <optional> <set> <sstream> <string> <utility> <vector>)
set(SNAPWING_PCH_EIGEN <Eigen/Core> <Eigen/Cholesky> <Eigen/Geometry> <Eigen/LU> <Eigen/SparseCore>)
set(SNAPWING_PCH_SOURCE ${CMAKE_CURRENT_LIST_DIR}/precompiled.cpp)

# A holder has the flags of its kind: libraries are compiled with -fPIC, programs with -fPIE.
function(snapwing_pch_holder kind)
  if(NOT SNAPWING_PCH)
    return()
  endif()
  cmake_parse_arguments(ARG "PROGRAM" "" "HEADERS;LINKS" ${ARGN})
  if(ARG_PROGRAM)
    add_executable(snapwing_pch_${kind} ${SNAPWING_PCH_SOURCE})
    set_target_properties(snapwing_pch_${kind} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
  else()
    add_library(snapwing_pch_${kind} STATIC ${SNAPWING_PCH_SOURCE})
    set_target_properties(snapwing_pch_${kind} PROPERTIES ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
  endif()
  target_link_libraries(snapwing_pch_${kind} PRIVATE ${ARG_LINKS})
  snapwing_compile_settings(snapwing_pch_${kind})
  target_precompile_headers(snapwing_pch_${kind} PRIVATE ${ARG_HEADERS})
endfunction()

function(snapwing_precompile target kind)
  if(TARGET snapwing_pch_${kind})
    target_precompile_headers(${target} REUSE_FROM snapwing_pch_${kind})
  endif()
endfunction()
