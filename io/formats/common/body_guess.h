#pragma once

#include <array>
#include <span>

#include "io/files/byte_source.h"
#include "io/points.h"

// Binary bodies of records that are longer than their header says: some writers state floats and write
// doubles, others write the padding of their structures.
namespace lucarne::io {

/// Records as a header describes them, and where they lie.
struct StatedBody {
    uint64_t begin = 0, bytes = 0;      ///< in the file; nothing else may follow the records
    uint64_t count = 0;                 ///< of records
    std::span<const ScalarType> types;  ///< of the values of a record
    std::array<size_t, 3> axes{};       ///< indices of x, y and z
    bool big_endian = false;
};

/// How the records surely differ from their description; at most one of these.
struct BodyGuess {
    bool doubles = false;  ///< every f32 is an f64
    size_t padding = 0;    ///< bytes after each record
    uint64_t more = 0;     ///< records that the count leaves out
};

/// Makes a guess where it is certain: the records fill the body exactly, and a sample from all over the body
/// has coordinates of a usual size only if it is read so, or has the same padding in every record. More
/// records are those that fill the rest of the body exactly and have coordinates of a usual size.
Result<BodyGuess> guess_body(const ByteSource& file, const StatedBody& body);

/// Makes the guess and warns of it. Where there is none, warns of bytes behind the records. More records
/// count only with `salvage`; otherwise the warning names them.
Result<BodyGuess> fit_body(const ByteSource& file, const StatedBody& body, bool salvage);

}  // namespace lucarne::io
