// SPDX-License-Identifier: GPL-3.0-or-later
//
// Edge profiles of any resin, from a dictionary: continuous in albedo, extinction and anisotropy.
//
// The integral equation of the sheet (optics/edge/edge_response.h) is solved once for every run, albedo node and
// channel that is asked for; between them profiles are combined: by the polynomial over all albedo nodes; in ln sigma_t
// by moving least squares, a cubic through the eight nearest extinctions (it smooths their noise, too); in g by a
// polynomial through the four nearest. A slab that is not quite as thick as one of the dictionary is a stretched one of
// the same optical depth: gel and glass are stretched with it, which is right to first order for small differences.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "base/progress.h"
#include "calibration/edge/edge_dictionary.h"

namespace voxtone::calibration {

/// A resin in one channel.
struct EdgeMedium {
    double sigma_t = 5, albedo = 0.9, g = 0.4;
};

/// Weights over a list of nodes that combine values there to one at x; few are not 0.
struct NodeWeights {
    std::size_t first = 0;
    std::vector<double> weights;
};
/// Moving least squares of degree 3 over the eight nearest nodes (fewer nodes: a lower degree), continuous in x.
[[nodiscard]] NodeWeights smooth_weights(const std::vector<double>& nodes, double x);
/// The polynomial through the four nearest nodes (fewer where there are not so many).
[[nodiscard]] NodeWeights polynomial_weights(const std::vector<double>& nodes, double x);

class EdgeProfileTable {
public:
    /// `sheet` of the setup may be another than that of the dictionary. Throws InputError where the dictionary is not
    /// whole or of another scene.
    EdgeProfileTable(std::shared_ptr<const EdgeDictionary> dictionary, const EdgeSetup& setup);

    /// Solves what profiles at this anisotropy need (all of the dictionary for `every_g`), in parallel. Must come
    /// first.
    void prepare(double g, bool every_g, const Progress* progress = nullptr);

    /// Means over the cells of optics::EdgeCells; `thickness`: index in the grid. The medium is kept within the grid.
    [[nodiscard]] Eigen::VectorXd cells(std::size_t thickness, std::size_t channel, const EdgeMedium& medium) const;
    /// Standard error of such a profile: of the record that is nearest.
    [[nodiscard]] double noise(std::size_t thickness, const EdgeMedium& medium) const;

    [[nodiscard]] const optics::EdgeCells& geometry() const { return cells_; }
    [[nodiscard]] const EdgeGrid& grid() const { return dictionary_->grid; }
    [[nodiscard]] const EdgeSetup& setup() const { return setup_; }

private:
    std::shared_ptr<const EdgeDictionary> dictionary_;
    EdgeSetup setup_;
    optics::EdgeCells cells_;
    std::vector<double> ln_sigma_t_;
    std::vector<std::array<Eigen::MatrixXd, 3>> solved_;  ///< per run and channel: cells x nodes
};

}  // namespace voxtone::calibration
