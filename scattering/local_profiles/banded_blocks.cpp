// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/local_profiles/banded_blocks.h"

#include <algorithm>

namespace voxtone::scattering {

void BandedBlocks::Block::factorise() {
    const std::size_t rows = bands_.size() / 3;
    const auto at = [&](std::size_t row, std::size_t left) -> double& { return bands_[3 * row + left]; };
    for (std::size_t k = 0; k < rows; ++k) {
        if (k >= 2) {
            const double far = at(k, 2);  // still times D
            at(k, 1) -= far * at(k - 1, 1);
            at(k, 2) = far / at(k - 2, 0);
            at(k, 0) -= far * at(k, 2);
        }
        if (k >= 1) {
            const double near = at(k, 1);
            at(k, 1) = near / at(k - 1, 0);
            at(k, 0) -= near * at(k, 1);
        }
    }
}

BandedBlocks::Block BandedBlocks::clear(std::size_t block) {
    Block cleared{std::span<double>(bands_).subspan(3 * rows_ * block, 3 * rows_)};
    std::fill(cleared.bands_.begin(), cleared.bands_.end(), 0.0);
    return cleared;
}

void BandedBlocks::solve(std::span<const double> right, std::span<double> x, std::size_t first, std::size_t end) const {
    for (std::size_t b = first; b < end; ++b) {
        const double* bands = bands_.data() + 3 * rows_ * b;
        const auto of = [&](std::size_t k) -> double& { return x[k * blocks_ + b]; };
        for (std::size_t k = 0; k < rows_; ++k) {
            of(k) = right[k * blocks_ + b];
            if (k >= 1) of(k) -= bands[3 * k + 1] * of(k - 1);
            if (k >= 2) of(k) -= bands[3 * k + 2] * of(k - 2);
        }
        for (std::size_t k = 0; k < rows_; ++k) of(k) /= bands[3 * k];
        for (std::size_t k = rows_; k-- > 0;) {
            if (k + 1 < rows_) of(k) -= bands[3 * (k + 1) + 1] * of(k + 1);
            if (k + 2 < rows_) of(k) -= bands[3 * (k + 2) + 2] * of(k + 2);
        }
    }
}

}  // namespace voxtone::scattering
