# SPDX-License-Identifier: Apache-2.0
find_package(OpenImageIO REQUIRED GLOBAL)
# Debian's package names include folders of OpenCV that it neither needs nor depends on.
get_target_property(include_folders OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
foreach(folder ${include_folders})
  if(NOT EXISTS ${folder})
    list(REMOVE_ITEM include_folders ${folder})
  endif()
endforeach()
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES
                      INTERFACE_INCLUDE_DIRECTORIES "${include_folders}")
