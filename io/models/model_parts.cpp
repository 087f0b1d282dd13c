// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/models/model_parts.h"

#include <cstring>
#include <type_traits>

#include "voxtone/base/error.h"

namespace voxtone::io {

namespace {

class Writer {
public:
    template <class... Values>
    void operator()(const Values&... values) {
        (put(values), ...);
    }
    std::vector<std::byte> bytes;

private:
    template <class Value>
    static constexpr bool is_plain = std::is_arithmetic_v<Value> || std::is_enum_v<Value>;

    void raw(const void* data, std::size_t size) {
        const std::size_t at = bytes.size();
        bytes.resize(at + size);
        if (size) std::memcpy(bytes.data() + at, data, size);
    }
    template <class Value>
    void put(const Value& value) requires(is_plain<Value>) {
        raw(&value, sizeof value);
    }
    void put(const Eigen::Vector3f& value) { raw(value.data(), sizeof value); }
    void put(const std::string& text) {
        put(std::uint64_t{text.size()});
        raw(text.data(), text.size());
    }
    template <class Value>
    void put(const std::vector<Value>& values) {
        put(std::uint64_t{values.size()});
        if constexpr (requires(Writer & w) { describe(w, values.front()); } || std::is_same_v<Value, std::string>) {
            for (const Value& value : values) put(value);
        } else {
            raw(values.data(), values.size() * sizeof(Value));
        }
    }
    template <class Value>
    void put(const Value& value) requires requires(Writer& w) {
        describe(w, value);
    }
    { describe(*this, value); }
};

class Reader {
public:
    explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
    template <class... Values>
    void operator()(Values&... values) {
        (get(values), ...);
    }

private:
    template <class Value>
    static constexpr bool is_plain = std::is_arithmetic_v<Value> || std::is_enum_v<Value>;

    void raw(void* data, std::size_t size) {
        if (size > bytes_.size()) throw InputError("the parsed model arrived cut short");
        if (size) std::memcpy(data, bytes_.data(), size);
        bytes_ = bytes_.subspan(size);
    }
    /// A count of things of at least `size` bytes each.
    std::size_t count(std::size_t size) {
        std::uint64_t n = 0;
        get(n);
        if (n > bytes_.size() / size) throw InputError("the parsed model arrived cut short");
        return static_cast<std::size_t>(n);
    }
    template <class Value>
    void get(Value& value) requires(is_plain<Value>) {
        raw(&value, sizeof value);
    }
    void get(Eigen::Vector3f& value) { raw(value.data(), sizeof value); }
    void get(std::string& text) {
        text.resize(count(1));
        raw(text.data(), text.size());
    }
    template <class Value>
    void get(std::vector<Value>& values) {
        if constexpr (requires(Reader & r) { describe(r, values.front()); } || std::is_same_v<Value, std::string>) {
            values.resize(count(1));
            for (Value& value : values) get(value);
        } else {
            values.resize(count(sizeof(Value)));
            raw(values.data(), values.size() * sizeof(Value));
        }
    }
    template <class Value>
    void get(Value& value) requires requires(Reader& r) {
        describe(r, value);
    }
    { describe(*this, value); }

    std::span<const std::byte> bytes_;
};

}  // namespace

template <class Stream, class Material>
requires std::is_same_v<std::remove_const_t<Material>, PartMaterial>
void describe(Stream& stream, Material& m) {
    stream(m.name, m.rgb, m.alpha, m.opaque, m.under, m.image, m.wrap_u, m.wrap_v, m.nearest);
}

template <class Stream, class Image>
requires std::is_same_v<std::remove_const_t<Image>, DecodedImage>
void describe(Stream& stream, Image& i) {
    stream(i.texels.width_px, i.texels.height_px, i.texels.srgb8, i.texels.linear16, i.dpi_x, i.dpi_y, i.has_alpha,
           i.warnings);
}

template <class Stream, class Parts>
requires std::is_same_v<std::remove_const_t<Parts>, ModelParts>
void describe(Stream& stream, Parts& p) {
    stream(p.format, p.mm_per_file_unit, p.has_colour, p.positions, p.triangles, p.material_of_triangle, p.corner_uv,
           p.corner_rgba, p.materials, p.images, p.image_names, p.warnings);
}

std::vector<std::byte> pack(const ModelParts& parts) {
    Writer writer;
    describe(writer, parts);
    return std::move(writer.bytes);
}

ModelParts unpack_model(std::span<const std::byte> bytes) {
    ModelParts parts;
    Reader reader(bytes);
    describe(reader, parts);
    return parts;
}

std::vector<std::byte> pack(const DecodedImage& image) {
    Writer writer;
    describe(writer, image);
    return std::move(writer.bytes);
}

DecodedImage unpack_image(std::span<const std::byte> bytes) {
    DecodedImage image;
    Reader reader(bytes);
    describe(reader, image);
    return image;
}

}  // namespace voxtone::io
