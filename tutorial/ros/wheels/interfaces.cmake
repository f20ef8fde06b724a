# Settings for interface packages that are built for the ROS 2 of PyPI's wheels. CMake includes them after project().

set(BUILD_TESTING OFF CACHE BOOL "")
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE MinSizeRel)
endif()

# Use no ROS 2 that is installed elsewhere: only CMAKE_PREFIX_PATH counts.
set(CMAKE_FIND_USE_SYSTEM_ENVIRONMENT_PATH OFF)
set(CMAKE_FIND_USE_PACKAGE_REGISTRY OFF)

# Libraries and the Python package find the libraries by an RPATH, which takes precedence over LD_LIBRARY_PATH.
set(CMAKE_INSTALL_RPATH "$ORIGIN" "$ORIGIN/../../..")
string(APPEND CMAKE_SHARED_LINKER_FLAGS " -Wl,--disable-new-dtags")
string(APPEND CMAKE_MODULE_LINKER_FLAGS " -Wl,--disable-new-dtags")

# The wheels' targets name include folders of the machine that built them, and CMake refuses folders that don't exist.
function(forget_foreign_folders)
  get_property(targets DIRECTORY PROPERTY IMPORTED_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(folders ${target} INTERFACE_INCLUDE_DIRECTORIES)
    foreach(folder IN LISTS folders)
      if(IS_ABSOLUTE "${folder}" AND NOT EXISTS "${folder}")
        list(REMOVE_ITEM folders "${folder}")
        set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${folders}")
      endif()
    endforeach()
  endforeach()
endfunction()
cmake_language(DEFER CALL forget_foreign_folders)
