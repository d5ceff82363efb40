# ccache, where it is installed, keeps objects across build folders. Precompiled headers need the two laxities named here;
# without them ccache would only pass the compiler's calls on.
option(SNAPWING_CCACHE "Compile through ccache where it is installed" ON)
find_program(SNAPWING_CCACHE_PROGRAM ccache)
if(SNAPWING_CCACHE AND SNAPWING_CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  foreach(language C CXX)
    set(CMAKE_${language}_COMPILER_LAUNCHER
        ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${SNAPWING_CCACHE_PROGRAM})
  endforeach()
endif()
