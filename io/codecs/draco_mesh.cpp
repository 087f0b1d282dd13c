// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/draco_mesh.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>

#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#include <fmt/format.h>

#include "base/error.h"
#include "base/printable.h"

namespace voxtone::io {

namespace {

constexpr std::int64_t type_byte = 5120, type_ubyte = 5121, type_short = 5122, type_ushort = 5123, type_float = 5126;

draco::DecoderBuffer buffer_of(std::span<const std::byte> stream) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(stream.data()), stream.size());
    return buffer;
}

struct Declared {
    std::uint32_t faces = 0, points = 0;
};

/// What stands before the connectivity; nothing where the stream ends before or is no mesh: its decoder says why.
std::optional<Declared> declared_by(std::span<const std::byte> stream) {
    draco::DecoderBuffer buffer = buffer_of(stream);
    draco::DracoHeader header{};
    if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) return std::nullopt;
    if (header.encoder_type != draco::TRIANGULAR_MESH) return std::nullopt;
    const int version = DRACO_BITSTREAM_VERSION(header.version_major, header.version_minor);
    buffer.set_bitstream_version(static_cast<std::uint16_t>(version));
    if (header.flags & METADATA_FLAG_MASK) {
        draco::GeometryMetadata metadata;
        if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) return std::nullopt;
    }
    const auto number = [&](std::uint32_t& value, int packed_since) {
        return version < packed_since ? buffer.Decode(&value) : draco::DecodeVarint(&value, &buffer);
    };
    Declared declared;
    if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING) {
        constexpr int packed_since = DRACO_BITSTREAM_VERSION(2, 2);
        if (!number(declared.faces, packed_since) || !number(declared.points, packed_since)) return std::nullopt;
        return declared;
    }
    constexpr int packed_since = DRACO_BITSTREAM_VERSION(2, 0);
    std::uint8_t traversal = 0;
    std::uint32_t new_points = 0;
    if (!buffer.Decode(&traversal)) return std::nullopt;
    if (version < DRACO_BITSTREAM_VERSION(2, 2) && !number(new_points, packed_since)) return std::nullopt;
    if (!number(declared.points, packed_since) || !number(declared.faces, packed_since)) return std::nullopt;
    return declared;
}

void check_declared(std::span<const std::byte> stream, std::uint64_t most_bytes) {
    constexpr std::uint64_t bytes_each = 12;  // three indices, three coordinates
    const std::optional<Declared> declared = declared_by(stream);
    if (declared && (std::uint64_t{declared->faces} + declared->points) * bytes_each > most_bytes)
        throw InputError(
            fmt::format("it declares {} triangles and {} points, more than the {} bytes that may be unpacked hold",
                        declared->faces, declared->points, most_bytes));
}

/// Bytes of the value of each point; they must be of the attribute.
class PointValues {
public:
    explicit PointValues(const draco::PointAttribute& attribute)
        : attribute_(attribute), bytes_(std::size_t(draco::DataTypeLength(attribute.data_type())) * components()) {}

    [[nodiscard]] std::size_t components() const { return attribute_.num_components(); }
    [[nodiscard]] std::size_t bytes() const { return bytes_; }
    [[nodiscard]] const std::uint8_t* operator[](std::uint32_t point) const {
        const draco::PointIndex index(point);
        if (!attribute_.is_mapping_identity() && point >= attribute_.indices_map_size()) refuse();
        const auto value = attribute_.mapped_index(index).value();
        const auto at = attribute_.byte_offset() + std::int64_t{value} * attribute_.byte_stride();
        const draco::DataBuffer* const buffer = attribute_.buffer();
        if (!buffer || at < 0 || std::uint64_t(at) > buffer->data_size() ||
            buffer->data_size() - std::uint64_t(at) < bytes_)
            refuse();
        return buffer->data() + at;
    }

private:
    [[noreturn]] static void refuse() { throw InputError("a point has a value that is not there"); }

    const draco::PointAttribute& attribute_;
    std::size_t bytes_;
};

/// Of all points and components, as `convert` makes Out of In.
template <class In, class Out, class Convert>
std::vector<std::byte> converted(const PointValues& values, std::uint32_t points, const Convert& convert) {
    std::vector<std::byte> bytes(sizeof(Out) * values.components() * points);
    std::byte* to = bytes.data();
    for (std::uint32_t p = 0; p < points; ++p) {
        const std::uint8_t* from = values[p];
        for (std::size_t c = 0; c < values.components(); ++c, from += sizeof(In), to += sizeof(Out)) {
            In in;
            std::memcpy(&in, from, sizeof in);
            const Out out = convert(in, c);
            std::memcpy(to, &out, sizeof out);
        }
    }
    return bytes;
}

std::vector<std::byte> as_they_are(const PointValues& values, std::uint32_t points) {
    std::vector<std::byte> bytes(values.bytes() * points);
    for (std::uint32_t p = 0; p < points; ++p)
        std::memcpy(bytes.data() + p * values.bytes(), values[p], values.bytes());
    return bytes;
}

template <class Small, class In>
std::vector<std::byte> shortened(const PointValues& values, std::uint32_t points) {
    return converted<In, Small>(values, points, [](In in, std::size_t) {
        using Limits = std::numeric_limits<Small>;
        return static_cast<Small>(std::clamp<std::int64_t>(in, Limits::min(), Limits::max()));
    });
}

/// Integers of 32 bits are what the decoder makes of smaller ones.
template <class In>
DracoValues of_integers(const PointValues& values, std::uint32_t points, std::int64_t component_type) {
    switch (component_type) {
        case type_byte:
            return {component_type, values.components(), shortened<std::int8_t, In>(values, points)};
        case type_ubyte:
            return {component_type, values.components(), shortened<std::uint8_t, In>(values, points)};
        case type_short:
            return {component_type, values.components(), shortened<std::int16_t, In>(values, points)};
        case type_ushort:
            return {component_type, values.components(), shortened<std::uint16_t, In>(values, points)};
        default:
            return {type_float, values.components(),
                    converted<In, float>(values, points, [](In in, std::size_t) { return static_cast<float>(in); })};
    }
}

DracoValues values_of(const draco::PointAttribute& attribute, std::uint32_t points, std::int64_t component_type) {
    const PointValues values(attribute);
    const std::size_t components = values.components();
    switch (attribute.data_type()) {
        case draco::DT_INT8:
            return {type_byte, components, as_they_are(values, points)};
        case draco::DT_UINT8:
        case draco::DT_BOOL:
            return {type_ubyte, components, as_they_are(values, points)};
        case draco::DT_INT16:
            return {type_short, components, as_they_are(values, points)};
        case draco::DT_UINT16:
            return {type_ushort, components, as_they_are(values, points)};
        case draco::DT_INT32:
            return of_integers<std::int32_t>(values, points, component_type);
        case draco::DT_UINT32:
            return of_integers<std::uint32_t>(values, points, component_type);
        case draco::DT_FLOAT32:
            return {type_float, components, as_they_are(values, points)};
        case draco::DT_FLOAT64:
            return {type_float, components, converted<double, float>(values, points, [](double v, std::size_t) {
                        return static_cast<float>(v);
                    })};
        default:
            throw InputError(
                fmt::format("its values are of a type ({}) that is not read", static_cast<int>(attribute.data_type())));
    }
}

/// Positions from their steps; `quantum` is the largest of what was asked for.
DracoValues dequantised(const draco::PointAttribute& attribute, const draco::AttributeQuantizationTransform& transform,
                        std::uint32_t points, double& quantum) {
    const PointValues values(attribute);
    const auto steps = static_cast<float>((std::int64_t{1} << transform.quantization_bits()) - 1);
    const float step = transform.range() / steps;
    if (transform.min_values().size() < values.components()) throw InputError("its positions have no origin");
    quantum = std::max(quantum, static_cast<double>(step));
    return {type_float, values.components(),
            converted<std::int32_t, float>(values, points, [&](std::int32_t in, std::size_t c) {
                return static_cast<float>(in) * step + transform.min_value(static_cast<int>(c));
            })};
}

std::vector<std::uint32_t> corners_of(const draco::Mesh& mesh) {
    std::vector<std::uint32_t> corners;
    corners.reserve(std::size_t{3} * mesh.num_faces());
    for (std::uint32_t f = 0; f < mesh.num_faces(); ++f)
        for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(f))) {
            if (corner.value() >= mesh.num_points()) throw InputError("a triangle has a corner that is not there");
            corners.push_back(corner.value());
        }
    return corners;
}

std::unique_ptr<draco::Mesh> mesh_of(std::span<const std::byte> stream) {
    draco::DecoderBuffer buffer = buffer_of(stream);
    draco::Decoder decoder;
    decoder.SetSkipAttributeTransform(draco::GeometryAttribute::POSITION);  // its steps are wanted
    try {
        auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
        if (decoded.ok() && decoded.value()) return std::move(decoded).value();
        const std::string why = decoded.ok() ? "" : decoded.status().error_msg_string();
        throw InputError("it is damaged or cut short" + (why.empty() ? "" : fmt::format(" ({})", printable(why))));
    } catch (const std::length_error&) {
        throw InputError("it is damaged, and declares more than there can be");
    }
}

}  // namespace

DracoMesh decode_draco(std::span<const std::byte> stream, std::span<const DracoAttribute> attributes,
                       std::uint64_t most_bytes) {
    check_declared(stream, most_bytes);
    const std::unique_ptr<draco::Mesh> mesh = mesh_of(stream);
    DracoMesh found;
    found.points = mesh->num_points();
    found.corners = corners_of(*mesh);
    for (const DracoAttribute& asked : attributes) {
        const draco::PointAttribute* const attribute = mesh->GetAttributeByUniqueId(asked.id);
        if (!attribute) throw InputError(fmt::format("it has no attribute {}, which the file names", asked.id));
        draco::AttributeQuantizationTransform transform;
        const bool has_steps =
            attribute->attribute_type() == draco::GeometryAttribute::POSITION &&
            (attribute->data_type() == draco::DT_INT32 || attribute->data_type() == draco::DT_UINT32) &&
            transform.InitFromAttribute(*attribute);
        found.values.push_back(has_steps ? dequantised(*attribute, transform, mesh->num_points(), found.quantum)
                                         : values_of(*attribute, mesh->num_points(), asked.component_type));
    }
    return found;
}

}  // namespace voxtone::io
