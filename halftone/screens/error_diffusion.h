// SPDX-License-Identifier: GPL-3.0-or-later
//
// Three-dimensional vector error diffusion: the optional screen. Each voxel gets the resin to which most is owed; what
// is then owed (its share less what it got) goes to voxels not yet visited: along the row, to the next row, to the next
// layer.
//
// Based on: R. W. Floyd, L. Steinberg, "An adaptive algorithm for spatial greyscale", Proc. SID 17 (1976), with shares
// of all resins at once instead of one grey, and a third dimension. Weights are proportional to 1 / distance^2 in mm;
// what would go to a voxel outside the body goes to the others. Rows are visited to and fro, layers up and down in y. A
// resin with no share in a voxel is never chosen there, and what was owed to it is forgotten.
//
// Slabs. The state is carried from voxel to voxel, so a job that is cut anywhere would come out differently. So debts
// are dropped at fixed layers, every `slab_layers` of the global index: slabs are independent, may be computed in any
// order, and a range of layers is begun at its slab's first layer. A slab begins from random debts (addressed by the
// voxel) of the size that is usual in the midst of it, without which its first layer would lack the rarer resins. What
// a border costs: the debts of one layer. In a field of constant colour, borders included, shares were kept within
// 0.7 % of the volume over cubes of 16^3 voxels and 0.09 % over 64^3 for seven colours of two to five resins with
// shares from 0.1 to 99 % (tests/halftone/screens/error_diffusion_test.cpp); unlike the blue-noise screen this is a
// sample, not a bound.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "halftone/separation/mixture.h"

namespace voxtone::halftone {

struct ErrorDiffusionOptions {
    std::array<double, 3> pitch_mm{1, 1, 1};  ///< of a voxel, > 0; only the ratios matter
    std::uint64_t seed = 1;
    float noise = 0.1f;  ///< added to the shares that are compared, uniform in +- half of it; in [0, 1]
};

class ErrorDiffusion {
public:
    static constexpr int slab_layers = 32;

    /// Layers of `width` x `height` voxels of up to max_resins resins. Memory: 8 bytes per voxel of a layer and resin.
    ErrorDiffusion(int width, int height, int resins, const ErrorDiffusionOptions& options);

    /// The layer of global index k >= 0, x fastest: `resin[v]` is written where `body[v]` is not 0. The layers of a
    /// slab come in rising order, its first (k a multiple of slab_layers) first. The rectangle is the job's: results
    /// depend on where it lies.
    void layer(int k, std::span<const CumulativeMixture> mixtures, std::span<const std::uint8_t> body,
               std::span<std::uint8_t> resin);

private:
    struct Neighbour {
        int dx, dy, dz;  ///< for rows visited rightward and upward; mirrored otherwise
        float weight;
    };
    using Shares = std::array<float, max_resins>;

    void visit(int x, int y, int k, int dx, int dy, std::span<const CumulativeMixture> mixtures,
               std::span<const std::uint8_t> body, std::span<std::uint8_t> resin);
    [[nodiscard]] float* owed(int x, int y, int dz);

    int width_, height_, resins_;
    ErrorDiffusionOptions options_;
    std::vector<Neighbour> neighbours_;
    std::vector<float> here_, above_;  ///< owed per voxel and resin, in this layer and the next
    int next_k_ = -1;
};

}  // namespace voxtone::halftone
