// SPDX-License-Identifier: GPL-3.0-or-later
//
// What slicers say of the parts of a 3MF file in files of their own beside the model: PrusaSlicer and its kin
// (Metadata/Slic3r_PE_model.config: volumes are runs of an object's triangles; Slic3r_PE.config), Bambu Studio,
// OrcaSlicer and theirs (Metadata/model_settings.config: parts are components of an object; project_settings.config).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace voxtone::io {

enum class SlicerRole : std::uint8_t {
    part,
    negative,  ///< to be cut out of the others
    modifier,  ///< changes how others are printed: modifiers, blockers and enforcers of support; no body
};

struct SlicerVolume {
    SlicerRole role = SlicerRole::part;
    int extruder = 0;  ///< from 1; 0: not said
};

/// Triangles of an object that follow each other and are of one volume.
struct SlicerSpan {
    std::size_t end = 0;  ///< the first triangle that is not of it
    SlicerVolume volume;
};

struct SlicerRoles {
    struct Run {
        std::size_t first = 0, last = 0;  ///< triangles
        SlicerVolume volume;
    };
    std::map<std::uint32_t, std::vector<Run>> runs;                         ///< by object
    std::map<std::pair<std::uint32_t, std::uint32_t>, SlicerVolume> parts;  ///< by object and component
    std::map<std::uint32_t, int> extruder;                                  ///< of whole objects
    /// Of extruders, sRGB codes; nothing where it is not said. Empty: of none.
    std::vector<std::optional<Eigen::Vector3f>> colours;

    /// More than one extruder is used: their colours tell parts apart.
    [[nodiscard]] bool tells_colours() const;
    /// Of an object as a whole that is a component of `parent` (or of none: itself).
    [[nodiscard]] SlicerVolume of(std::uint32_t parent, std::uint32_t object) const;
    /// Of so many triangles of it, in their order; where runs overlap the last one counts.
    [[nodiscard]] std::vector<SlicerSpan> spans(std::uint32_t parent, std::uint32_t object,
                                                std::size_t triangles) const;
};

/// Reads one of those files into `roles`; `xml` is its text, `what` names it in messages. Throws InputError where it is
/// no XML.
void read_slicer_volumes(std::string_view xml, const std::string& what, SlicerRoles& roles);
/// The extruder that a slicer painted a triangle for, from the attribute that it writes for it (TriangleSelector of
/// PrusaSlicer and its kin): a tree of divisions in hexadecimal digits, read from the end.
struct TrianglePaint {
    std::uint16_t extruder = 0;  ///< of most of it, from 1; 0: not painted
    bool is_divided = false;     ///< parts of it are painted otherwise
};
/// Nothing where the text is no such tree.
[[nodiscard]] std::optional<TrianglePaint> triangle_paint(std::string_view text);

/// A node of such a tree: how many sides of its triangle are divided, into sides + 1 children, and at which corner the
/// division begins (painted_triangles.h); of one that is not divided the extruder.
struct PaintNode {
    std::uint8_t sides = 0, corner = 0;
    std::uint16_t extruder = 0;
};
/// Each node before its children, of which the last comes first. Nothing where the text is no such tree.
[[nodiscard]] std::optional<std::vector<PaintNode>> paint_tree(std::string_view text);

/// Colours of "Metadata/Slic3r_PE.config" or of "Metadata/project_settings.config" (JSON).
void read_slicer_colours(std::string_view text, SlicerRoles& roles);

}  // namespace voxtone::io
