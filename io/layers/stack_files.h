// SPDX-License-Identifier: GPL-3.0-or-later
//
// A layer stack as it lies on the disk: a folder of ours (with manifest.json), anybody's folder of numbered PNG files
// (io/pictures/picture_series.h), a GCVF container, or the ZIP that was packed for a printer. All is parsed in this
// process: what voxtone-read does for io/layers/stack_reader.h behind its walls.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/zip_reader.h"
#include "io/layers/gcvf_config.h"
#include "io/layers/manifest.h"

namespace voxtone::io {

/// A name of the form STEM DIGITS .png
struct SliceName {
    std::string stem;
    std::uint64_t number = 0;
    int digits = 0;
};
/// Nothing where the name is of another form (the extension in any case, at most 18 digits).
[[nodiscard]] std::optional<SliceName> parse_slice_name(const std::string& file_name);

enum class StackKind : std::uint8_t { voxtone, folder, gcvf };

/// What the job.json beside a stack of ours says of how it was made; empty: nothing that can be understood.
struct StackOrigin {
    /// Values of these keys, as they stand there.
    std::string model, resins, illuminant, backing, view, coat, enclose;
    std::string fault;  ///< why there are none, where the file is there
};

/// What there is in a stack.
struct StackListing {
    StackKind kind = StackKind::folder;
    std::optional<StackDescription> description;   ///< of a stack of ours
    ManifestSeal seal = ManifestSeal::none;        ///< of its manifest
    StackOrigin origin;                            ///< of a stack of ours
    std::optional<std::string> sheet;              ///< of a stack of ours: the text of its sheet of resins
    std::optional<GcvfConfig> gcvf;                ///< of a container
    std::optional<Orientation> orientation{};      ///< of a folder: how its slicer says that the bitmaps lie
    bool has_zbuffer = false;                      ///< a container's Zbuffer.png is there
    std::array<std::uint64_t, 2> preview_bytes{};  ///< of a container's Mesh.stl and MeshBbx.ktn; 0: not there, empty
    std::vector<std::string> names;                ///< of layers, bottom first
    std::vector<std::string> strangers;            ///< what lies beside the layers and should not
    std::vector<std::string> missing;              ///< announced and not there: the first thousand by name
    std::uint64_t missing_count = 0;               ///< all of them
};

inline constexpr std::string_view zbuffer_name = "Zbuffer.png";
inline constexpr std::array<std::string_view, 2> preview_names{"Mesh.stl", "MeshBbx.ktn"};

class StackFiles {
public:
    /// Throws FileError, InputError: nothing there, no layer in it, a manifest or container that cannot be understood.
    explicit StackFiles(const std::filesystem::path& path);

    [[nodiscard]] const StackListing& listing() const { return listing_; }
    /// The bytes of a layer's file, 256 MiB at most. From any thread. Throws FileError, InputError.
    [[nodiscard]] std::vector<std::uint8_t> bytes(std::uint32_t index) const;
    /// The same of a container's Zbuffer.png; contract: it is there.
    [[nodiscard]] std::vector<std::uint8_t> zbuffer_bytes() const;

private:
    void list_folder(const std::filesystem::path& folder);
    void open_ours();
    void open_for_printer();
    void open_packed(std::map<std::string, std::size_t> index);
    void read_page(const std::vector<std::uint8_t>& bytes);
    void list_ours();
    void read_beside_manifest();
    void open_gcvf();
    void add_missing(const std::string& name);
    void take_layer(const std::string& name, std::map<std::string, std::size_t>& index);

    std::filesystem::path root_;
    StackListing listing_;
    std::unique_ptr<ZipReader> zip_;
    std::vector<std::size_t> entries_;  // of an archive, per layer
    std::optional<std::size_t> zbuffer_entry_;
};

}  // namespace voxtone::io
