# Install rules: headers, libraries, programs, scripts and everything that launch files and tools read.
get_property(snapwing_libraries GLOBAL PROPERTY SNAPWING_LIBRARIES)
get_property(snapwing_programs GLOBAL PROPERTY SNAPWING_PROGRAMS)

if(SNAPWING_WITH_ROS)
  set(snapwing_lib ${CATKIN_PACKAGE_LIB_DESTINATION})
  set(snapwing_bin ${CATKIN_PACKAGE_BIN_DESTINATION})
  set(snapwing_share ${CATKIN_PACKAGE_SHARE_DESTINATION})
else()
  set(snapwing_lib ${CMAKE_INSTALL_LIBDIR})
  set(snapwing_bin ${CMAKE_INSTALL_LIBDIR}/snapwing)
  set(snapwing_share ${CMAKE_INSTALL_DATADIR}/snapwing)
endif()

install(TARGETS ${snapwing_libraries} snapwing_lcm EXPORT snapwingTargets LIBRARY DESTINATION ${snapwing_lib})
install(TARGETS ${snapwing_programs} RUNTIME DESTINATION ${snapwing_bin})
install(DIRECTORY ${PROJECT_BINARY_DIR}/lcm_types/snapwing_lcm DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY include/snapwing DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY config data launch rviz lcm DESTINATION ${snapwing_share})
if(SNAPWING_WITH_ROS)
  catkin_install_python(PROGRAMS scripts/make_report scripts/plot_curve scripts/record_run scripts/run_scenario
                        DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
endif()

include(SnapwingExport)
