#pragma once

#include <cstdint>

namespace lucarne::gi::vpl {

// Storage bindings of this room's shaders; 0 to 2 are the cut's.
inline constexpr uint32_t kBindMaterials = 3;
inline constexpr uint32_t kBindGBuffer = 4;   // camera's or light's texels
inline constexpr uint32_t kBindLightIds = 5;  // of the surfels behind the light's texels
inline constexpr uint32_t kBindCasters = 5;
inline constexpr uint32_t kBindLarge = 6;
inline constexpr uint32_t kBindPoints = 7;  // Halton points
inline constexpr uint32_t kBindMeetings = 7;
inline constexpr uint32_t kBindImportance = 8;
inline constexpr uint32_t kBindSources = 8;
inline constexpr uint32_t kBindHistory = 8;  // history.glsl
inline constexpr uint32_t kBindLights = 9;   // VplLight[]
inline constexpr uint32_t kBindHistorySurfaces = 9;
inline constexpr uint32_t kBindAtlas = 10;
inline constexpr uint32_t kBindCoarse = 11;
inline constexpr uint32_t kBindQueue = 11;
inline constexpr uint32_t kBindLonely = 11;
inline constexpr uint32_t kBindFringe = 12;
inline constexpr uint32_t kBindFringeSources = 13;
inline constexpr uint32_t kBindDiffuse = 12;   // irradiance from the VPLs, a pixel
inline constexpr uint32_t kBindSpecular = 13;  // radiance by the receiver's lobe, a pixel
inline constexpr uint32_t kBindRadiance = 14;
inline constexpr uint32_t kBindOdds = 14;    // redistribution.glsl
inline constexpr uint32_t kBindJoints = 15;  // join.glsl

// Texture units of what is read as texels; 0 to 2 are the cut's.
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
