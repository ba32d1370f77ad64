# SPDX-License-Identifier: Apache-2.0
# One way to declare a library and a test, so that each has the same warnings and the same names.

add_library(goldthread_options INTERFACE)
target_include_directories(goldthread_options INTERFACE ${CMAKE_SOURCE_DIR})
# -ffp-contract=off: the same bits from each compiler and for each instruction set; kernels ask for
# fused operations by name.
target_compile_options(goldthread_options INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -ffp-contract=off
  $<$<BOOL:${GOLDTHREAD_WARNINGS_AS_ERRORS}>:-Werror>)
target_compile_definitions(goldthread_options INTERFACE
  GOLDTHREAD_VERSION="${PROJECT_VERSION}" GLM_FORCE_SILENT_WARNINGS
  $<$<BOOL:${GOLDTHREAD_CHECKS}>:GOLDTHREAD_CHECKS>)

# goldthread_library(NAME SOURCES … [LINK …] [PRIVATE_LINK …]): target goldthread_NAME, alias goldthread::NAME.
function(goldthread_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  add_library(goldthread_${name} STATIC ${ARG_SOURCES})
  add_library(goldthread::${name} ALIAS goldthread_${name})
  target_link_libraries(goldthread_${name} PUBLIC glm::glm ${ARG_LINK}
                        PRIVATE goldthread_options ${ARG_PRIVATE_LINK})
  target_include_directories(goldthread_${name} PUBLIC ${CMAKE_SOURCE_DIR})
endfunction()

# goldthread_test(NAME SOURCES … LINK … [TIMEOUT SECONDS]): one GoogleTest program, each test known to ctest.
function(goldthread_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LINK" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 60)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_link_libraries(${name} PRIVATE goldthread_options ${ARG_LINK} GTest::gtest_main GTest::gmock)
  target_compile_definitions(${name} PRIVATE GOLDTHREAD_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  gtest_discover_tests(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT} DISCOVERY_TIMEOUT 60)
endfunction()
