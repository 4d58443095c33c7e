// The fringe: what splats cover beyond the surface that is certainly there. A splat that stands in for its neighbours
// is larger than its surfel, and sticks out at the edge of a surface. Drawn whole, every outline in every map would
// be a texel and a half too wide. So the core of a splat goes to the atlas and the rest goes here; close.comp takes
// it only where the surface continues on both sides.
#include "gi/engines/vpl/bindings.h"

layout(std430, binding = kBindFringe) buffer Fringe { uint fringe[]; };  // same layout as the atlas
#ifdef LUCARNE_SOURCES
layout(std430, binding = kBindFringeSources) buffer FringeSources { uint fringe_sources[]; };  // sources.glsl
#endif
