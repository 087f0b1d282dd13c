// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/spectral_start.h"

#include <algorithm>
#include <array>

#include "calibration/chart/colour_fit.h"
#include "calibration/chart/observer_bands.h"
#include "calibration/chart/observer_fit.h"
#include "calibration/chart/observer_start.h"

namespace voxtone::calibration {

namespace {

// CIEDE2000 of a step of one cube root alone, where greys are of middle lightness.
constexpr double root_counts = 60;

// The three bands as a chart of colours whose observer sees one band each.
ChartData chart_of_bands(const ChartData& data, const std::array<Eigen::Index, 3>& columns) {
    ChartData bands = data;
    bands.squares = {}, bands.edges.clear(), bands.spectra.resize(0, 0);
    for (Eigen::Index i = 0; i < data.mixtures(); ++i)
        bands.roots.row(i) =
            roots_of({data.spectra(i, columns[0]), data.spectra(i, columns[1]), data.spectra(i, columns[2])})
                .transpose();
    bands.metric.assign(static_cast<std::size_t>(data.mixtures()), root_counts * Eigen::Matrix3d::Identity());
    return bands;
}

}  // namespace

ObserverParts spectral_start(const ChartData& data, Eigen::Index channels, const ObserverModelOptions& options,
                             const Progress* progress) {
    const ObserverBands bands = observer_bands(data.spectra, data.observer, channels);
    ObserverParts start;
    start.a.resize(data.resins(), channels), start.s.resize(data.resins(), channels);
    start.weights = bands.weights;
    start.surface = 0, start.gain = 0;
    ObserverModelOptions of_bands{.g = options.g, .eta = options.eta, .geometry = options.geometry};
    of_bands.known_observer = true;
    const ObserverModel model(data.resins(), white_resin(data), 3, of_bands);
    double fits = 0;
    for (Eigen::Index first = 0; first < channels; first += 3) {
        const Eigen::Index from = std::min(first, channels - 3);
        std::array<Eigen::Index, 3> columns{};
        for (Eigen::Index b = 0; b < 3; ++b)
            columns[static_cast<std::size_t>(b)] = bands.nodes[static_cast<std::size_t>(from + b)];
        ObserverParts three;
        three.a.resize(data.resins(), 3), three.s.setConstant(data.resins(), 3, 0.45);
        three.s.row(white_resin(data)).setOnes();
        for (Eigen::Index r = 0; r < data.resins(); ++r)
            for (Eigen::Index b = 0; b < 3; ++b)
                three.a(r, b) = absorption_by_reflectance(
                    data.spectra(purest_patch(data, r), columns[static_cast<std::size_t>(b)]));
        three.weights = Eigen::Matrix3d::Identity();
        three.surface = 0.015, three.gain = 1;
        const ObserverParts found = fit_observer(chart_of_bands(data, columns), model, three, progress).parts;
        start.a.middleCols(from, 3) = found.a, start.s.middleCols(from, 3) = found.s;
        start.surface += found.surface, start.gain += found.gain, ++fits;
    }
    start.surface /= fits, start.gain /= fits;
    return start;
}

}  // namespace voxtone::calibration
