// SPDX-License-Identifier: GPL-3.0-or-later
//
// The nodes of an FBX file, binary (32 and 64 bits, either order of bytes) or as text: names, values, children; what
// they mean is parse_fbx.h's. Arrays stay packed until they are asked for. Based on: C. Barton, "FBX binary file format
// specification", code.blender.org, 2013; of 7500 and later files by what they hold: sizes have 64 bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::io {

struct FbxValue {
    enum class Kind : char { integer, real, text, array };
    Kind kind = Kind::integer;
    char item = 0;            ///< of an array: its letter in binary files (f d l i b c); 't': it is text
    bool deflated = false;    ///< of an array
    std::uint64_t count = 0;  ///< of an array: how many it declares
    std::int64_t integer = 0;
    double real = 0;        ///< of integers, too
    std::string_view text;  ///< any bytes; of an array: as they lie in the file
};

struct FbxNode {
    std::string_view name;
    std::vector<FbxValue> values;
    std::vector<FbxNode> children;

    /// The first of that name; null: there is none.
    [[nodiscard]] const FbxNode* child(std::string_view wanted) const;
    /// Values by place; what is not there, or of another kind, is 0 or empty.
    [[nodiscard]] std::int64_t integer(std::size_t place) const;
    [[nodiscard]] double real(std::size_t place) const;
    [[nodiscard]] std::string_view text(std::size_t place) const;
};

class FbxTree {
public:
    /// `bytes` and `file` are pointed into; `most_unpacked`: bytes of all arrays that will be asked for. Throws
    /// InputError: damaged or cut short; older than 7000, where nodes mean something else; no FBX.
    FbxTree(std::span<const std::byte> bytes, const std::string& file, std::uint64_t most_unpacked);

    [[nodiscard]] const FbxNode& root() const { return root_; }

    /// The numbers of a node: of its array, or its values one by one; none where there is no node. Throws InputError.
    [[nodiscard]] std::vector<double> reals(const FbxNode* node);
    [[nodiscard]] std::vector<std::int64_t> integers(const FbxNode* node);
    /// The bytes of a file within the file: base64 where this one is text.
    [[nodiscard]] std::vector<std::byte> content(const FbxNode* node) const;

    [[noreturn]] void fail(const std::string& what) const;

private:
    void read_binary(std::span<const std::byte> bytes);
    void check_version(std::int64_t version) const;
    template <class Number>
    std::vector<Number> numbers(const FbxNode* node);

    const std::string& file_;
    std::uint64_t left_to_unpack_;
    bool is_text_ = false, swapped_ = false;
    std::string converted_;
    std::deque<std::string> unescaped_;
    FbxNode root_;
};

}  // namespace voxtone::io
