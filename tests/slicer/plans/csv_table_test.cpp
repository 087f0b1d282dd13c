// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plans/csv_table.h"

#include <catch2/catch.hpp>

using namespace voxtone::slicer;
using Catch::Matchers::Contains;
using Cells = std::vector<std::string>;

TEST_CASE("A table is taken apart as RFC 4180 says") {
    const CsvTable table = parse_csv("model,name\r\na.obj,\"one, \"\"two\"\"\"\r\n\"b\r\nc.obj\",x\r\nd.obj,\r\n");
    CHECK(table.faults.empty());
    CHECK(table.header == Cells{"model", "name"});
    REQUIRE(table.rows.size() == 3);
    CHECK(table.rows[0].cells == Cells{"a.obj", "one, \"two\""});
    CHECK(table.rows[0].line == 2);
    CHECK(table.rows[1].cells == Cells{"b\r\nc.obj", "x"});
    CHECK(table.rows[2].cells == Cells{"d.obj", ""});
    CHECK(table.rows[2].line == 5);
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
}

TEST_CASE("A header says what each column is, once") {
    CHECK_THAT(parse_csv("model;size\na;1\n").faults.at(0), Contains("line 1: ") && Contains("semicolons"));
    CHECK_THAT(parse_csv("model,size,model\n").faults.at(0), Contains("'model' twice"));
    CHECK_THAT(parse_csv("model,,size\n").faults.at(0), Contains("column 2"));
    CHECK(parse_csv("").header.empty());
}

TEST_CASE("A table cut short anywhere is read to its end") {
    const std::string whole = "# x\nmodel,name\r\n\"a\nb\",\"c\"\"d\"\ne,f\n";
    for (std::size_t size = 0; size <= whole.size(); ++size) {
        const CsvTable table = parse_csv(std::string_view(whole).substr(0, size));
        for (const CsvRow& row : table.rows) CHECK(row.cells.size() == table.header.size());
    }
}
