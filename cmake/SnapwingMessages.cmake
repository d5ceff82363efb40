# ROS messages, services and actions; they are generated into catkin's devel space in the build folder.
set(SNAPWING_CATKIN actionlib actionlib_msgs diagnostic_msgs diagnostic_updater geometry_msgs roscpp sensor_msgs
    std_msgs std_srvs tf2 tf2_ros visualization_msgs)
find_package(catkin REQUIRED COMPONENTS message_generation rostest ${SNAPWING_CATKIN})
find_package(rosbag_storage REQUIRED)
find_package(tf2_msgs REQUIRED)
file(GLOB snapwing_msgs RELATIVE ${PROJECT_SOURCE_DIR}/msg CONFIGURE_DEPENDS msg/*.msg)
file(GLOB snapwing_srvs RELATIVE ${PROJECT_SOURCE_DIR}/srv CONFIGURE_DEPENDS srv/*.srv)
file(GLOB snapwing_actions RELATIVE ${PROJECT_SOURCE_DIR}/action CONFIGURE_DEPENDS action/*.action)
add_message_files(FILES ${snapwing_msgs})
add_service_files(FILES ${snapwing_srvs})
add_action_files(FILES ${snapwing_actions})
catkin_python_setup()
generate_messages(DEPENDENCIES actionlib_msgs geometry_msgs std_msgs)
catkin_package(INCLUDE_DIRS include LIBRARIES snapwing_common snapwing_vehicle snapwing_rom snapwing_planning
               CATKIN_DEPENDS message_runtime ${SNAPWING_CATKIN} CFG_EXTRAS snapwing-extras.cmake)
