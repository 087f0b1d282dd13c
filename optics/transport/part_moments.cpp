// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/transport/part_moments.h"

#include <array>

namespace voxtone::optics {

void PartMoments::clear() {
    now_.assign(grid_.fine.medium.size(), {});
    up_.resize(now_.size());
    down_.resize(now_.size());
}

template <class Body>
void PartMoments::each_cell(std::size_t t, Body&& body) const {
    for_each({4, 4, 4}, [&](const Place& at) {
        const std::size_t cell = 64 * t + place_in_block(at);
        if (grid_.medium[cell] != 0) body(cell, grid_.fine.first[t] + grid_.fine.part(at, {}));
    });
}

void PartMoments::correct(std::size_t t, const ChannelMedia& media, std::span<const float> phi,
                          const ViewingDiffusion::Flows& J) {
    const FineBlocks& fine = grid_.fine;
    std::array<std::vector<float>, 3> falls;  // how much less phi is in a part, by its place along each axis
    for (std::size_t a = 0; a < 3; ++a) falls[a].resize(static_cast<std::size_t>(fine.split[a]));
    each_cell(t, [&](std::size_t cell, std::size_t first) {
        const std::size_t place = cell % 64;
        const float D = media.D[grid_.medium[cell]];
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t k = 0; k < falls[a].size(); ++k) {
                const float offset = (static_cast<float>(k) + 0.5f) / static_cast<float>(fine.split[a]) - 0.5f;
                falls[a][k] = offset * parameters_.edge[a] * J[a][place] / D;
            }
        for_each(fine.split, [&](const Place& part) {
            float here = phi[cell];
            for (std::size_t a = 0; a < 3; ++a) here -= falls[a][static_cast<std::size_t>(part[a])];
            now_[first + fine.part({}, part)] += {here, J[0][place], J[1][place], J[2][place]};
        });
    });
}

void PartMoments::take_sweep(std::size_t t, const GridMedia& media, std::span<Moments> cells,
                             std::span<Moments> sources) {
    const FineBlocks& fine = grid_.fine;
    const float share = 1 / static_cast<float>(fine.parts()), volume = parameters_.volume * share;
    for (std::size_t cell = 64 * t; cell < 64 * t + 64; ++cell) {
        cells[cell] = {};
        sources[cell].phi = 0;
    }
    each_cell(t, [&](std::size_t cell, std::size_t first) {
        float source = 0;
        Moments mean;
        for_each(fine.split, [&](const Place& part) {
            const std::size_t i = first + fine.part({}, part);
            const Moments now = up_[i] + down_[i];
            source += volume * media.parts[fine.medium[i]].sigma_s * (now.phi - now_[i].phi);
            mean += share * now;
            now_[i] = now;
        });
        sources[cell].phi = source;
        cells[cell] = mean;
    });
}

void PartMoments::take_sweep_of_cells(std::size_t t, std::span<const Moments> up, std::span<const Moments> down,
                                      std::span<const Moments> before) {
    each_cell(t, [&](std::size_t cell, std::size_t first) {
        const Moments more = up[cell] + down[cell] + -1.0f * before[cell];
        for_each(grid_.fine.split, [&](const Place& part) { now_[first + grid_.fine.part({}, part)] += more; });
    });
}

std::size_t PartMoments::memory_bytes() const {
    return (now_.capacity() + up_.capacity() + down_.capacity()) * sizeof(Moments);
}

}  // namespace voxtone::optics
