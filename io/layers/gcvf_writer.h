// SPDX-License-Identifier: GPL-3.0-or-later
//
// A GCVF container from the layers of a finished folder: a ZIP with ConfigFile.xml, layer_0.png ..., Mesh.stl (a
// preview in mm, y negative because image rows run downward), MeshBbx.ktn (six little-endian float32: least and
// greatest x, y, z in pixels and slices, y downward) and Zbuffer.png (topmost_layers.h). There is no public
// specification: the form is what public readers and writers agree on. The same stack gives the same bytes. PNG entries
// are stored, since they are compressed already.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "base/progress.h"
#include "io/layers/manifest.h"
#include "io/layers/topmost_layers.h"

namespace voxtone::io {

/// The hull that a GCVF shows as a preview, in the model's frame (mm). Empty: the box of the bitmaps is shown.
struct PreviewMesh {
    std::span<const std::array<float, 3>> vertices_mm;
    std::span<const std::array<std::uint32_t, 3>> triangles;
};

/// The bytes of Mesh.stl and of MeshBbx.ktn.
struct GcvfPreview {
    std::vector<std::uint8_t> stl, box;
};
[[nodiscard]] GcvfPreview gcvf_preview(const StackDescription& stack, const PreviewMesh& mesh);

/// Writes `file` from the layers under `folder`; `topmost` has seen them all. Warns of what gcvf_size_note says. Throws
/// FileError, TryAgain, Cancelled.
void write_gcvf(const std::filesystem::path& file, const StackDescription& stack, const std::filesystem::path& folder,
                const TopmostLayers& topmost, const GcvfPreview& preview, Progress* progress = nullptr);

}  // namespace voxtone::io
