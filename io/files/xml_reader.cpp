// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/xml_reader.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <system_error>

#include <fmt/format.h>

#include "base/error.h"
#include "io/files/utf8.h"

namespace voxtone::io {

namespace {

constexpr std::size_t deepest_element = 256, longest_reference = 12;
// Each element looks through them; the programs that write 3MF declare up to a dozen.
constexpr std::size_t most_declarations = 256;

bool blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool ends_name(char c) { return blank(c) || c == '/' || c == '>' || c == '=' || c == '<' || c == '"' || c == '\''; }

/// The character that "amp" or "#x41" means; 0: none. Halves of UTF-16 pairs are no characters.
std::uint32_t referenced(std::string_view entity) {
    if (entity == "amp") return '&';
    if (entity == "lt") return '<';
    if (entity == "gt") return '>';
    if (entity == "quot") return '"';
    if (entity == "apos") return '\'';
    if (!entity.starts_with('#')) return 0;
    const bool hexadecimal = entity.starts_with("#x");
    entity.remove_prefix(hexadecimal ? 2 : 1);
    std::uint32_t code = 0;
    const char* const end = entity.data() + entity.size();
    const auto [rest, error] = std::from_chars(entity.data(), end, code, hexadecimal ? 16 : 10);
    if (error != std::errc{} || rest != end) return 0;
    return code < 0x110000 && (code < 0xd800 || code > 0xdfff) ? code : 0;
}

}  // namespace

std::string_view behind_blanks(std::string_view text) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    return text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
}

std::string_view root_element(std::string_view text) {
    text = behind_blanks(text);
    // "]" ends what a document type declares in itself.
    while (text.starts_with("<?") || text.starts_with("<!") || text.starts_with(']')) {
        const std::string_view end = text.starts_with("<!--") ? "-->" : ">";
        const std::size_t at = text.find(end);
        if (at == text.npos) return {};
        text = behind_blanks(text.substr(at + end.size()));
    }
    if (!text.starts_with('<')) return {};
    text.remove_prefix(1);
    text = text.substr(0, text.find_first_of(" \t\r\n/>"));
    return text.substr(text.rfind(':') + 1);  // npos + 1 is 0
}

XmlReader::XmlReader(std::string_view text, std::string what) : text_(text), what_(std::move(what)) {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;
    if (text_.starts_with("\xff\xfe") || text_.starts_with("\xfe\xff")) fail("it is in UTF-16, only UTF-8 can be read");
}

void XmlReader::fail(const std::string& what) const {
    const auto line =
        1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(std::min(at_, text_.size())), '\n');
    throw InputError(fmt::format("{}, line {}: {}; the file is damaged, export it again", what_, line, what));
}

void XmlReader::skip_past(std::string_view mark) {
    const std::size_t found = text_.find(mark, at_);
    if (found == std::string_view::npos) fail("it is cut short");
    at_ = found + mark.size();
}

void XmlReader::skip_blanks() {
    while (at_ < text_.size() && blank(text_[at_])) ++at_;
}

std::string_view XmlReader::read_name() {
    const std::size_t first = at_;
    while (at_ < text_.size() && !ends_name(text_[at_])) ++at_;
    if (at_ == first) fail("a name is missing");
    return text_.substr(first, at_ - first);
}

XmlReader::Event XmlReader::next() {
    if (ended_) {
        open_.pop_back();
        while (!declarations_.empty() && declarations_.back().depth > open_.size()) declarations_.pop_back();
        ended_ = false;
    }
    if (closes_) {
        closes_ = false;
        ended_ = true;
        return Event::end;
    }
    for (;;) {
        at_ = std::min(text_.find('<', at_), text_.size());
        depth_ = open_.size();
        if (at_ == text_.size()) {
            if (!open_.empty()) fail(fmt::format("it is cut short inside <{}>", open_.back()));
            return Event::finished;
        }
        const std::string_view rest = text_.substr(at_);
        if (rest.starts_with("<!--")) {
            skip_past("-->");
        } else if (rest.starts_with("<![CDATA[")) {
            skip_past("]]>");
        } else if (rest.starts_with("<?")) {
            skip_past("?>");
        } else if (rest.starts_with("<!")) {
            fail("it has a document type declaration, which is not allowed here");
        } else if (rest.starts_with("</")) {
            at_ += 2;
            name_ = read_name();
            skip_past(">");
            if (open_.empty() || open_.back() != name_) fail(fmt::format("</{}> closes nothing", name_));
            ended_ = true;
            return Event::end;
        } else {
            read_start();
            return Event::start;
        }
    }
}

void XmlReader::read_start() {
    ++at_;
    name_ = read_name();
    attributes_.clear();
    for (;;) {
        skip_blanks();
        if (at_ >= text_.size()) fail("it is cut short");
        if (text_[at_] == '>') {
            ++at_;
            break;
        }
        if (text_[at_] == '/') {
            if (at_ + 1 >= text_.size() || text_[at_ + 1] != '>') fail("a '/' stands alone");
            at_ += 2;
            closes_ = true;
            break;
        }
        const std::string_view key = read_name();
        skip_blanks();
        if (at_ >= text_.size() || text_[at_] != '=') fail(fmt::format("the attribute {} has no value", key));
        ++at_;
        skip_blanks();
        if (at_ >= text_.size() || (text_[at_] != '"' && text_[at_] != '\''))
            fail(fmt::format("the value of {} has no quotes", key));
        const char quote = text_[at_++];
        const std::size_t end = text_.find(quote, at_);
        if (end == std::string_view::npos) fail("it is cut short");
        std::string_view value = text_.substr(at_, end - at_);
        if (value.find('&') != std::string_view::npos) value = decoded_.emplace_back(decode(value));
        attributes_.emplace_back(key, value);
        if (key.starts_with("xmlns")) declare(key, attributes_.back().second);
        at_ = end + 1;
    }
    open_.push_back(name_);
    depth_ = open_.size();
    if (depth_ > deepest_element) fail("its elements are nested too deep");
}

/// Of the element that is being read, which is not open yet.
void XmlReader::declare(std::string_view attribute, std::string_view uri) {
    if (attribute != "xmlns" && !attribute.starts_with("xmlns:")) return;
    if (declarations_.size() == most_declarations)
        fail(fmt::format("it has more than {} namespaces", most_declarations));
    declarations_.push_back({attribute == "xmlns" ? std::string_view() : local(attribute), uri, open_.size() + 1});
}

std::string_view XmlReader::meaning(std::string_view prefix) const {
    for (auto declared = declarations_.rbegin(); declared != declarations_.rend(); ++declared)
        if (declared->prefix == prefix) return declared->uri;
    return prefix;
}

std::string_view XmlReader::attribute(std::string_view local_name) const {
    for (const auto& [key, value] : attributes_)
        if (key == local_name ||
            (key.ends_with(local_name) && local(key) == local_name && attribute_namespace(key) == namespace_uri()))
            return value.empty() ? std::string_view("") : value;
    return {};
}

std::string_view XmlReader::text() const {
    if (closes_) return {};
    return text_.substr(at_, std::min(text_.find('<', at_), text_.size()) - at_);
}

std::string XmlReader::decode(std::string_view value) {
    std::string out;
    for (std::size_t i = 0; i < value.size(); ++i) {
        // Looked for no further than a reference can be long: a value of many ampersands takes no longer than others.
        const std::size_t length =
            value[i] == '&' ? value.substr(i + 1, longest_reference + 1).find(';') : std::string_view::npos;
        if (length == std::string_view::npos) {
            out += value[i];
            continue;
        }
        const std::uint32_t code = referenced(value.substr(i + 1, length));
        if (code == 0) {
            out += value[i];
            continue;
        }
        append_utf8(out, code);
        i += length + 1;
    }
    return out;
}

}  // namespace voxtone::io
