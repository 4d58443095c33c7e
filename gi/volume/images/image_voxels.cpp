#include "gi/volume/images/image_voxels.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/native/reflectance.h"
#include "gi/shared/surfel_code.h"
#include "gi/volume/images/seen.h"
#include "io/core/parallel.h"

namespace lucarne::gi::volume {
namespace {

constexpr uint32_t kEmptySlot = 0xffffffffu, kOutside = 0xfffffffeu;
constexpr size_t kVoxelsATask = 4096, kSamplesATask = 8192, kRowsATask = 64, kBricksATask = 512;
constexpr int kBrick = 4;  ///< voxels along each axis
/// Cells farther away than this have no number.
constexpr float kFarthestCell = 1e9f;

/// Returns the middle of a cell, m.
glm::vec3 middle_of(const glm::ivec3& cell, float voxel) {
    return (glm::vec3(cell) + 0.5f) * voxel;
}

int wrapped(int at, int size) {
    const int rest = at % size;
    return rest < 0 ? rest + size : rest;
}

constexpr uint32_t kColourBits = 0x3fffffffu;

}  // namespace

ImageVoxels::ImageVoxels(const glm::ivec3& size, float voxel, const glm::ivec3& low)
    : grid_{glm::vec3(0.0f), voxel, size}, low_(low), numbers_(grid_.cells(), kEmptySlot) {
    assert(size.x > 0 && size.y > 0 && size.z > 0 && voxel > 0);
}

uint32_t ImageVoxels::slot(const glm::ivec3& cell) const {
    return grid_.number(
        {wrapped(cell.x, grid_.size.x), wrapped(cell.y, grid_.size.y), wrapped(cell.z, grid_.size.z)});
}

const SeenVoxel* ImageVoxels::at(const glm::ivec3& cell) const {
    if (!holds(cell)) return nullptr;
    const uint32_t number = numbers_[slot(cell)];
    return number == kEmptySlot ? nullptr : &voxels_[number];
}

VoxelSet ImageVoxels::set() const {
    VoxelSet set{grid_, glm::dvec3(low_) * static_cast<double>(grid_.voxel), {}};
    for (const SeenVoxel& voxel : voxels_)
        set.voxels.push_back(
            {grid_.number(voxel.cell - low_), 0,
             voxel.normal == SeenVoxel::kNoSide ? glm::vec3(0.0f) : decode_octahedral(voxel.normal),
             decode_albedo(voxel.albedo)});
    std::ranges::sort(set.voxels, {}, &OccupiedVoxel::cell);
    return set;
}

void ImageVoxels::clear() {
    for (const SeenVoxel& voxel : voxels_) numbers_[slot(voxel.cell)] = kEmptySlot;
    voxels_.clear();
}

/// Copies the voxels that are to stay, by number, from V_prev to V_curr.
template <class Stays>
void ImageVoxels::keep(const Stays& stays) {
    before_.swap(voxels_);
    voxels_.clear();
    for (size_t i = 0; i < before_.size(); ++i) {
        uint32_t& number = numbers_[slot(before_[i].cell)];
        number = stays(i) ? static_cast<uint32_t>(voxels_.size()) : kEmptySlot;
        if (number != kEmptySlot) voxels_.push_back(before_[i]);
    }
}

void ImageVoxels::move_to(const glm::ivec3& low) {
    if (low == low_) return;
    keep([&](size_t i) { return grid_.holds(before_[i].cell - low); });
    low_ = low;
}

void ImageVoxels::update(std::span<const SeenImage> images, const ImageUpdate& how) {
    ++frame_;
    if (how.fused) {
        fuse(images, how);
    } else {
        clean(images, how);
        inject(images, how);
    }
}

/// Clears the voxels that any picture shows to be empty.
void ImageVoxels::clean(std::span<const SeenImage> images, const ImageUpdate& how) {
    std::vector<VoxelSight> sights;
    for (const SeenImage& image : images) sights.emplace_back(image, grid_.voxel);
    std::vector<uint8_t> kept(voxels_.size(), 1);
    parallel_ranges(voxels_.size(), kVoxelsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const glm::vec3 middle = middle_of(voxels_[i].cell, grid_.voxel);
            kept[i] = std::ranges::none_of(sights, [&](const VoxelSight& sight) {
                size_t pixel = 0;
                return sight.at(middle, pixel) == Sight::empty &&
                       (!how.careful || sight.surely_empty(middle));
            });
        }
    });
    keep([&](size_t i) { return kept[i] != 0; });
}

void ImageVoxels::inject(std::span<const SeenImage> images, const ImageUpdate& how) {
    filled_.clear();
    sums_.resize(voxels_.size());
    for (uint32_t i = 0; i < images.size(); ++i) {
        inject(images[i], i + 1, how);
        finish_image(images[i]);
    }
    // Means of this update alone: nothing adds up over time.
    parallel_ranges(filled_.size(), kVoxelsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            SeenVoxel& voxel = voxels_[filled_[i]];
            const Sums& sums = sums_[filled_[i]];
            const float length = glm::length(sums.normal);
            voxel.normal =
                length > 1e-3f * sums.count ? encode_octahedral(sums.normal / length) : SeenVoxel::kNoSide;
            voxel.albedo = encode_albedo(sums.albedo / sums.count);
        }
    });
}

/// Adds the samples of a picture to the sums of their voxels.
void ImageVoxels::inject(const SeenImage& image, uint32_t number, const ImageUpdate& how) {
    const uint32_t longer = std::max(image.view.width, image.view.height);
    const uint32_t step = how.samples == 0 ? 1 : std::max(1u, longer / how.samples);
    const uint32_t across = (image.view.width + step - 1) / step,
                   down = (image.view.height + step - 1) / step;
    const auto pixel_of = [&](size_t sample) {
        const auto x = std::min<size_t>(sample % across * step + step / 2, image.view.width - 1);
        const auto y = std::min<size_t>(sample / across * step + step / 2, image.view.height - 1);
        return glm::uvec2(x, y);
    };
    std::vector<std::pair<uint32_t, glm::ivec3>> places(size_t{across} * down, {kOutside, glm::ivec3(0)});
    parallel_ranges(places.size(), kSamplesATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const glm::uvec2 at = pixel_of(i);
            const GBufferTexel& texel = image.texels[size_t{at.y} * image.view.width + at.x];
            if (!(texel.depth > 0)) continue;
            const glm::vec3 place =
                glm::floor(texel_position(image.view, glm::vec2(at), texel) / grid_.voxel);
            const glm::vec3 far = glm::abs(place);
            if (!(far.x < kFarthestCell && far.y < kFarthestCell && far.z < kFarthestCell)) continue;
            const glm::ivec3 cell(place);
            if (holds(cell)) places[i] = {slot(cell), cell};
        }
    });
    touched_.clear();
    for (size_t i = 0; i < places.size(); ++i) {
        const auto& [home, cell] = places[i];
        if (home == kOutside) continue;
        uint32_t& voxel = numbers_[home];
        if (voxel == kEmptySlot) {
            voxel = static_cast<uint32_t>(voxels_.size());
            voxels_.push_back({.cell = cell});
            sums_.emplace_back();
        }
        Sums& sums = sums_[voxel];
        if (sums.frame != frame_) {
            sums = {.frame = frame_};
            filled_.push_back(voxel);
        }
        if (sums.image != number) {
            sums.image = number;
            sums.image_count = 0;
            sums.image_light = glm::vec3(0.0f);
            touched_.push_back(voxel);
        }
        const glm::uvec2 at = pixel_of(i);
        const size_t pixel = size_t{at.y} * image.view.width + at.x;
        const GBufferTexel& texel = image.texels[pixel];
        sums.normal += texel_normal(texel);
        sums.albedo += native::linear_albedo(texel.albedo);
        sums.count += 1;
        sums.image_count += 1;
        if (!image.light.empty()) sums.image_light += image.light[pixel];
    }
}

/// Brings the light of a picture to its voxels. The first light of an update replaces what was there; further
/// lights add to it; a camera shows all light at once and replaces that of the lights (chapter 7.5).
void ImageVoxels::finish_image(const SeenImage& image) {
    if (image.light.empty()) return;
    for (const uint32_t voxel : touched_) {
        Sums& sums = sums_[voxel];
        const glm::vec3 light = sums.image_light / sums.image_count;
        voxels_[voxel].light = image.of_light && sums.lit ? voxels_[voxel].light + light : light;
        sums.lit = true;
    }
}

/// Tells for each brick of the window, x fastest, whether pictures may show a surface in its voxels.
std::vector<uint8_t> ImageVoxels::shown_bricks(std::span<const VoxelSight> sights,
                                               std::span<const SeenImage> images) const {
    std::vector<DepthTiles> tiles;
    for (const SeenImage& image : images) tiles.emplace_back(image);
    const glm::ivec3 count = (grid_.size + kBrick - 1) / kBrick;
    const float radius = 0.5f * std::sqrt(3.0f) * (kBrick - 1) * grid_.voxel;  // about the middles of voxels
    std::vector<uint8_t> shown(static_cast<size_t>(count.x) * static_cast<size_t>(count.y) *
                               static_cast<size_t>(count.z));
    parallel_ranges(shown.size(), kBricksATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const int brick = static_cast<int>(i);
            const glm::ivec3 at(brick % count.x, brick / count.x % count.y, brick / count.x / count.y);
            const glm::vec3 middle =
                (glm::vec3(low_ + kBrick * at) + 0.5f * static_cast<float>(kBrick)) * grid_.voxel;
            for (size_t k = 0; k < sights.size() && !shown[i]; ++k)
                shown[i] = sights[k].may_show_surface(middle, radius, tiles[k]) ? 1 : 0;
        }
    });
    return shown;
}

/// Clears, keeps or fills every voxel of the window by what the pictures show at its middle. Voxels that are
/// empty stay so in bricks in which no surface can be visible.
void ImageVoxels::fuse(std::span<const SeenImage> images, const ImageUpdate& how) {
    std::vector<VoxelSight> sights;
    for (const SeenImage& image : images) sights.emplace_back(image, grid_.voxel);
    const std::vector<uint8_t> shown = shown_bricks(sights, images);
    const glm::ivec3 across = (grid_.size + kBrick - 1) / kBrick;  // bricks
    std::vector<int> wrapped_x;
    for (int x = 0; x < grid_.size.x; ++x) wrapped_x.push_back(wrapped(low_.x + x, grid_.size.x));
    std::vector<std::vector<SeenVoxel>> rows(static_cast<size_t>(grid_.size.y) *
                                             static_cast<size_t>(grid_.size.z));
    parallel_ranges(rows.size(), kRowsATask, [&](size_t first, size_t last) {
        for (size_t row = first; row < last; ++row) {
            glm::ivec3 cell = low_ + glm::ivec3(0, static_cast<int>(row) % grid_.size.y,
                                                static_cast<int>(row) / grid_.size.y);
            const glm::ivec3 home(0, wrapped(cell.y, grid_.size.y), wrapped(cell.z, grid_.size.z));
            const uint32_t* numbers = &numbers_[grid_.number(home)];
            const glm::ivec3 brick = (cell - low_) / kBrick;
            const uint8_t* bricks = &shown[static_cast<size_t>((brick.z * across.y + brick.y) * across.x)];
            for (int x = 0; x < grid_.size.x; ++x) {
                const uint32_t number = numbers[wrapped_x[static_cast<size_t>(x)]];
                if (number != kEmptySlot || bricks[x / kBrick])
                    fuse_cell(sights, images, how, cell, number, rows[row]);
                ++cell.x;
            }
        }
    });
    for (const SeenVoxel& voxel : voxels_) numbers_[slot(voxel.cell)] = kEmptySlot;
    before_.swap(voxels_);
    voxels_.clear();
    for (const auto& row : rows) voxels_.insert(voxels_.end(), row.begin(), row.end());
    for (uint32_t i = 0; i < voxels_.size(); ++i) numbers_[slot(voxels_[i].cell)] = i;
}

/// Adds the voxel at a cell to `row` if it is filled afterwards. `number`: of the voxel there, or kEmptySlot.
void ImageVoxels::fuse_cell(std::span<const VoxelSight> sights, std::span<const SeenImage> images,
                            const ImageUpdate& how, const glm::ivec3& cell, uint32_t number,
                            std::vector<SeenVoxel>& row) const {
    const glm::vec3 middle = middle_of(cell, grid_.voxel);
    bool filled = number != kEmptySlot, lit = false;
    SeenVoxel voxel;
    if (filled) voxel = voxels_[number];
    for (size_t i = 0; i < images.size(); ++i) {
        size_t pixel = 0;
        const Sight sight = sights[i].at(middle, pixel);
        if (sight == Sight::empty && filled && (!how.careful || sights[i].surely_empty(middle)))
            filled = false;
        if (sight != Sight::surface) continue;
        filled = true;
        voxel.cell = cell;
        voxel.normal = images[i].texels[pixel].normal;
        voxel.albedo = images[i].texels[pixel].albedo & kColourBits;
        if (images[i].light.empty()) continue;
        const glm::vec3& light = images[i].light[pixel];
        voxel.light = images[i].of_light && lit ? voxel.light + light : light;
        lit = true;
    }
    if (filled) row.push_back(voxel);
}

}  // namespace lucarne::gi::volume
