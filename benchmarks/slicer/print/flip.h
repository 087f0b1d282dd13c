// SPDX-License-Identifier: GPL-3.0-or-later
//
// FLIP: how far two pictures differ for a person who alternates between them.
//
// P. Andersson, J. Nilsson, T. Akenine-Moller, M. Oskarsson, K. Astrom, M. D. Fairchild, "FLIP: A Difference Evaluator
// for Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020; sections and constants are theirs.
// Colours are filtered by contrast sensitivity in YCxCz, compared by HyAB in Hunt-adjusted CIELAB and mapped to [0, 1];
// where edges or points differ the difference is raised. Values: 0, no difference, to 1, black against white. Nothing
// of the loop is tuned by it.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace voxtone::loop_benchmark {

/// Rows of a picture one after the other, linear sRGB; clamped to [0, 1].
struct FlipPicture {
    std::size_t columns = 0, rows = 0;
    std::vector<Eigen::Vector3f> rgb;
};

/// Per pixel. Both of one size. `pixels_per_degree`: distance / pixel * pi / 180.
[[nodiscard]] std::vector<double> flip(const FlipPicture& reference, const FlipPicture& test, double pixels_per_degree);

}  // namespace voxtone::loop_benchmark
