// SPDX-License-Identifier: GPL-3.0-or-later
//
// A part of a tray that shows no colours: a plain box, cylinder or model of a resin or of a mixture of some, or a print
// that is sliced already, whose voxels are taken as they are.
//   {"box": [10, 5, 2], "resin": "VeroClear"}
//   {"cylinder": {"diameter": 8, "height": 2}, "mixture": {"VeroWhite": 1, "VeroClear": 3}}
//   {"model": "block.stl", "resin": "VeroClear"}, with the options of a model
//   {"stack": "other/OUT"}, {"gcvf": "file.gcvf"}
// In a cell of a table: box "10 5 2", cylinder "8 2" (diameter, height), mixture "VeroWhite:1+VeroClear:3".
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/named_values.h"

namespace voxtone::io {
class JsonObject;
}

namespace voxtone::slicer {

/// The word that names each is its key in a plan, but for a body, which is a model with a resin.
enum class ComponentKind { box, cylinder, body, stack, gcvf };

}  // namespace voxtone::slicer

namespace voxtone {

template <>
struct NamesOf<slicer::ComponentKind> {
    using K = slicer::ComponentKind;
    static constexpr auto table = std::to_array<Named<K>>(
        {{K::box, "box"}, {K::cylinder, "cylinder"}, {K::body, "body"}, {K::stack, "stack"}, {K::gcvf, "gcvf"}});
};

}  // namespace voxtone

namespace voxtone::slicer {

struct ResinShare {
    std::string resin;  ///< name or role
    double share = 0;   ///< by volume, > 0; counts against the sum of all
};

struct TrayComponent {
    ComponentKind kind = ComponentKind::box;
    std::array<double, 3> size_mm{};  ///< of a box; of a cylinder, which stands upright: diameter, diameter, height
    std::vector<ResinShare> mixture;  ///< of a box, cylinder or body; empty: it cuts
    std::string path;                 ///< of the model, the stack's folder or the container, absolute

    [[nodiscard]] bool is_shape() const { return kind == ComponentKind::box || kind == ComponentKind::cylinder; }
    /// What it is called where the plan gives no name.
    [[nodiscard]] std::string usual_name() const;
};

/// Their keys in a part.
[[nodiscard]] std::vector<std::string> component_keys();

/// What the part is if it is no model; nothing: a model. Throws InputError for a part that is two things at once, sizes
/// or resins that are none, and options that only a model can have.
[[nodiscard]] std::optional<TrayComponent> component_of(const io::JsonObject& part, const std::filesystem::path& folder,
                                                        bool cuts);

}  // namespace voxtone::slicer
