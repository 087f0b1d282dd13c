// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/obj_file.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/printable.h"
#include "io/models/model_text.h"

namespace voxtone::io {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

class ObjReader {
public:
    explicit ObjReader(const std::string& name) : name_(name) {}

    ObjFile read_all(std::string_view text) {
        TextLines lines(text);
        while (const auto line = lines.next()) {
            line_number_ = lines.number();
            read(*line);
        }
        for (const ObjFace& face : file_.faces) check(face);
        return std::move(file_);
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}, line {}: {}", name_, line_number_, what));
    }

    void read(std::string_view line) {
        if (line.front() == '#') {
            if (line.starts_with("#MRGB")) read_polypaint(line.substr(5));
            return;
        }
        const std::string key = lower_case(std::string(cut_word(line)));
        if (key == "v")
            read_vertex(line);
        else if (key == "vt")
            read_coordinates(line);
        else if (key == "f" || key == "fo")
            read_face(line);
        else if (key == "usemtl")
            material_ = material_named(line);
        else if (key == "mtllib")
            read_library(trimmed(line));
        else if (key == "l" || key == "p")
            ++file_.points_and_lines;
        else if (key == "curv" || key == "surf" || key == "curv2")
            ++file_.free_forms;
    }

    void read_library(std::string_view line) {
        if (file_.libraries.empty() || file_.libraries.back() != line) file_.libraries.emplace_back(line);
    }

    void read_vertex(std::string_view line) {
        Eigen::Vector3d place = Eigen::Vector3d::Constant(nothing);
        ObjVertexExtra extra;
        std::size_t count = 0;
        while (!line.empty() && count < 8) {
            const std::string_view word = cut_word(line);
            if (word.front() == '#') break;
            const std::optional<double> value = number_of(word, file_.comma);
            if (count < 3)
                place[static_cast<Eigen::Index>(count)] = value.value_or(nothing);
            else if (value)
                extra.value[extra.count++] = static_cast<float>(*value);
            else
                break;
            ++count;
        }
        if (count < 3) fail("a vertex has fewer than three numbers; the file is damaged, export it again");
        file_.positions.push_back(place);
        if (extra.count == 0 && file_.extras.empty()) return;
        file_.extras.resize(file_.positions.size());
        file_.extras.back() = extra;
    }

    void read_coordinates(std::string_view line) {
        Eigen::Vector2f uv = Eigen::Vector2f::Zero();
        for (Eigen::Index i = 0; i < 2 && !line.empty(); ++i)
            uv[i] = static_cast<float>(number_of(cut_word(line), file_.comma).value_or(nothing));
        file_.uv.push_back(uv);
    }

    /// Hexadecimal, a mask and red, green, blue for each vertex.
    void read_polypaint(std::string_view digits) {
        digits = trimmed(digits);
        for (; digits.size() >= 8; digits.remove_prefix(8)) {
            std::uint32_t code = 0;
            const auto [end, error] = std::from_chars(digits.data(), digits.data() + 8, code, 16);
            if (error != std::errc() || end != digits.data() + 8) return;
            file_.polypaint.push_back(code);
        }
    }

    /// From 0. Backwards numbers count from what there is so far; others may come before what they name.
    std::int64_t index_of(std::string_view text, std::size_t so_far, const char* what) const {
        std::int64_t index = 0;
        if (text.starts_with('+')) text.remove_prefix(1);
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
        if (error != std::errc() || end != text.data() + text.size())
            fail(fmt::format("a face has '{}' for the number of a {}; the file is damaged, export it again",
                             printable(std::string(text.substr(0, 40))), what));
        const std::int64_t from_0 = index > 0 ? index - 1 : static_cast<std::int64_t>(so_far) + index;
        if (index == 0 || from_0 < 0)
            fail(fmt::format("a face uses {} {}, but there are only {} before it; the file is damaged", what, index,
                             so_far));
        return from_0;
    }

    void read_face(std::string_view line) {
        ObjFace face{material_, file_.corners.size(), 0, line_number_};
        while (!line.empty()) {
            const std::string_view word = cut_word(line);
            if (word.front() == '#') break;
            const std::size_t slash = std::min(word.find('/'), word.size());
            ObjCorner corner;
            corner.vertex = index_of(word.substr(0, slash), file_.positions.size(), "vertex");
            const std::string_view rest = word.substr(std::min(slash + 1, word.size()));
            const std::string_view uv = rest.substr(0, std::min(rest.find('/'), rest.size()));
            if (!uv.empty()) corner.uv = index_of(uv, file_.uv.size(), "texture coordinate");
            file_.corners.push_back(corner);
        }
        face.corners = file_.corners.size() - face.first;
        if (face.corners >= 3) {
            file_.faces.push_back(face);
            return;
        }
        file_.corners.resize(face.first);
        ++file_.points_and_lines;
    }

    /// Of the names that faces use, each with the libraries before it; 0 before the first.
    std::uint32_t material_named(std::string_view name) {
        const auto next = static_cast<std::uint32_t>(file_.materials.size());
        const auto [known, added] = numbers_.try_emplace({std::string(trimmed(name)), file_.libraries.size()}, next);
        if (added) {
            file_.materials.push_back(known->first.first);
            file_.libraries_before.push_back(file_.libraries.size());
        }
        return known->second;
    }

    void check(const ObjFace& face) {
        line_number_ = face.line;
        for (const ObjCorner& corner : file_.corners_of(face)) {
            if (corner.vertex >= static_cast<std::int64_t>(file_.positions.size()))
                fail(fmt::format("a face uses vertex {}, but there are only {}; the file is damaged", corner.vertex + 1,
                                 file_.positions.size()));
            if (corner.uv >= static_cast<std::int64_t>(file_.uv.size()))
                fail(fmt::format("a face uses texture coordinate {}, but there are only {}; the file is damaged",
                                 corner.uv + 1, file_.uv.size()));
        }
    }

    const std::string& name_;
    ObjFile file_;
    std::map<std::pair<std::string, std::size_t>, std::uint32_t> numbers_{{{"", 0}, 0}};  ///< of materials
    std::uint32_t material_ = 0;
    std::size_t line_number_ = 0;
};

}  // namespace

ObjFile read_obj(std::string_view text, const std::string& name) { return ObjReader(name).read_all(text); }

}  // namespace voxtone::io
