// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/csv_table.h"

#include <algorithm>
#include <fstream>

#include <catch2/catch.hpp>

#include "io/files/utf8.h"
#include "tests/io/files/temporary_folder.h"

using namespace voxtone::io;
using Catch::Matchers::Contains;
using Cells = std::vector<std::string>;

namespace {

/// ASCII as Windows programs write it when one asks for "Unicode".
std::string in_utf16(const std::string& text, bool little, bool mark) {
    std::string bytes = !mark ? "" : little ? "\xFF\xFE" : "\xFE\xFF";
    for (const char c : text) bytes += little ? std::string{c, '\0'} : std::string{'\0', c};
    return bytes;
}

std::vector<Cells> rows_of(CsvReader& reader) {
    std::vector<Cells> rows;
    CsvRow row;
    for (std::string fault; reader.next(row, fault);) rows.push_back(fault.empty() ? row.cells : Cells{fault});
    return rows;
}

}  // namespace

TEST_CASE("A table is taken apart as RFC 4180 says") {
    const CsvTable table =
        parse_csv("model,name\r\na.obj,\"one, \"\"two\"\"\"\r\n\"b\r\nc\rd\ne.obj\",x\r\nd.obj,\r\n");
    CHECK(table.faults.empty());
    CHECK(table.header == Cells{"model", "name"});
    REQUIRE(table.rows.size() == 3);
    CHECK(table.rows[0].cells == Cells{"a.obj", "one, \"two\""});
    CHECK(table.rows[0].line == 2);
    CHECK(table.rows[1].cells == Cells{"b\nc\nd\ne.obj", "x"});  // a label's line breaks are LF alone
    CHECK(table.rows[2].cells == Cells{"d.obj", ""});
    CHECK(table.rows[2].line == 7);
}

TEST_CASE("Blank lines, comments, a byte order mark and blanks around cells are no cells") {
    const CsvTable table =
        parse_csv("\xEF\xBB\xBF# what is printed on Monday\n\n model , size\n  \n# a.obj,1mm\nb.obj , \"60mm\" \n\n");
    CHECK(table.faults.empty());
    CHECK(table.header == Cells{"model", "size"});
    REQUIRE(table.rows.size() == 1);
    CHECK(table.rows[0].cells == Cells{"b.obj", "60mm"});
    CHECK(table.rows[0].line == 6);
}

TEST_CASE("Every line that is no row is told, and the others are read") {
    const CsvTable table =
        parse_csv("model,size\na.obj\nb.obj,1mm,2mm\nc.obj,1\"\n\"d.obj\" x,1mm\ne.obj,1mm\n\"f.obj,1mm\ng.obj,1mm\n");
    REQUIRE(table.faults.size() == 5);
    CHECK_THAT(table.faults[0], Contains("line 2: has 1 cell, and the header has 2"));
    CHECK_THAT(table.faults[1], Contains("line 3: has 3 cells"));
    CHECK_THAT(table.faults[2], Contains("line 4: ") && Contains("quote within"));
    CHECK_THAT(table.faults[3], Contains("line 5: ") && Contains("behind a closing quote"));
    CHECK_THAT(table.faults[4], Contains("line 7: ") && Contains("never closed"));
    REQUIRE(table.rows.size() == 2);
    CHECK(table.rows[0].cells == Cells{"e.obj", "1mm"});
    CHECK(table.rows[1].cells == Cells{"g.obj", "1mm"});
    CHECK_THAT(parse_csv("a;b\n1;2;3\n").faults.at(0), Contains("3 cells") && !Contains("comma"));
}

TEST_CASE("A header says what each column is, once") {
    CHECK_THAT(parse_csv("model,size,model\n").faults.at(0), Contains("'model' twice"));
    CHECK_THAT(parse_csv("model,,size\na,x,1mm\n").faults.at(0), Contains("line 2: ") && Contains("column 2"));
    CHECK_THAT(parse_csv("model,size,\na,1mm,x\n").faults.at(0), Contains("column 3"));
    CHECK(parse_csv("").header.empty());
}

TEST_CASE("Columns without a name and a value, and rows of empty cells, are what spreadsheets leave behind") {
    for (const char* text : {"model,copies,\na,2,\n,,\n", "model,copies\na,2,,,\n,\n,,,,,\n", "model,copies,,\na,2\n",
                             "model,,copies\na,,2\n", "model;copies;\na;2;\n;;\n", "model\tcopies\t\na\t2\t\n\t\t\n"}) {
        CAPTURE(text);
        const CsvTable table = parse_csv(text);
        CHECK(table.faults.empty());
        CHECK(table.header == Cells{"model", "copies"});
        REQUIRE(table.rows.size() == 1);
        CHECK(table.rows[0].cells == Cells{"a", "2"});
    }
}

TEST_CASE("Separators are those of the header, or what a first line tells") {
    for (const char* text : {"model;label\na;\"x;y, z\"\n", "model\tlabel\na\tx;y, z\n", "model,label\na,\"x;y, z\"\n",
                             "\"model\";\"label\"\n\"a\";\"x;y, z\"\n", "model,\tlabel\na,\t\"x;y, z\"\n",
                             "\xEF\xBB\xBFmodel;label\na;\"x;y, z\"\n"}) {
        CAPTURE(text);
        const CsvTable table = parse_csv(text);
        CHECK(table.header == Cells{"model", "label"});
        REQUIRE(table.rows.size() == 1);
        CHECK(table.rows[0].cells == Cells{"a", "x;y, z"});
    }
    for (const char* first : {"sep=;\n", "\"sep=;\"\n", "sep=;;;\n", "\nsep=;\n"})
        CHECK(parse_csv(std::string(first) + "model;copies\na;2\n").rows.at(0).cells == Cells{"a", "2"});
    CHECK(parse_csv("sep=,\na;b,c\n1,2\n").header == Cells{"a;b", "c"});
    CHECK(parse_csv("sep=\t\na,x\tc\n1\t2\n").header == Cells{"a,x", "c"});
    CHECK(parse_csv("a\n1\n2\n").rows.size() == 2);
    CHECK(parse_csv("a\rb\r\rc\r").rows.size() == 2);  // lines of old Macs
    CHECK(parse_csv("a\rb\r\rc\r").rows[1].line == 4);
}

TEST_CASE("Lenient rules keep quotes where they stand and names as they are") {
    CsvReader reader("name,L,L,,\n5\" proof,1,2,3,note\n\"5\" x,1,2,3,\n\"a\"\"b\",1,2,3\n\"open,1,2,3\n",
                     CsvRules::lenient);
    CHECK(reader.header().cells == Cells{"name", "L", "L"});
    const auto rows = rows_of(reader);
    REQUIRE(rows.size() == 4);
    CHECK(rows[0] == Cells{"5\" proof", "1", "2"});
    CHECK(rows[1] == Cells{"\"5\" x", "1", "2"});
    CHECK(rows[2] == Cells{"a\"b", "1", "2"});
    CHECK(rows[3] == Cells{"\"open", "1", "2"});
}

TEST_CASE("A header may stand below lines of another kind, and comments are kept") {
    const auto wanted = [](const Cells& cells) { return std::ranges::find(cells, "L") != cells.end(); };
    CsvReader reader(
        "Measured 2026-11-02, CM-700d, SCI\n# illuminant: D65;;\n\n\"a \"\"title\n\"# observer: 2, "
        "x\"\nW;L\n1;90\n#last\n",
        CsvRules::lenient, wanted);
    CHECK(reader.header().cells == Cells{"W", "L"});
    CHECK(reader.header().line == 6);
    CHECK(reader.separator() == ';');
    CHECK(reader.lines_above() == 2);
    CHECK(rows_of(reader) == std::vector<Cells>{{"1", "90"}});
    CHECK(reader.comments().size() == 3);
    CHECK(reader.comments().at(0) == "illuminant: D65");
    CHECK(reader.comments().at(1) == "observer: 2, x");
    // Where no line can be one, the first is it, so that what is wrong with it is told.
    CsvReader none("a,b\nc,d\n", CsvRules::lenient, wanted);
    CHECK(none.header().cells == Cells{"a", "b"});
    CHECK(none.lines_above() == 0);
    CHECK(rows_of(none).size() == 1);
}

TEST_CASE("A table cut short anywhere is read to its end") {
    for (const std::string& whole : {std::string("# x\nmodel,name\r\n\"a\nb\",\"c\"\"d\"\ne,f\n"),
                                     std::string("sep=;\rmodel;name;\r\n\"a\r\nb\";\"c\"\"d\"\r\ne;f;;\r\n")})
        for (std::size_t size = 0; size <= whole.size(); ++size) {
            const CsvTable table = parse_csv(std::string_view(whole).substr(0, size));
            for (const CsvRow& row : table.rows) CHECK(row.cells.size() == table.header.size());
        }
    // Time grows with the text, whatever it holds.
    CHECK(parse_csv(std::string(1 << 21, '\t')).header.empty());
    CHECK(parse_csv(std::string(1 << 21, '"')).rows.empty());
    CHECK(parse_csv("a\n" + std::string(1 << 21, '\r')).rows.empty());
}

TEST_CASE("Texts in UTF-16 become UTF-8, and others stay as they are") {
    const std::string text = "model;size\r\na.obj;6mm\r\n";
    for (const bool little : {true, false})
        for (const bool mark : {true, false}) CHECK(text_as_utf8(in_utf16(text, little, mark)) == text);
    CHECK(text_as_utf8("\xEF\xBB\xBF" + text) == text);
    CHECK(text_as_utf8("Gr\xF6\xDF"
                       "e") ==
          "Gr\xF6\xDF"
          "e");
    CHECK(text_as_utf8(std::string_view("\xFF\xFE\xFC\x00\x3D\xD8\x00\xDE", 8)) == "\xC3\xBC\xF0\x9F\x98\x80");
    // Halves of pairs, and half a character.
    CHECK(text_as_utf8(std::string_view("\xFF\xFE\x3D\xD8"
                                        "a\0",
                                        6)) ==
          "\xEF\xBF\xBD"
          "a");
    CHECK(text_as_utf8(std::string_view("\xFF\xFE\x00\xDE"
                                        "a",
                                        5)) == "\xEF\xBF\xBD\xEF\xBF\xBD");
    CHECK(text_as_utf8("").empty());
    CHECK(text_as_utf8("\xFF\xFE").empty());
    const std::string utf16 = in_utf16(text, true, true);
    for (std::size_t size = 0; size < utf16.size(); ++size) CHECK_NOTHROW(text_as_utf8(utf16.substr(0, size)));
}

TEST_CASE("Tables are known by their names, those of a spreadsheet's text by their header") {
    const TemporaryFolder folder;
    const auto file = [&](const std::string& name, const std::string& text) {
        std::ofstream(folder.path() / name, std::ios::binary) << text;
        return folder.path() / name;
    };
    for (const char* name : {"none.csv", "none.CSV", "none.tsv", "none.tab"})
        CHECK(is_table_file(folder.path() / name, "model"));
    for (const char* name : {"none.txt", "none.json", "none", "csv"})
        CHECK_FALSE(is_table_file(folder.path() / name, "model"));
    CHECK(is_table_file(file("a.txt", in_utf16("model\tcopies\r\na.obj\t2\r\n", true, true)), "model"));
    CHECK_FALSE(is_table_file(file("b.txt", "{\"model\": \"a.obj\"}\n"), "model"));
    CHECK_FALSE(is_table_file(file("c.txt", "Dear all, the model is late\n"), "model"));
}
