// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/parse_gltf.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "base/counted.h"
#include "base/error.h"
#include "base/printable.h"
#include "base/warning.h"
#include "io/codecs/draco_mesh.h"
#include "io/codecs/gltf_data.h"
#include "io/codecs/meshopt_stream.h"
#include "io/models/colour_range.h"
#include "io/models/model_text.h"
#include "io/models/weld.h"
#include "optics/layered/translucency_alpha.h"

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

/// Of a buffer or a view that is compressed by meshoptimizer; empty: it is not.
const Json& meshopt_of(const Json& parent) {
    const Json& extensions = object(parent, "extensions");
    const Json& known = object(extensions, "EXT_meshopt_compression");
    return known.empty() ? object(extensions, "KHR_meshopt_compression") : known;
}

/// Of a primitive that is compressed with Draco.
const Json& draco_of(const Json& primitive) {
    return object(object(primitive, "extensions"), "KHR_draco_mesh_compression");
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

// glTF 2.0, 4.4.3: "JSON", and "BIN" with a zero.
constexpr std::uint32_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

/// Four bytes as they are to be read.
std::string chunk_name(std::span<const std::byte> bytes, std::size_t at) {
    return printable({reinterpret_cast<const char*>(bytes.data()) + at, 4});
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
    bool operator==(const MaterialUv& other) const {
        const UvTransform &a = transform, &b = other.transform;
        return set == other.set && a.offset == b.offset && a.scale == b.scale && a.rotation == b.rotation;
    }
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
        read_views();
        read_accessors();
        for (std::size_t m = 0; m < array(root_, "materials").size(); ++m)
            read_material(item("materials", static_cast<std::int64_t>(m)));
        default_material_ = static_cast<std::uint32_t>(parts_.materials.size());
        parts_.materials.emplace_back().name = "(none)";
        parts_.materials.back().opaque = true;  // section 3.9.6: alpha is not looked at
        material_uv_.emplace_back();
        cutoff_.push_back(-1);
        read_scene();
        if (!quanta_.empty()) {
            quanta_.resize(parts_.positions.size());
            close_cracks(parts_.positions, parts_.triangles, quanta_);
        }
        settle_float_colours();
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
                if (chunk == 0 && type != json_chunk)
                    fail(fmt::format("its first chunk is of the type '{}' and not JSON", chunk_name(bytes, at + 4)));
                if (chunk == 0) json = bytes.subspan(at + 8, size);
                if (chunk == 1 && type == binary_chunk) binary_ = bytes.subspan(at + 8, size);
                at += 8 + size;
            }
        }
        try {
            root_ = Json::parse(model_text(json));
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
                name == "KHR_texture_basisu" || name == "KHR_node_visibility" || name == "EXT_mesh_gpu_instancing" ||
                name == "KHR_draco_mesh_compression" || name == "EXT_meshopt_compression" ||
                name == "KHR_meshopt_compression" || name.starts_with("KHR_animation") || names_splats(name))
                continue;
            const bool compressed = name.find("compress") != std::string::npos;
            throw InputError(fmt::format("{} cannot be read without the extension {}, which is not known here; {}",
                                         context_.name(), printable(name),
                                         compressed ? "export it without mesh compression" : "export it without"));
        }
    }

    std::optional<std::vector<std::byte>> data_uri(const std::string& uri) const {
        auto data = data_of_uri(uri);
        if (!data && uri.starts_with("data:")) fail("a data URI has no data");
        return data;
    }

    void read_buffers() {
        for (std::size_t b = 0; b < array(root_, "buffers").size(); ++b) {
            const auto index = static_cast<std::int64_t>(b);
            data_.buffers.push_back(is_fallback(index) ? std::vector<std::byte>() : buffer_bytes(index));
        }
    }

    /// Holds, if anything, what is compressed elsewhere, for readers that cannot decompress it.
    bool is_fallback(std::int64_t index) const {
        const Json& packed = meshopt_of(item("buffers", index));
        const auto fallback = packed.find("fallback");
        return fallback != packed.end() && *fallback == true;
    }

    std::vector<std::byte> buffer_bytes(std::int64_t index) {
        const Json& buffer = item("buffers", index);
        const std::int64_t length = integer(buffer, "byteLength", 0);
        const std::string uri = text(buffer, "uri");
        std::vector<std::byte> bytes;
        if (uri.empty()) {
            if (index != 0 || !binary_) fail(fmt::format("buffer {} has neither a file nor a binary chunk", index));
            bytes.assign(binary_->begin(), binary_->end());
        } else if (auto inside = data_uri(uri)) {
            bytes = std::move(*inside);
        } else {
            auto beside = context_.read_side_file(file_of(uri));
            if (!beside)
                throw InputError(
                    fmt::format("the file '{}', which holds the geometry of {}, was not found beside it; put it there",
                                uri, context_.name()));
            bytes = std::move(*beside);
        }
        if (length < 0 || static_cast<std::uint64_t>(length) > bytes.size())
            fail(fmt::format("buffer {} declares {} bytes and has {}: it is cut short", index, length, bytes.size()));
        return bytes;
    }

    void read_views() {
        const Json& views = array(root_, "bufferViews");
        for (const Json& v : views) data_.views.push_back(view_of(v));
        for (std::size_t v = 0; v < views.size(); ++v) {
            if (const Json& packed = meshopt_of(views[v]); !packed.empty())
                unpack_view(v, packed);
            else
                load_fallback(data_.views[v].buffer);
        }
    }

    static GltfView view_of(const Json& v) {
        return {integer(v, "buffer", -1), integer(v, "byteOffset", 0), integer(v, "byteLength", -1),
                integer(v, "byteStride", 0)};
    }

    void load_fallback(std::int64_t buffer) {
        if (buffer < 0 || static_cast<std::uint64_t>(buffer) >= data_.buffers.size() || !is_fallback(buffer)) return;
        std::vector<std::byte>& bytes = data_.buffers[static_cast<std::size_t>(buffer)];
        if (bytes.empty()) bytes = buffer_bytes(buffer);
    }

    void unpack_view(std::size_t index, const Json& packed) {
        const std::string what = fmt::format("compressed buffer view {}", index);
        MeshoptStream stream{data_.bytes_of(view_of(packed), what), integer(packed, "count", absurd),
                             integer(packed, "byteStride", absurd), text(packed, "mode"),
                             text(packed, "filter", "NONE")};
        MeshoptResult result;
        try {
            result = decode_meshopt(stream, context_.options().max_unpacked_bytes - unpacked_bytes_);
        } catch (const InputError& error) {
            throw InputError(
                fmt::format("the {} of {} cannot be decoded: {}; export it again, or without mesh compression", what,
                            context_.name(), error.what()));
        }
        GltfView& view = data_.views[index];
        if (!result.newer.empty()) {
            if (has_fallback(view.buffer)) return load_fallback(view.buffer);
            throw InputError(
                fmt::format("{} is compressed by a newer meshoptimizer than is known here ({}); export it with "
                            "EXT_meshopt_compression, or without mesh compression",
                            context_.name(), result.newer));
        }
        unpacked_bytes_ += result.bytes.size();
        view.buffer = static_cast<std::int64_t>(data_.buffers.size());
        view.offset = 0;
        view.length = static_cast<std::int64_t>(result.bytes.size());
        data_.buffers.push_back(std::move(result.bytes));
    }

    bool has_fallback(std::int64_t buffer) const {
        if (buffer < 0 || static_cast<std::uint64_t>(buffer) >= data_.buffers.size()) return false;
        return !is_fallback(buffer) || !text(item("buffers", buffer), "uri").empty();
    }

    void read_accessors() {
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
                                  : type == "MAT4" ? 16
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
        return context_.add_image_file(parts_, file_of(uri), decode);
    }

    /// Some write the name as it is, with a % in it.
    std::string file_of(const std::string& uri) {
        const std::string decoded = decode_uri(uri);
        return context_.finds(decoded) || !context_.finds(uri) ? decoded : uri;
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
                            "LOST. Export it with PNG, JPEG or WebP textures.",
                            material.name, extensions.empty() ? "no image" : extensions.begin().key()));
            return;
        }
        material.image = read_image(source);
    }

    /// What share of light goes through: KHR_materials_transmission and KHR_materials_diffuse_transmission say it, and
    /// a volume how far. What is milky without one is a wall without a thickness, which says nothing of a body.
    void take_transmission(const Json& extensions, PartMaterial& material) {
        const auto share = [&](const char* extension, const char* factor) {
            return static_cast<float>(std::clamp(real(object(extensions, extension), factor, 0), 0.0, 1.0));
        };
        const float clear = share("KHR_materials_transmission", "transmissionFactor"),
                    milky = share("KHR_materials_diffuse_transmission", "diffuseTransmissionFactor");
        material.glass = clear > 0 || milky > 0;
        if (!material.glass) return;
        take_volume(extensions, material);
        material.through = material.alpha_of_lengths ? clear + (1 - clear) * milky : clear;
        const auto lose = [&](const char* extension, const char* texture) {
            if (context_.options().keep_alpha && object(extensions, extension).contains(texture))
                parts_.lose_texture(fmt::format(
                    "The material '{}' has a {} ({}), which is not read: what it says by place of light that goes "
                    "through is LOST, and its factor holds everywhere. Put it into the base colour's alpha.",
                    printable(material.name), texture, extension));
        };
        lose("KHR_materials_diffuse_transmission", "diffuseTransmissionTexture");
        lose("KHR_materials_scatter", "scatterStrengthTexture");
        lose("KHR_materials_scatter", "multiscatterColorTexture");
    }

    void read_material(const Json& json) {
        PartMaterial& material = parts_.materials.emplace_back();
        MaterialUv& uv = material_uv_.emplace_back();
        material.name = text(json, "name");
        if (material.name.empty()) material.name = fmt::format("number {}", parts_.materials.size() - 1);
        material.opaque = text(json, "alphaMode", "OPAQUE") == "OPAQUE";
        take_transmission(object(json, "extensions"), material);
        const Json& old_workflow = object(object(json, "extensions"), "KHR_materials_pbrSpecularGlossiness");
        // Where the other says nothing, or less than what must be understood, the older one is the material.
        const bool old = !old_workflow.empty() && !object(json, "pbrMetallicRoughness").contains("baseColorTexture") &&
                         !object(json, "pbrMetallicRoughness").contains("baseColorFactor");
        const Json& pbr = old ? old_workflow : object(json, "pbrMetallicRoughness");
        Eigen::Vector4f factor = Eigen::Vector4f::Ones();
        numbers(pbr, old ? "diffuseFactor" : "baseColorFactor", factor);
        if (!factor.allFinite()) factor.setOnes();
        factor = factor.cwiseMax(0).cwiseMin(1);
        material.rgb = factor.head<3>();
        material.alpha = factor.w();
        has_shades_ |= (material.rgb.array() > 0 && material.rgb.array() < 1).any();
        if (material.rgb != Eigen::Vector3f::Ones()) parts_.has_colour = true;
        if (const Json& info = object(pbr, old ? "diffuseTexture" : "baseColorTexture"); !info.empty()) {
            parts_.has_colour = true;
            read_texture(info, material, uv);
        }
        take_emission(json, material, uv);
        if (material.through > 0 && context_.options().keep_alpha) {
            parts_.has_colour = true;
            const Json& clear = object(object(json, "extensions"), "KHR_materials_transmission");
            read_transmission(object(clear, "transmissionTexture"), material, uv);
        }
        const bool masked = text(json, "alphaMode", "OPAQUE") == "MASK";
        cutoff_.push_back(masked ? static_cast<float>(real(json, "alphaCutoff", 0.5)) : -1);
        if (masked) cut(material, cutoff_.back());
    }

    /// A beam keeps `attenuationColor` on a way of `attenuationDistance` (KHR_materials_volume). What it loses is
    /// absorbed, or scattered where a draft says so (KHR_materials_volume_scatter, KHR_materials_scatter): the colour
    /// that deep scattering shows gives the albedo of one event (Kulla and Conty, "Revisiting physically based shading
    /// at Imageworks", 2017).
    static void take_volume(const Json& extensions, PartMaterial& material) {
        const Json& volume = object(extensions, "KHR_materials_volume");
        const double distance_m = real(volume, "attenuationDistance", 0);
        Eigen::Vector3f colour = Eigen::Vector3f::Ones();
        numbers(volume, "attenuationColor", colour);
        if (!(distance_m > 0) || !colour.allFinite()) return;
        constexpr float least = 1e-4f;  // black: no way is too short
        material.tint = colour.cwiseMax(0).cwiseMin(1);
        const Eigen::Array3d lost_per_cm =
            -material.tint.cwiseMax(least).array().log().cast<double>() / (100 * distance_m);
        const Json& scatter = object(extensions, "KHR_materials_scatter");
        const Json& older = object(extensions, "KHR_materials_volume_scatter");
        const Json& of = scatter.empty() ? older : scatter;
        const double strength = std::clamp(real(of, "scatterStrengthFactor", scatter.empty() ? 1 : 0), 0.0, 1.0);
        Eigen::Vector3f seen = Eigen::Vector3f::Constant(scatter.empty() ? 0 : 1);
        numbers(of, "multiscatterColor", seen);
        numbers(of, "multiscatterColorFactor", seen);
        if (!seen.allFinite()) seen.setZero();
        seen = seen.cwiseMax(0).cwiseMin(1);
        const double g = std::clamp(real(of, "scatterAnisotropy", 0), -0.99, 0.99);
        const Eigen::Array3d deep = strength * seen.array().cast<double>();
        const Eigen::Array3d s2 =
            (4.09712 + 4.20863 * deep - (9.59217 + 41.6808 * deep + 17.7126 * deep.square()).sqrt()).min(1).square();
        const Eigen::Array3d albedo = (deep > 0).select((1 - s2) / (1 - g * s2), 0);
        const double eta =
            optics::translucency_eta((lost_per_cm * (1 - albedo)).mean(), (lost_per_cm * albedo).mean() * (1 - g));
        if (seen.maxCoeff() > 0) material.tint += static_cast<float>(strength) * (seen - material.tint);
        material.within = static_cast<float>(optics::translucency_alpha(eta));
        material.alpha_of_lengths = true;
    }

    /// What of the surface lets light through, by place: one set of coordinates serves both pictures.
    void read_transmission(const Json& info, PartMaterial& material, MaterialUv& uv) {
        if (info.empty()) return;
        PartMaterial picture;
        MaterialUv lay;
        picture.name = material.name;
        read_texture(info, picture, lay);
        if (picture.image < 0) return;
        if (material.image < 0) {
            uv = lay;
            material.wrap_u = picture.wrap_u, material.wrap_v = picture.wrap_v, material.nearest = picture.nearest;
        } else if (!(uv == lay) || material.wrap_u != picture.wrap_u || material.wrap_v != picture.wrap_v) {
            parts_.lose_texture(
                fmt::format("The material '{}' lays its transmission otherwise than its colours, which cannot be read: "
                            "where light is to go through is LOST. Give both pictures the same coordinates.",
                            printable(material.name)));
            material.through = 0;
            return;
        }
        material.through_image = picture.image;
    }

    /// Glow is the colour of a material that has no other: unlit exporters put it there. Beside a base that is white by
    /// default a picture is, a colour is a glow. A glow beside a colour is none of the print's.
    void take_emission(const Json& json, PartMaterial& material, MaterialUv& uv) {
        const Json& info = object(json, "emissiveTexture");
        const bool black = material.rgb.maxCoeff() <= 0, absent = material.rgb.minCoeff() >= 1 && !info.empty();
        const bool is_all = material.image < 0 && (black || absent);
        Eigen::Vector3f glow = Eigen::Vector3f::Zero();
        numbers(json, "emissiveFactor", glow);
        // left out by mistake: it is 0 then
        if (is_all && !info.empty() && !json.contains("emissiveFactor")) glow.setOnes();
        if (!glow.allFinite() || glow.maxCoeff() <= 0) return;
        if (!is_all) return glowing_.push_back(printable(material.name));
        material.rgb = glow.cwiseMax(0).cwiseMin(1);
        if (!info.empty()) read_texture(info, material, uv);
        warn(named_warning(
            "which-colour",
            fmt::format(
                "The material '{}' of {} has no base colour or a black one; its emission was taken for its colour.",
                printable(material.name), context_.name())));
    }

    /// alphaMode MASK: opaque from the cutoff on, nothing below it.
    void cut(PartMaterial& material, float cutoff) {
        const float factor = std::exchange(material.alpha, 1.0f);
        if (material.image < 0) {
            material.alpha = factor >= cutoff ? 1.0f : 0.0f;
            return;
        }
        DecodedImage image = parts_.images[static_cast<std::size_t>(material.image)];
        image.has_alpha = false;
        for (std::size_t i = 0; i < image.texels.pixels(); ++i) {
            if (image.texels.alpha(i) * factor >= cutoff) {
                image.texels.set_opaque(i);
                continue;
            }
            image.has_alpha = true;
            if (image.texels.is_8_bit())
                image.texels.srgb8[4 * i + 3] = 0;
            else
                image.texels.linear16[4 * i + 3] = 0;
        }
        parts_.image_names.push_back(parts_.image_names[static_cast<std::size_t>(material.image)]);
        material.image = static_cast<std::int32_t>(parts_.images.size());
        parts_.images.push_back(std::move(image));
    }

    /// Where the nodes of a tree stand, for skins.
    void place_nodes(std::int64_t root) {
        std::vector<std::pair<std::int64_t, Eigen::Affine3d>> open{{root, z_up()}};
        while (!open.empty()) {
            const auto [index, parent] = open.back();
            open.pop_back();
            const Json& node = item("nodes", index);
            const Eigen::Affine3d here = parent * local_transform(node);
            if (!placed_.emplace(index, here).second) fail(fmt::format("node {} has two parents", index));
            for (const Json& child : array(node, "children"))
                open.emplace_back(child.is_number_integer() ? child.get<std::int64_t>() : absurd, here);
        }
    }

    static Eigen::Affine3d z_up() {
        Eigen::Affine3d turn = Eigen::Affine3d::Identity();
        turn.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
        return turn;
    }

    void read_scene() {
        for (const std::int64_t root : roots()) place_nodes(root);
        for (const std::int64_t root : nobodys_children())  // skins may hang on nodes that the scene has not
            if (!placed_.contains(root)) place_nodes(root);
        for (const std::int64_t root : roots()) read_nodes(root);
    }

    std::vector<std::int64_t> nobodys_children() const {
        std::vector<std::int64_t> found;
        std::set<std::int64_t> children;
        for (const Json& node : array(root_, "nodes"))
            if (node.is_object())
                for (const Json& child : array(node, "children"))
                    if (child.is_number_integer()) children.insert(child.get<std::int64_t>());
        for (std::int64_t n = 0; n < static_cast<std::int64_t>(array(root_, "nodes").size()); ++n)
            if (!children.contains(n)) found.push_back(n);
        return found;
    }

    std::vector<std::int64_t> roots() const {
        std::vector<std::int64_t> found;
        const Json& scenes = array(root_, "scenes");
        if (scenes.empty()) return nobodys_children();
        for (const Json& node : array(item("scenes", integer(root_, "scene", 0)), "nodes"))
            found.push_back(node.is_number_integer() ? node.get<std::int64_t>() : absurd);
        return found;
    }

    /// A tree of nodes, with a stack of our own: files may nest deeper than the program's.
    void read_nodes(std::int64_t root) {
        std::vector<std::int64_t> open{root};
        while (!open.empty()) {
            const std::int64_t index = open.back();
            open.pop_back();
            const Json& node = item("nodes", index);
            const Eigen::Affine3d transform = placed_.at(index);
            if (const Json& visibility = object(object(node, "extensions"), "KHR_node_visibility");
                visibility.contains("visible") && visibility.at("visible") == false) {
                ++hidden_;
                continue;
            }
            if (const std::int64_t mesh = integer(node, "mesh", -1); mesh != -1) {
                const Pose pose = pose_of(node, mesh);
                const Json& primitives = array(item("meshes", mesh), "primitives");
                for (const Eigen::Affine3d& copy : copies_of(node))
                    for (std::size_t p = 0; p < primitives.size(); ++p)
                        read_primitive(unpacked(primitives[p], mesh, p), mesh, p, transform * copy, pose);
            }
            const Json& children = array(node, "children");
            for (std::size_t c = children.size(); c-- > 0;)
                open.push_back(children[c].is_number_integer() ? children[c].get<std::int64_t>() : absurd);
        }
    }

    /// The pose of the file: what moves vertices before or instead of the node.
    struct Pose {
        std::vector<Eigen::Affine3d> joints;  ///< of the skin, inverse bind applied; empty: the node moves the mesh
        std::vector<float> morph;             ///< weights of targets
    };

    Pose pose_of(const Json& node, std::int64_t mesh) {
        Pose pose;
        const Json& weights =
            array(node, "weights").empty() ? array(item("meshes", mesh), "weights") : array(node, "weights");
        for (const Json& weight : weights) pose.morph.push_back(weight.is_number() ? weight.get<float>() : 0);
        const std::int64_t index = integer(node, "skin", -1);
        if (index == -1) return pose;
        const Json& skin = item("skins", index);
        const std::int64_t inverse = integer(skin, "inverseBindMatrices", -1);
        const std::vector<float> bind = inverse == -1 ? std::vector<float>{} : data_.floats(inverse, 16);
        const Json& joints = array(skin, "joints");
        for (std::size_t j = 0; j < joints.size(); ++j) {
            const std::int64_t joint = joints[j].is_number_integer() ? joints[j].get<std::int64_t>() : absurd;
            (void)item("nodes", joint);
            const auto placed = placed_.find(joint);
            Eigen::Affine3d moved = placed == placed_.end() ? z_up() : placed->second;
            if (16 * (j + 1) <= bind.size()) {
                Eigen::Affine3d undo = Eigen::Affine3d::Identity();
                undo.matrix() = Eigen::Map<const Eigen::Matrix4f>(bind.data() + 16 * j).cast<double>();
                undo.matrix().row(3) << 0, 0, 0, 1;
                moved = moved * undo;
            }
            pose.joints.push_back(moved);
        }
        ++skinned_;
        return pose;
    }

    /// EXT_mesh_gpu_instancing; one that stays where it is for all else.
    std::vector<Eigen::Affine3d> copies_of(const Json& node) {
        const Json& attributes = object(object(object(node, "extensions"), "EXT_mesh_gpu_instancing"), "attributes");
        std::vector<Eigen::Affine3d> copies;
        std::array<std::vector<float>, 3> values;
        std::size_t count = 0;
        const std::array<std::pair<const char*, std::size_t>, 3> kinds{
            {{"TRANSLATION", 3}, {"ROTATION", 4}, {"SCALE", 3}}};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int64_t accessor = integer(attributes, kinds[k].first, -1);
            if (accessor == -1) continue;
            values[k] = data_.floats(accessor, kinds[k].second);
            count = std::max(count, values[k].size() / kinds[k].second);
        }
        if (count == 0) return {Eigen::Affine3d::Identity()};
        for (std::size_t i = 0; i < count; ++i) {
            Eigen::Affine3d copy = Eigen::Affine3d::Identity();
            const auto vector = [&](std::size_t k, double otherwise) -> Eigen::Vector3d {
                if (3 * (i + 1) > values[k].size()) return Eigen::Vector3d::Constant(otherwise);
                return Eigen::Map<const Eigen::Vector3f>(values[k].data() + 3 * i).cast<double>();
            };
            Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
            if (4 * (i + 1) <= values[1].size()) {
                const Eigen::Vector4d q = Eigen::Map<const Eigen::Vector4f>(values[1].data() + 4 * i).cast<double>();
                if (q.norm() > 0) turn = Eigen::Quaterniond(q).normalized();
            }
            copy.linear() = turn.toRotationMatrix() * vector(2, 1).asDiagonal();
            copy.translation() = vector(0, 0);
            copies.push_back(copy);
        }
        return copies;
    }

    /// Where the vertices of a primitive stand.
    std::vector<Eigen::Vector3d> placed_vertices(const Json& primitive, const std::vector<float>& xyz,
                                                 const Eigen::Affine3d& transform, const Pose& pose) {
        std::vector<Eigen::Vector3d> places;
        for (std::size_t v = 0; 3 * v + 2 < xyz.size(); ++v)
            places.emplace_back(xyz[3 * v], xyz[3 * v + 1], xyz[3 * v + 2]);
        const Json& targets = array(primitive, "targets");
        for (std::size_t k = 0; k < std::min(targets.size(), pose.morph.size()); ++k) {
            const std::int64_t accessor = targets[k].is_object() ? integer(targets[k], "POSITION", -1) : -1;
            if (accessor == -1 || pose.morph[k] == 0) continue;
            const std::vector<float> by = data_.floats(accessor, 3);
            for (std::size_t v = 0; v < places.size() && 3 * v + 2 < by.size(); ++v)
                places[v] +=
                    static_cast<double>(pose.morph[k]) * Eigen::Vector3d(by[3 * v], by[3 * v + 1], by[3 * v + 2]);
        }
        const Json& attributes = object(primitive, "attributes");
        std::vector<Eigen::Vector3d> moved(places.size(), Eigen::Vector3d::Zero());
        std::vector<double> sum(places.size(), 0);
        for (int set = 0; !pose.joints.empty(); ++set) {
            const std::int64_t joints = integer(attributes, fmt::format("JOINTS_{}", set).c_str(), -1),
                               weights = integer(attributes, fmt::format("WEIGHTS_{}", set).c_str(), -1);
            if (joints == -1 || weights == -1) break;
            const std::vector<float> joint = data_.floats(joints, 4), weight = data_.floats(weights, 4);
            for (std::size_t i = 0; i < std::min({joint.size(), weight.size(), 4 * places.size()}); ++i) {
                if (!(weight[i] > 0)) continue;
                if (!(joint[i] >= 0 && joint[i] < static_cast<float>(pose.joints.size())))
                    fail(fmt::format("a vertex hangs on joint {}, but its skin has {}", joint[i], pose.joints.size()));
                moved[i / 4] +=
                    static_cast<double>(weight[i]) * (pose.joints[static_cast<std::size_t>(joint[i])] * places[i / 4]);
                sum[i / 4] += static_cast<double>(weight[i]);
            }
        }
        for (std::size_t v = 0; v < places.size(); ++v)
            places[v] = sum[v] > 0 ? Eigen::Vector3d(moved[v] / sum[v]) : transform * places[v];
        return places;
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

    /// A primitive whose values are in accessors, those that Draco compressed, too.
    struct UnpackedPrimitive {
        Json json;
        double quantum = 0;  ///< of its positions
    };

    /// Where the values that are compressed are there as well, uncompressed, these are taken.
    bool needs_draco(const Json& primitive) const {
        const Json& draco = draco_of(primitive);
        const auto lacks = [&](const Json& parent, const char* key) {
            const std::int64_t accessor = integer(parent, key, -1);
            return accessor != -1 && !item("accessors", accessor).contains("bufferView");
        };
        if (draco.empty()) return false;
        if (lacks(primitive, "indices")) return true;
        for (const auto& [name, id] : object(draco, "attributes").items())
            if (lacks(object(primitive, "attributes"), name.c_str())) return true;
        return false;
    }

    const Json& unpacked(const Json& primitive, std::int64_t mesh, std::size_t number) {
        if (!primitive.is_object() || !needs_draco(primitive)) return primitive;
        const auto [place, is_new] = unpacked_.try_emplace({mesh, number});
        if (is_new) place->second = unpack_draco(primitive, fmt::format("primitive {} of mesh {}", number, mesh));
        return place->second.json;
    }

    UnpackedPrimitive unpack_draco(const Json& primitive, const std::string& what) {
        const Json& draco = draco_of(primitive);
        const Json& declared = object(primitive, "attributes");
        std::vector<std::string> names;
        std::vector<DracoAttribute> wanted;
        for (const auto& [name, id] : object(draco, "attributes").items()) {
            if (!declared.contains(name) || name == "NORMAL" || name == "TANGENT") continue;
            const std::int64_t number = id.is_number_integer() ? id.get<std::int64_t>() : absurd;
            if (number < 0 || number > std::numeric_limits<std::uint32_t>::max())
                fail(fmt::format("{} names no attribute of its Draco stream for {}", what, printable(name)));
            names.push_back(name);
            wanted.push_back({static_cast<std::uint32_t>(number), accessor_of(declared, name).component_type});
        }
        const std::span<const std::byte> stream = data_.view(integer(draco, "bufferView", -1));
        DracoMesh found;
        try {
            found = decode_draco(stream, wanted, context_.options().max_unpacked_bytes - unpacked_bytes_);
        } catch (const InputError& error) {
            throw InputError(fmt::format(
                "the Draco stream of {} of {} cannot be decoded: {}; export it again, or without mesh compression",
                what, context_.name(), error.what()));
        }
        return lay_down(primitive, names, std::move(found));
    }

    const GltfAccessor& accessor_of(const Json& attributes, const std::string& name) const {
        const std::int64_t index = integer(attributes, name.c_str(), -1);
        (void)item("accessors", index);
        return data_.accessors[static_cast<std::size_t>(index)];
    }

    /// What was decoded as accessors, which the primitive names in place of its own.
    UnpackedPrimitive lay_down(const Json& primitive, const std::vector<std::string>& names, DracoMesh mesh) {
        UnpackedPrimitive unpacked{primitive, mesh.quantum};
        const auto add = [&](std::vector<std::byte> bytes, GltfAccessor accessor) {
            unpacked_bytes_ += std::min(bytes.size(), context_.options().max_unpacked_bytes - unpacked_bytes_);
            return data_.add_values(std::move(bytes), accessor);
        };
        for (std::size_t a = 0; a < names.size(); ++a) {
            DracoValues& values = mesh.values[a];
            const bool normalised = accessor_of(object(primitive, "attributes"), names[a]).normalised;
            unpacked.json["attributes"][names[a]] =
                add(std::move(values.bytes), {.count = static_cast<std::int64_t>(mesh.points),
                                              .component_type = values.component_type,
                                              .components = values.components,
                                              .normalised = normalised && values.component_type != 5126,
                                              .sparse = {}});
        }
        const auto corners = std::as_bytes(std::span(mesh.corners));
        unpacked.json["indices"] =
            add({corners.begin(), corners.end()}, {.count = static_cast<std::int64_t>(mesh.corners.size()),
                                                   .component_type = 5125,
                                                   .components = 1,
                                                   .sparse = {}});
        unpacked.json["mode"] = 4;  // strips come as triangles, too
        return unpacked;
    }

    /// Steps of positions in the scene, by which primitives that were rounded apart are joined again.
    void note_quantum(std::int64_t mesh, std::size_t number, std::size_t first, const Eigen::Affine3d& turned) {
        const auto found = unpacked_.find({mesh, number});
        if (found == unpacked_.end() || found->second.quantum <= 0) return;
        const double largest = turned.linear().colwise().norm().maxCoeff();
        quanta_.resize(first);
        quanta_.resize(parts_.positions.size(), {++pieces_, static_cast<float>(found->second.quantum * largest)});
    }

    void read_primitive(const Json& primitive, std::int64_t mesh, std::size_t number, const Eigen::Affine3d& transform,
                        const Pose& pose) {
        const std::string what = fmt::format("primitive {} of mesh {}", number, mesh);
        if (!primitive.is_object()) fail(fmt::format("{} is no object", what));
        const Json& attributes = object(primitive, "attributes");
        if (holds_splats(primitive)) {
            ++splats_;
            return;
        }
        const std::int64_t position = integer(attributes, "POSITION", -1);
        if (position == -1) return;
        const std::vector<float> xyz = data_.floats(position, 3);
        const std::size_t vertices = xyz.size() / 3;
        if (parts_.positions.size() + vertices > std::numeric_limits<std::uint32_t>::max())
            fail("it has more than 2^32 vertices");

        const std::int64_t material_index = integer(primitive, "material", -1);
        if (material_index != -1) (void)item("materials", material_index);
        std::uint32_t material = material_index == -1 ? default_material_ : static_cast<std::uint32_t>(material_index);
        if (material_index == -1) lose_variants(primitive, what);
        std::vector<float> uv;
        if (parts_.materials[material].image >= 0 || parts_.materials[material].through_image >= 0) {
            const std::int64_t set = material_uv_[material].set,
                               accessor = integer(attributes, fmt::format("TEXCOORD_{}", set).c_str(), -1);
            if (accessor != -1)
                uv = data_.floats(accessor, 2);
            else
                parts_.lose_colour(
                    fmt::format("In {}, {} has a texture but no coordinates TEXCOORD_{}, so that it cannot be laid on "
                                "the surface: its colours are LOST and the material's own colour is used.",
                                context_.name(), what, set));
            if (accessor == -1) material = without_picture(material);
        }
        report_other_colours(attributes, what, parts_.materials[material].image >= 0);
        if (!uv.empty() && uv.size() / 2 < vertices)
            fail(fmt::format("{} has fewer texture coordinates than vertices", what));
        const std::vector<std::array<std::uint32_t, 3>> triangles = triangles_of(primitive, vertices);
        const Colours colours = colours_of(attributes, what, vertices, triangles.size());

        const auto first = static_cast<std::uint32_t>(parts_.positions.size());
        for (const Eigen::Vector3d& place : placed_vertices(primitive, xyz, transform, pose))
            parts_.positions.push_back(place);
        const Eigen::Affine3d& turned = pose.joints.empty() ? transform : pose.joints.front();
        note_quantum(mesh, number, first, turned);
        const bool mirrored = turned.linear().determinant() < 0;
        const MaterialUv lay = material_uv_[material];
        const std::size_t first_triangle = parts_.triangles.size();
        for (std::array<std::uint32_t, 3> corners : triangles) {
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
            if (!colours.values.empty()) {
                std::array<Eigen::Vector4f, 3> here;
                for (int c = 0; c < 3; ++c) {
                    const std::size_t at = colours.of_faces ? t - first_triangle : corners[c];
                    const float* colour = colours.values.data() + colours.channels * at;
                    const float alpha = colours.channels == 4 && cutoff_[material] < 0 ? colour[3] : 1.0f;
                    here[c] = {colour[0], colour[1], colour[2], alpha};
                }
                parts_.set_rgba(t, here);
            }
        }
        if (colours.floats && !colours.values.empty())
            float_colours_.emplace_back(first_triangle, parts_.triangles.size());
    }

    /// COLOR_0 of a primitive.
    struct Colours {
        std::vector<float> values;  ///< empty: none
        std::size_t channels = 4;
        bool of_faces = false, floats = false;
    };

    Colours colours_of(const Json& attributes, const std::string& what, std::size_t vertices, std::size_t faces) {
        Colours colours;
        const std::int64_t accessor = integer(attributes, "COLOR_0", -1);
        if (accessor == -1) return colours;
        parts_.has_colour = has_vertex_colours_ = true;
        colours.channels = data_.components(accessor) == 3 ? 3 : 4;
        colours.values = data_.shares(accessor, colours.channels);
        colours.floats = data_.holds_floats(accessor);
        const std::size_t count = colours.values.size() / colours.channels;
        if (count == vertices) return colours;
        colours.of_faces = count == faces;
        if (colours.of_faces) {
            warn(
                named_warning("which-colour",
                              fmt::format("In {}, {} has {} colours for {} vertices, as many as faces, which glTF does "
                                          "not know (VTK writes it): they were taken as the faces'.",
                                          context_.name(), what, count, vertices)));
            return colours;
        }
        colours.values.clear();
        parts_.lose_colour(fmt::format(
            "In {}, {} has {} colours for {} vertices, so that nobody knows which is whose: they are LOST. Export it "
            "again.",
            context_.name(), what, count, vertices));
        return colours;
    }

    /// Floats go by the same rule as in other formats (io/models/colour_range.h), but are linear.
    void settle_float_colours() {
        double most = 0, most_alpha = 0;
        bool whole = true;
        const auto for_each_colour = [&](const auto& visit) {
            for (const auto& [first, last] : float_colours_)
                for (std::size_t t = first; t < last; ++t)
                    for (Eigen::Vector4f& rgba : parts_.corner_rgba[t]) visit(rgba);
        };
        for_each_colour([&](const Eigen::Vector4f& rgba) {
            if (!rgba.allFinite()) return;
            most = std::max(most, static_cast<double>(rgba.head<3>().maxCoeff()));
            most_alpha = std::max(most_alpha, static_cast<double>(rgba.w()));
            whole &= rgba.head<3>() == Eigen::Vector3f(rgba.head<3>().array().floor());
        });
        const double range = colour_range(most, ColourNumbers::reals, whole);
        if (range == 1) return;
        const double of_alpha = colour_range(most_alpha, ColourNumbers::reals) == 1 ? 1 : range;
        for_each_colour([&](Eigen::Vector4f& rgba) {
            rgba.head<3>() /= static_cast<float>(range);
            rgba.w() /= static_cast<float>(of_alpha);
        });
        warn(named_warning("colour-range",
                           fmt::format("The vertex colours of {} go up to {:g}: they were taken as of 0 to {:.0f}.",
                                       context_.name(), most, range)));
    }

    /// The same material for what has no coordinates to lay its picture by.
    std::uint32_t without_picture(std::uint32_t material) {
        const auto [known, is_new] =
            without_picture_.try_emplace(material, static_cast<std::uint32_t>(parts_.materials.size()));
        if (!is_new) return known->second;
        PartMaterial plain = parts_.materials[material];
        plain.image = -1;
        parts_.materials.push_back(std::move(plain));
        material_uv_.emplace_back();
        cutoff_.push_back(cutoff_[material]);
        return known->second;
    }

    /// Of a primitive without a material that has some in variants (KHR_materials_variants).
    void lose_variants(const Json& primitive, const std::string& what) {
        const Json& mappings = array(object(object(primitive, "extensions"), "KHR_materials_variants"), "mappings");
        if (mappings.empty()) return;
        std::vector<std::string> names;
        for (const Json& variant : array(object(object(root_, "extensions"), "KHR_materials_variants"), "variants"))
            if (variant.is_object()) names.push_back("'" + printable(text(variant, "name")) + "'");
        parts_.has_colour = true;
        parts_.lose_colour(
            fmt::format("In {}, {} has no material of its own but those of variants ({}), none of which is the one to "
                        "print: its colours are LOST. Choose one and export it as the material.",
                        context_.name(), what, fmt::join(names, ", ")));
    }

    static bool names_splats(std::string_view name) { return name.find("gaussian_splat") != name.npos; }

    static bool holds_splats(const Json& primitive) {
        for (const auto& [name, extension] : object(primitive, "extensions").items())
            if (names_splats(name)) return true;
        for (const auto& [name, accessor] : object(primitive, "attributes").items())
            if (lower_case(name).find("gaussian_splat") != std::string::npos) return true;
        // the names in drafts of KHR_gaussian_splatting, which points may have without it
        const Json& attributes = object(primitive, "attributes");
        return integer(primitive, "mode", 4) == 0 && attributes.contains("_ROTATION") && attributes.contains("_SCALE");
    }

    /// Colours that are none by the standard: COLOR_1, _COLOR and their like.
    void report_other_colours(const Json& attributes, const std::string& what, bool textured) {
        for (const auto& [name, accessor] : attributes.items()) {
            const bool further = name.starts_with("COLOR_") && name != "COLOR_0";
            if (!further && !(name.starts_with("_") && lower_case(name).find("col") != std::string::npos)) continue;
            if (textured || attributes.contains("COLOR_0"))
                others_.insert(printable(name));
            else
                parts_.lose_colour(fmt::format(
                    "In {}, {} has its colours by the name of {}, which has no standard, and no COLOR_0: they are "
                    "LOST. Make them the first colours (in Blender the active ones) and export it again.",
                    context_.name(), what, printable(name)));
        }
    }

    /// Programs that write colours in a way of their own, by the name that they leave.
    void report_generator() {
        const std::string generator = text(object(root_, "asset"), "generator");
        if (generator.starts_with("Khronos glTF Blender I/O v3.4.") && has_vertex_colours_)
            warn(named_warning(
                "which-colour",
                fmt::format("{} was written by Blender 3.4, which mixes up colours of face corners in glTF: look at "
                            "OUT/target.glb. If they are wrong, export OBJ or PLY, or convert the colour attribute to "
                            "the domain Vertex first.",
                            context_.name())));
        const bool by_vtk = generator.find("VTK") != generator.npos,
                   by_obj2gltf = generator.find("obj2gltf") != generator.npos;
        if ((by_vtk && (has_vertex_colours_ || has_shades_)) || (by_obj2gltf && has_shades_))
            warn(named_warning(
                "which-colour",
                fmt::format("{} was written by {}, which puts sRGB codes where glTF has linear light: its colours come "
                            "out paler than they were. Give the {}.",
                            context_.name(), by_vtk ? "VTK" : "obj2gltf",
                            by_vtk ? "model as PLY, where codes are meant" : "OBJ itself")));
    }

    void report() {
        report_generator();
        if (splats_ && !parts_.triangles.empty())
            warn(named_warning("no-volume",
                               fmt::format("{} has {}, which have no surface and are left aside.", context_.name(),
                                           counted(splats_, "set") + " of Gaussian splats")));
        if (!others_.empty())
            warn(named_warning(
                "which-colour",
                fmt::format("{} has further colours of vertices ({}); they have no standard and are left aside.",
                            context_.name(), fmt::join(others_, ", "))));
        if (!glowing_.empty())
            warn(named_warning(
                "which-colour",
                fmt::format("{} of {} ('{}'{}) glow{} besides having a base colour; that was taken, the emission is "
                            "left aside.",
                            counted(glowing_.size(), "material"), context_.name(), glowing_.front(),
                            glowing_.size() > 1 ? ", ..." : "", glowing_.size() > 1 ? "" : "s")));
        if (points_and_lines_)
            warn(named_warning(
                "no-volume",
                fmt::format("{} has points or lines ({} vertices); they have no volume and are left aside.",
                            context_.name(), points_and_lines_)));
        if (skinned_)
            warn(named_warning("left-out",
                               fmt::format("{} has {} meshes with a skeleton; they are taken in the pose of the file.",
                                           context_.name(), skinned_)));
        if (hidden_)
            warn(named_warning(
                "left-out",
                fmt::format("{} has {} hidden nodes (KHR_node_visibility); they and what hangs on them are left aside.",
                            context_.name(), hidden_)));
        if (!array(root_, "animations").empty())
            warn(named_warning("left-out", fmt::format("{} has {} animations; they are left aside.", context_.name(),
                                                       array(root_, "animations").size())));
        for (const std::string& warning : context_.side_file_warnings()) warn(warning);
        context_.expect_faces(
            parts_,
            {splats_ ? std::string(what_splats_are) : "",
             points_and_lines_ ? "points or lines, which have no volume: make a mesh of them in a mesh editor" : "",
             hidden_ ? "hidden nodes (KHR_node_visibility): show what is to be printed and export it again" : ""});
    }

    ParseContext& context_;
    GltfData data_;
    Json root_;
    std::optional<std::span<const std::byte>> binary_;
    ModelParts parts_;
    std::vector<MaterialUv> material_uv_;
    std::uint32_t default_material_ = 0;
    std::map<std::pair<std::int64_t, std::size_t>, UnpackedPrimitive> unpacked_;  ///< by mesh and number in it
    std::uint64_t unpacked_bytes_ = 0;                                            ///< of all that was compressed
    std::vector<Rounding> quanta_;  ///< of positions; empty: none is rounded
    std::uint32_t pieces_ = 0;
    std::vector<float> cutoff_;  ///< per material; negative: alpha is not cut
    std::map<std::int64_t, Eigen::Affine3d> placed_;
    std::vector<std::string> glowing_;  ///< materials that have a colour, too
    std::set<std::string> others_;      ///< attributes that are colours and were not read
    std::size_t points_and_lines_ = 0, skinned_ = 0, hidden_ = 0, splats_ = 0;
    std::map<std::uint32_t, std::uint32_t> without_picture_;          ///< materials by materials
    std::vector<std::pair<std::size_t, std::size_t>> float_colours_;  ///< triangles, from and up to
    bool has_vertex_colours_ = false, has_shades_ = false;  ///< colours that are no corner of the cube, in materials
};

}  // namespace

ModelParts parse_gltf(ParseContext& context) { return GltfParser(context).parse(); }

}  // namespace voxtone::io
