// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/parse_obj.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "base/printable.h"
#include "base/warning.h"
#include "io/codecs/polygon_triangles.h"
#include "io/codecs/tiled_textures.h"
#include "io/models/colour_range.h"
#include "io/models/model_text.h"
#include "io/models/mtl_library.h"
#include "io/models/obj_file.h"
#include "io/models/udim.h"
#include "io/pictures/srgb_code.h"
#include "optics/colour/colour.h"

namespace voxtone::io {

namespace {

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

class ObjParser {
public:
    explicit ObjParser(ParseContext& context)
        : context_(context), file_(read_obj(model_text(context.bytes()), context.name())) {}

    ModelParts parse() {
        parts_.format = "OBJ";
        parts_.positions = std::move(file_.positions);
        for (const std::string& line : file_.libraries) read_libraries(line);
        if (file_.libraries.empty() && file_.materials.size() > 1) take_library_beside();
        settle_vertex_colours();
        for (std::size_t n = 0; n < file_.materials.size(); ++n)
            found_.push_back(in_libraries(file_.materials[n], file_.libraries_before[n]));
        join_uses();
        find_tiles();
        white_.resize(parts_.positions.size());
        for (const ObjFace& face : file_.faces) add(face);
        if (parts_.materials.empty()) parts_.materials.emplace_back();
        say_what_was_lost();
        return std::move(parts_);
    }

private:
    /// Of a material of the library, as one kind of face shows it.
    enum class Shown : char { as_it_is, vertex_colours, plain };

    /// Where there is one of that name, it is of the line that is read.
    bool read_library(const std::string& file) {
        const auto [known, is_new] = libraries_.try_emplace(file);
        if (!is_new) {
            if (known->second) of_lines_.back().push_back(file);
            return known->second.has_value();
        }
        const auto bytes = context_.read_side_file(file);
        if (!bytes) return false;
        of_lines_.back().push_back(file);
        // Within a file the last counts, as in most programs.
        Library& materials = known->second.emplace();
        for (MtlMaterial& material : parse_mtl(model_text(*bytes))) {
            const std::string name = material.name;
            if (!materials.insert_or_assign(name, std::move(material)).second)
                warn(named_warning(
                    "which-colour",
                    fmt::format("The library '{}' has the material '{}' several times; the last was taken.",
                                printable(file), printable(name))));
        }
        return true;
    }

    /// One name with blanks in it, or several.
    void read_libraries(std::string_view line) {
        of_lines_.emplace_back();
        const std::string_view whole = trimmed(line);
        if (whole.empty() || said_missing_.contains(std::string(whole))) return;
        // What is no file by one reading is not missing where it is one by another.
        for (const std::string& name : readings(whole))
            if (context_.finds(name) && read_library(name)) return;
        std::size_t found = 0;
        std::vector<std::string> missing;
        for (std::string_view rest = uncommented(whole); !rest.empty();) {
            const std::string name(unquoted(cut_word(rest)));
            if (context_.finds(name) && read_library(name))
                ++found;
            else
                missing.push_back(name);
        }
        if (found == 0) missing = {std::string(whole)};
        said_missing_.insert(std::string(whole));
        for (const std::string& name : missing) {
            (void)read_library(name);  // that it was looked for is noted
            parts_.lose_texture(
                fmt::format("The material library '{}' that {} names was not found beside the model: its colours "
                            "and textures are LOST. Put the file into the model's folder.",
                            name, context_.name()));
        }
    }

    /// Where the model names none: the one that is called as it is.
    void take_library_beside() {
        const std::string name = context_.name().substr(0, context_.name().rfind('.')) + ".mtl";
        of_lines_.emplace_back();
        if (read_library(name))
            warn(named_warning("side-file",
                               fmt::format("{} has materials and names no library for them; '{}' beside it was taken.",
                                           context_.name(), name)));
        else
            warn(named_warning(
                "lost-colour",
                fmt::format("{} has materials and names no library (mtllib) for them, so that their colours are not "
                            "known; export it again with its MTL file.",
                            context_.name())));
    }

    /// Files, in the order in which a name that was used behind so many of the file's lines is looked for in them: of
    /// the line before it, of those before that, of those behind it. Of a line the first counts (MTL's own rule).
    std::vector<std::string> libraries_for(std::size_t lines) const {
        std::vector<std::string> files;
        const auto add = [&](std::size_t line) {
            for (const std::string& file : of_lines_[line])
                if (std::ranges::find(files, file) == files.end()) files.push_back(file);
        };
        lines = std::min(lines, of_lines_.size());
        for (std::size_t line = lines; line-- > 0;) add(line);
        for (std::size_t line = lines; line < of_lines_.size(); ++line) add(line);
        return files;
    }

    /// By the name as it is written, without comment and quotes, or in other upper and lower case.
    const MtlMaterial* in_libraries(const std::string& name, std::size_t lines_before) {
        const std::vector<std::string> files = libraries_for(lines_before);
        for (const std::string& reading : readings(name)) {
            const MtlMaterial* found = nullptr;
            for (const std::string& file : files) {
                const Library& library = *libraries_.at(file);
                const auto there = library.find(reading);
                if (there == library.end()) continue;
                if (!found)
                    found = &there->second;
                else if (!look_alike(*found, there->second))
                    ambiguous_.insert(reading);
            }
            if (found) return found;
        }
        for (const std::string& reading : readings(name))
            for (const std::string& file : files)
                for (const auto& [key, material] : *libraries_.at(file))
                    for (const std::string& of_key : readings(key))
                        if (lower_case(of_key) == lower_case(reading)) return &material;
        return nullptr;
    }

    /// Uses of a name in several places, of the same material, are one.
    void join_uses() {
        std::map<std::pair<std::string, const MtlMaterial*>, std::uint32_t> first;
        std::vector<std::uint32_t> to;
        for (std::uint32_t n = 0; n < file_.materials.size(); ++n)
            to.push_back(first.try_emplace({file_.materials[n], found_[n]}, n).first->second);
        for (ObjFace& face : file_.faces) face.material = to[face.material];
    }

    /// Where alpha and weight stand is the same for all.
    void settle_vertex_colours() {
        const std::size_t vertices = parts_.positions.size();
        if (!file_.polypaint.empty()) {
            FileColours colours{{}, ColourNumbers::bytes, ColourNumbers::bytes, false};
            colours.value.assign(vertices, no_colour());
            for (std::size_t i = 0; i < std::min(vertices, file_.polypaint.size()); ++i)
                for (int c = 0; c < 3; ++c) colours.value[i][c] = file_.polypaint[i] >> (16 - 8 * c) & 0xff;
            rgba_ = settled_colours(colours, "vertex", context_.name(), parts_.warnings, &parts_.lost_colours);
        } else if (std::ranges::any_of(file_.extras, [](const ObjVertexExtra& e) { return e.count >= 3; })) {
            file_.extras.resize(vertices);
            place_extras();
        }
        parts_.has_colour = parts_.has_colour || !rgba_.empty();
    }

    static Eigen::Vector4d no_colour() { return {std::nan(""), std::nan(""), std::nan(""), 1}; }

    void place_extras() {
        const auto all_one = [&](std::size_t at) {
            return std::ranges::all_of(file_.extras,
                                       [&](const ObjVertexExtra& e) { return e.count != 4 || e.value[at] == 1; });
        };
        const bool weight_first = !all_one(3) && all_one(0);
        FileColours colours;
        for (const ObjVertexExtra& e : file_.extras) {
            Eigen::Vector4d& colour = colours.value.emplace_back(no_colour());
            if (e.count < 3) continue;
            const std::size_t first = e.count == 5 || (e.count == 4 && weight_first) ? 1 : 0;
            for (std::size_t c = 0; c < std::min<std::size_t>(e.count - first, 4); ++c)
                colour[static_cast<Eigen::Index>(c)] = static_cast<double>(e.value[first + c]);
            colours.has_alpha = colours.has_alpha || e.count > first + 3;
        }
        rgba_ = settled_colours(colours, "vertex", context_.name(), parts_.warnings, &parts_.lost_colours);
    }

    /// Of its corners, as the material lays them; empty where a corner has none.
    std::vector<Eigen::Vector2f> coordinates_of(const ObjFace& face) const {
        std::vector<Eigen::Vector2f> laid;
        const MtlMaterial* mtl = found_[face.material];
        for (const ObjCorner& corner : file_.corners_of(face)) {
            if (corner.uv < 0) return {};
            Eigen::Vector2f uv = file_.uv[static_cast<std::size_t>(corner.uv)];
            if (mtl) uv = uv.cwiseProduct(mtl->map_scale) + mtl->map_offset;
            laid.push_back(uv);
        }
        return laid;
    }

    /// Which textures are cut into tiles: by a mark in the name, or because coordinates leave the tile that is named
    /// for neighbours that are there. A face over several tiles says that the picture is repeated.
    void find_tiles() {
        marked_.resize(file_.materials.size());
        std::vector<std::optional<WrittenTile>> written(file_.materials.size());
        std::vector<std::set<UvTile>> used(file_.materials.size());
        for (std::size_t n = 0; n < file_.materials.size(); ++n) {
            const std::vector<std::string> files = readings(found_[n] ? found_[n]->map_kd : "");
            if (files.empty()) continue;
            if (tile_file(files.back(), {}))
                marked_[n] = files.back();
            else
                written[n] = written_tile(files.back());
        }
        for (const ObjFace& face : file_.faces) {
            if (!written[face.material]) continue;
            const std::vector<Eigen::Vector2f> uv = coordinates_of(face);
            if (uv.empty()) continue;
            if (const auto tile = tile_of(uv))
                used[face.material].insert(*tile);
            else
                written[face.material].reset();
        }
        for (std::size_t n = 0; n < file_.materials.size(); ++n) {
            if (!written[n] || !has_neighbours(*written[n], used[n], context_)) continue;
            marked_[n] = written[n]->marked;
            warn(taken_for_tiles(found_[n]->map_kd, context_.name()));
        }
    }

    /// An index into the materials of the parts. `tile`: of a texture that is cut into tiles.
    std::uint32_t material(std::uint32_t name, Shown shown, std::optional<UvTile> tile) {
        const auto [known, added] =
            made_.try_emplace({name, shown, tile}, static_cast<std::uint32_t>(parts_.materials.size()));
        if (!added) return known->second;
        PartMaterial made;
        made.name = file_.materials[name];
        if (const MtlMaterial* mtl = found_[name])
            use(*mtl, shown, tile ? *tile_file(marked_[name], *tile) : mtl->map_kd, made);
        if (tile) made.wrap_u = made.wrap_v = Wrap::clamp;
        parts_.materials.push_back(std::move(made));
        return known->second;
    }

    void use(const MtlMaterial& mtl, Shown shown, const std::string& map, PartMaterial& made) {
        made.alpha = mtl.opacity;
        if (mtl.kd && mtl.kd->minCoeff() < 1) parts_.has_colour = true;  // else white, which many write by default
        if (mtl.has_opacity_map)
            warn(named_warning(
                "transparent",
                fmt::format(
                    "The material '{}' has an opacity map, which is left aside; the alpha of its map_Kd is what "
                    "--alpha translucency prints.",
                    mtl.name)));
        if (!map.empty()) parts_.has_colour = true;
        if (!map.empty() && shown == Shown::as_it_is) {
            made.image = ranged(image(map), mtl);
            made.wrap_u = made.wrap_v = mtl.map_clamp ? Wrap::decal : Wrap::repeat;
            if (!mtl.map_from.empty())
                warn(named_warning("which-colour",
                                   fmt::format("The material '{}' has no map_Kd; its {} was taken for its colours.",
                                               mtl.name, mtl.map_from)));
        }
        if (map.empty() && shown != Shown::vertex_colours) lose_unknown_maps(mtl);
        if (!mtl.kd && !mtl.unread_kd.empty() && made.image < 0 && shown != Shown::vertex_colours)
            parts_.lose_colour(fmt::format(
                "The material '{}' has the Kd '{}', which is no red, green and blue: its colour is LOST. Export the "
                "model with colours in RGB.",
                printable(mtl.name), printable(mtl.unread_kd)));
        if (!mtl.kd || shown == Shown::vertex_colours) return;
        if (made.image < 0) {
            made.rgb = mtl.is_linear ? *mtl.kd : srgb_to_linear(*mtl.kd);
            if (mtl.is_linear && mtl.kd->minCoeff() < 1 && !std::exchange(said_linear_, true))
                warn(named_warning("which-colour",
                                   fmt::format("{}'s materials were written by Blender, whose colours of materials are "
                                               "linear; they were read as such.",
                                               context_.name())));
            if (!mtl.colour_from.empty())
                warn(named_warning(
                    "which-colour",
                    fmt::format("The material '{}' has a black Kd or none; its {} was taken for its colour.", mtl.name,
                                mtl.colour_from)));
        } else if (mtl.kd->maxCoeff() - mtl.kd->minCoeff() > 0.01f) {
            warn(named_warning(
                "which-colour",
                fmt::format(
                    "The material '{}' has both a texture and a coloured Kd ({:.2f} {:.2f} {:.2f}); the texture "
                    "is printed as it is, Kd is left aside.",
                    mtl.name, mtl.kd->x(), mtl.kd->y(), mtl.kd->z())));
        }
    }

    std::int32_t image(const std::string& file) {
        const std::vector<std::string> names = readings(file);
        for (const std::string& name : names)
            if (context_.finds(name)) return context_.add_image_file(parts_, name, context_.decode_options());
        return context_.add_image_file(parts_, names.empty() ? file : names.front(), context_.decode_options());
    }

    /// What is called otherwise than by MTL's names may be the colours, where there is such a picture.
    void lose_unknown_maps(const MtlMaterial& mtl) {
        for (const auto& [statement, file] : mtl.unknown_maps) {
            const std::vector<std::string> names = readings(file);
            if (std::ranges::none_of(names, [&](const std::string& name) { return context_.finds(name); })) continue;
            parts_.has_colour = true;
            parts_.lose_texture(fmt::format(
                "The material '{}' has the picture '{}' by the name of {}, which is not known, and no map_Kd: "
                "if it holds the colours, they are LOST. Call it map_Kd.",
                printable(mtl.name), printable(file), printable(statement)));
        }
    }

    /// The picture with the range of values that the material gives it (-mm); -1 stays.
    std::int32_t ranged(std::int32_t plain, const MtlMaterial& mtl) {
        if (plain < 0 || (mtl.map_base == 0 && mtl.map_gain == 1)) return plain;
        const auto [known, is_new] =
            ranged_.try_emplace({plain, mtl.map_base, mtl.map_gain}, static_cast<std::int32_t>(parts_.images.size()));
        if (!is_new) return known->second;
        DecodedImage image = parts_.images[static_cast<std::size_t>(plain)];
        const auto changed = [&](double code) {
            return std::clamp(static_cast<double>(mtl.map_base) + static_cast<double>(mtl.map_gain) * code, 0.0, 1.0);
        };
        for (std::size_t i = 0; i < image.texels.srgb8.size(); ++i)
            if (i % 4 != 3)
                image.texels.srgb8[i] =
                    static_cast<std::uint8_t>(std::lround(changed(image.texels.srgb8[i] / 255.0) * 255));
        for (std::size_t i = 0; i < image.texels.linear16.size(); ++i)
            if (i % 4 != 3)
                image.texels.linear16[i] = static_cast<std::uint16_t>(std::lround(
                    optics::srgb_decode(changed(optics::srgb_encode(image.texels.linear16[i] / 65535.0))) * 65535));
        parts_.images.push_back(std::move(image));
        parts_.image_names.push_back(parts_.image_names[static_cast<std::size_t>(plain)]);
        return known->second;
    }

    void warn(std::string sentence) {
        if (std::ranges::find(parts_.warnings, sentence) == parts_.warnings.end())
            parts_.warnings.push_back(std::move(sentence));
    }

    bool has_paint(const ObjCorner& corner) const {
        return !rgba_.empty() && !std::isnan(rgba_[static_cast<std::size_t>(corner.vertex)][0]);
    }

    /// How a face shows its material.
    struct Look {
        Shown shown = Shown::as_it_is;
        std::optional<UvTile> tile;
    };

    Look look_of(const ObjFace& face, const std::vector<Eigen::Vector2f>& uv) {
        const MtlMaterial* mtl = found_[face.material];
        const bool map = mtl && !mtl->map_kd.empty(),
                   painted = std::ranges::any_of(file_.corners_of(face), [&](const auto&c) { return has_paint(c); });
        bool textured = map && (!uv.empty() || file_.uv.empty());
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

    void count_white(const ObjFace& face) {
        for (const ObjCorner& corner : file_.corners_of(face))
            if (!has_paint(corner)) white_[static_cast<std::size_t>(corner.vertex)] = true;
    }

    void add(const ObjFace& face) {
        const std::span<const ObjCorner> corners = file_.corners_of(face);
        std::vector<Eigen::Vector3d> outline;
        for (const ObjCorner& corner : corners)
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
        for (const auto& triangle : polygon_triangles(outline, context_.name(), true)) {
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
        const bool coloured = std::ranges::any_of(libraries_, [](const auto& library) {
            return library.second &&
                   std::ranges::any_of(*library.second, [](const auto& m) { return has_colour(m.second); });
        });
        if (coloured && !used_ && !file_.faces.empty())
            parts_.lose_colour(fmt::format(
                "{} uses none of the materials in its library: their colours are LOST. Look at the names behind usemtl "
                "and newmtl, or export it again.",
                context_.name()));
        else if (coloured)
            for (const std::uint32_t name : unknown_)
                if (!file_.materials[name].empty())
                    parts_.lose_colour(fmt::format(
                        "{} uses the material '{}', which its library does not have: its colour is LOST. Look at the "
                        "names behind usemtl and newmtl, or export it again.",
                        context_.name(), printable(file_.materials[name])));
        if (!ambiguous_.empty())
            warn(named_warning(
                "which-colour",
                fmt::format(
                    "Several libraries of {} have the material '{}'{}, and not alike: where it is used, that of "
                    "the library named last before was taken.",
                    context_.name(), printable(*ambiguous_.begin()),
                    ambiguous_.size() > 1 ? fmt::format(" and {} more", ambiguous_.size() - 1) : "")));
        for (const auto& [name, faces] : without_coordinates_)
            parts_.lose_colour(fmt::format(
                "{} faces of {} have the material '{}' with a texture and no texture coordinates: its colours are LOST "
                "there and the material's own colour is used.",
                faces, context_.name(), printable(file_.materials[name])));
        for (const auto& [name, faces] : beyond_tiles_)
            parts_.lose_colour(beyond_tiles(faces, marked_[name], context_.name()));
        if (const auto white = static_cast<std::size_t>(std::ranges::count(white_, true)))
            parts_.lose_colour(white_without_colour(white, "vertices", context_.name()));
        if (paint_left_aside_)
            warn(named_warning(
                "which-colour",
                fmt::format("{} has textures and colours of vertices on the same faces; the textures are printed.",
                            context_.name())));
        if (file_.comma)
            warn(named_warning("decimal-commas",
                               fmt::format("{} has decimal commas; they were read as points.", context_.name())));
        if (file_.points_and_lines)
            warn(named_warning("no-volume",
                               fmt::format("{} has {} points or lines; they have no volume and are left aside.",
                                           context_.name(), file_.points_and_lines)));
        if (file_.free_forms)
            warn(named_warning(
                "left-out",
                fmt::format(
                    "{} has {} free-form curves or surfaces, which are not read: they are MISSING from the print. "
                    "Export it as a mesh.",
                    context_.name(), file_.free_forms)));
        for (const std::string& warning : context_.side_file_warnings()) warn(warning);
        const bool points = file_.points_and_lines || (!parts_.positions.empty() && !file_.free_forms);
        context_.expect_faces(
            parts_, {points ? "points or lines, which have no volume: make a mesh of them in a mesh editor" : "",
                     file_.free_forms ? "free-form curves or surfaces, which are not read: export it as a mesh" : ""});
    }

    ParseContext& context_;
    ObjFile file_;
    ModelParts parts_;
    std::vector<Eigen::Vector4f> rgba_;      ///< per vertex, linear; not a number where it has none; or empty
    std::vector<const MtlMaterial*> found_;  ///< of the names; null: the library has none
    using Library = std::map<std::string, MtlMaterial>;
    std::map<std::string, std::optional<Library>> libraries_;  ///< by file; nothing where there is none of that name
    std::vector<std::vector<std::string>> of_lines_;  ///< files that a line of the model names and that are there
    std::set<std::string> ambiguous_;                 ///< materials that several libraries have, and not alike
    std::map<std::tuple<std::int32_t, float, float>, std::int32_t> ranged_;  ///< images by image, base and gain
    std::set<std::string> said_missing_;
    std::vector<std::string> marked_;  ///< of the names: the texture's with a mark, where it is cut into tiles
    std::map<std::tuple<std::uint32_t, Shown, std::optional<UvTile>>, std::uint32_t> made_;
    std::set<std::uint32_t> unknown_;
    std::vector<bool> white_;  ///< per vertex: shown white for want of a colour
    std::map<std::uint32_t, std::size_t> without_coordinates_, beyond_tiles_;
    bool used_ = false, paint_left_aside_ = false, said_linear_ = false;
};

}  // namespace

ModelParts parse_obj(ParseContext& context) { return ObjParser(context).parse(); }

}  // namespace voxtone::io
