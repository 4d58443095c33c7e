#pragma once

#include <functional>
#include <string>
#include <vector>

#include "io/points.h"

namespace lucarne::octree {

/// Converts records from one schema into another that has all of its attributes, in types that can represent
/// every value. Attributes that only the other schema has become zero; 8-bit colour in 16-bit fields becomes
/// 16-bit colour.
class RecordMap {
 public:
    using Rename = std::function<std::string(const io::Attribute&)>;
    /// `rename` returns the name that an attribute of `from` has in `to`.
    RecordMap(const io::Schema& from, const io::Schema& to, const Rename& rename);
    RecordMap(const io::Schema& from, const io::Schema& to)
        : RecordMap(from, to, [](const io::Attribute& a) { return a.name; }) {}

    /// Whether `to` can hold everything of `from`. Must be true before records are converted.
    static bool fits(const io::Schema& from, const io::Schema& to);
    bool identical() const { return identical_; }
    /// Replaces the contents of `out` with `count` converted records.
    void convert(const std::byte* records, size_t count, std::vector<std::byte>& out) const;

 private:
    struct Step {
        uint32_t from = 0, to = 0, bytes = 0;  ///< bytes copied unchanged...
        uint32_t components = 0;               ///< ...or, where not 0, numbers converted one by one
        io::ScalarType from_type{}, to_type{};
        double factor = 1;
    };
    io::Schema from_;
    uint32_t stride_;
    bool identical_ = false, convert_position_ = false;
    std::vector<Step> steps_;
};

}  // namespace lucarne::octree
