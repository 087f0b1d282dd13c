// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/target/marker_pattern.h"

#include <opencv2/aruco.hpp>

#include "base/contracts.h"

namespace voxtone::calibration {

std::vector<bool> marker_pattern(int id) {
    VOXTONE_EXPECT(id >= 0 && id < marker_count);
    cv::Mat cells;
    cv::aruco::drawMarker(cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_1000), id, marker_cells, cells);
    VOXTONE_ENSURE(cells.rows == marker_cells && cells.cols == marker_cells);
    std::vector<bool> dark;
    for (int row = 0; row < marker_cells; ++row)
        for (int column = 0; column < marker_cells; ++column)
            dark.push_back(cells.at<unsigned char>(row, column) < 128);
    return dark;
}

}  // namespace voxtone::calibration
