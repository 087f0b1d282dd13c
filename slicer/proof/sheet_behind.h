// SPDX-License-Identifier: GPL-3.0-or-later
//
// What lies behind a print, as the camera sees it: a sheet as large as the print's box, below its first layer with air
// between (slicer/part/backing_sheet.h).
#pragma once

#include <memory>

#include <Eigen/Core>

#include "optics/camera/camera_scene.h"
#include "optics/scene/sheet.h"
#include "slicer/options/option_values.h"
#include "slicer/proof/proof_camera.h"

namespace voxtone::slicer {

class SheetBehind : public optics::DiffuseBody {
public:
    /// `print`: its box as it stands, +z from its first layer on. Throws InputError for a picture of another shape,
    /// FileError.
    SheetBehind(const BackingChoice& backing, const Box& print);

    [[nodiscard]] bool meets(const optics::Point& from, const optics::Point& way, double& distance,
                             optics::BoundaryNormals& normals, optics::Light& reflectance) const override;

private:
    Eigen::Vector3d low_, high_;
    double height_mm_;
    std::shared_ptr<const optics::Sheet> sheet_;  ///< null: `even_` everywhere
    double even_ = 0;
};

}  // namespace voxtone::slicer
