// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the camera sees across the edge, from the kernels of edge_paths.h.
//
// With a resin of albedo alpha, kernels are sums over orders n of alpha^n: a and l, what camera and base get straight
// from the light; P(x), K(x), what goes from the camera and from the base to the base at a distance x. The base's
// radiosity q and the profile F (1: a perfect diffuser lit alike) are
//
//   q(x) = l + integral of K(x' - x) R(x') q(x') dx'
//   F(x) = a + integral of P(x' - x) R(x') q(x') dx'
//
// solved on cells that are fine at the edge and end in two without end, q being constant in each; the integral over two
// cells is exact (differences of the second antiderivative of K). F has one value a cell, its mean there. Error of the
// cells: below 1e-3 of the step (tested against cells half as wide).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "optics/edge/edge_paths.h"

namespace voxtone::optics {

/// Kernels at one albedo. P and K: share of paths by distance bin, both sides together.
struct EdgeKernels {
    double from_camera = 0, from_base = 0;
    Eigen::VectorXd P, K;
};

/// What turns counts into kernels: the share of all directions that the light's window has (DirectionWindow), and the
/// index of the layer on the base, for light from there spreads in a wider cone outside.
struct EdgeUnits {
    explicit EdgeUnits(const EdgeRun& run)
        : window_share(run.light.share()), base_index(edge_layers(run.assembly, run.slab_mm).back().index) {}
    double window_share, base_index;
};

/// From one batch of counts.
[[nodiscard]] EdgeKernels edge_kernels(const PathBatch& batch, const EdgeUnits& units, double albedo);
/// Mean over all batches.
[[nodiscard]] EdgeKernels edge_kernels(const EdgeCounts& counts, const EdgeUnits& units, double albedo);

/// Reflectance of the sheet's base on both sides of x = 0.
struct EdgeSheet {
    double black = 0.024, white = 0.985;  ///< left (x < 0) and right
};

/// What is seen far from the edge over a base of one reflectance.
[[nodiscard]] double far_from_edge(const EdgeKernels& kernels, double reflectance);

class EdgeCells {
public:
    /// `halvings`: cuts every cell into 2^halvings.
    explicit EdgeCells(int halvings = 0);
    /// Ends of the cells, 0 among them; before and after them there is one cell without end.
    [[nodiscard]] const std::vector<double>& edges() const { return edges_; }
    [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(edges_.size()) + 1; }
    /// Means of F over all cells, those without end first and last.
    [[nodiscard]] Eigen::VectorXd profile(const EdgeKernels& kernels, const EdgeSheet& sheet) const;

private:
    [[nodiscard]] Eigen::MatrixXd pairs(const Eigen::VectorXd& kernel) const;
    struct Place {
        std::size_t bin;
        double beyond;
    };
    std::vector<double> edges_;
    std::vector<Place> places_;  ///< of every difference of edges
};

/// The map from means over cells to what pixels see: mean over a pixel of a profile that is a parabola in each cell
/// (with a step allowed at 0), blurred by a Gaussian. Lengths along x of the profile are `stretch` times those of the
/// cells: by similarity a slab that is thicker by a small part, of the same optical depth.
struct PixelView {
    double pixel_mm = 0.0276, blur_mm = 0, stretch = 1;
};
[[nodiscard]] Eigen::MatrixXd pixels_from_cells(const EdgeCells& cells, const std::vector<double>& x_mm,
                                                const PixelView& view);

}  // namespace voxtone::optics
