// SPDX-License-Identifier: GPL-3.0-or-later
//
// One part of a tray's stack: OUT/parts/NAME holds no layers, and stands for its box in those of OUT.
#pragma once

#include <optional>
#include <string>

#include "slicer/layers/layer_volume.h"

namespace voxtone::slicer {

struct PartInTray {
    std::string stack;            ///< folder of the tray
    LayerWindow window;           ///< of its first copy there
    std::string illuminant = {};  ///< lamp that it was made for; empty: the tray's
};

/// Nothing where that is no folder of a tray's part. Throws FileError, InputError where its tray.json cannot be read,
/// or does not know it.
[[nodiscard]] std::optional<PartInTray> find_part_in_tray(const std::string& folder);

/// The lamp that all parts of a tray were made for; empty: the tray's, or it is no tray. Throws InputError where parts
/// differ: no lamp shows them all as they were made to look.
[[nodiscard]] std::string lamp_of_parts(const std::string& folder);

}  // namespace voxtone::slicer
