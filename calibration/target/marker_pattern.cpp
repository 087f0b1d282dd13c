// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/target/marker_pattern.h"

#include <opencv2/core.hpp>
// ArUco moved with OpenCV 4.7, and changed its names.
#if CV_VERSION_MAJOR * 100 + CV_VERSION_MINOR >= 407
#include <opencv2/objdetect/aruco_detector.hpp>
#else
#include <opencv2/aruco.hpp>
#endif

#include "base/contracts.h"

namespace voxtone::calibration {
namespace {

#if CV_VERSION_MAJOR * 100 + CV_VERSION_MINOR >= 407
using Dictionary = cv::aruco::Dictionary;

void draw_marker(const Dictionary& dictionary, int id, cv::Mat& cells) {
    cv::aruco::generateImageMarker(dictionary, id, marker_cells, cells);
}

void detect(const cv::Mat& picture, const Dictionary& dictionary, const cv::aruco::DetectorParameters& parameters,
            std::vector<std::vector<cv::Point2f>>& corners, std::vector<int>& ids) {
    cv::aruco::ArucoDetector(dictionary, parameters).detectMarkers(picture, corners, ids);
}
#else
using Dictionary = cv::Ptr<cv::aruco::Dictionary>;

void draw_marker(const Dictionary& dictionary, int id, cv::Mat& cells) {
    cv::aruco::drawMarker(dictionary, id, marker_cells, cells);
}

void detect(const cv::Mat& picture, const Dictionary& dictionary, const cv::aruco::DetectorParameters& parameters,
            std::vector<std::vector<cv::Point2f>>& corners, std::vector<int>& ids) {
    cv::aruco::detectMarkers(picture, dictionary, corners, ids, cv::makePtr<cv::aruco::DetectorParameters>(parameters));
}
#endif

Dictionary dictionary() { return cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_1000); }

}  // namespace

std::vector<bool> marker_pattern(int id) {
    VOXTONE_EXPECT(id >= 0 && id < marker_count);
    cv::Mat cells;
    draw_marker(dictionary(), id, cells);
    VOXTONE_ENSURE(cells.rows == marker_cells && cells.cols == marker_cells);
    std::vector<bool> dark;
    for (int row = 0; row < marker_cells; ++row)
        for (int column = 0; column < marker_cells; ++column)
            dark.push_back(cells.at<unsigned char>(row, column) < 128);
    return dark;
}

std::vector<MarkerView> markers_in(std::span<const std::uint8_t> grey, int width, int height, bool inverted) {
    VOXTONE_EXPECT(grey.size() == std::size_t(width) * std::size_t(height));
    const cv::Mat picture(height, width, CV_8UC1, const_cast<std::uint8_t*>(grey.data()));  // only read
    std::vector<std::vector<cv::Point2f>> corners;
    std::vector<int> ids;
    cv::aruco::DetectorParameters parameters;
    parameters.adaptiveThreshWinSizeMax = 63;
    parameters.detectInvertedMarker = inverted;
    detect(picture, dictionary(), parameters, corners, ids);
    std::vector<MarkerView> found;
    for (std::size_t m = 0; m < ids.size(); ++m) {
        MarkerView& marker = found.emplace_back();
        marker.id = ids[m];
        // OpenCV has the middle of the first pixel at 0.
        for (std::size_t c = 0; c < 4; ++c) marker.corners[c] = {corners[m][c].x + 0.5, corners[m][c].y + 0.5};
    }
    return found;
}

}  // namespace voxtone::calibration
