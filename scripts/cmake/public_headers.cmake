# What of the tree is for those who link it. Run by itself (cmake -P), it lists the public headers.

# The component of find_package that a folder is of: calib's folders are one, but for those that
# load what the others do without. Empty: the programs' own.
function(rgbdt_component_of_folder folder result)
  set(component)
  if(folder MATCHES "^calib/(methods|present|simulate)")
    set(component ${CMAKE_MATCH_1})
  elseif(folder STREQUAL calib/monitor)
    set(component methods)  # it watches by one of them
  elseif(folder STREQUAL services/simulator)
    set(component simulate)
  elseif(folder MATCHES "^calib/")
    set(component calib)
  elseif(folder MATCHES "^services/(messages|bus|runtime|nodes|drivers)")
    set(component ${CMAKE_MATCH_1})
  elseif(folder STREQUAL lcmtypes)
    set(component messages)
  endif()
  set(${result} "${component}" PARENT_SCOPE)
endfunction()

# All headers beside a library's sources, but for those that say by where they lie or by their names
# that they are their folder's own.
function(rgbdt_public_headers folder result)
  if(NOT CMAKE_SCRIPT_MODE_FILE)
    set(when CONFIGURE_DEPENDS)
  endif()
  file(GLOB headers ${when} ${folder}/*.h)
  list(FILTER headers EXCLUDE REGEX "_internal\\.h$|/internal/")
  set(${result} ${headers} PARENT_SCOPE)
endfunction()

if(CMAKE_SCRIPT_MODE_FILE STREQUAL CMAKE_CURRENT_LIST_FILE)
  file(GLOB_RECURSE lists RELATIVE ${CMAKE_SOURCE_DIR} calib/CMakeLists.txt services/CMakeLists.txt)
  foreach(list ${lists})
    get_filename_component(folder ${list} DIRECTORY)
    rgbdt_component_of_folder(${folder} component)
    if(component)
      rgbdt_public_headers(${folder} headers)
      foreach(header ${headers})
        message(${header})
      endforeach()
    endif()
  endforeach()
endif()
