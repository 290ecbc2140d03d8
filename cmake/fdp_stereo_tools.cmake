# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Scenes with known disparity and the errors on them, for tools, benchmarks and tests; no part of what runs on a robot.
add_library(fdp_stereo_evaluation STATIC
  src/evaluation/corruption.cpp src/evaluation/scene.cpp src/evaluation/evaluation.cpp)
target_include_directories(fdp_stereo_evaluation PUBLIC ${PROJECT_SOURCE_DIR}/src)
target_link_libraries(fdp_stereo_evaluation PUBLIC fdp_stereo_core)

# docs/parameters.md follows the list of parameters: build update_docs after a change there; a test compares the two.
add_executable(parameters_doc tools/parameters_doc.cpp)
target_link_libraries(parameters_doc PRIVATE fdp_stereo_core)
add_custom_target(update_docs COMMAND parameters_doc > ${PROJECT_SOURCE_DIR}/docs/parameters.md VERBATIM)

find_package(CLI11 QUIET)
find_package(nlohmann_json QUIET)
if(NOT CLI11_FOUND OR NOT nlohmann_json_FOUND)
  message(STATUS "fdp_stereo: no command-line tools: CLI11 or nlohmann_json is not installed")
  return()
endif()

# Command-line tools. With catkin they land in devel/lib/fdp_stereo, where rosrun finds them.
add_library(fdp_stereo_tool_support STATIC tools/command_line.cpp tools/output_files.cpp tools/process_memory.cpp)
target_compile_definitions(fdp_stereo_tool_support PRIVATE FDP_STEREO_VERSION="${PROJECT_VERSION}")
target_include_directories(fdp_stereo_tool_support PUBLIC ${PROJECT_SOURCE_DIR}/tools)
target_link_libraries(fdp_stereo_tool_support PUBLIC fdp_stereo_evaluation CLI11::CLI11 nlohmann_json::nlohmann_json)

function(fdp_stereo_add_tool name)
  add_executable(${name} ${ARGN})
  target_link_libraries(${name} PRIVATE fdp_stereo_tool_support)
  if(CATKIN_DEVEL_PREFIX)
    set_target_properties(${name} PROPERTIES
      RUNTIME_OUTPUT_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION})
  endif()
  install(TARGETS ${name} RUNTIME DESTINATION ${FDP_STEREO_BIN_DESTINATION})
endfunction()

fdp_stereo_add_tool(match tools/match.cpp)
fdp_stereo_add_tool(make_seeds tools/make_seeds.cpp)
fdp_stereo_add_tool(warp_rows tools/warp_rows.cpp)

find_package(Threads REQUIRED)
set(_report_template ${PROJECT_SOURCE_DIR}/src/evaluation/report_template.html)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${_report_template})
file(READ ${_report_template} FDP_STEREO_REPORT_TEMPLATE)
configure_file(src/evaluation/report_template.cpp.in ${PROJECT_BINARY_DIR}/generated/report_template.cpp @ONLY)

add_library(fdp_stereo_evaluate STATIC
  src/evaluation/method.cpp
  src/evaluation/peer.cpp
  src/evaluation/pictures.cpp
  src/evaluation/progress.cpp
  src/evaluation/report.cpp
  src/evaluation/result.cpp
  src/evaluation/result_table.cpp
  src/evaluation/robustness.cpp
  src/evaluation/runner.cpp
  ${PROJECT_BINARY_DIR}/generated/report_template.cpp
)
target_link_libraries(fdp_stereo_evaluate PUBLIC fdp_stereo_tool_support opencv_calib3d Threads::Threads)
fdp_stereo_add_tool(evaluate tools/evaluate.cpp)
target_link_libraries(evaluate PRIVATE fdp_stereo_evaluate)
add_subdirectory(benchmark)
