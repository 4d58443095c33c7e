#pragma once

#include <limits>

#include "io/formats/las/layout.h"
#include "io/formats/scan.h"

// Which LAS file can hold the records of a schema, and how they are brought into its layout.
namespace lucarne::io::las {

/// Turns records of any schema into records of make_schema(header).
class Converter {
 public:
    Converter() = default;
    Converter(const Schema& from, const Schema& to) : from_(from), to_(to) {}

    /// An attribute becomes another: value * factor + shift, `most` at most.
    struct Field {
        Attribute from, to;
        double factor = 1.0, shift = 0.0, most = std::numeric_limits<double>::infinity();
        bool fills = false;  ///< only what is 0 so far
    };
    void map(const Field& field) { fields_.push_back(field); }
    /// False where a position does not fit 32-bit integers with the target's scale and offset.
    bool convert(const std::byte* in, size_t count, std::byte* out);
    /// By how much positions were rounded so far, at most: less than their type tells apart is none.
    double rounded() const { return rounded_; }
    /// Nothing to do: both schemas are the same.
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

/// The header kept in `info.notes` where the source was LAS, else the smallest point format that has a
/// field for every attribute it knows. What has no field, or does not fit the field's type, becomes extra
/// bytes (where it does not fit, the field gets what comes near: las_extras.h). Positions that are not
/// integers yet get the lattice of `options`, else the decimals that its preview shows, else the finest its
/// box allows. COPC has point formats 6 to 8 only.
Result<Target> make_target(const std::string& path, const Schema& schema, const ScanInfo& info,
                           const WriteOptions& options, Container container);

}  // namespace lucarne::io::las
