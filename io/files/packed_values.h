// SPDX-License-Identifier: GPL-3.0-or-later
//
// Values to bytes and back, for what crosses the wall between the process that reads files and the one that prints.
// The bytes are those of this machine and this build.
//
// A type is packed by a function `describe(stream, value)` beside it that calls `stream(field, field...)`; numbers,
// enums, strings, vectors of any of these and of plain structs need none. Unpacking believes nothing but the types: it
// throws InputError when the bytes are cut short, and takes no more than some ten times their size of memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "base/error.h"

namespace voxtone::io {

class PackedWriter {
public:
    /// Takes the next bytes.
    using Take = std::function<void(const void* from, std::size_t size)>;

    PackedWriter() = default;
    /// To somewhere else than `bytes`.
    explicit PackedWriter(Take take) : take_(std::move(take)) {}
    /// As they are, without their number.
    void add(std::span<const std::byte> as_they_are) { raw(as_they_are.data(), as_they_are.size()); }
    template <class... Values>
    void operator()(const Values&... values) {
        (put(values), ...);
    }
    std::vector<std::byte> bytes;

private:
    template <class Value>
    static constexpr bool is_plain = std::is_arithmetic_v<Value> || std::is_enum_v<Value>;

    void raw(const void* data, std::size_t size) {
        if (take_) return take_(data, size);
        const std::size_t at = bytes.size();
        bytes.resize(at + size);
        if (size) std::memcpy(bytes.data() + at, data, size);
    }
    template <class Value>
    void put(const Value& value) requires(is_plain<Value>) {
        raw(&value, sizeof value);
    }
    void put(const Eigen::Vector3f& value) { raw(value.data(), sizeof value); }
    template <class Value, std::size_t n>
    void put(const std::array<Value, n>& values) requires(is_plain<Value>) {
        raw(values.data(), sizeof values);
    }
    void put(const std::string& text) {
        put(std::uint64_t{text.size()});
        raw(text.data(), text.size());
    }
    template <class Value>
    void put(const std::vector<Value>& values) {
        put(std::uint64_t{values.size()});
        if constexpr (requires(PackedWriter & w) { describe(w, values.front()); } ||
                      std::is_same_v<Value, std::string>) {
            for (const Value& value : values) put(value);
        } else {
            raw(values.data(), values.size() * sizeof(Value));
        }
    }
    template <class Value>
    void put(const Value& value) requires requires(PackedWriter& w) {
        describe(w, value);
    }
    { describe(*this, value); }

    Take take_;
};

/// A value on its way out, which it keeps until it is written, once.
using Packing = std::function<void(PackedWriter& to)>;
template <class Value>
[[nodiscard]] Packing packing(Value value) {
    return [value = std::make_shared<const Value>(std::move(value))](PackedWriter& to) { to(*value); };
}
/// What is packed already.
[[nodiscard]] inline Packing packing_of(std::vector<std::byte> bytes) {
    return [bytes = std::move(bytes)](PackedWriter& to) { to.add(bytes); };
}

/// How many bytes PackedWriter makes of values.
class PackedSize {
public:
    template <class... Values>
    void operator()(const Values&... values) {
        (add(values), ...);
    }
    std::size_t bytes = 0;

private:
    template <class Value>
    void add(const Value& value) requires(std::is_arithmetic_v<Value> || std::is_enum_v<Value>) {
        bytes += sizeof value;
    }
    void add(const Eigen::Vector3f& value) { bytes += sizeof value; }
    template <class Value, std::size_t n>
    void add(const std::array<Value, n>& values) requires(std::is_arithmetic_v<Value>) {
        bytes += sizeof values;
    }
    void add(const std::string& text) { bytes += sizeof(std::uint64_t) + text.size(); }
    template <class Value>
    void add(const std::vector<Value>& values) {
        bytes += sizeof(std::uint64_t);
        if constexpr (requires(PackedSize & s) { describe(s, values.front()); } || std::is_same_v<Value, std::string>) {
            for (const Value& value : values) add(value);
        } else {
            bytes += values.size() * sizeof(Value);
        }
    }
    template <class Value>
    void add(const Value& value) requires requires(PackedSize& s) {
        describe(s, value);
    }
    { describe(*this, value); }
};

class PackedReader {
public:
    /// The next bytes, so many; called for each of them once.
    using Fetch = std::function<void(void* to, std::size_t size)>;

    explicit PackedReader(std::span<const std::byte> bytes) : bytes_(bytes), left_(bytes.size()) {}
    /// Of bytes that are not all in memory.
    PackedReader(std::uint64_t size, Fetch fetch) : left_(size), fetch_(std::move(fetch)) {}
    void expect_end() const {
        if (left_ > 0) throw InputError("what the reader left has bytes behind its end");
    }
    template <class... Values>
    void operator()(Values&... values) {
        (get(values), ...);
    }

private:
    template <class Value>
    static constexpr bool is_plain = std::is_arithmetic_v<Value> || std::is_enum_v<Value>;

    static constexpr std::size_t least_bytes = 8;  ///< of a packed string or described struct: a count, a number

    void raw(void* data, std::size_t size) {
        if (size > left_) throw InputError("what the reader left is cut short");
        left_ -= size;
        if (fetch_) {
            if (size) fetch_(data, size);
            return;
        }
        if (size) std::memcpy(data, bytes_.data(), size);
        bytes_ = bytes_.subspan(size);
    }
    /// A count of things of at least `size` bytes each.
    std::size_t count(std::size_t size) {
        std::uint64_t n = 0;
        get(n);
        if (n > left_ / size) throw InputError("what the reader left is cut short");
        return static_cast<std::size_t>(n);
    }
    template <class Value>
    void get(Value& value) requires(is_plain<Value>) {
        raw(&value, sizeof value);
    }
    void get(bool& value) {
        std::uint8_t byte = 0;  // a bool may hold nothing but 0 and 1
        get(byte);
        value = byte != 0;
    }
    void get(Eigen::Vector3f& value) { raw(value.data(), sizeof value); }
    template <class Value, std::size_t n>
    void get(std::array<Value, n>& values) requires(is_plain<Value>) {
        raw(values.data(), sizeof values);
    }
    void get(std::string& text) {
        text.resize(count(1));
        raw(text.data(), text.size());
    }
    template <class Value>
    void get(std::vector<Value>& values) {
        if constexpr (requires(PackedReader & r) { describe(r, values.front()); } ||
                      std::is_same_v<Value, std::string>) {
            values.resize(count(least_bytes));
            for (Value& value : values) get(value);
        } else {
            const std::size_t n = count(sizeof(Value));
            values.reserve(n);
            // Memory is taken with what fills it: a picture is not held twice, as bytes that are to come and as zeros.
            constexpr std::size_t piece = (std::size_t{16} << 20) / sizeof(Value);
            for (std::size_t at = 0; at < n; at = values.size()) {
                values.resize(std::min(n, at + piece));
                raw(values.data() + at, (values.size() - at) * sizeof(Value));
            }
        }
    }
    template <class Value>
    void get(Value& value) requires requires(PackedReader& r) {
        describe(r, value);
    }
    { describe(*this, value); }

    std::span<const std::byte> bytes_;
    std::uint64_t left_;
    Fetch fetch_;
};

template <class Value>
[[nodiscard]] std::vector<std::byte> packed(const Value& value) {
    PackedSize size;
    size(value);
    PackedWriter writer;
    writer.bytes.reserve(size.bytes);  // pictures are large: growing would hold one twice
    writer(value);
    return std::move(writer.bytes);
}

/// Throws InputError when the bytes are not those of such a value, as far as that can be told.
template <class Value>
[[nodiscard]] Value unpacked(PackedReader& reader) {
    Value value;
    reader(value);
    reader.expect_end();
    return value;
}
template <class Value>
[[nodiscard]] Value unpacked(std::span<const std::byte> bytes) {
    PackedReader reader(bytes);
    return unpacked<Value>(reader);
}

}  // namespace voxtone::io
