// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/codecs/parse_gltf.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "voxtone/base/error.h"
#include "voxtone/io/codecs/gltf_data.h"
#include "voxtone/io/files/base64.h"

namespace voxtone::io {

namespace {

using Json = nlohmann::json;

constexpr std::int64_t absurd = std::numeric_limits<std::int64_t>::min();

/// A member that is a whole number; `absurd`, which no check lets pass, when it is something else.
std::int64_t integer(const Json& object, const char* key, std::int64_t otherwise) {
    const auto found = object.find(key);
    if (found == object.end()) return otherwise;
    if (found->is_number_integer()) return found->get<std::int64_t>();
    const double value = found->is_number_float() ? found->get<double>() : 0.5;
    return std::abs(value) < 2e9 && value == std::floor(value) ? static_cast<std::int64_t>(value) : absurd;
}

double real(const Json& object, const char* key, double otherwise) {
    const auto found = object.find(key);
    return found != object.end() && found->is_number() ? found->get<double>() : otherwise;
}

std::string text(const Json& object, const char* key, const char* otherwise = "") {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : otherwise;
}

const Json& object(const Json& parent, const char* key) {
    static const Json empty = Json::object();
    const auto found = parent.find(key);
    return found != parent.end() && found->is_object() ? *found : empty;
}

const Json& array(const Json& parent, const char* key) {
    static const Json empty = Json::array();
    const auto found = parent.find(key);
    return found != parent.end() && found->is_array() ? *found : empty;
}

/// Numbers of an array member; what is missing keeps its value.
template <class Vector>
void numbers(const Json& parent, const char* key, Vector& values) {
    const Json& list = array(parent, key);
    for (Eigen::Index i = 0; i < values.size() && i < static_cast<Eigen::Index>(list.size()); ++i)
        if (list[static_cast<std::size_t>(i)].is_number())
            values.data()[i] = list[static_cast<std::size_t>(i)].template get<typename Vector::Scalar>();
}

std::uint32_t little_endian(std::span<const std::byte> bytes, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
}

/// KHR_texture_transform, in glTF's coordinates (v down): translation * rotation * scale. Positive angles turn the
/// coordinates counter-clockwise as one sees them on the picture; the matrix in the extension's listing turns the other
/// way, which is a known mistake there (KhronosGroup/glTF issue 1563) and not what viewers do.
struct UvTransform {
    Eigen::Vector2d offset = Eigen::Vector2d::Zero(), scale = Eigen::Vector2d::Ones();
    double rotation = 0;
    [[nodiscard]] Eigen::Vector2f operator()(float u, float v) const {
        const double c = std::cos(rotation), s = std::sin(rotation), x = scale.x() * u, y = scale.y() * v;
        return Eigen::Vector2d(offset.x() + c * x + s * y, offset.y() - s * x + c * y).cast<float>();
    }
};

struct MaterialUv {
    std::int64_t set = 0;
    UvTransform transform;
};

class GltfParser {
public:
    explicit GltfParser(ParseContext& context) : context_(context), data_(context.name()) {}

    ModelParts parse() {
        parts_.format = "glTF";
        parts_.mm_per_file_unit = 1000;
        read_document();
        check_extensions();
        read_buffers();
        read_accessors();
        for (std::size_t m = 0; m < array(root_, "materials").size(); ++m)
            read_material(item("materials", static_cast<std::int64_t>(m)));
        default_material_ = static_cast<std::uint32_t>(parts_.materials.size());
        parts_.materials.emplace_back().name = "(none)";
        material_uv_.emplace_back();
        read_scene();
        report();
        return std::move(parts_);
    }

private:
    [[noreturn]] void fail(const std::string& what) const { data_.fail(what); }
    void warn(std::string warning) { parts_.warnings.push_back(std::move(warning)); }

    const Json& item(const char* key, std::int64_t index) const {
        const Json& list = array(root_, key);
        if (index < 0 || static_cast<std::uint64_t>(index) >= list.size())
            fail(fmt::format("item {} of '{}' is used, but there are {}", index, key, list.size()));
        const Json& found = list[static_cast<std::size_t>(index)];
        if (!found.is_object()) fail(fmt::format("item {} of '{}' is no object", index, key));
        return found;
    }

    void read_document() {
        std::span<const std::byte> bytes = context_.bytes(), json = bytes;
        if (bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0) {
            if (bytes.size() < 20) fail("its header is cut short");
            if (little_endian(bytes, 4) != 2)
                fail(fmt::format("it is of version {}, only 2 can be read", little_endian(bytes, 4)));
            const std::size_t declared = little_endian(bytes, 8);
            if (declared > bytes.size())
                fail(fmt::format("it declares {} bytes and has {}: it is cut short", declared, bytes.size()));
            bytes = bytes.first(declared);
            std::size_t at = 12;
            for (int chunk = 0; at + 8 <= bytes.size(); ++chunk) {
                const std::size_t size = little_endian(bytes, at), type = little_endian(bytes, at + 4);
                if (size > bytes.size() - at - 8) fail("a chunk reaches beyond its end");
                if (chunk == 0) json = bytes.subspan(at + 8, size);
                if (chunk == 1 && type == 0x004E4942) binary_ = bytes.subspan(at + 8, size);  // "BIN"
                at += 8 + size;
            }
        }
        const auto* begin = reinterpret_cast<const char*>(json.data());
        try {
            root_ = Json::parse(begin, begin + json.size());
        } catch (const Json::exception& error) {
            fail(fmt::format("its JSON cannot be read ({})", error.what()));
        }
        const std::string version = root_.is_object() ? text(object(root_, "asset"), "version") : "";
        if (!version.starts_with("2."))
            fail(fmt::format("it says that it is of version '{}', only 2.0 can be read", version));
    }

    void check_extensions() const {
        for (const Json& extension : array(root_, "extensionsRequired")) {
            const std::string name = extension.is_string() ? extension.get<std::string>() : "";
            if (name.starts_with("KHR_materials_") || name == "KHR_texture_transform" ||
                name == "KHR_mesh_quantization" || name == "KHR_lights_punctual" || name == "EXT_texture_webp" ||
                name == "KHR_texture_basisu" || name.starts_with("KHR_animation"))
                continue;
            throw InputError(fmt::format(
                "{} cannot be read without the extension {}, which is not known here; export it without (for Draco or "
                "meshopt: without mesh compression)",
                context_.name(), name));
        }
    }

    std::optional<std::vector<std::byte>> data_uri(const std::string& uri) const {
        if (!uri.starts_with("data:")) return std::nullopt;
        const std::size_t comma = uri.find(',');
        if (comma == std::string::npos || uri.rfind(";base64", comma) == std::string::npos)
            fail("a data URI is not in base64");
        return base64_bytes(std::string_view(uri).substr(comma + 1));
    }

    void read_buffers() {
        for (std::size_t b = 0; b < array(root_, "buffers").size(); ++b) {
            const Json& buffer = item("buffers", static_cast<std::int64_t>(b));
            const std::int64_t length = integer(buffer, "byteLength", 0);
            const std::string uri = text(buffer, "uri");
            std::vector<std::byte> bytes;
            if (uri.empty()) {
                if (b != 0 || !binary_) fail(fmt::format("buffer {} has neither a file nor a binary chunk", b));
                bytes.assign(binary_->begin(), binary_->end());
            } else if (auto inside = data_uri(uri)) {
                bytes = std::move(*inside);
            } else {
                auto beside = context_.read_side_file(decode_uri(uri));
                if (!beside)
                    throw InputError(fmt::format(
                        "the file '{}', which holds the geometry of {}, was not found beside it; put it there", uri,
                        context_.name()));
                bytes = std::move(*beside);
            }
            if (length < 0 || static_cast<std::uint64_t>(length) > bytes.size())
                fail(fmt::format("buffer {} declares {} bytes and has {}: it is cut short", b, length, bytes.size()));
            data_.buffers.push_back(std::move(bytes));
        }
    }

    void read_accessors() {
        for (const Json& v : array(root_, "bufferViews"))
            data_.views.push_back({integer(v, "buffer", -1), integer(v, "byteOffset", 0), integer(v, "byteLength", -1),
                                   integer(v, "byteStride", 0)});
        for (const Json& a : array(root_, "accessors")) {
            GltfAccessor accessor{integer(a, "bufferView", -1),
                                  integer(a, "byteOffset", 0),
                                  integer(a, "count", -1),
                                  integer(a, "componentType", 0),
                                  0,
                                  false,
                                  {}};
            const std::string type = text(a, "type");
            accessor.components = type == "SCALAR" ? 1
                                  : type == "VEC2" ? 2
                                  : type == "VEC3" ? 3
                                  : type == "VEC4" ? 4
                                                   : 0;
            const auto normalised = a.find("normalized");
            accessor.normalised = normalised != a.end() && normalised->is_boolean() && normalised->get<bool>();
            if (const Json& sparse = object(a, "sparse"); !sparse.empty()) {
                const Json &where = object(sparse, "indices"), &what = object(sparse, "values");
                accessor.sparse = {integer(sparse, "count", -1),    integer(where, "bufferView", -1),
                                   integer(where, "byteOffset", 0), integer(where, "componentType", 0),
                                   integer(what, "bufferView", -1), integer(what, "byteOffset", 0)};
            }
            data_.accessors.push_back(accessor);
        }
    }

    std::int32_t read_image(std::int64_t index) {
        const Json& image = item("images", index);
        const std::string uri = text(image, "uri"), name = text(image, "name");
        DecodeOptions decode = context_.decode_options();
        decode.use_profile = false;  // section 3.9.2: colour space information in the picture is to be ignored
        const std::string key = name.empty() ? fmt::format("image {} of {}", index, context_.name())
                                             : fmt::format("image {} ({})", index, name);
        if (uri.empty())
            return context_.add_image_bytes(parts_, key, data_.view(integer(image, "bufferView", -1)), decode);
        if (const auto inside = data_uri(uri)) return context_.add_image_bytes(parts_, key, *inside, decode);
        return context_.add_image_file(parts_, decode_uri(uri), decode);
    }

    static Wrap wrap(std::int64_t code) {
        return code == 33071 ? Wrap::clamp : code == 33648 ? Wrap::mirror : Wrap::repeat;
    }

    void read_texture(const Json& info, PartMaterial& material, MaterialUv& uv) {
        const Json& texture = item("textures", integer(info, "index", -1));
        uv.set = integer(info, "texCoord", 0);
        if (const Json& transform = object(object(info, "extensions"), "KHR_texture_transform"); !transform.empty()) {
            uv.set = integer(transform, "texCoord", uv.set);
            numbers(transform, "offset", uv.transform.offset);
            numbers(transform, "scale", uv.transform.scale);
            uv.transform.rotation = real(transform, "rotation", 0);
        }
        if (const std::int64_t index = integer(texture, "sampler", -1); index != -1) {
            const Json& sampler = item("samplers", index);
            material.wrap_u = wrap(integer(sampler, "wrapS", 10497));
            material.wrap_v = wrap(integer(sampler, "wrapT", 10497));
            material.nearest = integer(sampler, "magFilter", 0) == 9728;
        }
        std::int64_t source = integer(texture, "source", -1);
        const Json& extensions = object(texture, "extensions");
        if (const Json& webp = object(extensions, "EXT_texture_webp"); !webp.empty())
            source = integer(webp, "source", source);
        if (source == -1) {
            parts_.lose_texture(
                fmt::format("The texture of the material '{}' is in a form that cannot be read ({}): its colours are "
                            "LOST. Export it with PNG or JPEG textures.",
                            material.name, extensions.empty() ? "no image" : extensions.begin().key()));
            return;
        }
        material.image = read_image(source);
    }

    void read_material(const Json& json) {
        PartMaterial& material = parts_.materials.emplace_back();
        MaterialUv& uv = material_uv_.emplace_back();
        material.name = text(json, "name");
        material.opaque = text(json, "alphaMode", "OPAQUE") == "OPAQUE";
        const Json& old_workflow = object(object(json, "extensions"), "KHR_materials_pbrSpecularGlossiness");
        const bool old = !json.contains("pbrMetallicRoughness") && !old_workflow.empty();
        const Json& pbr = old ? old_workflow : object(json, "pbrMetallicRoughness");
        Eigen::Vector4f factor = Eigen::Vector4f::Ones();
        numbers(pbr, old ? "diffuseFactor" : "baseColorFactor", factor);
        if (!factor.allFinite()) factor.setOnes();
        factor = factor.cwiseMax(0).cwiseMin(1);
        material.rgb = factor.head<3>();
        material.alpha = factor.w();
        if (material.rgb != Eigen::Vector3f::Ones()) parts_.has_colour = true;
        if (const Json& info = object(pbr, old ? "diffuseTexture" : "baseColorTexture"); !info.empty()) {
            parts_.has_colour = true;
            read_texture(info, material, uv);
        }
    }

    void read_scene() {
        const Json& scenes = array(root_, "scenes");
        if (scenes.empty()) {  // nodes that are nobody's children
            std::set<std::int64_t> children;
            for (const Json& node : array(root_, "nodes"))
                if (node.is_object())
                    for (const Json& child : array(node, "children"))
                        if (child.is_number_integer()) children.insert(child.get<std::int64_t>());
            for (std::int64_t n = 0; n < static_cast<std::int64_t>(array(root_, "nodes").size()); ++n)
                if (!children.contains(n)) read_nodes(n);
            return;
        }
        for (const Json& node : array(item("scenes", integer(root_, "scene", 0)), "nodes"))
            read_nodes(node.is_number_integer() ? node.get<std::int64_t>() : absurd);
    }

    /// A tree of nodes, with a stack of our own: files may nest deeper than the program's.
    void read_nodes(std::int64_t root) {
        Eigen::Affine3d z_up = Eigen::Affine3d::Identity();
        z_up.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
        std::vector<std::pair<std::int64_t, Eigen::Affine3d>> open{{root, z_up}};
        while (!open.empty()) {
            const auto [index, parent] = open.back();
            open.pop_back();
            const Json& node = item("nodes", index);
            if (!visited_.insert(index).second) fail(fmt::format("node {} has two parents", index));
            const Eigen::Affine3d transform = parent * local_transform(node);
            if (const std::int64_t mesh = integer(node, "mesh", -1); mesh != -1) {
                if (node.contains("skin")) ++skinned_;
                if (object(node, "extensions").contains("EXT_mesh_gpu_instancing"))
                    warn(fmt::format(
                        "Node {} of {} stands for many copies (EXT_mesh_gpu_instancing); only one was read.", index,
                        context_.name()));
                const Json& primitives = array(item("meshes", mesh), "primitives");
                for (std::size_t p = 0; p < primitives.size(); ++p) read_primitive(primitives[p], mesh, p, transform);
            }
            const Json& children = array(node, "children");
            for (std::size_t c = children.size(); c-- > 0;)
                open.emplace_back(children[c].is_number_integer() ? children[c].get<std::int64_t>() : absurd,
                                  transform);
        }
    }

    static Eigen::Affine3d local_transform(const Json& node) {
        Eigen::Affine3d transform = Eigen::Affine3d::Identity();
        if (!array(node, "matrix").empty()) {
            Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
            numbers(node, "matrix", matrix);  // both column by column
            transform.matrix() = matrix;
            transform.matrix().row(3) << 0, 0, 0, 1;
            return transform;
        }
        Eigen::Vector3d translation = Eigen::Vector3d::Zero(), scale = Eigen::Vector3d::Ones();
        Eigen::Vector4d q(0, 0, 0, 1);
        numbers(node, "translation", translation);
        numbers(node, "rotation", q);
        numbers(node, "scale", scale);
        const Eigen::Quaterniond rotation =
            q.norm() > 0 ? Eigen::Quaterniond(q).normalized() : Eigen::Quaterniond::Identity();
        transform.linear() = rotation.toRotationMatrix() * scale.asDiagonal();
        transform.translation() = translation;
        return transform;
    }

    std::vector<std::array<std::uint32_t, 3>> triangles_of(const Json& primitive, std::size_t vertices) {
        const std::int64_t mode = integer(primitive, "mode", 4);
        std::vector<std::uint32_t> index;
        if (const std::int64_t accessor = integer(primitive, "indices", -1); accessor != -1) {
            index = data_.indices(accessor);
        } else {
            index.resize(vertices);
            for (std::size_t i = 0; i < vertices; ++i) index[i] = static_cast<std::uint32_t>(i);
        }
        for (const std::uint32_t i : index)
            if (i >= vertices) fail(fmt::format("a triangle uses vertex {}, but there are only {}", i, vertices));
        std::vector<std::array<std::uint32_t, 3>> triangles;
        if (mode == 4)
            for (std::size_t i = 0; i + 2 < index.size(); i += 3)
                triangles.push_back({index[i], index[i + 1], index[i + 2]});
        else if (mode == 5)
            for (std::size_t i = 0; i + 2 < index.size(); ++i)
                triangles.push_back({index[i], index[i + 1 + i % 2], index[i + 2 - i % 2]});
        else if (mode == 6)
            for (std::size_t i = 1; i + 1 < index.size(); ++i) triangles.push_back({index[i], index[i + 1], index[0]});
        else if (mode >= 0 && mode <= 3)
            points_and_lines_ += index.size();
        else
            fail(fmt::format("a primitive has the unknown mode {}", mode));
        return triangles;
    }

    void read_primitive(const Json& primitive, std::int64_t mesh, std::size_t number,
                        const Eigen::Affine3d& transform) {
        const std::string what = fmt::format("primitive {} of mesh {}", number, mesh);
        if (!primitive.is_object()) fail(fmt::format("{} is no object", what));
        if (!array(primitive, "targets").empty()) morph_targets_ = true;
        const Json& attributes = object(primitive, "attributes");
        const std::int64_t position = integer(attributes, "POSITION", -1);
        if (position == -1) return;
        if (object(primitive, "extensions").contains("KHR_draco_mesh_compression") &&
            !item("accessors", position).contains("bufferView"))
            throw InputError(fmt::format(
                "{} is compressed with Draco, which cannot be read here; export it without mesh compression",
                context_.name()));
        const std::vector<float> xyz = data_.floats(position, 3);
        const std::size_t vertices = xyz.size() / 3;
        if (parts_.positions.size() + vertices > std::numeric_limits<std::uint32_t>::max())
            fail("it has more than 2^32 vertices");

        const std::int64_t material_index = integer(primitive, "material", -1);
        if (material_index != -1) (void)item("materials", material_index);
        const std::uint32_t material =
            material_index == -1 ? default_material_ : static_cast<std::uint32_t>(material_index);
        const MaterialUv& lay = material_uv_[material];
        std::vector<float> uv, rgba;
        std::size_t channels = 4;
        if (parts_.materials[material].image >= 0) {
            const std::int64_t accessor = integer(attributes, fmt::format("TEXCOORD_{}", lay.set).c_str(), -1);
            if (accessor != -1)
                uv = data_.floats(accessor, 2);
            else
                parts_.lose_colour(
                    fmt::format("In {}, {} has a texture but no coordinates TEXCOORD_{}: its corner (0, 0) was taken "
                                "everywhere, colours are LOST.",
                                context_.name(), what, lay.set));
        }
        if (const std::int64_t accessor = integer(attributes, "COLOR_0", -1); accessor != -1) {
            channels = data_.components(accessor) == 3 ? 3 : 4;
            rgba = data_.floats(accessor, channels);
            parts_.has_colour = true;
        }
        if ((!uv.empty() && uv.size() / 2 < vertices) || (!rgba.empty() && rgba.size() / channels < vertices))
            fail(fmt::format("{} has fewer texture coordinates or colours than vertices", what));

        const auto first = static_cast<std::uint32_t>(parts_.positions.size());
        for (std::size_t v = 0; v < vertices; ++v)
            parts_.positions.push_back(transform * Eigen::Vector3d(xyz[3 * v], xyz[3 * v + 1], xyz[3 * v + 2]));
        const bool mirrored = transform.linear().determinant() < 0;
        for (std::array<std::uint32_t, 3> corners : triangles_of(primitive, vertices)) {
            if (mirrored) std::swap(corners[1], corners[2]);
            const std::size_t t =
                parts_.add_triangle({first + corners[0], first + corners[1], first + corners[2]}, material);
            if (!uv.empty()) {
                std::array<Eigen::Vector2f, 3> here;
                for (int c = 0; c < 3; ++c) {
                    const Eigen::Vector2f laid = lay.transform(uv[2 * corners[c]], uv[2 * corners[c] + 1]);
                    here[c] = {laid.x(), 1 - laid.y()};
                }
                parts_.set_uv(t, here);
            }
            if (!rgba.empty()) {
                std::array<Eigen::Vector4f, 3> here;
                for (int c = 0; c < 3; ++c) {
                    const float* colour = rgba.data() + channels * corners[c];
                    here[c] = {colour[0], colour[1], colour[2], channels == 4 ? colour[3] : 1.0f};
                }
                parts_.set_rgba(t, here);
            }
        }
    }

    void report() {
        if (points_and_lines_)
            warn(fmt::format("{} has points or lines ({} vertices); they have no volume and are left aside.",
                             context_.name(), points_and_lines_));
        if (skinned_)
            warn(fmt::format("{} has {} meshes with a skeleton; they are taken in the pose in which they are stored.",
                             context_.name(), skinned_));
        if (!array(root_, "animations").empty())
            warn(fmt::format("{} has {} animations; they are left aside.", context_.name(),
                             array(root_, "animations").size()));
        if (morph_targets_)
            warn(fmt::format("{} has morph targets; the shape without them is taken.", context_.name()));
        for (const std::string& warning : context_.side_file_warnings()) warn(warning);
    }

    ParseContext& context_;
    GltfData data_;
    Json root_;
    std::optional<std::span<const std::byte>> binary_;
    ModelParts parts_;
    std::vector<MaterialUv> material_uv_;
    std::uint32_t default_material_ = 0;
    std::set<std::int64_t> visited_;
    std::size_t points_and_lines_ = 0, skinned_ = 0;
    bool morph_targets_ = false;
};

}  // namespace

ModelParts parse_gltf(ParseContext& context) { return GltfParser(context).parse(); }

}  // namespace voxtone::io
