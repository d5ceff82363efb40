# What the targets of snapwing need of others, and the targets.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
find_dependency(Eigen3 3.4)
find_dependency(PkgConfig)
if(NOT TARGET PkgConfig::LCM)
  pkg_check_modules(LCM REQUIRED IMPORTED_TARGET lcm)
endif()
include(${CMAKE_CURRENT_LIST_DIR}/snapwingTargets.cmake)
