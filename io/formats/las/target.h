#pragma once

#include <limits>

#include "io/formats/las/layout.h"
#include "io/formats/scan.h"

// Chooses a LAS file that can hold the records of a schema, and converts the records to its layout.
namespace lucarne::io::las {

/// Converts records of any schema to records of make_schema(header).
class Converter {
 public:
    Converter() = default;
    Converter(const Schema& from, const Schema& to) : from_(from), to_(to) {}

    /// How one attribute becomes another: value * factor + shift, but no more than `most`.
    struct Field {
        Attribute from, to;
        double factor = 1.0, shift = 0.0, most = std::numeric_limits<double>::infinity();
        bool fills = false;  ///< only replaces values of 0
    };
    void map(const Field& field) { fields_.push_back(field); }
    /// Returns false if a position does not fit 32-bit integers with the target's scale and offset.
    bool convert(const std::byte* in, size_t count, std::byte* out);
    /// Returns the largest rounding of a position so far. Differences below the resolution of its type do not
    /// count.
    double rounded() const { return rounded_; }
    /// Returns whether both schemas are the same, so that there is nothing to convert.
    bool identity() const { return from_ == to_; }

 private:
    bool convert_position(const std::byte* in, std::byte* out);

    Schema from_, to_;
    std::vector<Field> fields_;
    double rounded_ = 0;
};

enum class Container { las, laz, copc };

struct Target {
    Header header;
    Schema schema;  ///< make_schema(header)
    Converter converter;
};

/// Chooses the header and the conversion. If the source was LAS, takes the header kept in `info.notes`.
/// Otherwise takes the smallest point format that has a field for every attribute it knows. An attribute
/// without a field, or one that does not fit the field's type, becomes extra bytes; in the second case the
/// field gets an approximation (see extras.h). Positions that are not integers yet get the lattice of
/// `options`, otherwise the decimals that its preview shows, otherwise the finest lattice that their box
/// allows. COPC allows only point formats 6 to 8.
Result<Target> make_target(const std::string& path, const Schema& schema, const ScanInfo& info,
                           const WriteOptions& options, Container container);

}  // namespace lucarne::io::las
