// SPDX-License-Identifier: GPL-3.0-or-later
//
// manifest.json: the one description of a layer stack (data/schema/manifest.schema.json is its schema).
//
// Sizes, pitches and colours are those of the bitmaps as they lie in the folder: columns first, then rows, then layers.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/named_values.h"
#include "io/layers/layer_runs.h"
#include "io/layers/rgb.h"

namespace voxtone::io {

/// What was done to the bitmaps after slicing, in this order: rows and columns swapped, then columns mirrored (flip_x),
/// then rows mirrored (flip_y). Some printer set-ups print mirrored and want this.
struct Orientation {
    bool flip_x = false, flip_y = false, swap_xy = false;
    friend bool operator==(const Orientation&, const Orientation&) = default;
};

/// What a pixel with resin is in a bitmap of a single resin, as readers of its format show it.
enum class ResinPixels : std::uint8_t {
    unsaid,  ///< there are no such bitmaps
    white,   ///< PNG of one bit: 1
    black,   ///< TIFF of one bit: 0, as 0 is white in the file
};

struct StackResin {
    std::string name;  ///< the maker's name, "VeroWhite"
    std::string role;  ///< unique in the stack: "W"
    Rgb rgb{};         ///< unique in the stack and not the background
    std::uint64_t voxels = 0;
    double ml = 0;
    friend bool operator==(const StackResin&, const StackResin&) = default;
};

/// A body of a print of many.
struct StackMember {
    std::string name;  ///< unique in the stack
    /// Of its copies: least x, y, z, then greatest, from the corner of the grid, in the model's frame.
    std::vector<std::array<double, 6>> boxes_mm;
    double ml = 0;           ///< of all copies, as each would have it alone
    std::string verdict;     ///< "good", "fair", "bad"; empty: it was not asked for
    std::string about = {};  ///< whose it is and what is written on it; may be empty
    friend bool operator==(const StackMember&, const StackMember&) = default;
};

struct StackDescription {
    std::string printer;               ///< id of the profile
    std::array<double, 3> pitch_um{};  ///< of columns, rows, layers
    /// How far its resin runs before it is cured, along columns and rows: for who looks at it. 0: not, or not known.
    std::array<double, 2> spread_mm{};
    std::array<std::uint32_t, 2> size_px{};  ///< columns, rows; 1..65535
    std::uint32_t layers = 0;                ///< in this folder, >= 1
    std::uint32_t first_layer = 0;           ///< number of the first one: a part of a stack starts later
    std::array<double, 3> size_mm{};         ///< of the whole bitmap stack
    std::array<double, 3> origin_mm{};       ///< corner of the grid in the model's frame, before `orientation`
    std::string pattern = "layers/slice_%05d.png";
    Rgb background_rgb{};
    std::vector<StackResin> resins;  ///< material m of a layer is resins[m - 1]
    Orientation orientation;
    ResinPixels resin_pixels = ResinPixels::unsaid;
    std::vector<StackMember> members;  ///< empty: one body, or nobody says
    std::string content_sha256;        ///< see layer_digest.h; 64 hexadecimal digits

    friend bool operator==(const StackDescription&, const StackDescription&) = default;
    /// Colours of materials 0, 1, ...: the background, then the resins.
    [[nodiscard]] std::vector<Rgb> palette() const;
    /// Path of layer `index` (0-based in this folder) under the folder.
    [[nodiscard]] std::string layer_path(std::uint32_t index) const;
    /// Throws InputError, beginning with `source`, that names the key, its value and the rule it breaks.
    void validate(std::string_view source) const;
};

/// Size along each axis: pixels or layers times pitch.
[[nodiscard]] std::array<double, 3> stack_size_mm(const StackDescription& stack);

/// Millilitres in so many voxels of this pitch.
[[nodiscard]] double millilitres(std::uint64_t voxels, const std::array<double, 3>& pitch_um);

class JsonObject;
class JsonWriter;

/// The keys of a manifest but `manifest_sha256`, in an object of their own.
void add_stack(JsonWriter& json, const StackDescription& stack);
/// Of such an object. Throws InputError naming key and rule.
[[nodiscard]] StackDescription stack_in(const JsonObject& json, std::string_view source);

/// Ends with the key `manifest_sha256`: SHA-256 of the text without it. It binds the names and roles of resins to their
/// colours, which the bitmaps alone do not: swapped there, the wrong resins are loaded.
[[nodiscard]] std::string manifest_text(const StackDescription& stack);
/// Throws InputError naming key and rule.
[[nodiscard]] StackDescription parse_manifest(std::string_view text, std::string source);
/// Throws FileError, InputError.
[[nodiscard]] StackDescription read_manifest(const std::filesystem::path& file);

enum class ManifestSeal {
    none,    ///< of a program before 0.2, or somebody's own: nothing binds it
    whole,   ///< its values are those that were written, however they are set out now
    broken,  ///< a value was changed since
};
/// Of a manifest that can be read. Throws FileError, InputError.
[[nodiscard]] ManifestSeal seal_of_manifest(const std::filesystem::path& file);
/// The same of its text. Throws InputError.
[[nodiscard]] ManifestSeal seal_of_manifest_text(std::string_view text, std::string source);

}  // namespace voxtone::io

template <>
struct voxtone::NamesOf<voxtone::io::ResinPixels> {
    using Pixels = io::ResinPixels;
    static constexpr auto table = std::to_array<Named<Pixels>>({{Pixels::white, "white"}, {Pixels::black, "black"}});
};
