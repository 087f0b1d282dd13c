// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files that a model names (textures, material libraries, buffers), looked up beside the model and nowhere else.
//
// A model comes from anywhere, so a name in it is not trusted: absolute paths, drive letters and `..` are not followed;
// only the last part of such a name is looked for, in the model's own folder. A link that leads out of it is not
// followed; what begins with a dot is not looked at. Backslashes count as slashes. Where the exact name does not exist,
// one is taken that differs only in upper and lower case, in how accents are written (Unicode's normal forms) or in
// that one of the two is Windows-1252; then what the name is without blanks and quotes around it, or with %XX decoded.
// What was done instead of what the file asked for is said in a warning.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::io {

class SideFiles {
public:
    explicit SideFiles(const std::filesystem::path& model);

    /// The regular file that `name` means, or nothing. Each name is warned about once.
    [[nodiscard]] std::optional<std::filesystem::path> find(std::string_view name);

    /// What was taken instead of what was named, in whole sentences.
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

private:
    [[nodiscard]] std::optional<std::filesystem::path> find_as_written(std::string_view name);

    std::filesystem::path folder_;
    std::string model_;
    std::map<std::string, std::optional<std::filesystem::path>, std::less<>> found_;
    std::vector<std::string> warnings_;
};

/// Decodes %XX of a URI; a broken escape stays as it is.
[[nodiscard]] std::string decode_uri(std::string_view uri);

}  // namespace voxtone::io
