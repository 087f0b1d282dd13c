// SPDX-License-Identifier: GPL-3.0-or-later
//
// Many small symmetric positive definite systems of five bands, one per point: L D L^T without pivots (G. Golub, C. Van
// Loan, "Matrix Computations", 4th ed. 2013, Sec. 4.3).
//
// Eigen factorises dense and sparse matrices, not banded ones; its sparse solver would analyse and allocate once for
// each of some ten thousand points, at every step, for rows of three numbers.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace voxtone::scattering {

class BandedBlocks {
public:
    BandedBlocks(std::size_t blocks, std::size_t rows) : blocks_(blocks), rows_(rows), bands_(3 * blocks * rows) {}

    class Block {
    public:
        /// To the entry in `row`, `column`, 0 <= row - column <= 2.
        void add(std::size_t row, std::size_t column, double value) { bands_[3 * row + (row - column)] += value; }
        void factorise();

    private:
        friend class BandedBlocks;
        explicit Block(std::span<double> bands) : bands_(bands) {}
        std::span<double> bands_;  ///< row by row: diagonal (then D), and to the left of it (then L)
    };

    /// A block of zeros, to be added to and factorised.
    [[nodiscard]] Block clear(std::size_t block);
    /// For blocks [first, end); entry k of block b lies at [k blocks + b].
    void solve(std::span<const double> right, std::span<double> x, std::size_t first, std::size_t end) const;

private:
    std::size_t blocks_, rows_;
    std::vector<double> bands_;
};

}  // namespace voxtone::scattering
