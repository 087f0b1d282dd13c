// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files that a model names (textures, material libraries, buffers), looked up beside the model and nowhere else.
//
// A model comes from anywhere, so a name in it is not trusted: absolute paths, drive letters and `..` are not followed;
// only the last part of such a name is looked for, in the model's own folder. A link that leads out of it is not
// followed; what begins with a dot is not looked at. Backslashes count as slashes. Where the exact name does not exist,
// one is taken that differs only in upper and lower case, in how accents are written (Unicode's normal forms) or in
// that one of the two is Windows-1252; then what the name is without blanks and quotes around it, without ; or , behind
// it, or with %XX decoded; then its last part alone, as of a folder that was laid flat.
// What was done instead of what the file asked for is said in a warning.
//
// In an archive, all of which came with the model, `..` is followed as far as its root, and what is not beside the
// model is taken from elsewhere in it: the file of that name whose folders are called most like those that were named.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::io {

/// Where a model and the files that it names lie.
class ModelFolder {
public:
    ModelFolder() = default;
    ModelFolder(const ModelFolder&) = delete;
    ModelFolder& operator=(const ModelFolder&) = delete;
    virtual ~ModelFolder() = default;

    [[nodiscard]] virtual bool exists(const std::filesystem::path& path) const = 0;
    [[nodiscard]] virtual bool is_file(const std::filesystem::path& path) const = 0;
    /// What is in a folder, with the folder's path before it.
    [[nodiscard]] virtual std::vector<std::filesystem::path> entries(const std::filesystem::path& folder) const = 0;
    /// Whether a file lies where its path says, below `folder`, and is no link to elsewhere.
    [[nodiscard]] virtual bool lies_below(const std::filesystem::path& file,
                                          const std::filesystem::path& folder) const = 0;
    /// Throws FileError, InputError.
    [[nodiscard]] virtual std::vector<std::byte> read(const std::filesystem::path& file,
                                                      std::uint64_t max_bytes) const = 0;
    /// All files, where these all came with the model, by paths from one root; empty: they did not.
    [[nodiscard]] virtual std::vector<std::filesystem::path> all_files() const { return {}; }
};

/// That of the disk.
[[nodiscard]] const ModelFolder& disk_folder();

class SideFiles {
public:
    explicit SideFiles(const std::filesystem::path& model, const ModelFolder& place = disk_folder());

    /// The regular file that `name` means, or nothing. Each name is warned about once.
    [[nodiscard]] std::optional<std::filesystem::path> find(std::string_view name);

    /// What was taken instead of what was named, in whole sentences.
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

private:
    [[nodiscard]] std::optional<std::filesystem::path> find_as_written(std::string_view name);
    [[nodiscard]] std::optional<std::filesystem::path> find_from_root(std::string_view name,
                                                                      const std::vector<std::string>& parts);
    [[nodiscard]] std::optional<std::filesystem::path> find_elsewhere(std::string_view name);
    [[nodiscard]] std::optional<std::filesystem::path> walk(const std::filesystem::path& from,
                                                            const std::vector<std::string>& parts) const;
    [[nodiscard]] std::optional<std::filesystem::path> find_last_part(std::string_view name);

    const ModelFolder& place_;
    std::filesystem::path folder_;
    std::string model_;
    std::map<std::string, std::optional<std::filesystem::path>, std::less<>> found_;
    std::vector<std::string> warnings_;
};

/// Decodes %XX of a URI; a broken escape stays as it is.
[[nodiscard]] std::string decode_uri(std::string_view uri);
/// What a URI holds itself (RFC 2397, "data:"); nothing: it names a file.
[[nodiscard]] std::optional<std::vector<std::byte>> data_of_uri(std::string_view uri);

}  // namespace voxtone::io
