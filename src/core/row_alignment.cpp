// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/row_alignment.hpp"

namespace fdp_stereo {
double RowOffsetModel::offsetAt(double, double) const { return 0.0; }
RowAlignment estimateRowAlignment(const FeatureMatches&, cv::Size, const RowAlignmentParams&) { return {}; }
cv::Mat alignRows(const cv::Mat& right, const RowOffsetModel&) { return right; }
RowAlignment RowAlignmentAccumulator::update(const FeatureMatches&, cv::Size, const RowAlignmentParams&) { return {}; }
void RowAlignmentAccumulator::reset() { history_.clear(); }
}  // namespace fdp_stereo
