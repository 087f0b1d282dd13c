// SPDX-License-Identifier: GPL-3.0-or-later
//
// A stack from boxes of resin mixtures: for test pieces that are known to the voxel, without a mesh.
//
// A voxel belongs to the last box that holds its centre (lower faces included, upper ones not); in none of them it is
// empty. Where a box mixes resins, every voxel draws its resin by itself with the fractions as probabilities, from a
// random number that is addressed by the voxel's place: the same bits for any number of threads and any part of the
// stack. Or its two resins lie as a checker, which begins with the first of them at the lower left.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <Eigen/Core>

#include "base/progress.h"
#include "io/layers/layer_stack_writer.h"
#include "slicer/layers/layer_source.h"
#include "slicer/printer/printer.h"

namespace voxtone::slicer {

struct PrintBox {
    Eigen::Vector3d min_mm = Eigen::Vector3d::Zero(), max_mm = Eigen::Vector3d::Zero();
    std::vector<double> fractions;  ///< of each resin (material m is fractions[m - 1]); they sum to 1
    /// Where it is not 0, the two resins that there are alternate in cells of so many columns and rows.
    std::array<int, 2> cell = {};
};

/// Makes layers of boxes. Memory: one row of box numbers beside the layer's runs.
class BoxLayers final : public LayerSource {
public:
    /// The grid begins at (0, 0, 0) and covers `size_mm`, rounded to whole voxels. Throws InputError where a box has
    /// no volume, its fractions do not sum to 1, or the grid is larger than a bitmap may be.
    BoxLayers(std::vector<PrintBox> boxes, const Eigen::Vector3d& size_mm, const Eigen::Vector3d& pitch_um,
              std::uint64_t seed);

    /// Columns, rows, layers.
    [[nodiscard]] const std::array<std::uint32_t, 3>& size() const { return size_; }
    [[nodiscard]] io::LayerRuns layer(std::uint32_t k) const;

    [[nodiscard]] const VoxelGrid& grid() const override { return grid_; }
    [[nodiscard]] int slab_layers() const override { return 1; }
    LayerCounts make(int slab, int k_begin, int k_end, const LayerSink& sink) const override;

private:
    struct Span {  // voxels [first, last) of each axis
        std::array<std::uint32_t, 3> first{}, last{};
        std::vector<double> sums;             // of the fractions up to each resin
        io::Material only = io::background;   // where there is one resin
        std::array<std::uint32_t, 2> cell{};  // of a checker
        std::array<io::Material, 2> in_cells{};
    };
    [[nodiscard]] io::Material draw(const Span& box, std::uint32_t i, std::uint32_t j, std::uint32_t k) const;

    std::vector<Span> boxes_;
    std::array<std::uint32_t, 3> size_{};
    VoxelGrid grid_;
    std::uint64_t seed_;
};

struct BoxPrint {
    std::vector<PrintBox> boxes;
    Eigen::Vector3d size_mm = Eigen::Vector3d::Zero();
    std::vector<std::string> roles;  ///< of the resins
    std::uint64_t seed = 1;
    std::string title = "the test piece";  ///< for the page of the printer's folder
    std::vector<std::string> remarks{};    ///< for the same: how it is read once it is printed
};

/// Writes the boxes as a stack for this printer into `out`, with its printer's folder. Throws InputError (more resins
/// than the printer carries, larger than its tray, fewer layers than it takes), FileError, Cancelled.
io::StackDescription print_boxes(const BoxPrint& print, const PrinterProfile& printer, const std::filesystem::path& out,
                                 const io::StackOutputs& outputs, bool overwrite, Progress& progress);

}  // namespace voxtone::slicer
