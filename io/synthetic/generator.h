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

/// Makes the records of a virtual scan in numbered pieces that do not depend on each other: run in any order,
/// by any number of threads, laid end to end they are the same bytes. Thread-safe.
class PieceGenerator {
 public:
    virtual ~PieceGenerator() = default;
    virtual uint64_t pieces() const = 0;
    virtual void generate(uint64_t piece, std::vector<std::byte>& records) const = 0;
};

/// Packs one point as the schema of virtual scans wants it.
class RecordPacker {
 public:
    static constexpr double kScale = 1e-4;  ///< metres in a position step
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

/// Exactly `points` samples, spread evenly over the area: rows of nearly hexagonal, jittered cells across
/// each patch.
std::unique_ptr<PieceGenerator> make_even_sampler(std::shared_ptr<const SceneGeometry> geometry,
                                                  const RecordPacker& packer, uint64_t points, uint64_t seed);

struct ScanSetup {
    std::vector<glm::dvec3> stations;
    uint64_t points = 0;  ///< about how many, over all stations
    double noise = 0;     ///< standard deviation of the range, metres
    uint64_t seed = 0;
};
/// A terrestrial laser scanner set up at each station in turn; point_source_id counts from 1.
std::unique_ptr<PieceGenerator> make_scanner(std::shared_ptr<const SceneGeometry> geometry,
                                             const RecordPacker& packer, const ScanSetup& setup);

/// The benchmark's town, about `options.points` points of it (survey.cpp): no surface to compare with.
std::unique_ptr<PieceGenerator> make_survey(const SyntheticOptions& options);
Schema survey_schema();

}  // namespace lucarne::io
