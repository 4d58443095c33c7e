#include "gi/post/fill_gaps.h"

#include <algorithm>
#include <array>
#include <vector>

#include <glm/packing.hpp>
#include <glm/vec4.hpp>

#include "gi/post/bindings.h"
#include "io/core/parallel.h"

namespace lucarne::gi {
namespace {

constexpr size_t kRowsPerTask = 32;
constexpr uint8_t kFar = 255;  ///< no points are that near in this direction

/// A picture in memory. See fill_gaps.comp.
struct PictureToFill {
    int width, height, reach;
    const GBufferTexel* texels;
    const glm::vec4* radiance;
    bool averaged;
    uint32_t* pixels;

    size_t at(int x, int y) const {
        return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
    }
    bool has_points(size_t at) const { return averaged ? radiance[at].w > 0 : texels[at].depth != 0; }
};

/// The steps from each pixel of a row to the nearest pixel with points in four directions: along the row, and
/// three from the row before. Rows have a pixel more at both ends, which has no points.
struct Steps {
    enum Direction { along, straight, left, right };
    std::array<std::vector<uint8_t>, 4> to;

    explicit Steps(int width) {
        for (auto& row : to) row.assign(static_cast<size_t>(width) + 2, kFar);
    }
};

/// Follows `before`, the steps of the row before (`points_before`: where it has points), to the next row, and
/// along that row (`points`) from its beginning, or from its end.
void follow(const std::vector<uint8_t>& points_before, const Steps& before,
            const std::vector<uint8_t>& points, bool from_end, Steps& steps) {
    const size_t last = points.size() - 1;
    const auto next = [](uint8_t has_points, uint8_t count) {
        return has_points ? uint8_t{1} : static_cast<uint8_t>(count + (count < kFar));
    };
    for (const auto& [direction, from] :
         {std::pair{Steps::straight, 0}, {Steps::left, -1}, {Steps::right, 1}}) {
        const uint8_t* const seen = points_before.data() + from;
        const uint8_t* const counts = before.to[direction].data() + from;
        uint8_t* const result = steps.to[direction].data();
        for (size_t i = 1; i < last; ++i) result[i] = next(seen[i], counts[i]);
    }
    std::vector<uint8_t>& row = steps.to[Steps::along];
    for (size_t i = 1; i < last; ++i) {
        const size_t here = from_end ? last - i : i, there = from_end ? here + 1 : here - 1;
        row[here] = next(points[there], row[there]);
    }
}

/// Fills the rows from `first` to `last`, of which each is looked at with `reach` rows around them.
void fill_rows(const PictureToFill& picture, int first, int last) {
    const int begin = std::max(0, first - picture.reach),
              end = std::min(picture.height, last + picture.reach);
    const auto rows = static_cast<size_t>(end - begin);
    const std::vector<uint8_t> none(static_cast<size_t>(picture.width) + 2);
    std::vector<std::vector<uint8_t>> points(rows, none);
    for (size_t row = 0; row < rows; ++row)
        for (int x = 0; x < picture.width; ++x)
            points[row][static_cast<size_t>(x) + 1] =
                picture.has_points(picture.at(x, begin + static_cast<int>(row)));
    std::vector<Steps> down(rows, Steps(picture.width));
    const Steps nothing(picture.width);
    for (size_t row = 0; row < rows; ++row)
        follow(row ? points[row - 1] : none, row ? down[row - 1] : nothing, points[row], false, down[row]);
    Steps up = nothing, below = nothing;
    for (size_t row = rows; row-- > 0; std::swap(up, below)) {
        follow(row + 1 < rows ? points[row + 1] : none, below, points[row], true, up);
        const int y = begin + static_cast<int>(row);
        if (y < first || y >= last) continue;
        for (int x = 0; x < picture.width; ++x) {
            const auto i = static_cast<size_t>(x) + 1;
            if (points[row][i]) continue;
            glm::vec4 sum(0);
            float weights = 0;
            int between = 0;
            const auto add = [&](int steps, int dx, int dy) {
                if (steps > picture.reach) return 0;
                const float weight = 1.0f / static_cast<float>(steps * steps);
                sum +=
                    weight * glm::unpackUnorm4x8(picture.pixels[picture.at(x + steps * dx, y + steps * dy)]);
                weights += weight;
                return 1;
            };
            const auto& above = down[row].to;
            between += add(up.to[Steps::along][i], 1, 0) + add(above[Steps::along][i], -1, 0) == 2;
            between += add(up.to[Steps::straight][i], 0, 1) + add(above[Steps::straight][i], 0, -1) == 2;
            between += add(up.to[Steps::right][i], 1, 1) + add(above[Steps::left][i], -1, -1) == 2;
            between += add(above[Steps::right][i], 1, -1) + add(up.to[Steps::left][i], -1, 1) == 2;
            if (between >= 2) picture.pixels[picture.at(x, y)] = glm::packUnorm4x8(sum / weights);
        }
    }
}

Result<void> fill_natively(const GBuffer& gbuffer, const Buffer& radiance, bool averaged, uint32_t reach,
                           Buffer& picture) {
    LUCARNE_ASSIGN(const MappedBuffer texels, gbuffer.texels.map());
    LUCARNE_ASSIGN(const MappedBuffer light, radiance.map());
    LUCARNE_ASSIGN(const MappedBuffer pixels, picture.map());
    const PictureToFill mapped{static_cast<int>(gbuffer.width),
                               static_cast<int>(gbuffer.height),
                               static_cast<int>(reach),
                               texels.as<const GBufferTexel>().data(),
                               light.as<const glm::vec4>().data(),
                               averaged,
                               pixels.as<uint32_t>().data()};
    parallel_ranges(gbuffer.height, kRowsPerTask, [&](size_t first, size_t last) {
        fill_rows(mapped, static_cast<int>(first), static_cast<int>(last));
    });
    return {};
}

}  // namespace

Result<void> fill_gaps(Device& device, const GBuffer& gbuffer, const Buffer& radiance, bool averaged,
                       uint32_t reach, Buffer& picture) {
    reach = std::min(reach, kMostReach);
    if (device.native_passes()) return fill_natively(gbuffer, radiance, averaged, reach, picture);
    LUCARNE_ASSIGN(const Program* program, device.program("gi/post/fill_gaps.comp"));
    gbuffer.texels.bind_texels(post::kUnitGBuffer, TexelView::four_words);
    radiance.bind(post::kBindRadiance);
    picture.bind(post::kBindPicture);
    program->set("averaged", averaged ? 1u : 0u);
    program->set("reach", reach);
    program->set("width", gbuffer.width);
    program->set("height", gbuffer.height);
    program->dispatch(gbuffer.width * gbuffer.height);
    return {};
}

}  // namespace lucarne::gi
