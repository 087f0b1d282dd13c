// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/codecs/parse_obj.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "voxtone/base/error.h"
#include "voxtone/base/printable.h"
#include "voxtone/io/codecs/polygon_triangles.h"
#include "voxtone/io/models/colour_range.h"
#include "voxtone/io/models/model_text.h"
#include "voxtone/io/models/mtl_library.h"
#include "voxtone/io/models/udim.h"
#include "voxtone/io/pictures/srgb_code.h"

namespace voxtone::io {

namespace {

constexpr float nothing = std::numeric_limits<float>::quiet_NaN();

bool has_colour(const MtlMaterial& m) { return !m.map_kd.empty() || (m.kd && m.kd->minCoeff() < 0.9f); }

/// Without the quotes around it.
std::string_view unquoted(std::string_view text) {
    text = trimmed(text);
    if (text.size() > 1 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
    return text;
}

/// Without what stands behind " #".
std::string_view uncommented(std::string_view text) {
    for (std::size_t at = text.find('#'); at != std::string_view::npos; at = text.find('#', at + 1))
        if (at > 0 && (text[at - 1] == ' ' || text[at - 1] == '\t')) return trimmed(text.substr(0, at));
    return text;
}

/// What a name may mean, as it is written first.
std::vector<std::string> readings(std::string_view name) {
    std::vector<std::string> all;
    for (const std::string_view text : {name, unquoted(name), unquoted(uncommented(name))})
        if (!text.empty() && std::ranges::find(all, text) == all.end()) all.emplace_back(text);
    return all;
}

/// What stands behind the place of a vertex.
struct VertexExtra {
    std::array<float, 5> value{};
    std::uint8_t count = 0;
};

class ObjParser {
public:
    explicit ObjParser(ParseContext& context) : context_(context), text_(model_text(context.bytes())) {}

    ModelParts parse() {
        parts_.format = "OBJ";
        TextLines lines(text_);
        while (const auto line = lines.next()) {
            line_ = lines.number();
            read(*line);
        }
        settle_vertex_colours();
        for (const std::string& name : names_) found_.push_back(in_library(name));
        for (const Face& face : faces_) check(face);
        find_tiles();
        white_.resize(parts_.positions.size());
        for (const Face& face : faces_) add(face);
        if (parts_.materials.empty()) parts_.materials.emplace_back();
        say_what_was_lost();
        return std::move(parts_);
    }

private:
    struct Corner {
        std::int64_t vertex = 0, uv = -1;
    };
    struct Face {
        std::uint32_t material = 0;
        std::size_t first = 0, corners = 0, line = 0;
    };
    /// Of a material of the library, as one kind of face shows it.
    enum class Shown : char { as_it_is, vertex_colours, plain };

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}, line {}: {}", context_.name(), line_, what));
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
            read_libraries(line);
        else if (key == "l" || key == "p")
            ++points_and_lines_;
        else if (key == "curv" || key == "surf" || key == "curv2")
            ++free_forms_;
    }

    void read_vertex(std::string_view line) {
        Eigen::Vector3d place = Eigen::Vector3d::Constant(static_cast<double>(nothing));
        VertexExtra extra;
        std::size_t count = 0;
        while (!line.empty() && count < 8) {
            const std::string_view word = cut_word(line);
            if (word.front() == '#') break;
            const std::optional<double> value = number_of(word, comma_);
            if (count < 3)
                place[static_cast<Eigen::Index>(count)] = value.value_or(static_cast<double>(nothing));
            else if (value)
                extra.value[extra.count++] = static_cast<float>(*value);
            else
                break;
            ++count;
        }
        if (count < 3) fail("a vertex has fewer than three numbers; the file is damaged, export it again");
        parts_.positions.push_back(place);
        if (extra.count == 0 && extras_.empty()) return;
        extras_.resize(parts_.positions.size());
        extras_.back() = extra;
    }

    void read_coordinates(std::string_view line) {
        Eigen::Vector2f uv = Eigen::Vector2f::Zero();
        for (Eigen::Index i = 0; i < 2 && !line.empty(); ++i)
            uv[i] = static_cast<float>(number_of(cut_word(line), comma_).value_or(static_cast<double>(nothing)));
        uv_.push_back(uv);
    }

    /// Hexadecimal, a mask and red, green, blue for each vertex.
    void read_polypaint(std::string_view digits) {
        digits = trimmed(digits);
        for (; digits.size() >= 8; digits.remove_prefix(8)) {
            std::uint32_t code = 0;
            const auto [end, error] = std::from_chars(digits.data(), digits.data() + 8, code, 16);
            if (error != std::errc() || end != digits.data() + 8) return;
            polypaint_.push_back(code);
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
        Face face{material_, corners_.size(), 0, line_};
        while (!line.empty()) {
            const std::string_view word = cut_word(line);
            if (word.front() == '#') break;
            const std::size_t slash = std::min(word.find('/'), word.size());
            Corner corner;
            corner.vertex = index_of(word.substr(0, slash), parts_.positions.size(), "vertex");
            const std::string_view rest = word.substr(std::min(slash + 1, word.size()));
            const std::string_view uv = rest.substr(0, std::min(rest.find('/'), rest.size()));
            if (!uv.empty()) corner.uv = index_of(uv, uv_.size(), "texture coordinate");
            corners_.push_back(corner);
        }
        face.corners = corners_.size() - face.first;
        if (face.corners >= 3) {
            faces_.push_back(face);
            return;
        }
        corners_.resize(face.first);
        ++points_and_lines_;
    }

    /// Of the names that faces use; 0 before the first.
    std::uint32_t material_named(std::string_view name) {
        const std::string key(trimmed(name));
        const auto known = std::ranges::find(names_, key);
        if (known != names_.end()) return static_cast<std::uint32_t>(known - names_.begin());
        names_.push_back(key);
        return static_cast<std::uint32_t>(names_.size() - 1);
    }

    bool read_library(const std::string& file) {
        if (const auto known = libraries_.find(file); known != libraries_.end()) return known->second;
        const auto bytes = context_.read_side_file(file);
        libraries_[file] = bytes.has_value();
        if (!bytes) return false;
        // Within a file the last counts, as in most programs; of several files the first (MTL's own rule).
        std::map<std::string, MtlMaterial> materials;
        for (MtlMaterial& material : parse_mtl(model_text(*bytes))) {
            const std::string name = material.name;
            if (!materials.insert_or_assign(name, std::move(material)).second)
                say(fmt::format("The library '{}' has the material '{}' several times; the last was taken.",
                                printable(file), printable(name)));
        }
        library_.merge(materials);
        return true;
    }

    /// One name with blanks in it, or several.
    void read_libraries(std::string_view line) {
        const std::string_view whole = trimmed(line);
        if (whole.empty() || said_missing_.contains(std::string(whole))) return;
        for (const std::string& name : readings(whole))
            if (read_library(name)) return;
        std::size_t found = 0;
        std::vector<std::string> missing;
        for (std::string_view rest = uncommented(whole); !rest.empty();) {
            const std::string name(unquoted(cut_word(rest)));
            if (read_library(name))
                ++found;
            else
                missing.push_back(name);
        }
        if (found == 0) missing = {std::string(whole)};
        said_missing_.insert(std::string(whole));
        for (const std::string& name : missing)
            parts_.lose_texture(
                fmt::format("The material library '{}' that {} names was not found beside the model: its colours "
                            "and textures are LOST. Put the file into the model's folder.",
                            name, context_.name()));
    }

    /// By the name as it is written, without comment and quotes, or in other upper and lower case.
    const MtlMaterial* in_library(const std::string& name) const {
        for (const std::string& reading : readings(name))
            if (const auto found = library_.find(reading); found != library_.end()) return &found->second;
        for (const std::string& reading : readings(name))
            for (const auto& [key, material] : library_)
                for (const std::string& of_key : readings(key))
                    if (lower_case(of_key) == lower_case(reading)) return &material;
        return nullptr;
    }

    /// Where alpha and weight stand is the same for all.
    void settle_vertex_colours() {
        const std::size_t vertices = parts_.positions.size();
        if (!polypaint_.empty()) {
            FileColours colours{{}, ColourNumbers::bytes, ColourNumbers::bytes, false};
            colours.value.assign(vertices, no_colour());
            for (std::size_t i = 0; i < std::min(vertices, polypaint_.size()); ++i)
                for (int c = 0; c < 3; ++c) colours.value[i][c] = polypaint_[i] >> (16 - 8 * c) & 0xff;
            rgba_ = settled_colours(colours, "vertex", context_.name(), parts_.warnings);
        } else if (std::ranges::any_of(extras_, [](const VertexExtra& e) { return e.count >= 3; })) {
            extras_.resize(vertices);
            place_extras();
        }
        parts_.has_colour = parts_.has_colour || !rgba_.empty();
    }

    static Eigen::Vector4d no_colour() { return {std::nan(""), std::nan(""), std::nan(""), 1}; }

    void place_extras() {
        const auto all_one = [&](std::size_t at) {
            return std::ranges::all_of(extras_, [&](const VertexExtra& e) { return e.count != 4 || e.value[at] == 1; });
        };
        const bool weight_first = !all_one(3) && all_one(0);
        FileColours colours;
        for (const VertexExtra& e : extras_) {
            Eigen::Vector4d& colour = colours.value.emplace_back(no_colour());
            if (e.count < 3) continue;
            const std::size_t first = e.count == 5 || (e.count == 4 && weight_first) ? 1 : 0;
            for (std::size_t c = 0; c < std::min<std::size_t>(e.count - first, 4); ++c)
                colour[static_cast<Eigen::Index>(c)] = static_cast<double>(e.value[first + c]);
            colours.has_alpha = colours.has_alpha || e.count > first + 3;
        }
        rgba_ = settled_colours(colours, "vertex", context_.name(), parts_.warnings);
    }

    void check(const Face& face) {
        line_ = face.line;
        for (const Corner& corner : corners_of(face)) {
            if (corner.vertex >= static_cast<std::int64_t>(parts_.positions.size()))
                fail(fmt::format("a face uses vertex {}, but there are only {}; the file is damaged", corner.vertex + 1,
                                 parts_.positions.size()));
            if (corner.uv >= static_cast<std::int64_t>(uv_.size()))
                fail(fmt::format("a face uses texture coordinate {}, but there are only {}; the file is damaged",
                                 corner.uv + 1, uv_.size()));
        }
    }

    std::span<const Corner> corners_of(const Face& face) const {
        return std::span(corners_).subspan(face.first, face.corners);
    }

    /// Of its corners, as the material lays them; empty where a corner has none.
    std::vector<Eigen::Vector2f> coordinates_of(const Face& face) const {
        std::vector<Eigen::Vector2f> laid;
        const MtlMaterial* mtl = found_[face.material];
        for (const Corner& corner : corners_of(face)) {
            if (corner.uv < 0) return {};
            Eigen::Vector2f uv = uv_[static_cast<std::size_t>(corner.uv)];
            if (mtl) uv = uv.cwiseProduct(mtl->map_scale) + mtl->map_offset;
            laid.push_back(uv);
        }
        return laid;
    }

    /// Which textures are cut into tiles: by a mark in the name, or because coordinates leave the tile that is named
    /// for neighbours that are there. A face over several tiles says that the picture is repeated.
    void find_tiles() {
        marked_.resize(names_.size());
        std::vector<std::optional<WrittenTile>> written(names_.size());
        std::vector<std::set<UvTile>> used(names_.size());
        for (std::size_t n = 0; n < names_.size(); ++n) {
            const std::vector<std::string> files = readings(found_[n] ? found_[n]->map_kd : "");
            if (files.empty()) continue;
            if (tile_file(files.back(), {}))
                marked_[n] = files.back();
            else
                written[n] = written_tile(files.back());
        }
        for (const Face& face : faces_) {
            if (!written[face.material]) continue;
            const std::vector<Eigen::Vector2f> uv = coordinates_of(face);
            if (uv.empty()) continue;
            if (const auto tile = tile_of(uv))
                used[face.material].insert(*tile);
            else
                written[face.material].reset();
        }
        for (std::size_t n = 0; n < names_.size(); ++n) {
            if (!written[n] || !has_neighbours(*written[n], used[n])) continue;
            marked_[n] = written[n]->marked;
            say(
                fmt::format("The texture '{}' of {} was taken for one of several tiles (UDIM): coordinates lie beyond "
                            "it, and its neighbours are there.",
                            printable(found_[n]->map_kd), context_.name()));
        }
    }

    bool has_neighbours(const WrittenTile& written, const std::set<UvTile>& used) {
        if (written.tile != UvTile{} && !used.contains(written.tile)) return false;
        return std::ranges::any_of(used, [&](const UvTile& tile) {
            return tile != written.tile && context_.finds(*tile_file(written.marked, tile));
        });
    }

    /// An index into the materials of the parts. `tile`: of a texture that is cut into tiles.
    std::uint32_t material(std::uint32_t name, Shown shown, std::optional<UvTile> tile) {
        const auto [known, added] =
            made_.try_emplace({name, shown, tile}, static_cast<std::uint32_t>(parts_.materials.size()));
        if (!added) return known->second;
        PartMaterial made;
        made.name = names_[name];
        if (const MtlMaterial* mtl = found_[name])
            use(*mtl, shown, tile ? *tile_file(marked_[name], *tile) : mtl->map_kd, made);
        if (tile) made.wrap_u = made.wrap_v = Wrap::clamp;
        parts_.materials.push_back(std::move(made));
        return known->second;
    }

    void use(const MtlMaterial& mtl, Shown shown, const std::string& map, PartMaterial& made) {
        made.alpha = mtl.opacity;
        if (mtl.kd) parts_.has_colour = true;
        if (mtl.has_opacity_map)
            say(fmt::format("The material '{}' has an opacity map; prints are opaque here, it is left aside.",
                            mtl.name));
        if (!map.empty()) parts_.has_colour = true;
        if (!map.empty() && shown == Shown::as_it_is) {
            made.image = image(map);
            made.wrap_u = made.wrap_v = mtl.map_clamp ? Wrap::decal : Wrap::repeat;
            if (!mtl.map_from.empty())
                say(fmt::format("The material '{}' has no map_Kd; its {} was taken for its colours.", mtl.name,
                                mtl.map_from));
        }
        if (!mtl.kd || shown == Shown::vertex_colours) return;
        if (made.image < 0) {
            made.rgb = srgb_to_linear(*mtl.kd);
            if (!mtl.colour_from.empty())
                say(fmt::format("The material '{}' has a black Kd or none; its {} was taken for its colour.", mtl.name,
                                mtl.colour_from));
        } else if (mtl.kd->maxCoeff() - mtl.kd->minCoeff() > 0.01f) {
            say(fmt::format(
                "The material '{}' has both a texture and a coloured Kd ({:.2f} {:.2f} {:.2f}); the texture "
                "is printed as it is, Kd is left aside.",
                mtl.name, mtl.kd->x(), mtl.kd->y(), mtl.kd->z()));
        }
    }

    std::int32_t image(const std::string& file) {
        const std::vector<std::string> names = readings(file);
        for (const std::string& name : names)
            if (context_.finds(name)) return context_.add_image_file(parts_, name, context_.decode_options());
        return context_.add_image_file(parts_, names.empty() ? file : names.front(), context_.decode_options());
    }

    void say(std::string sentence) {
        if (std::ranges::find(parts_.warnings, sentence) == parts_.warnings.end())
            parts_.warnings.push_back(std::move(sentence));
    }

    bool has_paint(const Corner& corner) const {
        return !rgba_.empty() && !std::isnan(rgba_[static_cast<std::size_t>(corner.vertex)][0]);
    }

    /// How a face shows its material.
    struct Look {
        Shown shown = Shown::as_it_is;
        std::optional<UvTile> tile;
    };

    Look look_of(const Face& face, const std::vector<Eigen::Vector2f>& uv) {
        const MtlMaterial* mtl = found_[face.material];
        const bool map = mtl && !mtl->map_kd.empty(),
                   painted = std::ranges::any_of(corners_of(face), [&](const auto&c) { return has_paint(c); });
        bool textured = map && (!uv.empty() || uv_.empty());
        if (map && !textured) ++without_coordinates_[face.material];
        Look look;
        if (textured && !marked_[face.material].empty()) {
            look.tile = uv.empty() ? UvTile{} : tile_of(uv);
            textured = look.tile.has_value();
            if (!textured) ++beyond_tiles_[face.material];
        }
        if (textured && painted) paint_left_aside_ = true;
        if (!textured && painted) look.shown = Shown::vertex_colours;
        if (!textured && !painted && map) look.shown = Shown::plain;
        if (!rgba_.empty() && !textured && !(mtl && mtl->kd && !painted)) count_white(face);
        return look;
    }

    void count_white(const Face& face) {
        for (const Corner& corner : corners_of(face))
            if (!has_paint(corner)) white_[static_cast<std::size_t>(corner.vertex)] = true;
    }

    void add(const Face& face) {
        const std::span<const Corner> corners = corners_of(face);
        std::vector<Eigen::Vector3d> outline;
        for (const Corner& corner : corners)
            outline.push_back(parts_.positions[static_cast<std::size_t>(corner.vertex)]);
        std::vector<Eigen::Vector2f> uv = coordinates_of(face);
        const Look look = look_of(face, uv);
        if (look.tile)
            for (Eigen::Vector2f& place : uv)
                place -= Eigen::Vector2f(static_cast<float>(look.tile->column), static_cast<float>(look.tile->row));
        const std::uint32_t m = material(face.material, look.shown, look.tile);
        if (found_[face.material])
            used_ = true;
        else
            unknown_.insert(face.material);
        for (const auto& triangle : polygon_triangles(outline)) {
            const auto vertex = [&](std::size_t c) { return static_cast<std::uint32_t>(corners[triangle[c]].vertex); };
            const std::size_t t = parts_.add_triangle({vertex(0), vertex(1), vertex(2)}, m);
            if (!uv.empty()) parts_.set_uv(t, {uv[triangle[0]], uv[triangle[1]], uv[triangle[2]]});
            if (look.shown != Shown::vertex_colours) continue;
            std::array<Eigen::Vector4f, 3> rgba;
            for (std::size_t c = 0; c < 3; ++c) {
                rgba[c] = rgba_[vertex(c)];
                if (std::isnan(rgba[c][0])) rgba[c].setOnes();
            }
            parts_.set_rgba(t, rgba);
        }
    }

    void say_what_was_lost() {
        const bool coloured = std::ranges::any_of(library_, [](const auto& m) { return has_colour(m.second); });
        if (coloured && !used_ && !faces_.empty())
            parts_.lose_colour(fmt::format(
                "{} uses none of the materials in its library: their colours are LOST. Look at the names behind usemtl "
                "and newmtl, or export it again.",
                context_.name()));
        else if (coloured)
            for (const std::uint32_t name : unknown_)
                if (!names_[name].empty())
                    parts_.lose_colour(fmt::format(
                        "{} uses the material '{}', which its library does not have: its colour is LOST. Look at the "
                        "names behind usemtl and newmtl, or export it again.",
                        context_.name(), printable(names_[name])));
        for (const auto& [name, faces] : without_coordinates_)
            parts_.lose_colour(fmt::format(
                "{} faces of {} have the material '{}' with a texture and no texture coordinates: its colours are LOST "
                "there and the material's own colour is used.",
                faces, context_.name(), printable(names_[name])));
        for (const auto& [name, faces] : beyond_tiles_)
            parts_.lose_colour(fmt::format(
                "{} faces of {} lie over several tiles of the texture '{}' or in none: its colours are LOST there and "
                "the material's own colour is used. Cut the coordinates where tiles end.",
                faces, context_.name(), printable(marked_[name])));
        if (const auto white = static_cast<std::size_t>(std::ranges::count(white_, true)))
            parts_.lose_colour(white_without_colour(white, "vertices", context_.name()));
        if (paint_left_aside_)
            say(fmt::format("{} has textures and colours of vertices on the same faces; the textures are printed.",
                            context_.name()));
        if (comma_) say(fmt::format("{} has decimal commas; they were read as points.", context_.name()));
        if (points_and_lines_)
            say(fmt::format("{} has {} points or lines; they have no volume and are left aside.", context_.name(),
                            points_and_lines_));
        if (free_forms_)
            say(fmt::format(
                "{} has {} free-form curves or surfaces, which are not read: they are MISSING from the print. "
                "Export it as a mesh.",
                context_.name(), free_forms_));
        for (const std::string& warning : context_.side_file_warnings()) say(warning);
        const bool points = points_and_lines_ || (!parts_.positions.empty() && !free_forms_);
        context_.expect_faces(
            parts_, {points ? "points or lines, which have no volume: make a mesh of them in a mesh editor" : "",
                     free_forms_ ? "free-form curves or surfaces, which are not read: export it as a mesh" : ""});
    }

    ParseContext& context_;
    const std::string text_;
    ModelParts parts_;
    std::size_t line_ = 0;
    std::vector<VertexExtra> extras_;       ///< per vertex up to the last that has some; empty: none has
    std::vector<std::uint32_t> polypaint_;  ///< 0xMMRRGGBB per vertex
    std::vector<Eigen::Vector4f> rgba_;     ///< per vertex, linear; not a number where it has none; or empty
    std::vector<Eigen::Vector2f> uv_;
    std::vector<Corner> corners_;
    std::vector<Face> faces_;
    std::vector<std::string> names_{""};     ///< of materials, as faces use them
    std::vector<const MtlMaterial*> found_;  ///< of the names; null: the library has none
    std::uint32_t material_ = 0;
    std::map<std::string, MtlMaterial> library_;
    std::map<std::string, bool> libraries_;  ///< whether there is one of that name
    std::set<std::string> said_missing_;
    std::vector<std::string> marked_;  ///< of the names: the texture's with a mark, where it is cut into tiles
    std::map<std::tuple<std::uint32_t, Shown, std::optional<UvTile>>, std::uint32_t> made_;
    std::set<std::uint32_t> unknown_;
    std::vector<bool> white_;  ///< per vertex: shown white for want of a colour
    std::map<std::uint32_t, std::size_t> without_coordinates_, beyond_tiles_;
    std::size_t points_and_lines_ = 0, free_forms_ = 0;
    bool comma_ = false, used_ = false, paint_left_aside_ = false;
};

}  // namespace

ModelParts parse_obj(ParseContext& context) { return ObjParser(context).parse(); }

}  // namespace voxtone::io
