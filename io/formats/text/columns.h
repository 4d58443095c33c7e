#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/core/error.h"
#include "io/formats/text/cells.h"
#include "io/formats/text/rows.h"

// What the columns of a text file are: as the user says, as its header says, or as its numbers look.
namespace lucarne::io::text {

struct Column {
    std::string name;                ///< "x", "red", "nx", "intensity"...; "-" is left out
    std::optional<ScalarType> type;  ///< where it was stated
};

/// Rows from all over a file as numbers, but for those with stray words.
struct Sample {
    size_t columns = 0;
    std::vector<double> values;  ///< row by row; NaN where there is none
    /// Of each column: more than one cell in a hundred is no number. Fewer are damage, and to be told.
    std::vector<bool> words;
    bool whole = true;  ///< every row is there
    size_t rows() const { return columns ? values.size() / columns : 0; }
    double at(size_t row, size_t column) const { return values[row * columns + column]; }
};

/// "x,y,z,-,intensity:f32,r,g,b". Errors (bad arguments): an unknown type, x, y or z missing or named twice.
Result<std::vector<Column>> parse_columns(std::string_view text);
/// The same as our writer says it: every column with its type, under its own name. Nothing where it is not
/// so.
std::optional<std::vector<Column>> written_columns(std::string_view text);

/// What a header's words mean: the names that others use become ours. Nothing where x, y and z are not among
/// them, each once.
std::optional<std::vector<Column>> named_columns(const std::vector<std::string_view>& words);

/// The first three columns of numbers are x, y, z, but for a first one before three of fractions that counts
/// whole numbers up ("id") or of which some are words ("4a"); then what looks like unit normals, colours, an
/// intensity. Of four columns that may be an intensity and colours either way round, those of 0 to 255 are
/// the colours; else the colours stand first, but last in PTS. Columns of words are left out. Nothing where
/// there are no three of numbers.
std::optional<std::vector<Column>> guess_columns(const Sample& sample, bool pts);

/// The records that these columns make: positions double, or float where all three are said to be. Types that
/// are not stated follow from the sample: whole numbers and
/// colours as small as they are, normals float, anything else double. Rows that the sample has not seen fit
/// as well: then colours take 16 bits and numbers of no agreed type are double, but for whole ones that all
/// are over 2^53.
RowLayout make_layout(const std::vector<Column>& columns, const Sample& sample);

/// "x y z intensity:i32 red green blue"; of very many the first.
std::string columns_text(const std::vector<Column>& columns);

/// 8, 16, or 0 where they go from 0 to 1: of the sample's colours.
uint32_t color_bits(const std::vector<Column>& columns, const Sample& sample);

}  // namespace lucarne::io::text
