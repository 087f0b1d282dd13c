// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/scenes/vrml_tree.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <map>
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "base/printable.h"

namespace voxtone::io {

namespace {

enum class VrmlToken : char { end, bracket, number, string, word };

class VrmlReader {
public:
    VrmlReader(std::string_view text, const std::string& file) : left_(text), file_(file) { next(); }

    VrmlScene scene() {
        while (token_ != VrmlToken::end) {
            if (passes_over()) continue;
            scene_.roots.push_back(node(0));
        }
        return std::move(scene_);
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}, line {}: {}; the VRML file is damaged or cut short, export it again", file_,
                                     line_, printable(what)));
    }

    // ---- words

    /// Blanks, commas and comments.
    void skip_blanks() {
        while (!left_.empty()) {
            const char c = left_.front();
            if (c == '#') {
                left_.remove_prefix(std::min(left_.find_first_of("\r\n"), left_.size()));
            } else if (static_cast<unsigned char>(c) <= ' ' || c == ',') {
                line_ += c == '\n';
                left_.remove_prefix(1);
            } else {
                return;
            }
        }
    }

    void next() {
        skip_blanks();
        if (left_.empty()) {
            token_ = VrmlToken::end;
            text_ = {};
            return;
        }
        if (left_.front() == '"') return string();
        std::size_t length = 1;
        token_ = VrmlToken::bracket;
        if (std::string_view("{}[]").find(left_.front()) == std::string_view::npos) {
            while (length < left_.size() && static_cast<unsigned char>(left_[length]) > ' ' &&
                   std::string_view("{}[]\",#").find(left_[length]) == std::string_view::npos)
                ++length;
            token_ = is_number(left_.substr(0, length)) ? VrmlToken::number : VrmlToken::word;
        }
        text_ = left_.substr(0, length);
        left_.remove_prefix(length);
    }

    void string() {
        token_ = VrmlToken::string;
        text_ = "a string";
        string_.clear();
        for (std::size_t at = 1; at < left_.size(); ++at) {
            if (left_[at] == '"') return left_.remove_prefix(at + 1);
            line_ += left_[at] == '\n';
            if (left_[at] == '\\' && at + 1 < left_.size()) ++at;
            string_ += left_[at];
        }
        fail("a string has no end");
    }

    /// "0xFF" too, as pixels are written.
    bool is_number(std::string_view word) {
        if (word.front() == '+') word.remove_prefix(1);
        const char* const last = word.data() + word.size();
        if (word.starts_with("0x") || word.starts_with("0X")) {
            std::uint64_t whole = 0;
            const auto [end, error] = std::from_chars(word.data() + 2, last, whole, 16);
            number_ = static_cast<double>(whole);
            return error == std::errc() && end == last;
        }
        const auto [end, error] = std::from_chars(word.data(), last, number_);
        if (error == std::errc::result_out_of_range) number_ = std::strtod(std::string(word).c_str(), nullptr);
        return error != std::errc::invalid_argument && end == last;
    }

    [[nodiscard]] bool is_bracket(char which) const { return token_ == VrmlToken::bracket && text_.front() == which; }
    [[nodiscard]] bool is_word(std::string_view which) const { return token_ == VrmlToken::word && text_ == which; }

    std::string_view word(const char* what) {
        if (token_ != VrmlToken::word)
            fail(fmt::format("{} is wanted where {} stands", what,
                             token_ == VrmlToken::end ? "its end" : "'" + std::string(text_) + "'"));
        const std::string_view taken = text_;
        next();
        return taken;
    }

    // ---- what is passed over

    /// From a bracket to the one that closes it.
    void skip_brackets(char open) {
        if (!is_bracket(open)) fail(fmt::format("'{}' is wanted", open));
        int depth = 0;
        do {
            if (token_ == VrmlToken::end) fail(fmt::format("'{}' has no end", open));
            if (is_bracket('{') || is_bracket('[')) ++depth;
            if (is_bracket('}') || is_bracket(']')) --depth;
            next();
        } while (depth > 0);
    }

    bool passes_over() {
        if (is_word("ROUTE")) {  // from TO to
            next();
            for (int i = 0; i < 3; ++i) (void)word("a name");
            return true;
        }
        const bool elsewhere = is_word("EXTERNPROTO");
        if (!elsewhere && !is_word("PROTO")) return false;
        next();
        prototypes_.insert(word("a name"));
        skip_brackets('[');
        if (!elsewhere)
            skip_brackets('{');
        else if (token_ == VrmlToken::string)
            next();
        else
            skip_brackets('[');
        return true;
    }

    // ---- nodes

    std::uint32_t node(int level) {
        if (level > most_vrml_levels) fail(fmt::format("nodes are nested more than {} deep", most_vrml_levels));
        if (is_word("USE")) {
            next();
            const std::string_view name = word("a name");
            const auto found = named_.find(name);
            if (found == named_.end()) fail(fmt::format("USE names '{}', and no node before it has that name", name));
            return found->second;
        }
        std::string_view name;
        if (is_word("DEF")) {
            next();
            name = word("a name");
        }
        VrmlNode made{{}, name, line_, {}};
        made.type = word("a node");
        if (prototypes_.contains(made.type))
            throw InputError(
                fmt::format("{}, line {}: '{}' is a prototype of its own (PROTO), and these are not read; export the "
                            "model without them",
                            file_, made.line, printable(made.type)));
        if (!is_bracket('{')) fail(fmt::format("'{{' is wanted behind '{}'", made.type));
        next();
        while (!is_bracket('}')) {
            if (passes_over()) continue;
            add_field(made, level);
        }
        next();
        scene_.nodes.push_back(std::move(made));
        const auto index = static_cast<std::uint32_t>(scene_.nodes.size() - 1);
        if (!name.empty()) named_[name] = index;  // known from its end on, so that none is part of itself
        return index;
    }

    void add_field(VrmlNode& node, int level) {
        std::string_view name = word("a field");
        // Of a script: its interface stands among its fields.
        const bool of_script = name == "field" || name == "exposedField",
                   event = name == "eventIn" || name == "eventOut";
        if (of_script || event) {
            (void)word("a type");
            name = word("a name");
        }
        if (is_word("IS")) {
            next();
            (void)word("a name");
            return;
        }
        if (event) return;
        VrmlField field;
        field.name = name;
        values(field, level);
        node.fields.push_back(std::move(field));
    }

    void values(VrmlField& field, int level) {
        if (!is_bracket('[')) {
            const bool number = token_ == VrmlToken::number;
            do value(field, level);
            while (number && token_ == VrmlToken::number);
            return;
        }
        next();
        while (!is_bracket(']')) value(field, level);
        next();
    }

    void value(VrmlField& field, int level) {
        if (token_ == VrmlToken::number)
            field.numbers.push_back(number_);
        else if (token_ == VrmlToken::string)
            field.strings.push_back(std::move(string_));
        else if (is_word("TRUE") || is_word("FALSE"))
            field.numbers.push_back(text_ == "TRUE");
        else if (!is_word("NULL"))
            return field.nodes.push_back(node(level + 1));
        next();
    }

    std::string_view left_;
    const std::string& file_;
    std::size_t line_ = 1;
    VrmlToken token_ = VrmlToken::end;
    std::string_view text_;
    std::string string_;
    double number_ = 0;
    VrmlScene scene_;
    std::map<std::string_view, std::uint32_t> named_;
    std::set<std::string_view> prototypes_;
};

}  // namespace

const VrmlField* VrmlNode::field(std::string_view wanted) const {
    const auto found = std::find_if(fields.rbegin(), fields.rend(), [&](const auto& f) { return f.name == wanted; });
    return found == fields.rend() ? nullptr : &*found;
}

double VrmlNode::number(std::string_view wanted, double otherwise) const {
    const std::vector<double>& all = numbers(wanted);
    return all.empty() ? otherwise : all.front();
}

const std::vector<double>& VrmlNode::numbers(std::string_view wanted) const {
    static const std::vector<double> none;
    const VrmlField* const found = field(wanted);
    return found ? found->numbers : none;
}

const VrmlNode* VrmlScene::node(const VrmlNode& parent, std::string_view field) const {
    const VrmlField* const found = parent.field(field);
    return found && !found->nodes.empty() ? &nodes[found->nodes.front()] : nullptr;
}

VrmlScene read_vrml(std::string_view text, const std::string& file) { return VrmlReader(text, file).scene(); }

}  // namespace voxtone::io
