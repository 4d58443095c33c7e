#pragma once

#include <functional>
#include <string>
#include <vector>

#include "io/points.h"

namespace lucarne::octree {

/// Converts records from one schema into another that has all their attributes, in types that hold every
/// value. What the other has besides becomes zero; 8-bit colour in 16-bit fields becomes 16-bit colour.
class RecordMap {
 public:
    using Rename = std::function<std::string(const io::Attribute&)>;
    /// `rename` gives an attribute's name in `to`.
    RecordMap(const io::Schema& from, const io::Schema& to, const Rename& rename);
    RecordMap(const io::Schema& from, const io::Schema& to)
        : RecordMap(from, to, [](const io::Attribute& a) { return a.name; }) {}

    /// Whether `to` has a place for everything of `from`: what must hold before records are converted.
    static bool fits(const io::Schema& from, const io::Schema& to);
    bool identical() const { return identical_; }
    /// Replaces `out` by `count` records.
    void convert(const std::byte* records, size_t count, std::vector<std::byte>& out) const;

 private:
    struct Step {
        uint32_t from = 0, to = 0, bytes = 0;  ///< copied as they are...
        uint32_t components = 0;               ///< ...or, where not 0, converted one by one
        io::ScalarType from_type{}, to_type{};
        double factor = 1;
    };
    io::Schema from_;
    uint32_t stride_;
    bool identical_ = false, convert_position_ = false;
    std::vector<Step> steps_;
};

}  // namespace lucarne::octree
