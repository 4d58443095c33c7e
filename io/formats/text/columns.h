#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/core/error.h"
#include "io/formats/text/cells.h"
#include "io/formats/text/rows.h"

// What the columns of a text file are: as the user says, as its header says, or as its numbers suggest.
namespace lucarne::io::text {

struct Column {
    std::string name;                ///< "x", "red", "nx", "intensity"...; "-" leaves it out
    std::optional<ScalarType> type;  ///< if it was stated
};

/// Rows from all over a file as numbers, without rows that hold words where others hold numbers.
struct Sample {
    size_t columns = 0;
    std::vector<double> values;  ///< row by row; NaN for a cell without a number
    /// For each column, whether more than one cell in a hundred is no number. Fewer such cells count as
    /// damage, which is reported.
    std::vector<bool> words;
    bool whole = true;      ///< the sample holds every row of the file
    std::string no_number;  ///< the first cell that says_no_number; empty if there is none
    size_t rows() const { return columns ? values.size() / columns : 0; }
    double at(size_t row, size_t column) const { return values[row * columns + column]; }
};

/// Parses "x,y,z,-,intensity:f32,r,g,b". Errors (bad arguments): an unknown type, x, y or z missing or named
/// twice.
Result<std::vector<Column>> parse_columns(std::string_view text);
/// Parses the columns as Lucarne's own writer states them: every column with its type, under its own name.
/// Returns nothing if the text has another form.
std::optional<std::vector<Column>> written_columns(std::string_view text);

/// Interprets the words of a header: names that other programs use become Lucarne's. Returns nothing unless
/// x, y and z are among them exactly once each.
std::optional<std::vector<Column>> named_columns(const std::vector<std::string_view>& words);

/// The unit of length that the names of x, y and z state in brackets: "X (mm)", "Easting [US ft]".
struct AxisUnit {
    std::optional<double> metres;
    std::string problem;  ///< what the user must know: degrees, a unit that is not known, or different units
};
/// `columns` are the named_columns of `words`.
AxisUnit axis_unit(const std::vector<std::string_view>& words, const std::vector<Column>& columns);

/// Guesses the columns. The first three columns of numbers are x, y, z. A first column before three columns
/// of fractions is skipped if it counts up in whole numbers ("id") or if some of its cells are words ("4a").
/// Then follow columns that look like unit normals, colours, an intensity. If an intensity and three colours
/// may be in either order, the values from 0 to 255 are the colours; if that does not decide, colours come
/// first, but last in PTS. Columns of words are left out. Returns nothing if there are not three columns of
/// numbers.
std::optional<std::vector<Column>> guess_columns(const Sample& sample, bool pts);

/// Returns the record layout for these columns. Positions are double, or float if all three are stated to be.
/// Types that are not stated follow from the sample: whole numbers and colours get their smallest type,
/// normals float, everything else double. Rows outside the sample must fit as well. So if the sample does not
/// hold every row, colours take 16 bits and numbers without a fixed type are double, except whole numbers
/// that all exceed 2^53.
RowLayout make_layout(const std::vector<Column>& columns, const Sample& sample);

/// Returns "x y z intensity:i32 red green blue"; shortened if there are very many columns.
std::string columns_text(const std::vector<Column>& columns);

/// Returns the number of colour bits, from the sample's colours: 8, 16, or 0 if they range from 0 to 1.
uint32_t color_bits(const std::vector<Column>& columns, const Sample& sample);

}  // namespace lucarne::io::text
