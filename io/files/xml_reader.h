// SPDX-License-Identifier: GPL-3.0-or-later
//
// A pull parser for XML as data files use it: elements, attributes and plain text in UTF-8, with namespaces. No DTD is
// accepted (so no entity can expand). Works in place, in time proportional to the text.
// Based on: T. Bray et al., "Namespaces in XML 1.0", third edition, W3C 2009. Laxer than it where a prefix is declared
// nowhere, which is an error there.
//
// Why not expat: it calls back, which turns its callers inside out, and hands every attribute of millions of vertices
// over as a copy that ends in 0; what it has more (DTDs, encodings) is what must be refused here. Why not pugixml: it
// would hold a model of 2 GB as a tree.
#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace voxtone::io {

/// Behind a byte order mark and blanks.
[[nodiscard]] std::string_view behind_blanks(std::string_view text);

/// Of the first element of XML, without its prefix, behind declarations, comments and document type; empty where there
/// is none. The beginning of a text is enough.
[[nodiscard]] std::string_view root_element(std::string_view text);

class XmlReader {
public:
    enum class Event { start, end, finished };

    /// `text` must outlive the reader; `what` names the file in errors.
    XmlReader(std::string_view text, std::string what);

    /// The next start or end of an element; an empty element gives both. Throws InputError naming the line when the
    /// text is not well-formed.
    Event next();

    /// Name of the element, with and without its prefix.
    [[nodiscard]] std::string_view full_name() const { return name_; }
    [[nodiscard]] std::string_view name() const { return local(name_); }
    /// What the element's prefix is declared as, or the default; empty: nothing. A prefix that is declared nowhere
    /// stands for itself.
    [[nodiscard]] std::string_view namespace_uri() const { return meaning(prefix(name_)); }
    /// How many elements are open, this one included (at its end too).
    [[nodiscard]] std::size_t depth() const { return depth_; }

    /// Attributes of the start that was read last: names with prefixes, values with their character
    /// references resolved.
    [[nodiscard]] const std::vector<std::pair<std::string_view, std::string_view>>& attributes() const {
        return attributes_;
    }
    /// Value of the attribute with this name that belongs to the element: without prefix, or with one of the element's
    /// namespace. data() == nullptr: none.
    [[nodiscard]] std::string_view attribute(std::string_view local_name) const;
    /// An attribute's name without its prefix.
    [[nodiscard]] static std::string_view local(std::string_view name) {
        const std::size_t colon = name.find(':');
        return colon == std::string_view::npos ? name : name.substr(colon + 1);
    }
    /// The namespace of an attribute of this name: the element's where it has no prefix.
    [[nodiscard]] std::string_view attribute_namespace(std::string_view full_name) const {
        return full_name.find(':') == std::string_view::npos ? namespace_uri() : meaning(prefix(full_name));
    }
    /// What a prefix is declared as at the element; itself where it is declared nowhere. Empty: the default.
    [[nodiscard]] std::string_view meaning(std::string_view prefix) const;

    /// What stands behind the start that was read last, as written, up to the next mark.
    [[nodiscard]] std::string_view text() const;

    /// Text with its character references resolved; one that is not known stays as it is.
    [[nodiscard]] static std::string decode(std::string_view value);

    [[noreturn]] void fail(const std::string& what) const;

private:
    static std::string_view prefix(std::string_view name) {
        const std::size_t colon = name.find(':');
        return colon == std::string_view::npos ? std::string_view() : name.substr(0, colon);
    }
    void declare(std::string_view attribute, std::string_view uri);
    void skip_past(std::string_view mark);
    void skip_blanks();
    std::string_view read_name();
    void read_start();

    std::string_view text_;
    std::string what_;
    std::size_t at_ = 0, depth_ = 0;
    bool closes_ = false, ended_ = false;  // the last start was an empty element; the last event was an end
    std::string_view name_;
    std::vector<std::string_view> open_;
    struct Declaration {
        std::string_view prefix, uri;
        std::size_t depth;  // of the element that it stands in
    };
    std::vector<Declaration> declarations_;  // of the elements that are open
    std::deque<std::string> decoded_;        // values that do not stand in the text as they are
    std::vector<std::pair<std::string_view, std::string_view>> attributes_;
};

}  // namespace voxtone::io
