// SPDX-License-Identifier: GPL-3.0-or-later
//
// Opens a layer stack: a folder of ours (with manifest.json), anybody's folder of PNG files, or a GCVF container.
// Layers are read one at a time, in any order, from any thread; memory is one layer's file and its runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "voxtone/io/layers/gcvf_config.h"
#include "voxtone/io/layers/layer_runs.h"
#include "voxtone/io/layers/manifest.h"
#include "voxtone/io/pictures/png_pixels.h"

namespace voxtone::io {

using Rgba = std::array<std::uint8_t, 4>;

/// A colour of a layer, how many pixels have it and where the first one is.
struct ColourCount {
    Rgba rgba{};
    std::uint64_t pixels = 0;
    std::uint32_t first_x = 0, first_y = 0;
};

/// What is in one layer's bitmap.
struct LayerScan {
    PngHeader header;
    /// In order of appearance, at most `most_colours`; what has another colour is in `other_pixels`.
    std::vector<ColourCount> colours;
    std::uint64_t other_pixels = 0;
    /// The layer in materials of the palette; absent where a pixel has none of its colours or an alpha other than 255.
    std::optional<LayerRuns> runs;

    static constexpr std::size_t most_colours = 256;
};

/// Decodes one layer. With an empty palette there are no runs. Throws InputError beginning with `source`.
[[nodiscard]] LayerScan scan_layer(std::span<const std::uint8_t> file, const std::string& source,
                                   std::span<const Rgb> palette);

/// A name of the form STEM DIGITS .png
struct SliceName {
    std::string stem;
    std::uint64_t number = 0;
    int digits = 0;
};
/// Nothing where the name is of another form (the extension in any case, at most 18 digits).
[[nodiscard]] std::optional<SliceName> parse_slice_name(const std::string& file_name);

class StackReader {
public:
    enum class Kind { voxtone, folder, gcvf };

    /// Throws FileError, InputError: nothing there, no layer in it, a manifest or container that cannot be understood.
    explicit StackReader(const std::filesystem::path& path);
    ~StackReader();
    StackReader(StackReader&&) noexcept;
    StackReader& operator=(StackReader&&) noexcept;

    [[nodiscard]] Kind kind() const;
    /// Of a stack of ours.
    [[nodiscard]] const std::optional<StackDescription>& description() const;
    /// Of a GCVF.
    [[nodiscard]] const std::optional<GcvfConfig>& gcvf() const;
    [[nodiscard]] std::uint32_t layers() const;
    /// Name of a layer for messages, bottom first.
    [[nodiscard]] const std::string& layer_name(std::uint32_t index) const;
    /// What lies beside the layers and should not: file or entry names.
    [[nodiscard]] const std::vector<std::string>& strangers() const;
    /// Layers that the manifest or container announces and that are not there: the first thousand by name, and all of
    /// them.
    [[nodiscard]] const std::vector<std::string>& missing() const;
    [[nodiscard]] std::uint64_t missing_count() const;
    /// The bytes of a layer's file, 256 MiB at most. Throws FileError, InputError.
    [[nodiscard]] std::vector<std::uint8_t> bytes(std::uint32_t index) const;
    /// A layer in materials of the palette. Throws InputError where it has another colour.
    [[nodiscard]] LayerRuns read(std::uint32_t index, std::span<const Rgb> palette) const;
    /// The palette that is given by manifest or container; else the colours that are found in all layers, the
    /// background (0, 0, 0) first, then in order of first appearance. Throws InputError for more than max_materials.
    [[nodiscard]] std::vector<Rgb> palette() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace voxtone::io
