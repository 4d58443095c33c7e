#pragma once

#include <cstdint>

namespace lucarne::gi::vpl {

// Storage bindings of this engine's shaders; bindings 0 to 2 belong to the cut.
inline constexpr uint32_t kBindMaterials = 3;
inline constexpr uint32_t kBindGBuffer = 4;   // texels of the camera's or the light's G-buffer
inline constexpr uint32_t kBindLightIds = 5;  // surfel ids of the light's G-buffer
inline constexpr uint32_t kBindCasters = 5;
inline constexpr uint32_t kBindLarge = 6;
inline constexpr uint32_t kBindPoints = 7;    // Halton points
inline constexpr uint32_t kBindMeetings = 7;  // block-map pairs that pass the culling, queue.glsl
inline constexpr uint32_t kBindImportance = 8;
inline constexpr uint32_t kBindSources = 8;
inline constexpr uint32_t kBindHistory = 8;  // history.glsl
inline constexpr uint32_t kBindLights = 9;   // VplLight[]
inline constexpr uint32_t kBindHistorySurfaces = 9;
inline constexpr uint32_t kBindAtlas = 10;
inline constexpr uint32_t kBindCoarse = 11;
inline constexpr uint32_t kBindQueue = 11;
inline constexpr uint32_t kBindLonely = 11;  // isolated pixels, join.comp
inline constexpr uint32_t kBindFringe = 12;
inline constexpr uint32_t kBindFringeSources = 13;
inline constexpr uint32_t kBindDiffuse = 12;   // irradiance from the VPLs, one a pixel
inline constexpr uint32_t kBindSpecular = 13;  // radiance by the receiver's lobe, one a pixel
inline constexpr uint32_t kBindRadiance = 14;
inline constexpr uint32_t kBindOdds = 14;    // weight sums, redistribute.comp
inline constexpr uint32_t kBindJoints = 15;  // join.glsl

// Texture units of buffers that are read as texels; units 0 to 2 belong to the cut.
inline constexpr uint32_t kUnitLights = 3;
inline constexpr uint32_t kUnitGBuffer = 4;
inline constexpr uint32_t kUnitAtlas = 5;
inline constexpr uint32_t kUnitCasters = 6;
inline constexpr uint32_t kUnitBounds = 7;
inline constexpr uint32_t kUnitDiffuse = 8;
inline constexpr uint32_t kUnitSpecular = 9;
inline constexpr uint32_t kUnitOwnDiffuse = 10;
inline constexpr uint32_t kUnitOwnSpecular = 11;
inline constexpr uint32_t kUnitSources = 12;
inline constexpr uint32_t kUnitOdds = 13;
inline constexpr uint32_t kUnitHistory = 14;
inline constexpr uint32_t kUnitHistorySurfaces = 15;

}  // namespace lucarne::gi::vpl
