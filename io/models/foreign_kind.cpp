// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/foreign_kind.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "base/embedded_file.h"
#include "io/files/json_object.h"
#include "io/files/xml_reader.h"
#include "io/models/model_reader.h"
#include "io/models/model_text.h"

namespace voxtone::embedded {
std::span<const EmbeddedFile> foreign_files();
}

namespace voxtone::io {

namespace {

using namespace std::string_view_literals;

/// Bytes at a place that no other kind has there.
struct Mark {
    std::string bytes;
    std::size_t at = 0;
};

/// What the bytes of a kind may be that has no mark of its own.
enum class Inside : std::uint8_t {
    anything,  ///< an archive, too
    picture,   ///< the bytes of one that can be read, which is not what is meant
    text
};

/// A kind of file that is not read (data/foreign-files.json): what it is called, how names of it end, what to do.
struct Kind {
    std::string id;  ///< of one that the program asks for; else empty
    std::string what, endings, remedy;
    Inside inside = Inside::anything;
    std::vector<Mark> marks;
    std::string root;  ///< element of XML, in small letters; empty: it is none

    [[nodiscard]] bool is(std::string_view wanted) const { return id == wanted; }
};

/// A picture that can be read.
struct KnownPicture {
    std::string what, ending;
    std::vector<Mark> marks;
};

struct ForeignFiles {
    std::vector<Kind> kinds;
    std::vector<KnownPicture> pictures;
};

std::string bytes_of_hex(const std::string& hex) {
    std::string bytes(hex.size() / 2, '\0');
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        unsigned value = 0;
        std::from_chars(hex.data() + 2 * i, hex.data() + 2 * i + 2, value, 16);
        bytes[i] = static_cast<char>(value);
    }
    return bytes;
}

std::vector<Mark> marks_of(const JsonObject& entry) {
    std::vector<Mark> marks;
    if (!entry.has("marks")) return marks;
    for (const JsonObject& mark : entry.objects("marks"))
        marks.push_back({mark.has("hex") ? bytes_of_hex(mark.text("hex")) : mark.text("bytes"),
                         mark.has("at") ? std::size_t(mark.integer("at", 0, kind_bytes)) : 0});
    return marks;
}

ForeignFiles read_foreign_files() {
    const JsonObject file = JsonObject::parse(embedded::foreign_files().front().text, "data/foreign-files.json");
    const JsonObject advice = file.object("advice");
    const auto text = [](const JsonObject& entry, std::string_view key) {
        return entry.has(key) ? entry.text(key) : std::string();
    };
    ForeignFiles files;
    for (const JsonObject& entry : file.objects("kinds")) {
        const std::string remedy = entry.text("advice"), inside = text(entry, "inside");
        files.kinds.push_back({text(entry, "id"), entry.text("what"), text(entry, "endings"),
                               advice.has(remedy) ? advice.text(remedy) : remedy,
                               inside == "picture" ? Inside::picture
                               : inside == "text"  ? Inside::text
                                                   : Inside::anything,
                               marks_of(entry), lower_case(text(entry, "root"))});
    }
    for (const JsonObject& entry : file.objects("pictures"))
        files.pictures.push_back({entry.text("what"), entry.text("ending"), marks_of(entry)});
    return files;
}

const ForeignFiles& foreign_files() {
    static const ForeignFiles read = read_foreign_files();
    return read;
}

const Kind* kind_called(std::string_view id) { return &*std::ranges::find(foreign_files().kinds, id, &Kind::id); }

bool has(std::string_view text, std::string_view bytes, std::size_t at) {
    return text.size() >= at && text.substr(at).starts_with(bytes);
}

bool is_word_of(std::string_view list, std::string_view word) {
    for (std::size_t at = 0; at < list.size();) {
        const std::size_t end = std::min(list.find(' ', at), list.size());
        if (list.substr(at, end - at) == word) return true;
        at = end + 1;
    }
    return false;
}

/// "a.nii.gz" -> "nii.gz", then "gz".
std::vector<std::string> endings_of(const std::string& name) {
    std::vector<std::string> endings;
    const std::string lower = lower_case(name);
    for (std::size_t dot = lower.find('.'); dot != lower.npos; dot = lower.find('.', dot + 1))
        endings.push_back(lower.substr(dot + 1));
    return endings;
}

const Kind* kind_by_name(const std::string& name) {
    for (const std::string& ending : endings_of(name))
        for (const Kind& kind : foreign_files().kinds)
            if (is_word_of(kind.endings, ending)) return &kind;
    return nullptr;
}

const Kind* kind_of_xml(std::string_view text) {
    const std::string_view plain = behind_blanks(text);
    if (lower_case(plain.substr(0, 14)) == "<!doctype html") return kind_called("html");
    const std::string root = lower_case(root_element(text));
    for (const Kind& kind : foreign_files().kinds)
        if (!root.empty() && root == kind.root) return &kind;
    return plain.starts_with("<?xml") && !root.empty() ? kind_called("xml") : nullptr;
}

/// The first line of an IGES file has 80 columns, the last of which count the lines of its start section.
bool is_iges(std::string_view text) { return text.size() > 80 && text.substr(72, 8) == "S      1"; }

/// "MM" and the length of the file.
bool is_3ds(std::string_view text, std::uintmax_t size) {
    if (text.size() < 6 || !text.starts_with("MM")) return false;
    std::uint32_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length |= std::uint32_t{static_cast<unsigned char>(text[2 + i])} << (8 * i);
    return length == size;
}

/// By the names of parts in its beginning, where documents of offices have others.
bool is_3mf(std::string_view text) {
    const auto holds = [&](std::string_view name) { return text.find(name) != text.npos; };
    if (holds("3dmodel.model")) return true;
    return holds("[Content_Types].xml") && !holds("word/") && !holds("ppt/") && !holds("xl/");
}

/// By the name of the first part: archives of models may hold a package as a part.
bool begins_as_3mf(std::string_view text) {
    constexpr std::size_t name_at = 30;
    const std::string_view first = text.substr(std::min(name_at, text.size()));
    return first.starts_with("3D/") || first.starts_with("[Content_Types].xml") || first.starts_with("_rels/");
}

/// What an archive holds, by the names in its beginning.
const Kind* kind_of_zip(std::string_view text) {
    if (is_3mf(text)) return nullptr;
    const std::string_view first = text.size() > 30 ? text.substr(30, 256) : std::string_view();
    for (const std::string_view inner : {".usdc"sv, ".usda"sv, ".usd"sv})
        if (first.find(inner) != first.npos) return kind_called("usd");
    return kind_called("zip");
}

const Kind* kind_by_content(const std::string& name, std::string_view text, std::uintmax_t size) {
    if (text.starts_with("PK\x03\x04")) return kind_of_zip(text);
    if (is_3ds(text, size)) return kind_called("max3ds");
    const std::string_view plain = text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text;
    for (const Kind& kind : foreign_files().kinds)
        for (const Mark& mark : kind.marks)
            if (has(text, mark.bytes, mark.at) || (mark.at == 0 && plain.starts_with(mark.bytes)))
                return kind.is("step") && text.find("IFC") != text.npos ? kind_called("ifc") : &kind;
    if (is_iges(plain)) return kind_called("iges");
    if (const Kind* kind = kind_of_xml(text)) return kind;
    if (plain.starts_with('{') && text.find("voxtone-job") != text.npos) return kind_called("job");
    if ((plain.starts_with('{') || plain.starts_with('[')) && is_model_name(name) && extension_of(name) != "gltf" &&
        text.find("\"asset\"") == text.npos)
        return kind_called("sent");  // JSON
    constexpr std::size_t least_zeros = 512;
    const bool only_zeros = text.find_first_not_of('\0') == text.npos;
    return only_zeros && text.size() >= least_zeros ? kind_called("zeros") : nullptr;
}

/// A line "v 1 2 3".
bool has_vertex_line(std::string_view text) {
    if (text.find('\0') != text.npos) return false;
    TextLines lines(text);
    bool comma = false;
    while (const auto line = lines.next()) {
        std::string_view words = *line;
        if (cut_word(words) != "v") continue;
        for (int i = 0; i < 3; ++i)
            if (!number_of(cut_word(words), comma)) return false;
        return true;
    }
    return false;
}

bool is_binary_stl(std::string_view text, std::uintmax_t size) {
    if (text.size() <= 84) return false;
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < 4; ++i) count |= std::uint64_t{static_cast<unsigned char>(text[80 + i])} << (8 * i);
    return count > 0 && size == 84 + 50 * count;
}

struct ModelKind {
    std::string_view ending, what, other;  ///< another ending of the same
};

/// A model that can be read; nothing where the bytes do not tell.
const ModelKind* model_by_content(std::string_view text, std::uintmax_t size) {
    static constexpr ModelKind glb{"glb", "a GLB model", "gltf"}, gltf{"gltf", "a glTF model", "glb"},
        ply{"ply", "a PLY model", ""}, threemf{"3mf", "a 3MF model", ""}, stl{"stl", "an STL model", ""},
        obj{"obj", "an OBJ model", ""}, fbx{"fbx", "an FBX model", ""}, vrml{"wrl", "a VRML model", "vrml"};
    if (text.starts_with("glTF")) return &glb;
    if (text.starts_with("ply\n") || text.starts_with("ply\r")) return &ply;
    if (text.starts_with("PK\x03\x04")) return kind_of_zip(text) ? nullptr : &threemf;
    const std::string_view plain = behind_blanks(text);
    if (text.starts_with("Kaydara FBX") || plain.starts_with("; FBX")) return &fbx;
    if (plain.starts_with("#VRML")) return &vrml;
    if (plain.starts_with('{') && text.find("\"asset\"") != text.npos) return &gltf;
    if (lower_case(plain.substr(0, 5)) == "solid" && lower_case(text).find("facet") != text.npos) return &stl;
    if (is_binary_stl(text, size)) return &stl;
    return has_vertex_line(text) ? &obj : nullptr;
}

const KnownPicture* picture_by_content(std::string_view text) {
    for (const KnownPicture& picture : foreign_files().pictures)
        for (const Mark& mark : picture.marks)
            if (has(text, mark.bytes, mark.at)) return &picture;
    return nullptr;
}

std::string refusal(const std::string& name, const Kind& kind, Wanted wanted, bool in_spite_of_name) {
    return fmt::format(
        "{} is {}{}, and {} that can be read: {}", name, kind.what, in_spite_of_name ? ", whatever its name says" : "",
        wanted != Wanted::model_or_picture ? "no picture" : "neither a model nor a picture", kind.remedy);
}

std::string stem_of(const std::string& name) { return std::filesystem::path(name).stem().string(); }

}  // namespace

std::string foreign_kind(const std::string& name, std::span<const std::byte> beginning, std::uintmax_t size,
                         Wanted wanted) {
    const std::string_view text(reinterpret_cast<const char*>(beginning.data()), beginning.size());
    const Kind* const named = kind_by_name(name);
    const std::string extension = extension_of(name);
    if (named && named->inside == Inside::picture) return refusal(name, *named, wanted, false);
    if (extension == "stl" && is_binary_stl(text, size)) return {};  // whatever its header says
    const bool is_archive = extension == "zip" && wanted == Wanted::model_or_picture;
    if (is_archive && text.starts_with("PK") && !begins_as_3mf(text)) return {};  // its reader knows what is in it
    if (extension == "3mf" && text.starts_with("PK")) return {};                  // its parser knows what is in it
    if (is_vrml_name(name) && text.starts_with("\x1f\x8b")) return {};            // packed by gzip, as it may be
    const bool may_be_drawn = wanted != Wanted::texture && !is_model_name(name);
    if (may_be_drawn && extension == "svgz" && text.starts_with("\x1f\x8b")) return {};
    if (const KnownPicture* const picture = picture_by_content(text)) {
        if (wanted != Wanted::model_or_picture || !is_model_name(name)) return {};
        return fmt::format(
            "{} is {} by its first bytes and no model: rename it {}.{} to print it as a picture, or give "
            "the model",
            name, picture->what, stem_of(name), picture->ending);
    }
    if (const Kind* const kind = kind_by_content(name, text, size)) {
        if (kind->is("svg") && may_be_drawn) return {};
        const bool packed = kind->is("zip") || kind->is("gzip");
        const bool as_named =
            named && (kind == named || named->remedy == kind->remedy || (packed && named->inside == Inside::anything));
        const bool in_spite = !as_named && (named || is_model_name(name) || is_picture_name(name));
        return refusal(name, as_named ? *named : *kind, wanted, in_spite);
    }
    if (const ModelKind* const model = model_by_content(text, size)) {
        if (wanted != Wanted::model_or_picture) return fmt::format("{} is {} and no picture", name, model->what);
        if (extension == model->ending || (!extension.empty() && extension == model->other)) return {};
        if (model->ending == "wrl" && is_vrml_name(name)) return {};
        return fmt::format("{} is {} by its first bytes, and models are known by their names: rename it {}.{}", name,
                           model->what, stem_of(name), model->ending);
    }
    if (named && named->is("svg") && may_be_drawn) return {};  // its reader says what is wrong with it
    return named && !is_archive ? refusal(name, *named, wanted, false) : std::string();
}

std::string foreign_kind(const std::filesystem::path& file, Wanted wanted) {
    std::vector<std::byte> bytes;
    std::uintmax_t size = 0;
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error)) {
        size = std::filesystem::file_size(file, error);
        std::ifstream in(file, std::ios::binary);
        bytes.resize(kind_bytes);
        in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        bytes.resize(in.bad() ? 0 : static_cast<std::size_t>(in.gcount()));
    }
    return foreign_kind(file.filename().string(), bytes, size, wanted);
}

}  // namespace voxtone::io
