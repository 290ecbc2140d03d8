// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Writes cfg/Disparity.cfg from the list of parameters: write_cfg FILE.
#include <fstream>
#include <iostream>

#include "params_ros.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: write_cfg FILE\n";
    return 2;
  }
  std::ofstream file(argv[1]);
  file << fdp_stereo::reconfigureFile();
  if (!file.flush()) {
    std::cerr << argv[1] << ": cannot be written\n";
    return 1;
  }
  return 0;
}
