// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a job writes beside its stack to tell about it, in one table: a new job removes what an earlier one left there.
#pragma once

#include <array>
#include <string_view>

#include "slicer/options/job_file.h"

namespace voxtone::slicer::report_file {

inline constexpr std::string_view page = "report.html", figures = "report.json", customer_page = "for-customer.html";
/// The first view of the page: what was asked for, and what is expected.
inline constexpr std::string_view target_preview = "preview-target.webp", preview = "preview.webp";
/// Of a picture, from above.
inline constexpr std::string_view target_png = "target.png", predicted_png = "predicted.png",
                                  difference_png = "difference.png", open_loop_png = "open-loop.png",
                                  target_exr = "target.exr", predicted_exr = "predicted.exr";
/// By light from behind.
inline constexpr std::string_view night_target_png = "target-night.png", night_png = "night.png";
/// Of a body, with its colours.
inline constexpr std::string_view target_glb = "target.glb", predicted_glb = "predicted.glb";

inline constexpr std::array all{job_file_name,  page,          figures,          customer_page,
                                target_png,     predicted_png, difference_png,   open_loop_png,
                                target_exr,     predicted_exr, target_glb,       predicted_glb,
                                target_preview, preview,       night_target_png, night_png};

}  // namespace voxtone::slicer::report_file
