// Coordinates that are no map's: degrees, and metres from the centre of the earth.
#include "io/formats/crs/frame.h"

#include <gmock/gmock.h>

#include "tests/io/formats/las/las_builder.h"
#include "tests/io/formats/scan_text.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;

class Frame : public testing::TextScan {
 protected:
    /// Returns what is said of a scan whose box has these corners.
    std::string said_of(const std::array<double, 3>& low, const std::array<double, 3>& high,
                        double scale = .001, const std::string& wkt = {}) {
        testing::LasFile file;
        file.scale[0] = file.scale[1] = scale;
        for (size_t axis = 0; axis < 3; ++axis) file.offset[axis] = low[axis];
        file.records = {testing::record0(0, 0, 0)};
        if (!wkt.empty()) file.add_vlr("LASF_Projection", 2112, wkt);
        std::string bytes = file.bytes();
        for (size_t axis = 0; axis < 3; ++axis) {
            testing::put(bytes, 179 + 16 * axis, high[axis]);
            testing::put(bytes, 187 + 16 * axis, low[axis]);
        }
        ::testing::internal::CaptureStderr();
        read(bytes);
        return ::testing::internal::GetCapturedStderr();
    }
};

TEST_F(Frame, CoordinatesFromTheCentreOfTheEarthNameAProjection) {
    EXPECT_THAT(said_of({4012345, 345678, 4923456}, {4012355, 345688, 4923466}),
                AllOf(HasSubstr("the centre of the earth"), HasSubstr("UTM zone 31N, EPSG:32631")));
    EXPECT_THAT(said_of({-4646000, 2553000, -3534000}, {-4645000, 2554000, -3533000}),
                HasSubstr("UTM zone 56S, EPSG:32756"));
    // As far from the origin, but on a map.
    EXPECT_EQ(said_of({500000, 6350000, 100}, {501000, 6351000, 200}), "");
    EXPECT_EQ(said_of({500000, 6350000, 8000}, {501000, 6351000, 8800}), "");
    EXPECT_EQ(said_of({0, 0, 0}, {0, 0, 0}), "");
}

TEST_F(Frame, DegreesNameAProjection) {
    EXPECT_THAT(said_of({-123, 45, 300}, {-122.5, 45.2, 320}, 1e-9),
                AllOf(HasSubstr("seem to be degrees"), HasSubstr("UTM zone 10N, EPSG:32610")));
    EXPECT_THAT(said_of({179, -17, 0}, {180, -16, 20}, 1e-7), HasSubstr("UTM zone 60S, EPSG:32760"));
    EXPECT_THAT(
        said_of({12, 55, 0}, {13, 56, 20}, 1e-7, R"(GEOGCS["WGS 84",UNIT["degree",0.0174532925199433]])"),
        AllOf(HasSubstr("are degrees"), HasSubstr("EPSG:32633")));
    // Lengths with the usual scale, or farther than the globe goes.
    EXPECT_EQ(said_of({-12, 4, 0}, {12, 5, 3}), "");
    EXPECT_EQ(said_of({-12, 4, 0}, {12, 500, 3}, 1e-7), "");
}

}  // namespace
}  // namespace lucarne::io
