# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Builds config/*.yaml into the library, so that a preset is found by name wherever the program runs.
file(GLOB FDP_STEREO_PRESET_FILES CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/config/*.yaml)
set(FDP_STEREO_PRESETS_SOURCE ${PROJECT_BINARY_DIR}/generated/presets.cpp)
set(_presets "// Generated from config/*.yaml.\n#include \"params/presets.hpp\"\nnamespace fdp_stereo {\nconst std::vector<Preset>& builtInPresets() {\n  static const std::vector<Preset> presets = {\n")
foreach(file IN LISTS FDP_STEREO_PRESET_FILES)
  get_filename_component(name ${file} NAME_WE)
  file(READ ${file} text)
  string(APPEND _presets "    {\"${name}\", R\"yaml(${text})yaml\"},\n")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
endforeach()
string(APPEND _presets "  };\n  return presets;\n}\n}  // namespace fdp_stereo\n")
file(GENERATE OUTPUT ${FDP_STEREO_PRESETS_SOURCE} CONTENT "${_presets}")
