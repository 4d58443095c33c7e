// Which station saw a point, for ids of any number type, including values that make no sense.
#include "octree/tree/station_ids.h"

#include <cmath>

#include <gtest/gtest.h>

namespace lucarne::octree {
namespace {

TEST(StationIds, NumbersThatAreNoIdNameNoStation) {
    io::Schema schema;
    schema.stride = static_cast<uint32_t>(io::position_bytes(schema.position));
    schema.add(std::string(io::names::point_source_id), io::ScalarType::f64);
    io::ScanInfo scan;
    scan.stations = {{0, {0, 0, 0}}, {1, {1, 0, 0}}, {UINT32_MAX, {2, 0, 0}}};
    const StationIds ids({scan}, schema);
    const auto of = [&](double id) {
        std::vector<std::byte> record(schema.stride);
        io::store(&record[schema.attributes[0].offset], id);
        return ids.of(record.data());
    };
    EXPECT_EQ(of(0), 0);
    EXPECT_EQ(of(1), 1);
    EXPECT_EQ(of(4294967295.0), 2);
    EXPECT_EQ(of(2), -1);
    for (const double none :
         {-1.0, 0.5, 4294967296.0, 4294967297.0, 1e300, -1e300, double{INFINITY}, double{NAN}})
        EXPECT_EQ(of(none), -1) << none;
}

TEST(StationIds, AnEstimatedStationSawAllPointsOfItsScanOrNamesNone) {
    io::Schema schema;
    schema.stride = static_cast<uint32_t>(io::position_bytes(schema.position));
    schema.add(std::string(io::names::scan), io::ScalarType::u16);
    std::vector<io::ScanInfo> scans(3);
    scans[1].stations = {{7, {1, 0, 0}}};
    const std::vector<EstimatedStation> estimated = {
        {0, {2, 0, 0}, true}, {1, {3, 0, 0}, true}, {2, {4, 0, 0}}, {2, {5, 0, 0}}};
    const StationIds ids(scans, schema, estimated);
    const auto of = [&](uint16_t scan) {
        std::vector<std::byte> record(schema.stride);
        io::store(&record[schema.attributes[0].offset], scan);
        return ids.of(record.data());
    };
    EXPECT_EQ(ids.stations().size(), 5u);
    EXPECT_EQ(ids.stated(), 1u);
    EXPECT_EQ(of(0), 1);
    EXPECT_EQ(of(1), 0) << "what the file states counts";
    EXPECT_EQ(of(2), -1);
    EXPECT_EQ(of(3), -1);
}

}  // namespace
}  // namespace lucarne::octree
