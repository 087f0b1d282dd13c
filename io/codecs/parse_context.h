// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the parsers of models share: the bytes of the model, the files beside it, the pictures read so far. They run in
// voxtone-read; all throw InputError.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/codecs/side_files.h"
#include "io/decoders/decode_image.h"
#include "io/files/read_bytes.h"
#include "io/files/read_options.h"
#include "io/models/model_parts.h"

namespace voxtone::io {

/// Of a model that has them and no faces.
inline constexpr std::string_view what_splats_are =
    "Gaussian splats, which have no surface: export a mesh (GLB, OBJ, or PLY with faces) from the program that scanned "
    "them";

/// What is done elsewhere for the parsers.
struct ParseHelp {
    OtherDecoder others = {};                   ///< of pictures that are not decoded here
    std::function<void()> ask_for_folder = {};  ///< before a file beside the model is read; empty: they can be read
};

/// What the parsers share: the model's bytes, the files beside it, the pictures read so far.
class ParseContext {
public:
    /// `name`: for messages; empty: the file's own.
    ParseContext(const std::filesystem::path& path, const ReadOptions& options, const ParseHelp& help = {},
                 const ModelFolder& place = disk_folder(), const std::string& name = {});

    [[nodiscard]] const std::string& name() const { return name_; }  ///< the file's name, for messages
    [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }
    [[nodiscard]] const ReadOptions& options() const { return options_; }
    /// The bytes of a file that the model names; nothing where there is none. Throws FileError, InputError.
    [[nodiscard]] std::optional<std::vector<std::byte>> read_side_file(const std::string& name);
    /// Whether there is such a file, or the name itself holds it ("data:").
    [[nodiscard]] bool finds(const std::string& name) { return name.starts_with("data:") || find(name).has_value(); }
    /// All that were asked for, with what was read of them.
    [[nodiscard]] const std::vector<SideFile>& side_files() const { return side_files_; }
    /// What was taken instead of what the model named, in whole sentences.
    [[nodiscard]] const std::vector<std::string>& side_file_warnings() const { return files_.warnings(); }

    /// Decodes a picture into parts.images; -1, with a warning that names it, when it is missing or damaged. `key`
    /// tells pictures apart: each is decoded once.
    std::int32_t add_image_file(ModelParts& parts, const std::string& file, const DecodeOptions& decode);
    std::int32_t add_image_bytes(ModelParts& parts, const std::string& key, std::span<const std::byte> bytes,
                                 const DecodeOptions& decode);

    /// Throws InputError where no triangle was found and `instead` says what was: what it is, and what to do. Empty
    /// entries are none.
    void expect_faces(const ModelParts& parts, const std::vector<std::string>& instead) const;

    [[nodiscard]] DecodeOptions decode_options() const {
        return {.max_pixels = options_.max_pixels, .others = help_.others};
    }

private:
    [[nodiscard]] std::optional<std::filesystem::path> find(const std::string& name);
    std::int32_t add(ModelParts& parts, const std::string& key, DecodedImage image);

    std::string name_;
    const ReadOptions& options_;
    const ParseHelp help_;
    const ModelFolder& place_;
    std::filesystem::path folder_;
    SideFiles files_;
    std::vector<SideFile> side_files_;
    std::vector<std::byte> bytes_;
    std::map<std::string, std::int32_t> images_;
};

}  // namespace voxtone::io
