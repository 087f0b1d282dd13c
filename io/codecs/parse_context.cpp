// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/parse_context.h"

#include <fmt/format.h>

#include "base/error.h"
#include "io/files/sha256.h"

namespace voxtone::io {

ParseContext::ParseContext(const std::filesystem::path& path, const ReadOptions& options, const ParseHelp& help,
                           const ModelFolder& place, const std::string& name)
    : name_(name.empty() ? path.filename().string() : name),
      options_(options),
      help_(help),
      place_(place),
      folder_(path.parent_path().empty() ? "." : path.parent_path()),
      files_(path, place),
      bytes_(place.read(path, options.max_file_bytes)) {
    if (bytes_.empty()) throw InputError(fmt::format("{} is empty", name_));
}

std::optional<std::filesystem::path> ParseContext::find(const std::string& name) {
    if (help_.ask_for_folder) help_.ask_for_folder();
    return files_.find(name);
}

std::optional<std::vector<std::byte>> ParseContext::read_side_file(const std::string& name) {
    const auto path = find(name);
    if (!path) {
        side_files_.push_back({name, {}});
        return std::nullopt;
    }
    std::vector<std::byte> bytes = place_.read(*path, options_.max_file_bytes);
    side_files_.push_back({path->lexically_relative(folder_).generic_string(),
                           sha256({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()})});
    return bytes;
}

void ParseContext::expect_faces(const ModelParts& parts, const std::vector<std::string>& instead) const {
    if (!parts.triangles.empty()) return;
    std::string all;
    for (const std::string& what : instead)
        if (!what.empty()) all += (all.empty() ? "" : "; and ") + what;
    if (!all.empty()) throw InputError(fmt::format("{} holds no faces to print, only {}", name_, all));
}

std::int32_t ParseContext::add(ModelParts& parts, const std::string& key, DecodedImage image) {
    for (std::string& warning : image.warnings) parts.warnings.push_back(std::move(warning));
    image.warnings.clear();
    if (!image.lost_colour.empty()) parts.lose_colour(image.lost_colour);
    const auto index = static_cast<std::int32_t>(parts.images.size());
    parts.images.push_back(std::move(image));
    parts.image_names.push_back(key);
    return images_[key] = index;
}

std::int32_t ParseContext::add_image_file(ModelParts& parts, const std::string& file, const DecodeOptions& decode) {
    if (const auto known = images_.find(file); known != images_.end()) return known->second;
    if (const auto inside = data_of_uri(file)) {  // too long a name to be said
        const std::string name = fmt::format("{} ({})", file.substr(0, file.find_first_of(";,")), images_.size() + 1);
        return images_[file] = add_image_bytes(parts, name, *inside, decode);
    }
    std::optional<std::vector<std::byte>> bytes;
    try {
        bytes = read_side_file(file);
    } catch (const Error& error) {
        parts.lose_texture(
            fmt::format("The texture '{}' could not be read ({}): its colours are LOST and the material's own "
                        "colour is used.",
                        file, error.what()));
        return images_[file] = -1;
    }
    if (!bytes) {
        parts.lose_texture(
            fmt::format("The texture '{}' that {} names was not found beside the model: its colours are LOST and "
                        "the material's own colour is used. Put the file into the model's folder.",
                        file, name_));
        return images_[file] = -1;
    }
    return add_image_bytes(parts, file, *bytes, decode);
}

std::int32_t ParseContext::add_image_bytes(ModelParts& parts, const std::string& key, std::span<const std::byte> bytes,
                                           const DecodeOptions& decode) {
    if (const auto known = images_.find(key); known != images_.end()) return known->second;
    try {
        return add(parts, key, decode_image(bytes, "'" + key + "'", decode));
    } catch (const InputError& error) {
        parts.lose_texture(
            fmt::format("A texture could not be used: {}. Its colours are LOST and the material's own colour is used.",
                        error.what()));
        return images_[key] = -1;
    }
}

}  // namespace voxtone::io
