// SPDX-License-Identifier: GPL-3.0-or-later
//
// The picture of the house in HACKING.md is the tree: its floors, its rooms, and the arrows between them. An arrow is
// an #include; one that does not follow from those that are drawn fails here, and so does one that is drawn and not
// there.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "tests/places.h"

namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

const fs::path root = voxtone::test::source_dir();

std::vector<std::string> lines_of(const fs::path& file) {
    std::ifstream in(file);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

struct Place {
    Names rooms;  ///< of a floor
    Names knows;  ///< places of the same height
};

/// The lines of what HACKING.md draws; one that goes on is indented.
std::vector<std::string> drawn_lines() {
    std::vector<std::string> lines;
    bool drawn = false;
    for (const std::string& line : lines_of(root / "HACKING.md")) {
        if (line.starts_with("```")) {
            if (drawn) break;
            drawn = true;
        } else if (drawn && line.starts_with("      ")) {
            lines.back() += line.substr(line.find_first_not_of(' ') - 1);
        } else if (drawn) {
            lines.push_back(line);
        }
    }
    return lines;
}

/// "optics" and "optics/layered" -> what HACKING.md draws.
std::map<std::string, Place> picture() {
    static const std::regex entry(R"(^( *)([a-z_]+)/ .*?(?: knows ([a-z_, ]+))?$)");
    std::map<std::string, Place> places;
    std::string floor;
    for (const std::string& line : drawn_lines()) {
        std::smatch match;
        if (!std::regex_match(line, match, entry)) continue;
        Names knows;
        static const std::regex word("[a-z_]+");
        const std::string list = match[3];
        for (std::sregex_iterator i(list.begin(), list.end(), word), end; i != end; ++i) knows.insert(i->str());
        const std::string name = match[2];
        if (match.length(1) == 0) {
            floor = name;
            places[floor].knows = knows;
        } else if (match.length(1) == 2) {
            places[floor].rooms.insert(name);
            places[floor + "/" + name].knows = knows;
        }
    }
    return places;
}

struct Include {
    std::string text;  ///< what stands between the quotes or brackets
    bool quoted;
};

std::vector<Include> includes_of(const fs::path& file) {
    static const std::regex include(R"(^\s*#\s*include\s+([<"])([^>"]+)[>"].*)");
    std::vector<Include> found;
    for (const std::string& line : lines_of(file)) {
        std::smatch match;
        if (line.find("#") != std::string::npos && std::regex_match(line, match, include))
            found.push_back({match[2], match[1] == "\""});
    }
    return found;
}

struct Source {
    std::string path;  ///< from the root: "optics/layered/phase.h"
    std::string floor, room;
    std::vector<Include> includes;
};

/// Parts of "optics/transport/x.h": floor "optics", room "transport".
Source place_of(const std::string& path) {
    Source source;
    source.path = path;
    const std::size_t first = path.find('/');
    source.floor = path.substr(0, first);
    const std::size_t second = path.find('/', first + 1);
    if (second != std::string::npos) source.room = path.substr(first + 1, second - first - 1);
    return source;
}

const std::vector<Source>& sources() {
    static const std::vector<Source> all = [] {
        std::vector<Source> list;
        for (const auto& [name, place] : picture()) {
            if (name.find('/') != std::string::npos) continue;
            for (const auto& entry : fs::recursive_directory_iterator(root / name)) {
                const std::string ending = entry.path().extension().string();
                if (ending != ".h" && ending != ".cpp") continue;
                list.push_back(place_of(fs::relative(entry.path(), root).generic_string()));
                list.back().includes = includes_of(entry.path());
            }
        }
        std::sort(list.begin(), list.end(), [](const Source& a, const Source& b) { return a.path < b.path; });
        return list;
    }();
    return all;
}

/// The others in quotes are Highway's.
/// Where arrows lead from a place of "" or of "optics/".
Names reached(const std::map<std::string, Place>& places, const std::string& floor, const std::string& from) {
    Names all;
    std::vector<std::string> left{from};
    while (!left.empty()) {
        const auto place = places.find(floor + left.back());
        left.pop_back();
        if (place == places.end()) continue;
        for (const std::string& next : place->second.knows)
            if (all.insert(next).second) left.push_back(next);
    }
    return all;
}

bool of_the_tree(const Include& include) { return include.quoted && !include.text.starts_with("hwy/"); }
std::string unit_of(const std::string& path) { return fs::path(path).replace_extension().generic_string(); }

/// The nodes that lie on a circle.
Names circles(const std::map<std::string, Names>& arrows) {
    // What has no arrow out, or none in, lies on no circle; take such away until nothing changes.
    std::map<std::string, Names> left = arrows;
    for (bool changed = true; changed;) {
        changed = false;
        Names pointed_at;
        for (const auto& [from, to] : left) pointed_at.insert(to.begin(), to.end());
        for (auto i = left.begin(); i != left.end();) {
            Names& to = i->second;
            std::erase_if(to, [&](const std::string& name) { return !left.contains(name) || name == i->first; });
            if (to.empty() || !pointed_at.contains(i->first)) {
                i = left.erase(i);
                changed = true;
            } else {
                ++i;
            }
        }
    }
    Names names;
    for (const auto& [from, to] : left) names.insert(from);
    return names;
}

std::string listed(const Names& names) {
    std::string text;
    for (const std::string& name : names) text += name + " ";
    return text;
}

}  // namespace

TEST_CASE("the picture of the house shows the floors and rooms that there are") {
    const auto places = picture();
    REQUIRE(places.size() > 30);
    for (const auto& [name, place] : places) {
        if (name.find('/') != std::string::npos) continue;
        Names there;
        for (const auto& entry : fs::directory_iterator(root / name))
            if (entry.is_directory()) there.insert(entry.path().filename().string());
        INFO(name << ": drawn " << listed(place.rooms) << ", there " << listed(there));
        CHECK(there == place.rooms);
    }
}

TEST_CASE("a room is no heap") {
    std::map<std::string, Names> units;
    for (const Source& source : sources())
        units[fs::path(source.path).parent_path().generic_string()].insert(unit_of(source.path));
    for (const auto& [folder, names] : units) {
        INFO(folder);
        CHECK(names.size() <= 24u);
    }
}

TEST_CASE("arrows run down only, and follow from those that are drawn") {
    const auto places = picture();
    std::map<std::string, Names> floors, rooms;
    for (const Source& source : sources())
        for (const Include& include : source.includes) {
            if (!of_the_tree(include)) continue;
            const Source to = place_of(include.text);
            INFO(source.path << " includes " << include.text);
            if (to.floor != source.floor) {
                CHECK(reached(places, "", source.floor).contains(to.floor));
                floors[source.floor].insert(to.floor);
            } else if (to.room != source.room) {
                CHECK(reached(places, source.floor + "/", source.room).contains(to.room));
                rooms[source.floor + "/" + source.room].insert(source.floor + "/" + to.room);
            }
        }
    CHECK(listed(circles(floors)).empty());
    CHECK(listed(circles(rooms)).empty());
    for (const auto& [name, place] : places) {
        const bool room = name.find('/') != std::string::npos;
        const std::string floor = room ? name.substr(0, name.find('/') + 1) : "";
        for (const std::string& to : place.knows) {
            INFO(name << " is drawn to know " << to << ", and includes nothing of it");
            CHECK((room ? rooms : floors)[name].contains(floor + to));
        }
    }
}

TEST_CASE("no two files need each other") {
    std::map<std::string, Names> units;
    for (const Source& source : sources())
        for (const Include& include : source.includes)
            if (of_the_tree(include) && unit_of(include.text) != unit_of(source.path))
                units[unit_of(source.path)].insert(unit_of(include.text));
    CHECK(listed(circles(units)).empty());
}

TEST_CASE("includes give the whole path, and the file is there") {
    for (const Source& source : sources())
        for (const Include& include : source.includes) {
            if (!include.quoted || include.text == "hwy/foreach_target.h") continue;
            INFO(source.path << " includes " << include.text);
            CHECK(fs::exists(root / include.text));
        }
}

TEST_CASE("libraries stay in source files: public headers speak plain values") {
    static const std::regex hidden(
        "(nlohmann|openvdb|embree[34]|CGAL|opencv2|ceres|OpenImageIO|assimp|Model/COM|expat|nettle|xxhash)[/.].*|"
        "(zip|png|tiffio|lcms2|expat|xxhash)\\.h");
    for (const Source& source : sources())
        if (source.path.ends_with(".h"))
            for (const Include& include : source.includes) {
                INFO(source.path << " includes " << include.text);
                CHECK(!std::regex_match(include.text, hidden));
            }
}

TEST_CASE("JSON that we write goes through one writer") {
    // A parser of JSON writes it, too, in a form and of names of its own.
    const Names may_parse{"io/files/json_object.cpp", "io/files/json_lines.cpp", "io/codecs/parse_gltf.cpp"};
    static const std::regex parser(R"(#include <nlohmann/.*)");
    for (const Source& source : sources()) {
        if (may_parse.contains(source.path)) continue;
        for (const std::string& line : lines_of(root / source.path)) {
            INFO(source.path);
            CHECK_FALSE(std::regex_match(line, parser));
        }
    }
}

TEST_CASE("a source has its header beside it, and includes it first") {
    for (const Source& source : sources()) {
        if (!source.path.ends_with(".cpp") || source.floor == "cli" || source.path.ends_with("main.cpp")) continue;
        INFO(source.path);
        const std::string header = unit_of(source.path) + ".h";
        CHECK(fs::exists(root / header));
        REQUIRE(!source.includes.empty());
        CHECK(source.includes.front().text == header);
    }
}

TEST_CASE("everything is compiled without fused multiply-adds: the same bits on every machine") {
    std::size_t units = 0;
    for (const std::string& line : lines_of(fs::path(voxtone::test::build_dir()) / "compile_commands.json")) {
        if (line.find("\"command\":") == std::string::npos || line.find("catch_main") != std::string::npos) continue;
        ++units;
        INFO(line);
        CHECK(line.find("-ffp-contract=off") != std::string::npos);
    }
    CHECK(units > 50);
}

TEST_CASE("no path of this machine is compiled in but into two sources: a compiler cache answers for other clones") {
    const std::string here = voxtone::test::source_dir();
    const std::string told = "\"" + here;  // a folder in quotes begins with it: a short one may be a part of another
    std::size_t units = 0;
    for (const std::string& line : lines_of(fs::path(voxtone::test::build_dir()) / "compile_commands.json")) {
        if (line.find("\"command\":") == std::string::npos || line.find("/tests/places.cpp") != std::string::npos ||
            line.find("/screen_data.cpp") != std::string::npos)
            continue;
        ++units;
        INFO(line);
        for (std::size_t at = line.find(" -D"); at != std::string::npos; at = line.find(" -D", at + 1))
            CHECK(line.substr(at, line.find(' ', at + 1) - at).find(told) == std::string::npos);
    }
    CHECK(units > 50);
    for (const std::string& line : lines_of(fs::path(voxtone::test::build_dir()) / "build.ninja"))
        if (line.find("/ccache ") != std::string::npos) {
            INFO(line);
            CHECK(line.find("CCACHE_BASEDIR=" + here + " ") != std::string::npos);
        }
}

/// Types that a file defines outside of unnamed namespaces, with those they lie in. The formatter keeps namespaces at
/// the margin and names their ends.
Names types_of(const fs::path& file) {
    static const std::regex space(R"(^(?:inline )?namespace ([a-z_:0-9]*) ?\{$)"),
        closing(R"(^\}  // (?:inline )?namespace\b.*)"),
        type(
            R"(^(?:class|struct|union|enum class|enum) (?:alignas\([^)]*\) )?([A-Za-z0-9_]+)(?: final)?(?: \{.*| : .*)?$)");
    Names types;
    std::vector<std::string> spaces;
    int number = 0, opened = 0;  // lines
    for (const std::string& line : lines_of(file)) {
        std::smatch match;
        ++number;
        if (std::regex_match(line, match, space)) {
            spaces.push_back(match[1]);
            opened = number;
        }
        // The end of a namespace of one line has no comment.
        const bool short_end = line == "}" && number - opened <= 2;
        if (!spaces.empty() && (short_end || std::regex_match(line, closing))) spaces.pop_back();
        if (line.ends_with(';') && line.find('{') == std::string::npos) continue;  // declared, not defined
        if (!std::regex_match(line, match, type) || std::ranges::find(spaces, "") != spaces.end()) continue;
        std::string name;
        for (const std::string& s : spaces) name += s + "::";
        types.insert(name + match[1].str());
    }
    return types;
}

TEST_CASE("a type of a namespace is defined once: two of one name are undefined behaviour") {
    std::map<std::string, std::string> defined;  // type -> file
    for (const Source& source : sources())
        for (const std::string& type : types_of(root / source.path)) {
            const auto [known, is_new] = defined.try_emplace(type, source.path);
            INFO(type << " is defined in " << source.path << " and in " << known->second);
            CHECK(is_new);
        }
    CHECK(defined.size() > 500);
}

TEST_CASE("a header that stands alone declares nothing that a source must define") {
    // Values, templates and inline functions: every function declared ends in a body, = default, = 0 or is a
    // template's.
    static const std::regex declaration(R"(^(\[\[nodiscard\]\] )?[A-Za-z_:<>,\*&]+ [a-z_]+\(.*\);$)");
    for (const Source& source : sources()) {
        if (!source.path.ends_with(".h") || source.floor == "cli" || fs::exists(root / (unit_of(source.path) + ".cpp")))
            continue;
        for (const std::string& line : lines_of(root / source.path)) {
            INFO(source.path << ": " << line);
            CHECK(!(line.find("inline") == std::string::npos && std::regex_match(line, declaration)));
        }
    }
}

TEST_CASE("tests and benchmarks lie in the rooms that they are about") {
    const auto places = picture();
    for (const char* mirror : {"tests", "benchmarks"})
        for (const auto& entry : fs::directory_iterator(root / mirror)) {
            const std::string floor = entry.path().filename().string();
            // What is read, the fuzzer of all readers and figures belong to no floor alone.
            if (!entry.is_directory() || floor == "data" || floor == "fuzz" || floor == "results") continue;
            INFO(entry.path());
            REQUIRE(places.contains(floor));
            for (const auto& room : fs::directory_iterator(entry.path())) {
                if (!room.is_directory()) continue;
                INFO(room.path());
                CHECK(places.at(floor).rooms.contains(room.path().filename().string()));
            }
        }
}

TEST_CASE("no test has a name that CMake cuts into two, neither of which is there") {
    static const std::regex name(R"re(TEST_CASE\("([^"]*)".*)re");
    for (const auto& entry : fs::recursive_directory_iterator(root / "tests")) {
        if (entry.path().extension() != ".cpp") continue;
        for (const std::string& line : lines_of(entry.path())) {
            std::smatch match;
            if (!line.starts_with("TEST_CASE(") || !std::regex_match(line, match, name)) continue;
            CAPTURE(entry.path().string(), line);
            CHECK(match[1].str().find(';') == std::string::npos);
        }
    }
}

TEST_CASE("every place in the tree that a page names is there") {
    static const std::regex named(
        "`((?:base|optics|io|calibration|halftone|slicer|scattering|farm|cli|tests|benchmarks|data|docs|cmake|tools|"
        "examples)/[A-Za-z0-9_./-]+)`");
    for (auto entry = fs::recursive_directory_iterator(root); entry != fs::recursive_directory_iterator(); ++entry) {
        const std::string path = fs::relative(entry->path(), root).generic_string();
        // What was built, mutated or printed is not the tree.
        if (path == "build" || path == "out" || path == ".git") entry.disable_recursion_pending();
        if (entry->path().extension() != ".md") continue;
        for (const std::string& line : lines_of(entry->path()))
            for (std::sregex_iterator i(line.begin(), line.end(), named), end; i != end; ++i) {
                const std::string place = (*i)[1];
                INFO(path << " names " << place);
                CHECK((fs::exists(root / place) || fs::exists(root / (place + ".h")) ||
                       fs::exists(root / (place + ".cpp"))));
            }
    }
}
