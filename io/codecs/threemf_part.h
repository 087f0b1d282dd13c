// SPDX-License-Identifier: GPL-3.0-or-later
//
// One model part of a 3MF package as plain values: resources, objects, build items. Indices are as written; nothing is
// resolved yet. The namespace of <model> is the core's, whatever its address: some files have none, some an older one.
// Based on: 3MF Consortium, "3D Manufacturing Format, Core Specification" 1.3.0; "Materials and Properties
// Extension" 1.2.1; "Production Extension" 1.1.2.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "io/models/slicer_roles.h"
#include "io/pictures/texture.h"

namespace voxtone::io {

inline constexpr std::uint32_t no_property = 0xffffffffu;

struct ThreemfTexture {
    std::string path;
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
    bool nearest = false;
};

/// Every kind of property group; which members mean something depends on `kind`.
struct ThreemfGroup {
    enum class Kind : std::uint8_t {
        base_materials,
        colours,
        texture,
        composites,
        multi,
        unknown
    } kind = Kind::unknown;
    std::string element;                      ///< name of the element, for messages
    std::vector<Eigen::Vector4f> rgba;        ///< base_materials, colours: sRGB codes and alpha in [0, 1]
    std::uint32_t refers_to = no_property;    ///< texture: its texture2d; composites: its base materials
    std::vector<Eigen::Vector2f> uv;          ///< texture
    std::vector<std::uint32_t> members;       ///< composites: indices into the base materials; multi: ids of groups
    std::vector<std::vector<double>> values;  ///< composites: shares; multi: indices into each member
    std::vector<std::vector<double>> attenuation;  ///< translucentdisplayproperties: 1/m, of R, G, B
    std::uint32_t display = no_property;           ///< base_materials: its display properties
    std::vector<bool> multiply;                    ///< multi: how member i + 1 is laid over those before
};

struct ThreemfTriangle {
    std::array<std::uint32_t, 3> corners;
    std::uint32_t pid = no_property;  ///< of the triangle; else the object's
    std::array<std::uint32_t, 3> p{no_property, no_property, no_property};
    TrianglePaint paint{};  ///< in a slicer
};

struct ThreemfReference {
    std::uint32_t object = no_property;
    std::string path;  ///< of the part that holds it (production extension); empty: the same part
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
    bool printable = true;  ///< of an item, as PrusaSlicer and its kin say it
};

struct ThreemfObject {
    std::string type = "model", name;
    std::uint32_t pid = no_property, pindex = no_property;
    std::vector<Eigen::Vector3d> vertices;
    std::vector<ThreemfTriangle> triangles;
    std::map<std::size_t, std::string> paint_in_parts;  ///< of triangles that a slicer painted so, as it wrote it
    std::vector<ThreemfReference> components;
    bool has_beams = false;   ///< a beam lattice, which is not read
    std::string other_shape;  ///< an element that says its shape otherwise than by a mesh; empty: none
    std::string volume;  ///< what gives it colours or a shape, which are not read (Volumetric Extension); empty: none
};

struct ThreemfPart {
    std::string path;  ///< in the package
    double mm_per_unit = 1;
    std::map<std::uint32_t, ThreemfTexture> textures;
    std::map<std::uint32_t, ThreemfGroup> groups;
    std::map<std::uint32_t, ThreemfObject> objects;
    std::vector<ThreemfReference> items;
    std::vector<std::string> required_extensions;  ///< namespaces; a prefix that is declared nowhere
    bool is_translucent = false;                   ///< has display properties of materials that light goes through
    std::set<std::string> plain_volumes,           ///< volumedata that give no colours, by id
        shaping_volumes;                           ///< that give a shape (`boundary` of the extension's drafts)
};

/// Throws InputError naming the line. `what` names the part.
[[nodiscard]] ThreemfPart parse_threemf_part(std::string_view xml, const std::string& what);

}  // namespace voxtone::io
