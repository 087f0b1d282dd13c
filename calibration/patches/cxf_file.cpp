// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/patches/cxf_file.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "calibration/tables/table_cells.h"
#include "io/files/xml_reader.h"

namespace voxtone::calibration {

namespace {

constexpr std::size_t most_objects = 4 * most_chart_patches, most_roles_of_object = 64;

// Values under one ColorSpecification.
struct CxfValues {
    std::string specification;
    std::optional<double> start_nm;
    std::vector<double> values;
};

struct CxfObject {
    std::string type, name, place = {};
    PatchMixture mixture = {};  // percent, as written
    bool device_rgb = false;
    std::optional<CxfValues> spectrum = {}, lab = {}, xyz = {};
    [[nodiscard]] bool measured() const { return spectrum || lab || xyz; }
};

struct CxfSpecification {
    MeasuringConditions conditions;
    std::optional<double> start_nm, increment_nm;
};

struct CxfContent {
    std::vector<CxfObject> objects;
    std::map<std::string, CxfSpecification> specifications;
};

std::string role_of_spot(const std::string& name) {
    const std::string capitals = in_capitals(name);
    return capitals == "WHITE" ? "W" : capitals == "CLEAR" ? "T" : name;
}

// Collects what is wanted, element by element.
class CxfParser {
public:
    CxfParser(std::string_view text, const std::string& source) : xml_(text, source), source_(source) {}

    CxfContent read() {
        for (auto event = xml_.next(); event != io::XmlReader::Event::finished; event = xml_.next()) {
            if (event == io::XmlReader::Event::end) {
                open_.pop_back();
                continue;
            }
            if (open_.empty() && xml_.name() != "CxF")
                throw InputError(
                    fmt::format("{}: is XML, but its root is {}, not CxF; export the chart as CxF3, CGATS text or CSV.",
                                source_, shown(xml_.name())));
            open_.push_back(xml_.name());
            start();
        }
        if (!any_) throw InputError(fmt::format("{}: is XML without an element; export it again.", source_));
        return std::move(content_);
    }

private:
    bool inside(std::string_view name) const { return std::ranges::find(open_, name) != open_.end(); }
    std::string_view parent() const { return open_.size() < 2 ? std::string_view() : open_[open_.size() - 2]; }
    std::string attribute(std::string_view name) const { return std::string(xml_.attribute(name)); }

    std::string text() const {
        const std::string_view whole = xml_.text();
        const std::size_t from = whole.find_first_not_of(" \t\r\n");
        if (from == std::string_view::npos) return {};
        return io::XmlReader::decode(whole.substr(from, whole.find_last_not_of(" \t\r\n") - from + 1));
    }

    double number_here(std::string_view written) const {
        const auto value = number_with_comma(trimmed(written));
        if (!value) xml_.fail(fmt::format("{} in {} is no number", shown(written), open_.back()));
        return *value;
    }
    std::optional<double> number_attribute(std::string_view name) const {
        const std::string_view value = xml_.attribute(name);
        return value.data() == nullptr ? std::nullopt : std::optional(number_here(value));
    }

    void start() {
        any_ = true;
        const std::string_view name = open_.back();
        if (name == "Object") {
            if (content_.objects.size() >= most_objects) xml_.fail(fmt::format("more than {} objects", most_objects));
            content_.objects.push_back({.type = attribute("ObjectType"), .name = attribute("Name")});
            if (content_.objects.back().name.empty()) content_.objects.back().name = attribute("Id");
        } else if (name == "ColorSpecification") {
            specification_ = &content_.specifications[attribute("Id")];
        } else if (inside("Object")) {
            CxfObject& object = content_.objects.back();
            if (inside("DeviceColorValues"))
                device_value(object, name);
            else if (inside("ColorValues"))
                measured_value(object, name);
            else if (name == "Tag" && parent() == "TagCollection")
                object.place += fmt::format("{}={};", attribute("Name"), attribute("Value"));
            else if (name == "TagCollection")
                object.place.clear();
        } else if (specification_ && inside("ColorSpecification")) {
            specification(*specification_, name);
        }
    }

    void device_value(CxfObject& object, std::string_view name) const {
        static constexpr std::array<std::pair<std::string_view, const char*>, 4> process{
            {{"Cyan", "C"}, {"Magenta", "M"}, {"Yellow", "Y"}, {"Black", "K"}}};
        if (name == "ColorRGB" || name == "ColorSRGB" || name == "ColorAdobeRGB") object.device_rgb = true;
        if (parent() == "ColorCMYK" || parent() == "ColorCMYKPlusN")
            for (const auto& [element, role] : process)
                if (name == element) add_share(object, role, number_here(text()));
        if (name == "SpotColor") {
            add_share(object, role_of_spot(attribute("Name")), number_attribute("Percentage").value_or(0));
        } else if (parent() == "SpotColor" && !object.mixture.empty()) {
            if (name == "Name") object.mixture.back().role = role_of_spot(text());
            if (name == "Percentage") object.mixture.back().fraction = number_here(text());
        }
    }

    void add_share(CxfObject& object, std::string role, double percent) const {
        if (object.mixture.size() >= most_roles_of_object)
            xml_.fail(fmt::format("more than {} colorants in object {}", most_roles_of_object, shown(object.name)));
        object.mixture.push_back({std::move(role), percent});
    }

    void measured_value(CxfObject& object, std::string_view name) const {
        if (name == "ReflectanceSpectrum" && !object.spectrum) {
            object.spectrum = {attribute("ColorSpecification"), number_attribute("StartWL"), {}};
            const std::string values = text();
            for (std::size_t from = values.find_first_not_of(blanks); from < values.size();) {
                const std::size_t to = std::min(values.find_first_of(blanks, from), values.size());
                object.spectrum->values.push_back(number_here(std::string_view(values).substr(from, to - from)));
                from = values.find_first_not_of(blanks, to);
            }
        }
        if (name == "ColorCIELab" && !object.lab) object.lab = {attribute("ColorSpecification"), {}, {}};
        if (name == "ColorCIEXYZ" && !object.xyz) object.xyz = {attribute("ColorSpecification"), {}, {}};
        if (parent() == "ColorCIELab" && object.lab) coordinate(object.lab->values, std::string_view("LAB").find(name));
        if (parent() == "ColorCIEXYZ" && object.xyz) coordinate(object.xyz->values, std::string_view("XYZ").find(name));
    }

    // A second colour of the object is left out: its coordinates come when three are there.
    void coordinate(std::vector<double>& values, std::size_t index) const {
        if (open_.back().size() == 1 && index == values.size() && index < 3) values.push_back(number_here(text()));
    }

    void specification(CxfSpecification& specification, std::string_view name) const {
        if (parent() == "TristimulusSpec") note_condition(specification.conditions, name, text());
        if (name == "WavelengthRange") {
            specification.start_nm = number_attribute("StartWL");
            specification.increment_nm = number_attribute("Increment");
        }
    }

    static constexpr const char* blanks = " \t\r\n";
    io::XmlReader xml_;
    std::string source_;
    std::vector<std::string_view> open_;
    CxfContent content_;
    CxfSpecification* specification_ = nullptr;
    bool any_ = false;
};

// Makes rows of objects: pairs them, and decides what of their measurements is taken.
class CxfChart {
public:
    CxfChart(CxfContent content, const std::string& source) : content_(std::move(content)), source_(source) {
        reading_.table.source = source;
    }

    ChartReading read() {
        pair_objects();
        if (pairs_.empty()) fail_for_want_of_pairs();
        take_one_kind();
        choose_quantity();
        bool white = false;
        for (const Pair& pair : pairs_) {
            add(pair);
            white = white || std::ranges::any_of(pair.mixture->mixture, [](const auto& s) { return s.role == "W"; });
        }
        reading_.rest_is_white = !white;
        std::set<std::string> inks;
        for (const Pair& pair : pairs_)
            for (const ResinShare& share : pair.mixture->mixture) inks.insert(share.role);
        reading_.inks = inks.size();
        return std::move(reading_);
    }

private:
    struct Pair {
        const CxfObject *mixture, *measured;
    };

    [[noreturn]] void fail(const std::string& what) const { throw InputError(fmt::format("{}: {}.", source_, what)); }
    static std::string called(const CxfObject& object) { return fmt::format("object {}", shown(object.name)); }

    void pair_objects() {
        std::map<std::string, const CxfObject*> by_place, by_name;
        for (const CxfObject& object : content_.objects) {
            if (object.mixture.empty()) continue;
            if (!object.place.empty()) by_place.try_emplace(object.place, &object);
            by_name.try_emplace(object.name, &object);
        }
        std::size_t alone = 0;
        for (const CxfObject& object : content_.objects) {
            if (!object.measured()) continue;
            const CxfObject* mixture = object.mixture.empty() ? nullptr : &object;
            if (const auto found = by_place.find(object.place); !mixture && found != by_place.end())
                mixture = found->second;
            if (const auto found = by_name.find(object.name); !mixture && found != by_name.end())
                mixture = found->second;
            if (mixture)
                pairs_.push_back({mixture, &object});
            else
                ++alone;
        }
        if (alone > 0 && !pairs_.empty())
            reading_.table.notes.push_back(
                fmt::format("{}: {} measured objects have no mixture and are left out.", source_, alone));
    }

    [[noreturn]] void fail_for_want_of_pairs() const {
        if (std::ranges::none_of(content_.objects, &CxfObject::measured))
            fail(
                "is no measured chart: no object has a ReflectanceSpectrum, ColorCIELab or ColorCIEXYZ; print it, "
                "measure it, and export the measurement");
        if (std::ranges::any_of(content_.objects, &CxfObject::device_rgb))
            fail(
                "its patches are given as RGB of a device, which says nothing of the resins that the printer mixed; "
                "give the shares of all resins as ColorCMYKPlusN, or in a table with columns such as W,C,M,Y,K");
        fail(
            "no measured object says its mixture by ColorCMYK or ColorCMYKPlusN; give the shares of all resins there, "
            "or "
            "in a table with columns such as W,C,M,Y,K");
    }

    // What a chart aims at may stand beside what was measured of it.
    static bool is_aim(const std::string& type) {
        constexpr std::string_view aims[] = {"TARGET", "STANDARD", "REFERENCE"};
        return std::ranges::find(aims, in_capitals(type)) != std::end(aims);
    }

    void take_one_kind() {
        const auto measured =
            std::ranges::find_if_not(pairs_, [](const Pair& pair) { return is_aim(pair.measured->type); });
        const std::string kind = (measured == pairs_.end() ? pairs_.front() : *measured).measured->type;
        if (is_aim(kind))
            reading_.table.notes.push_back(fmt::format(
                "{}: its colours stand in objects of the type {}, which may be what the chart aims at; they are taken "
                "as measured.",
                source_, shown(kind)));
        const std::size_t all = pairs_.size();
        std::erase_if(pairs_, [&](const Pair& pair) { return pair.measured->type != kind; });
        if (pairs_.size() < all)
            reading_.table.notes.push_back(
                fmt::format("{}: patches are measured in several ways; {} is taken.", source_, shown(kind)));
    }

    void choose_quantity() {
        const auto all_have = [&](auto member) {
            return std::ranges::all_of(pairs_, [&](const Pair& p) { return (p.measured->*member).has_value(); });
        };
        if (all_have(&CxfObject::spectrum))
            reading_.quantity = Quantity::spectrum;
        else if (all_have(&CxfObject::lab))
            reading_.quantity = Quantity::lab;
        else if (all_have(&CxfObject::xyz))
            reading_.quantity = Quantity::xyz;
        else
            fail("not all objects are measured alike; export spectra, or L, a, b, of all");
    }

    const CxfSpecification& specification_of(const CxfValues& values) const {
        static const CxfSpecification none;
        const auto found = content_.specifications.find(values.specification);
        if (found != content_.specifications.end()) return found->second;
        // A file of one specification need not name it.
        return content_.specifications.size() == 1 ? content_.specifications.begin()->second : none;
    }

    void add(const Pair& pair) {
        if (reading_.table.patches.size() >= most_chart_patches)
            fail(fmt::format("more than {} patches", most_chart_patches));
        Patch patch;
        patch.where = fmt::format("{}: {}", source_, called(*pair.measured));
        patch.top = pair.mixture->mixture;
        for (std::size_t k = 0; k < patch.top.size(); ++k) {
            const std::string& role = patch.top[k].role;
            if (!is_role(role))
                fail(fmt::format("{}: the colorant {} is no role of a resin, a short word such as C or W",
                                 called(*pair.mixture), shown(role)));
            for (std::size_t other = 0; other < k; ++other)
                if (patch.top[other].role == role)
                    fail(fmt::format("{}: the colorant {} is there twice", called(*pair.mixture), role));
        }
        const CxfValues& values = reading_.quantity == Quantity::spectrum ? *pair.measured->spectrum
                                  : reading_.quantity == Quantity::lab    ? *pair.measured->lab
                                                                          : *pair.measured->xyz;
        const CxfSpecification& specification = specification_of(values);
        if (reading_.quantity == Quantity::spectrum)
            check_wavelengths(*pair.measured, values, specification);
        else
            check_conditions(*pair.measured, values, specification);
        patch.rho = values.values;
        reading_.table.patches.push_back(std::move(patch));
    }

    void check_wavelengths(const CxfObject& object, const CxfValues& values, const CxfSpecification& specification) {
        const auto start = values.start_nm ? values.start_nm : specification.start_nm;
        if (!start || !specification.increment_nm)
            fail(
                fmt::format("{}: nothing says the wavelengths of its spectrum; its ColorSpecification must have a "
                            "WavelengthRange with StartWL and Increment",
                            called(object)));
        if (!(*start >= 300 && *start <= 1100 && *specification.increment_nm >= 0.1 &&
              *specification.increment_nm <= 100) ||
            values.values.empty())
            fail(
                fmt::format("{}: its spectrum has {} values from {} nm in steps of {} nm; expected steps of 0.1 to 100 "
                            "nm from 300 nm or above",
                            called(object), values.values.size(), *start, *specification.increment_nm));
        std::vector<double> nm;
        for (std::size_t k = 0; k < values.values.size(); ++k)
            nm.push_back(*start + *specification.increment_nm * static_cast<double>(k));
        if (reading_.table.patches.empty()) reading_.table.channels.wavelengths_nm = nm;
        if (reading_.table.channels.wavelengths_nm != nm)
            fail(fmt::format("{} and {} have other wavelengths; export all spectra with the same",
                             called(*pairs_.front().measured), called(object)));
    }

    void check_conditions(const CxfObject& object, const CxfValues& values, const CxfSpecification& specification) {
        if (values.values.size() != 3)
            fail(fmt::format("{}: of its three coordinates some are missing; export it again", called(object)));
        const MeasuringConditions& conditions = specification.conditions;
        if (reading_.table.patches.empty()) reading_.conditions = conditions;
        if (conditions.illuminant != reading_.conditions.illuminant ||
            conditions.observer != reading_.conditions.observer)
            fail(fmt::format("{} and {} are under other illuminants or observers; export all under the same",
                             called(*pairs_.front().measured), called(object)));
    }

    CxfContent content_;
    std::string source_;
    std::vector<Pair> pairs_;
    ChartReading reading_;
};

}  // namespace

bool is_xml(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && text[first] == '<';
}

ChartReading read_cxf(std::string_view text, const std::string& source) {
    return CxfChart(CxfParser(text, source).read(), source).read();
}

}  // namespace voxtone::calibration
