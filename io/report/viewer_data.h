// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the report's viewer carries as JSON. Arrays of numbers are differences to the number before, deflated, in
// base64: data/report/viewer/unpack.js reads them again.
//
//   colours       bytes: code minus the same channel's code one place before, red of all places, then green, then blue
//   positions     the same in 16 bits: low bytes of x of all vertices, then high bytes; then y, then z
//   triangles     index minus the index before, zigzag, as LEB128
//   differences   bytes as they are
//   parts         numbers: low bytes of all places, then high bytes
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/layers/rgb.h"
#include "io/report/viewer.h"

namespace voxtone::io {

struct ViewerResin {
    std::string name, role;
    Rgb rgb{};
};

/// All but the voxels, as one JSON object. `resins`: materials 1, 2, ... of them. `about`: what the prediction is; may
/// be empty.
[[nodiscard]] std::string viewer_json(const ReportViewer& viewer, std::span<const ViewerResin> resins,
                                      std::string_view about);

[[nodiscard]] std::string voxels_json(const ViewerVoxels& voxels);

/// About what the surface takes in the page.
[[nodiscard]] std::size_t packed_bytes(const ViewerSurface& surface);
/// What voxels take in the page.
[[nodiscard]] std::size_t packed_bytes(const std::vector<ViewerLayer>& layers);
[[nodiscard]] std::size_t packed_bytes(const ViewerVoxels& voxels);

}  // namespace voxtone::io
