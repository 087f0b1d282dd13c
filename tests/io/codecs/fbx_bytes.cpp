// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/io/codecs/fbx_bytes.h"

#include <cstddef>
#include <span>

#include "io/files/deflate.h"

namespace voxtone::test {

namespace {

template <class Value>
std::string little(Value value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

template <class Value>
std::string array_of(char type, const std::vector<Value>& values, bool packed) {
    const auto bytes = std::as_bytes(std::span(values));
    std::string inside(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (packed) {
        const std::vector<std::byte> small = io::deflated(bytes, 6);
        inside.assign(reinterpret_cast<const char*>(small.data()), small.size());
    }
    return type + little(static_cast<std::uint32_t>(values.size())) + little(std::uint32_t{packed}) +
           little(static_cast<std::uint32_t>(inside.size())) + inside;
}

std::string size_of(std::size_t size, bool wide) {
    return wide ? little(std::uint64_t{size}) : little(static_cast<std::uint32_t>(size));
}

std::string record_at(const FbxRecord& record, std::size_t at, bool wide) {
    const std::size_t header = 3 * (wide ? 8 : 4) + 1 + record.name.size();
    std::string values, children;
    for (const std::string& value : record.values) values += value;
    for (const FbxRecord& child : record.children)
        children += record_at(child, at + header + values.size() + children.size(), wide);
    if (!record.children.empty()) children += std::string(3 * (wide ? 8 : 4) + 1, '\0');
    return size_of(at + header + values.size() + children.size(), wide) + size_of(record.values.size(), wide) +
           size_of(values.size(), wide) + static_cast<char>(record.name.size()) + record.name + values + children;
}

}  // namespace

std::string fbx_number(std::int64_t value) { return 'L' + little(value); }

std::string fbx_number(double value) { return 'D' + little(value); }

std::string fbx_text(const std::string& value) {
    return 'S' + little(static_cast<std::uint32_t>(value.size())) + value;
}

std::string fbx_reals(const std::vector<double>& values, bool packed) { return array_of('d', values, packed); }

std::string fbx_indices(const std::vector<std::int32_t>& values, bool packed) { return array_of('i', values, packed); }

FbxRecord fbx_property(const std::string& name, const std::vector<double>& values) {
    FbxRecord record{"P", {fbx_text(name), fbx_text(""), fbx_text(""), fbx_text("A")}};
    for (const double value : values) record.values.push_back(fbx_number(value));
    return record;
}

FbxRecord fbx_word(const std::string& name, const std::string& value) {
    return {"P", {fbx_text(name), fbx_text("KString"), fbx_text(""), fbx_text(""), fbx_text(value)}};
}

FbxRecord fbx_object(const std::string& type, std::int64_t id, const std::string& name, const std::string& kind,
                     const std::vector<FbxRecord>& properties, std::vector<FbxRecord> children) {
    const std::string whole = name + std::string("\0\1", 2) + type;
    FbxRecord record{type, {fbx_number(id), fbx_text(whole), fbx_text(kind)}, std::move(children)};
    if (!properties.empty()) record.children.push_back({"Properties70", {}, properties});
    return record;
}

FbxRecord fbx_link(std::int64_t child, std::int64_t parent, const std::string& property) {
    FbxRecord record{"C", {fbx_text(property.empty() ? "OO" : "OP"), fbx_number(child), fbx_number(parent)}};
    if (!property.empty()) record.values.push_back(fbx_text(property));
    return record;
}

std::string fbx_file(const std::vector<FbxRecord>& records, std::uint32_t version) {
    const bool wide = version >= 7500;
    std::string file = std::string("Kaydara FBX Binary  \0\x1a\0", 23) + little(version);
    for (const FbxRecord& record : records) file += record_at(record, file.size(), wide);
    return file + std::string(wide ? 25 : 13, '\0') + "footer";
}

std::string fbx_scene(const std::vector<FbxRecord>& settings, const std::vector<FbxRecord>& objects,
                      const std::vector<FbxRecord>& links, std::uint32_t version) {
    return fbx_file({{"GlobalSettings", {}, {{"Properties70", {}, settings}}},
                     {"Objects", {}, objects},
                     {"Connections", {}, links}},
                    version);
}

}  // namespace voxtone::test
