// SPDX-License-Identifier: GPL-3.0-or-later
//
// A 3MF file as a package of parts (Open Packaging Conventions), as the world writes and packs it: names with
// backslashes, a folder around it all, paths that are relative or percent-encoded, other cases of letters, a model part
// by another name than its relationship says. What was taken instead of what was named is a warning; what is not there
// is told with what is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/zip_reader.h"

namespace voxtone::io {

class ThreemfPackage {
public:
    /// `bytes` must outlive it; `name` is the file's, for messages. Throws InputError where it is no archive, or one
    /// without any model part.
    ThreemfPackage(std::span<const std::byte> bytes, const std::string& name, std::uint64_t most_unpacked_bytes);

    /// A part by its path, seen from the part `from` where it does not begin with a slash: "/3D/a.png", as it lies in
    /// the package; nothing where there is none.
    [[nodiscard]] std::optional<std::string> find(const std::string& path, const std::string& from = "/") const;
    /// Of a path that `find` gave. Throws InputError where it is damaged or has more than it may.
    [[nodiscard]] std::vector<std::byte> read(const std::string& found) const;
    /// The part that the package's relationships call its model, or the only one there is.
    [[nodiscard]] std::string root_part();

    /// Whether a part's name ends so, in any case of letters: ".gcode".
    [[nodiscard]] bool has_ending(std::string_view ending) const;

    /// "'/3D/a.model', '/3D/b.png' and 3 more", for messages.
    [[nodiscard]] std::string parts_there() const;
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

private:
    [[nodiscard]] std::optional<std::string> find_exactly(const std::string& path) const;
    void leave_folder();

    std::string name_;
    ZipReader archive_;
    std::map<std::string, std::size_t> parts_;     ///< by path with slashes, index of the archive
    std::map<std::string, std::string> any_case_;  ///< path in lower case -> path
    std::vector<std::string> warnings_;
};

}  // namespace voxtone::io
