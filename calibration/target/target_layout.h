// SPDX-License-Identifier: GPL-3.0-or-later
//
// What lies where on a calibration target: a slab, half of a light resin and half of a dark one, thin squares of every
// resin and of mixtures upon both halves, and a light frame around all with four markers. Iser, Rittig, Wilkie 2025,
// Sec. 3.5.
//
//   layout A  every resin by itself
//   layout B  A, the dark and the light resin 10:90 and 90:10, every other resin with the light one 10:90
//   layout C  B, and the shares 5, 25 and 50 % as well
//   layout E  all equal mixtures of one, two, three ... resins: the chart of Elek et al. 2017, supplement, Sec. 6
//   mixtures  any, each upon both halves: the chart of 121 in steps of a fifth that validates a fit (Sec. 6.1)
//   chart     any mixtures, each once, row by row from the upper left, thick and upon the light resin alone: for a
//             spectrophotometer (calibrate chart)
//
// Where clear resin (role T) is among those of A, B or C, two larger squares of it, 5 and 10 mm deep, lie in a strip of
// the light resin under the halves: in thin ones its absorption is not seen. They are 2.7 times as wide as deep, so
// that light of 45 degrees (28 within) reaches all of the bottom that is sampled; the base is then as thick as they
// want.
//
// Strips of checkers tell how far resin runs before it is cured (calibration/fit/spread_fit.h): half of two resins each
// in cells of 1 to 16 columns by 8 rows or more, and of 1 to 16 rows by 16 columns or more.
//
// Every square lies once upon each half; the number of squares grows linearly with that of resins, that of layout
// E doubles with every resin. Squares are let into the slab, so that its top is flat: between them is the resin of the
// half. The frame is of the light resin from top to bottom and wide enough that its middle sees little of what is
// around it: photographs measure the light there.
//
// Coordinates: mm, x to the right, y up, seen from above; (0, 0) is the lower left corner. z: 0 is the lower side.
// Upon surfaces that were there before (target_surfaces.h) there is no base: z = 0 is theirs.
// The numbers of the four markers are a fingerprint of what the target holds, so that a photograph of another target is
// recognised; no marker looks like another one turned or mirrored, so that a turned or mirrored one is recognised too.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calibration/patches/patch_table.h"

namespace voxtone::calibration {

enum class TargetLayout { a, b, c, e = 4, chart, mixtures };  ///< letters from A

struct TargetOptions {
    TargetLayout layout = TargetLayout::b;
    std::vector<PatchMixture> chart;  ///< of the layouts chart and mixtures, in the order in which they lie
    std::vector<std::array<std::string, 2>> strips;                  ///< pairs of resins with a strip of checkers each
    std::vector<std::string> roles;                                  ///< of the resins, two or more, all different
    std::vector<std::shared_ptr<const PatchSurface>> surfaces = {};  ///< that it is printed upon; R, G, B
    std::string light = "W";  ///< role of the light half and of the frame, one of `roles`; or a surface
    std::string dark = "K";   ///< the same of the dark half, and of the markers; not the light one
    std::string printer;      ///< id of its profile
    std::array<double, 3>
        pitch_um{};  ///< of its voxels; squares get the nearest whole number of layers, the base at least its thickness
    double square_mm = 10;  ///< edge of a square, [1, 100]
    double top_mm = 0.675;  ///< thickness of the squares, (0, 10]
    double base_mm = 5;     ///< thickness of what is under them, (0, 100]
    double gap_mm = 2;      ///< between squares, and from squares to the edge of their half, [0, 50]
    double marker_mm = 9;   ///< edge of a marker, [2, 50]
    double quiet_mm = 1.5;  ///< light around a marker; at least one of its cells (a seventh of its edge), at most 50
};

/// An axis-parallel rectangle, mm.
struct Area {
    Eigen::Vector2d min_mm = Eigen::Vector2d::Zero(), max_mm = Eigen::Vector2d::Zero();
    [[nodiscard]] Eigen::Vector2d size() const { return max_mm - min_mm; }
    [[nodiscard]] Eigen::Vector2d center() const { return 0.5 * (min_mm + max_mm); }
    /// Closed.
    [[nodiscard]] bool contains(const Eigen::Vector2d& p) const {
        return (p.array() >= min_mm.array()).all() && (p.array() <= max_mm.array()).all();
    }
    /// `by_mm` less on every side; more where it is negative.
    [[nodiscard]] Area shrunk(double by_mm) const {
        return {min_mm + Eigen::Vector2d::Constant(by_mm), max_mm - Eigen::Vector2d::Constant(by_mm)};
    }
};

struct TargetSquare {
    PatchMixture top;
    std::string backing;  ///< role
    Area area;
    double depth_mm = 0;  ///< where it is not that of the target's others; 0: it is
    /// Columns and rows of the cells of a checker of the two resins of `top`; 0: they are mixed voxel by voxel.
    std::array<int, 2> cell{};
    [[nodiscard]] bool is_checker() const { return cell[0] > 0; }
};

struct TargetMarker {
    int id = 0;
    Area area;
};

/// A target as it is printed.
struct Target {
    std::string printer;
    std::array<double, 3> pitch_um{};
    std::string layout;  ///< "A", "B", "C", "E", "chart", "mixtures"
    std::vector<std::string> roles;
    std::string light, dark;
    std::vector<std::shared_ptr<const PatchSurface>> surfaces = {};  ///< then `light` and `dark` are two of them
    double top_mm = 0, base_mm = 0;
    Eigen::Vector2d size_mm = Eigen::Vector2d::Zero();
    Area dark_half;  ///< what is around it is light; a chart has none
    std::vector<TargetSquare> squares;
    std::vector<TargetMarker> markers;  ///< upper left, upper right, lower right, lower left

    [[nodiscard]] bool is_chart() const { return layout == "chart"; }
    [[nodiscard]] double height_mm() const { return base_mm + top_mm; }
    [[nodiscard]] double depth_mm(const TargetSquare& square) const {
        return square.depth_mm > 0 ? square.depth_mm : top_mm;
    }
    /// How thick the base under a square is.
    [[nodiscard]] double under_mm(const TargetSquare& square) const {
        return surfaces.empty() ? height_mm() - depth_mm(square) : 0;
    }
    /// By its name; nothing where that is a resin's.
    [[nodiscard]] std::shared_ptr<const PatchSurface> surface(std::string_view name) const;
    /// What the dark cells of its markers are printed of.
    [[nodiscard]] PatchMixture of_markers() const;
    /// Of a square's checker.
    [[nodiscard]] std::array<double, 2> cell_mm(const TargetSquare& square) const {
        return {square.cell[0] * pitch_um[0] / 1000, square.cell[1] * pitch_um[1] / 1000};
    }
    /// Throws InputError naming the part and the rule it breaks: outside, overlapping, unknown roles, fractions, ...
    void validate(const std::string& where) const;
};

/// Throws InputError that names the option and the rule it breaks.
[[nodiscard]] Target lay_out_target(const TargetOptions& options);

/// Row and column of each square, from the upper left and from 1.
[[nodiscard]] std::vector<std::array<int, 2>> square_places(const Target& target);

/// A share of each resin of `roles` within a box; later boxes of a list replace what earlier ones hold there.
struct TargetBox {
    Eigen::Vector3d min_mm, max_mm;
    std::vector<double> fractions;
    /// Where it is not 0: the two resins of `fractions` alternate in cells of so many columns and rows.
    std::array<int, 2> cell = {};
};

/// The whole target, markers included, as boxes.
[[nodiscard]] std::vector<TargetBox> target_boxes(const Target& target);

/// "Square 7 (C:10+W:90 on K)": how messages and overlays name a square.
[[nodiscard]] std::string square_name(const Target& target, std::size_t square);

}  // namespace voxtone::calibration
