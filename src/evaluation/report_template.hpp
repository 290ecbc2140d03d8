// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace fdp_stereo {

/// report_template.html; the data replace /*REPORT*/.
extern const char kReportTemplate[];

}  // namespace fdp_stereo
