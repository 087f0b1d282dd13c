// SPDX-License-Identifier: GPL-3.0-or-later
//
// Plain values to bytes and back on one machine, from the process that parses a file to the one that prints. A struct
// takes part by a template `describe(stream, value)` beside it that hands all of its members to `stream`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

#include "voxtone/base/error.h"

namespace voxtone::io {

class PackedWriter {
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
};

/// Throws InputError where the bytes are cut short.
class PackedReader {
public:
    explicit PackedReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
    template <class... Values>
    void operator()(Values&... values) {
        (get(values), ...);
    }

private:
    template <class Value>
    static constexpr bool is_plain = std::is_arithmetic_v<Value> || std::is_enum_v<Value>;

    void raw(void* data, std::size_t size) {
        if (size > bytes_.size()) throw InputError("what was parsed arrived cut short");
        if (size) std::memcpy(data, bytes_.data(), size);
        bytes_ = bytes_.subspan(size);
    }
    /// A count of things of at least `size` bytes each.
    std::size_t count(std::size_t size) {
        std::uint64_t n = 0;
        get(n);
        if (n > bytes_.size() / size) throw InputError("what was parsed arrived cut short");
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
        if constexpr (requires(PackedReader & r) { describe(r, values.front()); } ||
                      std::is_same_v<Value, std::string>) {
            values.resize(count(1));
            for (Value& value : values) get(value);
        } else {
            values.resize(count(sizeof(Value)));
            raw(values.data(), values.size() * sizeof(Value));
        }
    }
    template <class Value>
    void get(Value& value) requires requires(PackedReader& r) {
        describe(r, value);
    }
    { describe(*this, value); }

    std::span<const std::byte> bytes_;
};

}  // namespace voxtone::io
