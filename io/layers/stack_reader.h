// SPDX-License-Identifier: GPL-3.0-or-later
//
// Opens a layer stack: a folder of ours (with manifest.json), anybody's folder of PNG files, or a GCVF container.
// Layers are read one at a time, in any order, from any thread; memory is one layer's runs.
//
// A stack is taken for hostile, as a model is: its files are parsed by programs of their own, one for each thread that
// asks at the same time, which may read nothing but the stack (io/files/isolate.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/layers/stack_service.h"

namespace voxtone::io {

class StackReader {
public:
    using Kind = StackKind;

    /// Throws FileError, InputError: nothing there, no layer in it, a manifest or container that cannot be understood;
    /// TryAgain.
    explicit StackReader(const std::filesystem::path& path);
    ~StackReader();
    StackReader(StackReader&&) noexcept;
    StackReader& operator=(StackReader&&) noexcept;

    [[nodiscard]] Kind kind() const;
    /// Of a stack of ours.
    [[nodiscard]] const std::optional<StackDescription>& description() const;
    /// Of a stack of ours: whether its manifest says what was written, what its job says, and the text of its sheet of
    /// resins where it has one.
    [[nodiscard]] ManifestSeal seal() const;
    [[nodiscard]] const StackOrigin& origin() const;
    [[nodiscard]] const std::optional<std::string>& sheet() const;
    /// Of a GCVF.
    [[nodiscard]] const std::optional<GcvfConfig>& gcvf() const;
    /// Of a folder: how its bitmaps lie, where the slicer that made them left its settings beside them (PrusaSlicer).
    [[nodiscard]] const std::optional<Orientation>& orientation() const;
    /// Of a container: nothing where it has no Zbuffer.png. Throws as `look` does.
    [[nodiscard]] std::optional<ZbufferInspection> zbuffer() const;
    [[nodiscard]] bool has_zbuffer() const;
    /// Of a container: the sizes of Mesh.stl and MeshBbx.ktn; 0: not there, or empty.
    [[nodiscard]] std::array<std::uint64_t, 2> preview_bytes() const;
    [[nodiscard]] std::uint32_t layers() const;
    /// Name of a layer for messages, bottom first.
    [[nodiscard]] const std::string& layer_name(std::uint32_t index) const;
    /// What lies beside the layers and should not: file or entry names.
    [[nodiscard]] const std::vector<std::string>& strangers() const;
    /// Layers that the manifest or container announces and that are not there: the first thousand by name, and all of
    /// them.
    [[nodiscard]] const std::vector<std::string>& missing() const;
    [[nodiscard]] std::uint64_t missing_count() const;
    /// What the system lacks of the walls around the program that reads, where this run did not say it yet.
    [[nodiscard]] std::string untold_note() const;
    /// What is in a layer's file, with runs in materials of the palette; a fault of the file is in it. Throws
    /// InputError where the file makes its reader crash, ResourceError, TryAgain.
    [[nodiscard]] LayerInspection inspect(std::uint32_t index, std::span<const Rgb> palette,
                                          const OtherPixels& others = {}) const;
    /// A layer in materials of the palette. Throws InputError where it has another colour.
    [[nodiscard]] LayerRuns read(std::uint32_t index, std::span<const Rgb> palette,
                                 const OtherPixels& others = {}) const;
    /// The palette that is given by manifest or container; else the colours that are found in all layers but in pixels
    /// of alpha 0, the background (0, 0, 0) first, then in order of first appearance. Throws InputError for more than
    /// max_materials.
    [[nodiscard]] std::vector<Rgb> palette() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace voxtone::io
