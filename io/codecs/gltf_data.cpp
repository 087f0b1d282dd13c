// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/gltf_data.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "base/error.h"

namespace voxtone::io {

namespace {

constexpr std::int64_t most_elements = std::int64_t{1} << 31;

std::size_t component_size(std::int64_t type) {
    switch (type) {
        case 5120:
        case 5121:
            return 1;
        case 5122:
        case 5123:
            return 2;
        case 5125:
        case 5126:
            return 4;
        default:
            return 0;
    }
}

}  // namespace

void GltfData::fail(const std::string& what) const {
    throw InputError(fmt::format("{} is no valid glTF file: {}; export it again", name_, what));
}

const GltfAccessor& GltfData::accessor_at(std::int64_t index) const {
    if (index < 0 || static_cast<std::uint64_t>(index) >= accessors.size())
        fail(fmt::format("accessor {} is used, but there are {}", index, accessors.size()));
    const GltfAccessor& accessor = accessors[static_cast<std::size_t>(index)];
    if (accessor.count < 0 || accessor.count > most_elements)
        fail(fmt::format("accessor {} declares {} elements", index, accessor.count));
    // A bomb declares many elements over few bytes: this check comes before any memory is taken.
    if (accessor.view != -1 && static_cast<std::uint64_t>(accessor.count) > view(accessor.view).size())
        fail(fmt::format("accessor {} declares {} elements, more than its buffer view has bytes", index,
                         accessor.count));
    return accessor;
}

std::span<const std::byte> GltfData::view(std::int64_t index) const {
    if (index < 0 || static_cast<std::uint64_t>(index) >= views.size())
        fail(fmt::format("buffer view {} is used, but there are {}", index, views.size()));
    return bytes_of(views[static_cast<std::size_t>(index)], fmt::format("buffer view {}", index));
}

std::span<const std::byte> GltfData::bytes_of(const GltfView& v, const std::string& what) const {
    if (v.buffer < 0 || static_cast<std::uint64_t>(v.buffer) >= buffers.size())
        fail(fmt::format("{} has no buffer", what));
    const std::vector<std::byte>& data = buffers[static_cast<std::size_t>(v.buffer)];
    if (v.offset < 0 || v.length < 0 || v.stride < 0 || v.stride > 65535 ||
        static_cast<std::uint64_t>(v.offset) > data.size() ||
        static_cast<std::uint64_t>(v.length) > data.size() - static_cast<std::uint64_t>(v.offset))
        fail(fmt::format("{} reaches beyond its buffer", what));
    return std::span(data).subspan(static_cast<std::size_t>(v.offset), static_cast<std::size_t>(v.length));
}

std::int64_t GltfData::add_values(std::vector<std::byte> bytes, const GltfAccessor& accessor) {
    views.push_back(
        {.buffer = static_cast<std::int64_t>(buffers.size()), .length = static_cast<std::int64_t>(bytes.size())});
    buffers.push_back(std::move(bytes));
    accessors.push_back(accessor);
    accessors.back().view = static_cast<std::int64_t>(views.size()) - 1;
    return static_cast<std::int64_t>(accessors.size()) - 1;
}

/// The bytes of `count` elements of `size` bytes each, `stride` apart.
std::span<const std::byte> GltfData::elements(std::int64_t index, std::int64_t offset, std::int64_t count,
                                              std::size_t stride, std::size_t size) const {
    const std::span<const std::byte> data = view(index);
    if (count == 0) return {};
    const auto first = static_cast<std::uint64_t>(offset), n = static_cast<std::uint64_t>(count);
    if (offset < 0 || count < 0 || first > data.size() || size > data.size() - first ||
        n - 1 > (data.size() - first - size) / stride)
        fail(fmt::format("an accessor declares {} elements, more than buffer view {} holds", count, index));
    return data.subspan(static_cast<std::size_t>(first));
}

/// Calls store(element, component, value) for every value, those of the sparse part last.
template <class Value, class Store>
void GltfData::scan(const GltfAccessor& a, const Store& store) const {
    const std::size_t size = a.components * sizeof(Value);
    const auto run = [&](std::span<const std::byte> data, std::size_t stride, std::int64_t count, const auto& element) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
            for (std::size_t c = 0; c < a.components; ++c) {
                Value value;
                std::memcpy(&value, data.data() + i * stride + c * sizeof(Value), sizeof(Value));
                store(element(i), c, value);
            }
    };
    if (a.view != -1) {
        (void)view(a.view);
        const std::int64_t declared = views[static_cast<std::size_t>(a.view)].stride;
        const std::size_t stride = declared > 0 ? static_cast<std::size_t>(declared) : size;
        run(elements(a.view, a.offset, a.count, stride, size), stride, a.count, [](std::size_t i) { return i; });
    }
    const GltfSparse& s = a.sparse;
    if (s.count == 0) return;
    const std::size_t index_size = component_size(s.index_type);
    if (s.count < 0 || s.count > a.count || index_size == 0 || s.index_type == 5126)
        fail("a sparse accessor is malformed");
    const auto index_data = elements(s.index_view, s.index_offset, s.count, index_size, index_size);
    run(elements(s.value_view, s.value_offset, s.count, size, size), size, s.count, [&](std::size_t i) {
        std::uint32_t index = 0;
        std::memcpy(&index, index_data.data() + i * index_size, index_size);  // little-endian, as this machine
        if (index >= static_cast<std::uint64_t>(a.count))
            fail("a sparse accessor replaces an element that does not exist");
        return static_cast<std::size_t>(index);
    });
}

std::vector<float> GltfData::floats(std::int64_t index, std::size_t wanted) const {
    return values(index, wanted, false);
}

std::vector<float> GltfData::shares(std::int64_t index, std::size_t wanted) const {
    return values(index, wanted, true);
}

std::vector<float> GltfData::values(std::int64_t index, std::size_t wanted, bool as_shares) const {
    const GltfAccessor& a = accessor_at(index);
    if (a.components != wanted)
        fail(fmt::format("accessor {} has {} components where {} are needed", index, a.components, wanted));
    std::vector<float> found(static_cast<std::size_t>(a.count) * wanted);
    const auto scaled = [&](float largest) {
        return [&found, wanted, largest, normalised = a.normalised || as_shares](std::size_t i, std::size_t c,
                                                                                 auto value) {
            const auto plain = static_cast<float>(value);
            found[i * wanted + c] = normalised ? std::max(plain / largest, -1.0f) : plain;
        };
    };
    switch (a.component_type) {
        case 5120:
            scan<std::int8_t>(a, scaled(127));
            break;
        case 5121:
            scan<std::uint8_t>(a, scaled(255));
            break;
        case 5122:
            scan<std::int16_t>(a, scaled(32767));
            break;
        case 5123:
            scan<std::uint16_t>(a, scaled(65535));
            break;
        case 5126:
            scan<float>(a, [&](std::size_t i, std::size_t c, float value) { found[i * wanted + c] = value; });
            break;
        default:
            fail(fmt::format("accessor {} has the component type {}, which is not for this", index, a.component_type));
    }
    return found;
}

std::vector<std::uint32_t> GltfData::indices(std::int64_t index) const {
    const GltfAccessor& a = accessor_at(index);
    if (a.components != 1) fail(fmt::format("accessor {} holds no indices", index));
    std::vector<std::uint32_t> values(static_cast<std::size_t>(a.count));
    const auto store = [&](std::size_t i, std::size_t, auto value) { values[i] = value; };
    switch (a.component_type) {
        case 5121:
            scan<std::uint8_t>(a, store);
            break;
        case 5123:
            scan<std::uint16_t>(a, store);
            break;
        case 5125:
            scan<std::uint32_t>(a, store);
            break;
        default:
            fail(fmt::format("accessor {} holds no indices", index));
    }
    return values;
}

}  // namespace voxtone::io
