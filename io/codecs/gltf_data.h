// SPDX-License-Identifier: GPL-3.0-or-later
//
// The binary side of a glTF 2.0 file: buffers, views and accessors as plain values, and the reading of accessors, in
// which nothing that the file declares is believed. Every member throws InputError naming the file. Based on: Khronos
// Group, "glTF 2.0 Specification", version 2.0.1, 2021, sections 3.6 and 5.1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace voxtone::io {

struct GltfView {
    std::int64_t buffer = -1, offset = 0, length = -1, stride = 0;  ///< stride 0: packed
};

struct GltfSparse {
    std::int64_t count = 0;  ///< 0: not sparse
    std::int64_t index_view = -1, index_offset = 0, index_type = 0, value_view = -1, value_offset = 0;
};

struct GltfAccessor {
    std::int64_t view = -1, offset = 0, count = -1, component_type = 0;  ///< view -1: zeros
    std::size_t components = 0;                                          ///< 0: of an unknown type
    bool normalised = false;
    GltfSparse sparse;
};

class GltfData {
public:
    explicit GltfData(std::string name) : name_(std::move(name)) {}

    std::vector<std::vector<std::byte>> buffers;
    std::vector<GltfView> views;
    std::vector<GltfAccessor> accessors;

    /// All elements as floats, `components` each; normalised integers in [0, 1] or [-1, 1].
    [[nodiscard]] std::vector<float> floats(std::int64_t accessor, std::size_t components) const;
    /// The same of shares: integers are taken to be normalised, whether the file says so or not.
    [[nodiscard]] std::vector<float> shares(std::int64_t accessor, std::size_t components) const;
    /// An accessor of unsigned scalars.
    [[nodiscard]] std::vector<std::uint32_t> indices(std::int64_t accessor) const;
    [[nodiscard]] std::size_t components(std::int64_t accessor) const { return accessor_at(accessor).components; }
    [[nodiscard]] bool holds_floats(std::int64_t accessor) const {
        return accessor_at(accessor).component_type == 5126;
    }
    [[nodiscard]] std::span<const std::byte> view(std::int64_t index) const;
    /// The same of one that is not in `views`; `what` is for messages.
    [[nodiscard]] std::span<const std::byte> bytes_of(const GltfView& view, const std::string& what) const;
    /// Adds packed values as a buffer, a view and an accessor of their own, which is returned.
    std::int64_t add_values(std::vector<std::byte> bytes, const GltfAccessor& accessor);

    [[noreturn]] void fail(const std::string& what) const;

private:
    [[nodiscard]] const GltfAccessor& accessor_at(std::int64_t index) const;
    [[nodiscard]] std::span<const std::byte> elements(std::int64_t view, std::int64_t offset, std::int64_t count,
                                                      std::size_t stride, std::size_t size) const;
    [[nodiscard]] std::vector<float> values(std::int64_t accessor, std::size_t components, bool as_shares) const;
    template <class Value, class Store>
    void scan(const GltfAccessor& accessor, const Store& store) const;

    std::string name_;
};

}  // namespace voxtone::io
