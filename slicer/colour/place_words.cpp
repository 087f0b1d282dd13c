// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/colour/place_words.h"

#include <algorithm>
#include <map>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/printable.h"

namespace voxtone::slicer {

namespace {

/// As programs number what nobody named: "12", "4700acf5-024d"; a "Bed2" is short enough to be a name.
bool is_number(const std::string& name) {
    constexpr std::size_t least_of_hex = 8;
    const bool digits = name.find_first_not_of("0123456789") == std::string::npos;
    return digits ||
           (name.size() >= least_of_hex && name.find_first_not_of("0123456789abcdefABCDEF-{}_") == std::string::npos &&
            name.find_first_of("0123456789") != std::string::npos);
}

}  // namespace

PlaceWords::PlaceWords(const JobBody& body) : body_(body) {
    if (body.is_picture) return;
    std::map<std::string, std::size_t> triangles;
    for (const std::uint32_t material : body.model.mesh.material_of_triangle)
        ++triangles[body.model.mesh.materials[material].name];
    // What most of it is made of is no place.
    for (const auto& [name, count] : triangles)
        // Names in brackets are a program's own: "(layers)".
        if (!name.empty() && name.front() != '(' && !is_number(name) && 2 * count < body.model.mesh.triangles.size())
            names_.insert(name);
}

std::string PlaceWords::at(const std::array<double, 3>& at_mm) const {
    const auto& size = body_.grid.size;
    const Eigen::Vector3d& pitch = body_.grid.pitch_mm;
    std::string words =
        place_in_box(at_mm, {size[0] * pitch[0], size[1] * pitch[1], size[2] * pitch[2]}, body_.is_picture);
    if (names_.empty() || body_.surface->triangles.empty()) return words;
    const Eigen::Vector3d point = Eigen::Vector3d(at_mm[0], at_mm[1], at_mm[2]) + body_.grid.origin_mm;
    const TriangleTree::Nearest nearest = body_.surface.tree().nearest(point);
    if (nearest.triangle == TriangleTree::none) return words;
    const io::TexturedMesh& mesh = body_.model.mesh;
    const std::uint32_t source = body_.surface->source_triangle[nearest.triangle];
    if (source >= mesh.material_of_triangle.size()) return words;  // of a patch
    const std::string& name = mesh.materials[mesh.material_of_triangle[source]].name;
    return !names_.contains(name) ? words : fmt::format("{}, on '{}'", words, printable(name));
}

std::string place_in_box(const std::array<double, 3>& at_mm, const std::array<double, 3>& size_mm, bool is_picture) {
    constexpr double thin = 0.2;
    const double longest = *std::ranges::max_element(size_mm);
    std::vector<const char*> words;
    const auto say = [&](std::size_t axis, const char* low, const char* high) {
        if (size_mm[axis] < thin * longest) return;
        const double part = at_mm[axis] / size_mm[axis];
        if (part < 1.0 / 3) words.push_back(low);
        if (part > 2.0 / 3) words.push_back(high);
    };
    say(is_picture ? 1 : 2, "lower", "upper");
    say(0, "left", "right");
    if (!is_picture) say(1, "front", "back");
    return words.empty() ? "middle" : fmt::format("{}", fmt::join(words, " "));
}

}  // namespace voxtone::slicer
