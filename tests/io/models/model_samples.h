// SPDX-License-Identifier: GPL-3.0-or-later
//
// Small models and pictures made on the spot, for the tests of the readers. A sample is a set of files; the first is
// the one to read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace voxtone::test {

using Files = std::vector<std::pair<std::string, std::string>>;  // name, contents

/// A folder of its own that is removed at the end.
class Folder {
public:
    Folder();
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder();
    /// Writes the files; the path of the first.
    std::filesystem::path write(const Files& files) const;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// PNG of 8-bit RGBA, or of 16-bit when `deep` (values times 257).
[[nodiscard]] std::string png(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& rgba,
                              bool deep = false);
/// 2 x 2: red, green / blue, white.
[[nodiscard]] std::string four_colours();

[[nodiscard]] std::string zip(const Files& parts);
/// A package around one model part and others.
[[nodiscard]] std::string threemf(const std::string& resources, const std::string& build, const Files& others = {},
                                  const std::string& unit = "millimeter", const std::string& model_attributes = "");
/// <mesh> of a tetrahedron with corners 0, x, y, z of the given size; `triangle_attributes` of each of its four
/// triangles.
[[nodiscard]] std::string threemf_tetrahedron(double size, const std::vector<std::string>& triangle_attributes);

/// GLB from a JSON text and a binary chunk.
[[nodiscard]] std::string glb(const std::string& json, const std::string& binary);
template <class Value>
[[nodiscard]] std::string raw(const std::vector<Value>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)};
}

/// One sample of every format, with all that the reader looks at: textures, colours, transforms.
[[nodiscard]] std::vector<Files> every_sample();

}  // namespace voxtone::test
