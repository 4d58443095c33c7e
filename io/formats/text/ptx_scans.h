#pragma once

#include <memory>
#include <vector>

#include "io/formats/text/rows.h"

// The scans of a PTX file: their headers, and where their rows are.
namespace lucarne::io::ptx {

struct Scan {
    uint64_t promised = 0;  ///< rows, by the header
    uint64_t rows = 0;      ///< rows from `begin` to `end`; those that do not fit are not counted
    text::RowLayout::Pose pose;
    glm::dvec3 station{0.0};
    uint64_t begin = 0, end = 0, first_line = 0;
    size_t values = 0;  ///< per row: 3, 4 or 7
};

struct Scans {
    std::vector<Scan> scans;
    Losses losses;  ///< only with `salvage`; rows that the scans promise and lack come on top
};

/// Finds the scans. Reads the whole file, because only its lines tell where the next scan begins. Errors: a
/// header that is no header, a scan with fewer or more rows than it promises.
///
/// With `salvage` a scan's rows end where the next header begins, whatever its own header promises. No row
/// comes under the pose of another scan: scans whose header is damaged are left out, and so are rows behind
/// unreadable text that may have been a header. Errors: no scan has a readable header.
Result<Scans> find_scans(std::shared_ptr<const ByteSource> file, char line_end, bool salvage);

/// Returns whether the text begins with two counts and three numbers.
bool begins_scan(std::string_view head);

}  // namespace lucarne::io::ptx
