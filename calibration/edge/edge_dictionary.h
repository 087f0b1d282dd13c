// SPDX-License-Identifier: GPL-3.0-or-later
//
// The dictionary of edge profiles: light paths for every extinction, anisotropy and thickness of a grid, from which the
// profile of any resin follows.
//
// The paper (Elek et al. 2017, supplement, Sec. 5.2) simulated 34,276 profiles, 38 x 41 x 11 x 2, for one sheet. Here
// one run of paths serves all albedos, all places across the edge and all reflectances of the sheet (optics/edge), so
// the grid has 38 x 11 x 2 = 836 runs. Of each the kernels are kept at 20 albedos, Chebyshev's in u = sqrt(1 - albedo),
// in which they are smooth; between them a polynomial is within 1e-5 (tested), far below the noise.
//
// Noise of a record: the standard error of its profile (green sheet), root mean square over the cells that lie within
// 5 mm of the edge, from the spread of 32 independent batches; kept at each of the 20 albedos.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/progress.h"
#include "calibration/edge/edge_setup.h"
#include "optics/edge/edge_response.h"

namespace voxtone::calibration {

struct EdgeGrid {
    std::vector<double> thickness_mm{0.5, 1}, g{0.4}, sigma_t;  ///< ascending; mm^-1
    std::uint32_t paths = 1u << 18;                             ///< from the camera, per run
    std::uint64_t seed = 1;

    [[nodiscard]] std::size_t runs() const { return thickness_mm.size() * g.size() * sigma_t.size(); }
    /// Order of the runs: extinction runs fastest, thickness slowest.
    [[nodiscard]] std::size_t run(std::size_t thickness, std::size_t g_index, std::size_t sigma) const {
        return (thickness * g.size() + g_index) * sigma_t.size() + sigma;
    }
    friend bool operator==(const EdgeGrid&, const EdgeGrid&) = default;
};

/// The extinctions and anisotropies of the paper.
[[nodiscard]] const std::vector<double>& paper_extinctions();
[[nodiscard]] const std::vector<double>& paper_albedos();
[[nodiscard]] const std::vector<double>& paper_anisotropies();

/// Throws InputError that names the list and the rule.
void validate(const EdgeGrid& grid);

/// Albedos at which kernels are kept: u = sqrt(1 - albedo) is (1 - cos(pi k / 19)) / 2.
inline constexpr std::size_t albedo_nodes = 20;
[[nodiscard]] double albedo_node(std::size_t k);
/// Weights of the nodes of the polynomial at an albedo in [0, 1].
[[nodiscard]] Eigen::VectorXd albedo_weights(double albedo);

/// One run: kernels and noise at every node.
struct EdgeRecord {
    std::vector<optics::EdgeKernels> kernels;
    std::vector<double> noise;
};

/// Traces one run of the grid. The same bits for any number of threads.
[[nodiscard]] EdgeRecord edge_record(const EdgeSetup& setup, const EdgeGrid& grid, std::size_t run,
                                     const Progress* progress = nullptr);

struct EdgeDictionary {
    EdgeSetup setup;
    EdgeGrid grid;
    std::vector<EdgeRecord> records;  ///< in the grid's order; without kernels where they are in another shard
};

}  // namespace voxtone::calibration
