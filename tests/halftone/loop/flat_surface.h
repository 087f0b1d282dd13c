// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "optics/scene/appearance_model.h"

namespace voxtone::test {

/// A plate that looks up, of columns x rows square cells, in order of y, x.
inline optics::Surface flat_surface(int columns, int rows, double pitch_mm) {
    optics::Surface surface;
    surface.cell_voxels = {2, 1, 3};
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            optics::SurfaceCell cell;
            cell.cell = {x, y, 0};
            cell.centre_mm = {static_cast<float>((x + 0.5) * pitch_mm), static_cast<float>((y + 0.5) * pitch_mm), 0};
            cell.normal = {0, 0, 1};
            cell.area_mm2 = static_cast<float>(pitch_mm * pitch_mm);
            surface.cells.push_back(cell);
        }
    return surface;
}

}  // namespace voxtone::test
