// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the body lies in the layers of another program, and whether every pixel of them is understood.
//
// All layers are looked at before anything is refused: a message names every colour that has to be told, and what is
// told after it is enough. Pixels of alpha 0 are no material, whatever their colour. With `nearest` a colour that
// stands for nothing is taken for the nearest one that was told and occurs; what is less than half opaque is nothing.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/progress.h"
#include "io/layers/stack_reader.h"
#include "optics/media/resin_volume.h"
#include "slicer/layers/layer_volume.h"

namespace voxtone::slicer {

using MaterialTable = std::array<optics::Material, io::max_materials>;

/// What the pixels of a stack are printed of: colour i of the palette of `material_of[i]`.
struct PixelMaterials {
    std::vector<io::Rgb> palette;
    MaterialTable material_of{};
    io::OtherPixels others{};
};

struct ForeignStack {
    const io::StackReader& layers;
    std::string name;  ///< for messages
    io::Orientation orientation;
    std::string resin_set, roles, role;  ///< that colours may be assigned to, and one of them, for messages
    bool any_assigned = true;            ///< colours were told, by the user or by a container
    bool nearest = false;
};

struct ForeignBody {
    LayerWindow window;                                     ///< the smallest that holds every voxel with a resin
    PixelMaterials materials;                               ///< by which the layers are to be read
    std::array<std::uint64_t, io::max_materials> pixels{};  ///< of each material of its palette

    /// Pixels of a colour that are not taken for another.
    [[nodiscard]] std::uint64_t pixels_of(const io::Rgb& rgb) const;
    [[nodiscard]] std::uint64_t solid_voxels() const;
};

/// Throws InputError: a layer that cannot be read or is of another size, colours that stand for nothing, no body.
[[nodiscard]] ForeignBody find_foreign_body(const ForeignStack& stack, PixelMaterials materials, Progress& progress);

}  // namespace voxtone::slicer
