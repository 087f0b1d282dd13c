// SPDX-License-Identifier: GPL-3.0-or-later
//
// A target seen from above: the colour of every point. For previews and for simulated photographs.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calibration/target/target_layout.h"
#include "io/pictures/picture_writer.h"

namespace voxtone::calibration {

/// Linear RGB of the parts.
struct TargetColours {
    Eigen::Vector3d light = Eigen::Vector3d::Ones(), dark = Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3d> squares;
    std::optional<Eigen::Vector3d> markers = {};  ///< of their dark cells; none: as `dark`
};

/// What mixtures are: smooth (ideal_patch.h), or random dithers of the voxels that the target is printed of, as the fit
/// has them (patch_model.h).
enum class MixtureKind { ideal, dithered };

/// Squares as if they had no end, or as light goes between them (square_ends.h).
enum class SquareKind { endless, ended };

/// rho(45 -> 0) of an RGB resin set as colours. Throws InputError where the set is not RGB or lacks a
/// resin.
[[nodiscard]] TargetColours reflected_colours(const Target& target, const optics::ResinSet& set,
                                              MixtureKind mixtures = MixtureKind::ideal,
                                              SquareKind squares = SquareKind::endless);
/// The resins' colours averaged by their shares: a drawing, no prediction. One colour for each of the target's roles.
[[nodiscard]] TargetColours drawn_colours(const Target& target, const std::vector<Eigen::Vector3d>& of_roles);

class TargetScene {
public:
    TargetScene(const Target& target, TargetColours colours);
    /// The colour at a point of the target, mm. Points beyond the edge see the frame.
    [[nodiscard]] const Eigen::Vector3d& at(const Eigen::Vector2d& p) const;

private:
    [[nodiscard]] Eigen::Array2i bin(const Eigen::Vector2d& p) const;
    [[nodiscard]] std::size_t index(const Eigen::Array2i& bin) const {
        return std::size_t(bin.y() * bins_.x() + bin.x());
    }

    const Target& target_;
    TargetColours colours_;
    Eigen::Vector3d marker_;
    std::vector<std::vector<bool>> patterns_;
    Eigen::Array2i bins_;                            ///< of `bin_mm`, across the target
    std::vector<std::vector<std::size_t>> squares_;  ///< that reach into a bin, in their order
};

/// Rows from the top, `px_per_mm` on a side.
[[nodiscard]] io::LinearPicture target_preview(const Target& target, const TargetColours& colours, double px_per_mm);

}  // namespace voxtone::calibration
