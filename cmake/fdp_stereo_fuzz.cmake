# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# test/fuzz/fuzz_<name>.cpp: with the preset fuzz (clang) a fuzzer, else a test that replays test/fuzz/corpus/<name>.
foreach(name files messages parameters)
  set(target fuzz_${name})
  if(FDP_STEREO_FUZZ)
    add_executable(${target} test/fuzz/fuzz_${name}.cpp)
    target_link_options(${target} PRIVATE -fsanitize=fuzzer)
  else()
    add_executable(${target} EXCLUDE_FROM_ALL test/fuzz/fuzz_${name}.cpp test/fuzz/replay.cpp)
    add_test(NAME ${target}_corpus COMMAND ${target} ${PROJECT_SOURCE_DIR}/test/fuzz/corpus/${name})
    set_tests_properties(${target}_corpus PROPERTIES LABELS ros)
    add_dependencies(ros_tests ${target})
  endif()
  target_include_directories(${target} PRIVATE test/fuzz)
  target_link_libraries(${target} PRIVATE fdp_stereo_nodelet)
endforeach()
