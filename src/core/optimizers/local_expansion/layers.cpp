// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/layers.hpp"

#include <algorithm>

namespace fdp_stereo::local_expansion {
namespace {

// Borders of the cells along one axis: 0, cell, 2 cell, ..., size.
std::vector<int> borders(int size, int cell) {
  const int rest = size % cell;
  const int count = std::max(1, size / cell + (2 * rest >= cell && rest > 0 ? 1 : 0));
  std::vector<int> result(count + 1);
  for (int i = 0; i < count; ++i) result[i] = i * cell;
  result[count] = size;
  return result;
}

}  // namespace

Layer::Layer(cv::Size image, int cell_px) {
  const std::vector<int> xs = borders(image.width, cell_px);
  const std::vector<int> ys = borders(image.height, cell_px);
  const int columns = static_cast<int>(xs.size()) - 1;
  const int rows = static_cast<int>(ys.size()) - 1;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      Cell cell;
      cell.core = cv::Rect(cv::Point(xs[i], ys[j]), cv::Point(xs[i + 1], ys[j + 1]));
      cell.region = cv::Rect(cv::Point(xs[std::max(i - 1, 0)], ys[std::max(j - 1, 0)]),
                             cv::Point(xs[std::min(i + 2, columns)], ys[std::min(j + 2, rows)]));
      cell.index = static_cast<int>(cells_.size());
      groups_[(j % 4) * 4 + i % 4].push_back(cell.index);
      cells_.push_back(cell);
    }
  }
}

}  // namespace fdp_stereo::local_expansion
