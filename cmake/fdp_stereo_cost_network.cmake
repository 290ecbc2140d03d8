# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Builds training/cost_network.txt into the library, so that there is no file to find at run time. The format is in
# training/README.md.
set(_weights ${PROJECT_SOURCE_DIR}/training/cost_network.txt)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${_weights})
set(FDP_STEREO_COST_NETWORK_SOURCE ${PROJECT_BINARY_DIR}/generated/cost_network_weights.cpp)
file(READ ${_weights} _text)
if(NOT _text MATCHES "^(fdp_stereo_cost_network 1\nchannels ([0-9]+) ([0-9]+) ([0-9]+)\nfloor ([0-9]+)\n([-0-9 \n]+\n))sha256 ([0-9a-f]+)\n$")
  message(FATAL_ERROR "${_weights} is no file of weights (it may be cut): take it from the repository or write it anew by scripts/train_cost.sh")
endif()
set(_channels "${CMAKE_MATCH_2}, ${CMAKE_MATCH_3}, ${CMAKE_MATCH_4}")
set(_floor ${CMAKE_MATCH_5})
set(_numbers "${CMAKE_MATCH_6}")
set(_sum ${CMAKE_MATCH_7})
string(SHA256 _found "${CMAKE_MATCH_1}")
if(NOT _found STREQUAL _sum)
  message(FATAL_ERROR "${_weights} was changed since it was written, its sha256 differs: take it from the repository or write it anew by scripts/train_cost.sh")
endif()
string(REGEX REPLACE "[ \n]+" ", " _numbers "${_numbers}")
file(GENERATE OUTPUT ${FDP_STEREO_COST_NETWORK_SOURCE} CONTENT "// Generated from training/cost_network.txt.
#include \"costs/cost_network_weights.hpp\"
namespace fdp_stereo {
const NetworkWeights& costNetworkWeights() {
  static const NetworkWeights weights{{{${_channels}}}, ${_floor}, {${_numbers}}};
  return weights;
}
}  // namespace fdp_stereo
")
