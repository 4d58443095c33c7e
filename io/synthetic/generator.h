#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <glm/vec3.hpp>

#include "io/points.h"
#include "io/synthetic/scene_geometry.h"
#include "io/synthetic/synthetic.h"

namespace lucarne::io {

/// Generates the records of a virtual scan in numbered pieces. The pieces are independent: generated in any
/// order by any number of threads, they concatenate to the same bytes. Thread-safe.
class PieceGenerator {
 public:
    virtual ~PieceGenerator() = default;
    virtual uint64_t pieces() const = 0;
    virtual void generate(uint64_t piece, std::vector<std::byte>& records) const = 0;
};

/// Packs one point into a record of the virtual scans' schema.
class RecordPacker {
 public:
    static constexpr double kScale = 1e-4;  ///< metres per position step
    RecordPacker(bool with_station, bool with_normal);
    const Schema& schema() const { return schema_; }
    struct Point {
        glm::dvec3 position, normal, albedo;
        double signal = 0;  ///< strength of the return, 0..1
        uint16_t station = 0;
    };
    void append(const Point& point, std::vector<std::byte>& records) const;

 private:
    Schema schema_;
    bool with_station_, with_normal_;
};

/// Generates exactly `points` samples, spread evenly over the area: rows of nearly hexagonal, jittered cells
/// across each patch.
std::unique_ptr<PieceGenerator> make_even_sampler(std::shared_ptr<const SceneGeometry> geometry,
                                                  const RecordPacker& packer, uint64_t points, uint64_t seed);

struct ScanSetup {
    std::vector<glm::dvec3> stations;
    uint64_t points = 0;  ///< approximate total of all stations
    double noise = 0;     ///< standard deviation of the range, metres
    uint64_t seed = 0;
};
/// Simulates a terrestrial laser scanner at each station in turn; point_source_id counts from 1.
std::unique_ptr<PieceGenerator> make_scanner(std::shared_ptr<const SceneGeometry> geometry,
                                             const RecordPacker& packer, const ScanSetup& setup);

/// Generates the benchmark's town with about `options.points` points (survey.cpp). It has no surface to
/// compare with.
std::unique_ptr<PieceGenerator> make_survey(const SyntheticOptions& options);
Schema survey_schema();

}  // namespace lucarne::io
