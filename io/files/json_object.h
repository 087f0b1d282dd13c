// SPDX-License-Identifier: GPL-3.0-or-later
//
// JSON objects as a user writes them (manifests, resin sets, job files): every fault is an InputError that names the
// file, the line, the key, the value and the rule; a key that is not known is an error that names the nearest one that
// is.
//
// nlohmann-json parses; what it lacks is all that comes after: its exceptions know neither file nor key, and a schema
// validator says which rule of the schema was broken, not what to write instead. (Schemas: tests/io/files/schema_test.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::io {

/// A JSON object together with where it came from.
class JsonObject {
public:
    /// `source` names the text in errors. Throws InputError with line and column.
    [[nodiscard]] static JsonObject parse(std::string_view text, std::string source);
    /// A text of one line, whose `source` says which.
    [[nodiscard]] static JsonObject of_line(std::string_view text, std::string source);
    /// Throws FileError where the file cannot be read, InputError where it is larger than `most_bytes` or no JSON
    /// object.
    [[nodiscard]] static JsonObject read(const std::filesystem::path& file, std::size_t most_bytes = usual_bytes);
    static constexpr std::size_t usual_bytes = std::size_t{64} << 20;

    /// Throws InputError for the first key that is not among `known`.
    void allow_only(std::initializer_list<std::string_view> known) const;
    void allow_only(std::span<const std::string> known) const;
    [[nodiscard]] bool has(std::string_view key) const;
    /// Whether the value is a text, an object: for keys that may hold something else too.
    [[nodiscard]] bool is_text(std::string_view key) const;
    [[nodiscard]] bool is_object(std::string_view key) const;
    [[nodiscard]] std::vector<std::string> keys() const;

    /// A text as it is; a number, true and false as they are written; a list of texts with commas between.
    [[nodiscard]] std::string any_text(std::string_view key) const;

    // Texts are the bytes that JsonWriter wrote, whatever they are (base/printable.h, escaped_bytes).
    // Each throws InputError where the key is missing, of another type or out of range (ends included).
    [[nodiscard]] std::string text(std::string_view key) const;
    [[nodiscard]] bool boolean(std::string_view key) const;
    [[nodiscard]] double number(std::string_view key, double least, double most) const;
    [[nodiscard]] std::uint64_t integer(std::string_view key, std::uint64_t least, std::uint64_t most) const;
    /// `count` == 0: any number of them.
    [[nodiscard]] std::vector<double> numbers(std::string_view key, std::size_t count, double least, double most) const;
    /// A list of `lists` lists (0: any number of them), each of any length.
    [[nodiscard]] std::vector<std::vector<double>> number_lists(std::string_view key, std::size_t lists, double least,
                                                                double most) const;
    /// Lists of `rows` lists of numbers.
    [[nodiscard]] std::vector<std::vector<std::vector<double>>> tables(std::string_view key, std::size_t rows,
                                                                       double least, double most) const;
    [[nodiscard]] std::vector<std::uint64_t> integers(std::string_view key, std::size_t count, std::uint64_t least,
                                                      std::uint64_t most) const;
    [[nodiscard]] std::vector<std::string> texts(std::string_view key) const;
    [[nodiscard]] JsonObject object(std::string_view key) const;
    [[nodiscard]] std::vector<JsonObject> objects(std::string_view key) const;

    /// Throws InputError "FILE: line N: key `KEY`: RULE", without the line where the file has no such key. `key` may
    /// end in places in a list, "rows[3][1]".
    [[noreturn]] void fail(std::string_view key, std::string_view rule) const;

private:
    struct Document;
    struct Node;
    explicit JsonObject(std::shared_ptr<const Node> node);
    [[nodiscard]] static JsonObject parsed(std::string_view text, std::string source, bool has_lines);
    std::shared_ptr<const Node> node_;
};

}  // namespace voxtone::io
