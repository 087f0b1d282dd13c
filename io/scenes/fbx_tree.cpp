// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/scenes/fbx_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include <fmt/format.h>

#include "base/error.h"
#include "base/printable.h"
#include "io/files/base64.h"
#include "io/files/deflate.h"
#include "io/models/model_text.h"

namespace voxtone::io {

namespace {

using namespace std::string_view_literals;

constexpr std::string_view fbx_magic = "Kaydara FBX Binary  \0\x1a"sv;
constexpr std::size_t fbx_header_bytes = 27;
constexpr int most_fbx_levels = 64;

template <class Number>
Number number_at(std::string_view bytes, std::size_t at, bool swapped) {
    std::array<char, sizeof(Number)> raw{};
    std::memcpy(raw.data(), bytes.data() + at, raw.size());
    if (swapped) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<Number>(raw);
}

std::size_t size_of_item(char item) { return item == 'd' || item == 'l' ? 8 : item == 'f' || item == 'i' ? 4 : 1; }

std::int64_t whole_of(double real) {
    return std::abs(real) < 9e15 ? static_cast<std::int64_t>(real) : std::numeric_limits<std::int64_t>::min();
}

/// Records of a binary file: where it ends, how many values of how many bytes, a name; values, then children, of which
/// a record of zeros is the last.
class FbxBinary {
public:
    FbxBinary(std::string_view bytes, const FbxTree& tree, bool wide, bool swapped)
        : bytes_(bytes), tree_(tree), wide_(wide), swapped_(swapped) {}

    FbxNode read() {
        FbxNode root;
        at_ = fbx_header_bytes;
        if (!read_children(root, bytes_.size(), 0)) tree_.fail("it has no end");
        return root;
    }

private:
    template <class Number>
    Number take() {
        need(sizeof(Number));
        const Number number = number_at<Number>(bytes_, at_, swapped_);
        at_ += sizeof(Number);
        return number;
    }
    std::uint64_t take_size() { return wide_ ? take<std::uint64_t>() : take<std::uint32_t>(); }
    std::string_view take_text(std::uint64_t size) {
        need(size);
        at_ += size;
        return bytes_.substr(at_ - size, size);
    }
    void need(std::uint64_t size) const {
        if (size > bytes_.size() - at_) tree_.fail("it ends within a record");
    }

    /// Whether the record of zeros came.
    bool read_children(FbxNode& parent, std::size_t end, int level) {
        if (level > most_fbx_levels) tree_.fail(fmt::format("records are nested more than {} deep", most_fbx_levels));
        while (at_ < end) {
            const std::uint64_t next = take_size(), values = take_size(), size = take_size();
            FbxNode node;
            node.name = take_text(take<std::uint8_t>());
            if (next == 0) return true;
            if (next > end || next < at_ || size > next - at_) tree_.fail("a record reaches beyond its end");
            const std::size_t behind = at_ + size;
            for (std::uint64_t i = 0; i < values; ++i) {
                if (at_ >= behind) tree_.fail("a record has fewer values than it says");
                node.values.push_back(take_value());
            }
            at_ = behind;
            if (at_ < next) read_children(node, next, level + 1);
            at_ = next;
            parent.children.push_back(std::move(node));
        }
        return false;
    }

    FbxValue take_value() {
        FbxValue value;
        const char type = take<char>();
        if (type == 'Y')
            value.integer = take<std::int16_t>();
        else if (type == 'C' || type == 'B' || type == 'Z')
            value.integer = take<std::uint8_t>();
        else if (type == 'I')
            value.integer = take<std::int32_t>();
        else if (type == 'L')
            value.integer = take<std::int64_t>();
        else if (type == 'F' || type == 'D') {
            value.kind = FbxValue::Kind::real;
            value.real = type == 'F' ? static_cast<double>(take<float>()) : take<double>();
            value.integer = whole_of(value.real);
            return value;
        } else if (type == 'S' || type == 'R') {
            value.kind = FbxValue::Kind::text;
            value.text = take_text(take<std::uint32_t>());
        } else if ("fdlibc"sv.find(type) != std::string_view::npos) {
            value.kind = FbxValue::Kind::array;
            value.item = type;
            value.count = take<std::uint32_t>();
            const auto encoding = take<std::uint32_t>(), size = take<std::uint32_t>();
            value.deflated = encoding == 1;
            if (encoding > 1) tree_.fail("an array is packed in an unknown way");
            value.text = take_text(value.deflated ? size : value.count * size_of_item(type));
        } else {
            tree_.fail(fmt::format("a value is of the unknown type '{}'", printable({&type, 1})));
        }
        value.real = static_cast<double>(value.integer);
        return value;
    }

    std::string_view bytes_;
    const FbxTree& tree_;
    const bool wide_, swapped_;
    std::size_t at_ = 0;
};

/// "Name: value, value { children }"; arrays are "*count { a: number, number }".
class FbxText {
public:
    FbxText(std::string_view text, const FbxTree& tree, std::deque<std::string>& unescaped)
        : left_(text), tree_(tree), unescaped_(unescaped) {}

    FbxNode read() {
        FbxNode root;
        read_children(root, 0);
        if (!left_.empty()) fail("a '}' closes nothing");
        return root;
    }

private:
    [[noreturn]] void fail(const std::string& what) const { tree_.fail(fmt::format("line {}: {}", line_, what)); }

    void skip(std::size_t size) {
        line_ += static_cast<std::size_t>(std::ranges::count(left_.substr(0, size), '\n'));
        left_.remove_prefix(size);
    }
    /// Blanks and comments.
    void skip_blanks() {
        for (;;) {
            skip(std::min(left_.find_first_not_of(" \t\r\n\0"sv), left_.size()));
            if (!left_.starts_with(';')) return;
            left_.remove_prefix(std::min(left_.find('\n'), left_.size()));
        }
    }
    bool skip_char(char c) {
        skip_blanks();
        if (!left_.starts_with(c)) return false;
        left_.remove_prefix(1);
        return true;
    }
    /// The word that is next, and is left there.
    [[nodiscard]] std::string_view word() const {
        return left_.substr(0, std::min(left_.find_first_of(" \t\r\n,:;{}\"*"), left_.size()));
    }
    /// Names end with a colon; nothing where a value is next.
    [[nodiscard]] std::string_view name() const {
        const std::string_view found = word();
        const std::size_t colon = left_.find_first_not_of(" \t", found.size());
        return !found.empty() && colon != left_.npos && left_[colon] == ':' ? found : std::string_view();
    }

    void read_children(FbxNode& parent, int level) {
        if (level > most_fbx_levels) fail(fmt::format("nodes are nested more than {} deep", most_fbx_levels));
        for (skip_blanks(); !left_.empty() && left_.front() != '}'; skip_blanks()) {
            FbxNode node;
            node.name = name();
            if (node.name.empty()) fail(fmt::format("a name is wanted where '{}' stands", printable(word())));
            left_.remove_prefix(node.name.size());
            (void)skip_char(':');
            read_values(node);
            if (skip_char('{')) {
                read_children(node, level + 1);
                if (!skip_char('}')) fail("'{' has no end");
            }
            parent.children.push_back(std::move(node));
        }
    }

    void read_values(FbxNode& node) {
        for (;;) {
            skip_blanks();
            if (left_.empty() || left_.front() == '{' || left_.front() == '}' || !name().empty()) return;
            if (left_.front() == ',')
                left_.remove_prefix(1);
            else
                node.values.push_back(value());
        }
    }

    FbxValue value() {
        FbxValue made;
        if (left_.front() == '"') {
            made.kind = FbxValue::Kind::text;
            const std::size_t end = left_.find('"', 1);
            if (end == left_.npos) fail("a text has no end");
            made.text = unescaped(left_.substr(1, end - 1));
            skip(end + 1);
        } else if (left_.front() == '*') {
            left_.remove_prefix(1);
            made = array();
        } else {
            const std::string_view found = word();
            const char *const first = found.data(), *const last = first + found.size();
            if (found.empty()) fail("a value is wanted");
            left_.remove_prefix(found.size());
            const auto whole = std::from_chars(first, last, made.integer);
            made.real = static_cast<double>(made.integer);
            if (whole.ec == std::errc() && whole.ptr == last) return made;
            const auto real = std::from_chars(first, last, made.real);
            made.kind = real.ptr == last && real.ec == std::errc() ? FbxValue::Kind::real : FbxValue::Kind::text;
            made.integer = made.kind == FbxValue::Kind::real ? whole_of(made.real) : 0;
            made.text = found;
        }
        return made;
    }

    FbxValue array() {
        FbxValue made;
        made.kind = FbxValue::Kind::array;
        made.item = 't';
        const std::string_view count = word();
        if (std::from_chars(count.data(), count.data() + count.size(), made.count).ec != std::errc())
            fail("an array does not say how many it holds");
        left_.remove_prefix(count.size());
        const bool opened = skip_char('{');
        const std::size_t colon = left_.find(':'), end = left_.find('}');
        if (!opened || end == left_.npos) fail("an array has no end");
        if (colon < end) made.text = left_.substr(colon + 1, end - colon - 1);
        skip(end + 1);
        return made;
    }

    std::string_view unescaped(std::string_view text) {
        constexpr std::array<std::array<std::string_view, 2>, 6> marks{
            {{"&quot;", "\""}, {"&cr;", "\r"}, {"&lf;", "\n"}, {"&lt;", "<"}, {"&gt;", ">"}, {"&amp;", "&"}}};
        if (text.find('&') == text.npos) return text;
        std::string& made = unescaped_.emplace_back();
        for (std::size_t at = 0; at < text.size();) {
            const auto mark =
                std::ranges::find_if(marks, [&](const auto& m) { return text.substr(at).starts_with(m[0]); });
            made += mark == marks.end() ? text.substr(at, 1) : (*mark)[1];
            at += mark == marks.end() ? 1 : (*mark)[0].size();
        }
        return made;
    }

    std::string_view left_;
    const FbxTree& tree_;
    std::deque<std::string>& unescaped_;
    std::size_t line_ = 1;
};

}  // namespace

const FbxNode* FbxNode::child(std::string_view wanted) const {
    const auto found = std::ranges::find(children, wanted, &FbxNode::name);
    return found == children.end() ? nullptr : &*found;
}

std::int64_t FbxNode::integer(std::size_t place) const { return place < values.size() ? values[place].integer : 0; }

double FbxNode::real(std::size_t place) const { return place < values.size() ? values[place].real : 0; }

std::string_view FbxNode::text(std::size_t place) const {
    return place < values.size() && values[place].kind == FbxValue::Kind::text ? values[place].text
                                                                               : std::string_view();
}

void FbxTree::fail(const std::string& what) const {
    throw InputError(fmt::format("{} is an FBX file that is damaged or cut short: {}; export it again", file_, what));
}

void FbxTree::check_version(std::int64_t version) const {
    constexpr std::int64_t oldest = 7000;  // FBX 2011
    if (version <= 0) fail("it does not say its version");
    if (version < oldest)
        throw InputError(fmt::format(
            "{} is an FBX file of version {}, and only those from 7000 on (FBX 2011) can be read; export it as FBX "
            "2013 or later, GLB or OBJ",
            file_, version));
}

FbxTree::FbxTree(std::span<const std::byte> bytes, const std::string& file, std::uint64_t most_unpacked)
    : file_(file), left_to_unpack_(most_unpacked) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with(fbx_magic.substr(0, 11))) {
        read_binary(bytes);
        return;
    }
    is_text_ = true;
    converted_ = model_text(bytes);
    if (converted_.find("FBXHeaderExtension") == converted_.npos)
        throw InputError(fmt::format("{} is no FBX file, or was cut short; export it again", file_));
    root_ = FbxText(converted_, *this, unescaped_).read();
    const FbxNode* const header = root_.child("FBXHeaderExtension");
    const FbxNode* const version = header ? header->child("FBXVersion") : nullptr;
    check_version(version ? version->integer(0) : 0);
}

void FbxTree::read_binary(std::span<const std::byte> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.size() < fbx_header_bytes || !text.starts_with(fbx_magic)) fail("its header is cut short");
    swapped_ = text[fbx_magic.size()] != 0;  // the highest byte first
    const auto version = number_at<std::uint32_t>(text, fbx_magic.size() + 1, swapped_);
    check_version(version);
    constexpr std::uint32_t wide_from = 7500;
    root_ = FbxBinary(text, *this, version >= wide_from, swapped_).read();
}

template <class Number>
std::vector<Number> FbxTree::numbers(const FbxNode* node) {
    std::vector<Number> all;
    if (!node || node->values.empty()) return all;
    const FbxValue& value = node->values.front();
    if (value.kind != FbxValue::Kind::array) {  // as older writers have them
        for (const FbxValue& one : node->values)
            all.push_back(std::is_floating_point_v<Number> ? static_cast<Number>(one.real)
                                                           : static_cast<Number>(one.integer));
        return all;
    }
    const std::size_t wide = value.item == 't' ? 1 : size_of_item(value.item);
    if (value.count > left_to_unpack_ / std::max(wide, sizeof(Number)))
        throw InputError(fmt::format("{} unpacks to more bytes than are allowed; export it with fewer faces", file_));
    left_to_unpack_ -= value.count * std::max(wide, sizeof(Number));
    if (value.item == 't') {
        std::string_view text = value.text;
        while (all.size() < value.count) {
            text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n,"), text.size()));
            if (text.starts_with(';')) {  // a comment
                text.remove_prefix(std::min(text.find('\n'), text.size()));
                continue;
            }
            const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n,;"));
            if (word.empty()) fail(fmt::format("'{}' has fewer numbers than it says", printable(node->name)));
            double real = std::numeric_limits<double>::quiet_NaN();
            (void)std::from_chars(word.data(), word.data() + word.size(), real);
            all.push_back(std::is_floating_point_v<Number> ? static_cast<Number>(real)
                                                           : static_cast<Number>(whole_of(real)));
            text.remove_prefix(word.size());
        }
        return all;
    }
    std::vector<std::byte> unpacked;
    std::string_view items = value.text;
    if (value.deflated) {
        try {
            unpacked = inflated({reinterpret_cast<const std::byte*>(items.data()), items.size()}, value.count * wide);
        } catch (const InputError& error) {
            fail(fmt::format("the array '{}' {}", printable(node->name), error.what()));
        }
        items = {reinterpret_cast<const char*>(unpacked.data()), unpacked.size()};
    }
    all.reserve(value.count);
    for (std::size_t i = 0; i < value.count; ++i) {
        const std::size_t at = i * wide;
        if (value.item == 'd' || value.item == 'f') {
            const double real = value.item == 'd' ? number_at<double>(items, at, swapped_)
                                                  : static_cast<double>(number_at<float>(items, at, swapped_));
            all.push_back(std::is_floating_point_v<Number> ? static_cast<Number>(real)
                                                           : static_cast<Number>(whole_of(real)));
        } else {
            all.push_back(static_cast<Number>(value.item == 'l'   ? number_at<std::int64_t>(items, at, swapped_)
                                              : value.item == 'i' ? number_at<std::int32_t>(items, at, swapped_)
                                                                  : number_at<std::int8_t>(items, at, swapped_)));
        }
    }
    return all;
}

std::vector<double> FbxTree::reals(const FbxNode* node) { return numbers<double>(node); }

std::vector<std::int64_t> FbxTree::integers(const FbxNode* node) { return numbers<std::int64_t>(node); }

std::vector<std::byte> FbxTree::content(const FbxNode* node) const {
    std::string all;
    if (node)
        for (const FbxValue& value : node->values)
            if (value.kind == FbxValue::Kind::text) all += value.text;
    if (is_text_) return base64_bytes(all);
    const auto* const first = reinterpret_cast<const std::byte*>(all.data());
    return {first, first + all.size()};
}

}  // namespace voxtone::io
