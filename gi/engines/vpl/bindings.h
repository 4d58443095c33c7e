// Bindings of the shaders of this engine, shared by C++ and GLSL.
#ifndef LUCARNE_GI_ENGINES_VPL_BINDINGS_H
#define LUCARNE_GI_ENGINES_VPL_BINDINGS_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::vpl {
#endif

// Storage bindings of this engine's shaders; bindings 0 to 2 belong to the cut.
const uint kBindMaterials = 3u;
const uint kBindGBuffer = 4u;   // texels of the camera's or the light's G-buffer
const uint kBindLightIds = 5u;  // surfel ids of the light's G-buffer
const uint kBindCasters = 5u;
const uint kBindBounds = 5u;    // bounds of blocks, queue.glsl
const uint kBindEmitters = 5u;  // weights of emitting surfels, or those that were drawn
const uint kBindLarge = 6u;
const uint kBindPoints = 7u;    // Halton points
const uint kBindMeetings = 7u;  // block-map pairs that pass the culling, queue.glsl
const uint kBindImportance = 8u;
const uint kBindSources = 8u;
const uint kBindHistory = 8u;  // history.glsl
const uint kBindLights = 9u;   // VplLight[]
const uint kBindHistorySurfaces = 9u;
const uint kBindAtlas = 10u;
const uint kBindCoarse = 11u;
const uint kBindQueues = 11u;    // shadow_maps/queue.h
const uint kBindIsolated = 11u;  // isolated pixels, join.comp
const uint kBindFringe = 12u;
const uint kBindFringeSources = 13u;
const uint kBindDiffuse = 12u;         // irradiance from the VPLs, one a pixel
const uint kBindSpecular = 13u;        // radiance by the receiver's lobe, one a pixel
const uint kBindViewImportance = 13u;  // of candidates for VPLs, measure.comp
const uint kBindOpenings = 13u;        // importance of directions of the sky, openings.comp
const uint kBindRadiance = 14u;
const uint kBindPairs = 14u;       // pairs of surfel and map, shadow_maps/queue.glsl
const uint kBindWeightSums = 14u;  // weight sums, redistribute.comp
const uint kBindJoints = 15u;      // join.glsl

// Texture units of buffers that are read as texels; units 0 to 2 belong to the cut.
const uint kUnitLights = 3u;
const uint kUnitGBuffer = 4u;
const uint kUnitAtlas = 5u;
const uint kUnitCasters = 6u;
const uint kUnitBounds = 7u;
const uint kUnitDiffuse = 8u;
const uint kUnitSpecular = 9u;
const uint kUnitOwnDiffuse = 10u;
const uint kUnitOwnSpecular = 11u;
const uint kUnitSources = 12u;
const uint kUnitWeightSums = 13u;
const uint kUnitHistory = 14u;
const uint kUnitHistorySurfaces = 15u;

#ifdef __cplusplus
}  // namespace lucarne::gi::vpl
#endif
#endif
