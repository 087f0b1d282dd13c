// SPDX-License-Identifier: GPL-3.0-or-later
//
// A laminate, the layers of resin under a point, as a JSON file (format "voxtone-laminate", earlier "voxtone-stack"):
// what `voxtone laminate search` finds and `laminate predict` reads.
//
//   {"format": "voxtone-laminate", "version": 1, "name": "jade", "source": "...",
//    "resins": "vero-opaque",  (a set that comes with the program, or a file; left out where materials are profile
//    files) "surface": "air" | "matched",  "backing": "black" | "white" | "air" | a profile file, "layers":
//    [{"material": "W", "mm": 0.3}, {"material": "T", "mm": 1.2}]}   (the first one is on top)
//
// A material is the role of a resin of the set, or the file of a measured profile (profile_file.h). What `surface` and
// `backing` mean: docs/laminate-search.md.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::io {

struct SequenceLayer {
    std::string material;
    double mm = 0;
};

struct LayerSequence {
    std::string name, source;
    std::string resins;  ///< empty: materials are profile files
    std::string surface = "air", backing = "black";
    std::vector<SequenceLayer> layers;  ///< top first; may be none
};

/// Throws InputError that names file, key and rule: also for a thickness that is not above 0.
[[nodiscard]] LayerSequence parse_layer_sequence(std::string_view text, std::string source);
/// Throws FileError, InputError.
[[nodiscard]] LayerSequence read_layer_sequence(const std::filesystem::path& file);
[[nodiscard]] std::string layer_sequence_text(const LayerSequence& sequence);

/// Layers as a person writes them, the first one on top: "W 0.3, K 100um" (mm where no unit is given). Throws
/// UsageError.
[[nodiscard]] std::vector<SequenceLayer> parse_layers(std::string_view text);
/// The same, in mm.
[[nodiscard]] std::string layers_text(const std::vector<SequenceLayer>& layers);

}  // namespace voxtone::io
