# find_package(snapwing) for programs of others: snapwing::common, snapwing::statics ... one target per layer, from an
# installed package or from catkin's devel space. With catkin the package file is catkin's and includes this one's targets.
foreach(library ${snapwing_libraries})
  string(REGEX REPLACE "^snapwing_" "" layer ${library})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${layer})
endforeach()
if(SNAPWING_WITH_ROS)
  set(snapwing_cmake ${snapwing_share}/cmake)
  export(EXPORT snapwingTargets NAMESPACE snapwing::
         FILE ${CATKIN_DEVEL_PREFIX}/share/${PROJECT_NAME}/cmake/snapwingTargets.cmake)
else()
  set(snapwing_cmake ${CMAKE_INSTALL_LIBDIR}/cmake/snapwing)
  include(CMakePackageConfigHelpers)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/snapwingConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES cmake/snapwing-extras.cmake DESTINATION ${snapwing_cmake} RENAME snapwingConfig.cmake)
  install(FILES ${PROJECT_BINARY_DIR}/snapwingConfigVersion.cmake DESTINATION ${snapwing_cmake})
endif()
install(EXPORT snapwingTargets NAMESPACE snapwing:: DESTINATION ${snapwing_cmake})
