// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/transport_parameters.h"

#include <cstdint>

#include "base/parallel.h"
#include "optics/grid/sheet_way.h"

namespace voxtone::optics {

TransportParameters::TransportParameters(const ViewingGrid& of) : grid(of) {
    // Both ways along z keep two threads busy; more of them cross several planes of each at once.
    const std::size_t threads = thread_count(), fronts = threads > 2 ? threads / 2 + 2 : 1;
    for (std::size_t half = 0; half < 2; ++half) rows[half] = sweep_rows(grid, half == 1, fronts);
    const auto edge_mm = grid.edge_mm();
    for (std::size_t a = 0; a < 3; ++a) {
        edge[a] = static_cast<float>(edge_mm[a]);
        for (std::size_t d = 0; d < 8; ++d)
            flux_weight[a].v[d] = grid.directions.weight.v[d] * grid.directions.cosine[a].v[d];
    }
    volume = edge[0] * edge[1] * edge[2];
    sheet_way = static_cast<float>(way_into_sheet(grid.directions));
    sheet_T_inverse = static_cast<float>(1 / let_out_of_diffuse(grid.directions));
    const std::size_t of_one = grid.laws_of_one > 0 ? grid.laws_of_one : grid.laws.size();
    std::vector<std::uint8_t> axis(of_one, 0);
    for (std::size_t f = 0; f < grid.faces.size(); ++f)
        axis[grid.law[f] % of_one] = static_cast<std::uint8_t>(axis_of(f));
    sums.resize(grid.laws.size());
    for (std::size_t l = 1; l < sums.size(); ++l)
        for (const Octet& t : grid.laws[l].through)
            for (std::size_t d = 0; d < 8; ++d) {
                const float weight = flux_weight[axis[l % of_one]].v[d];
                sums[l].weight += weight;
                sums[l].through += weight * t.v[d];
            }
}

}  // namespace voxtone::optics
