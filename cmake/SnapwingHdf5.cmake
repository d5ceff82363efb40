# snapwing_hdf5_in_programs: HDF5 for a program that must start fast. Debian's shared library reads from S3, too, and for that
# is linked with curl and OpenSSL, which need thirty more libraries. In its archive that driver is an object of its own, which
# nothing refers to. The archive serves programs only: its code is not for shared libraries. Where it is missing, or does
# not link without those libraries, the shared one takes its place, and predictions start more slowly.
include(CheckCSourceCompiles)
find_library(HDF5_ARCHIVE libhdf5.a HINTS ${HDF5_LIBRARY_DIRS})
if(HDF5_ARCHIVE)
  set(CMAKE_REQUIRED_INCLUDES ${HDF5_INCLUDE_DIRS})
  set(CMAKE_REQUIRED_LIBRARIES ${HDF5_ARCHIVE} z sz m ${CMAKE_DL_LIBS})
  check_c_source_compiles("#include <hdf5.h>
int main(void) { return H5Fopen(\"\", H5F_ACC_RDONLY, H5P_DEFAULT) < 0; }" HDF5_ARCHIVE_LINKS)
endif()

add_library(snapwing_hdf5_in_programs INTERFACE)
if(HDF5_ARCHIVE_LINKS)
  target_include_directories(snapwing_hdf5_in_programs SYSTEM INTERFACE ${HDF5_INCLUDE_DIRS})
  target_link_libraries(snapwing_hdf5_in_programs INTERFACE ${CMAKE_REQUIRED_LIBRARIES})
else()
  message(STATUS "HDF5's archive cannot be linked: predictions start with its shared library")
  target_link_libraries(snapwing_hdf5_in_programs INTERFACE PkgConfig::HDF5)
endif()
unset(CMAKE_REQUIRED_INCLUDES)
unset(CMAKE_REQUIRED_LIBRARIES)
